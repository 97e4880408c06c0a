// SPDX-License-Identifier: Apache-2.0
// Expected change over the next sub-step of quantities that follow the motion.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"

namespace slew::coupling {

// The change over the last sub-step is continued, limited to twice the one before it, and dropped if the two differ in
// sign (the limiter of van Leer 1977, J. Comput. Phys. 23, 276): a smooth change is continued to second order, an
// alternating one gives no expected change. Both are changes from the beginning of a sub-step to its own end, under the
// inputs held in it: neither contains a jump between two sub-steps. A caller that changes an input, or detects a
// change, calls forget().
class Trends {
 public:
  explicit Trends(std::size_t count) : last_(count) {}

  // Takes the value at the beginning of a sub-step; returns the expected change until its end, 0 for the first two
  // sub-steps.
  [[nodiscard]] double begin(std::size_t index, double value) noexcept;
  // Takes the value at its end, less changes from other known causes; ignored if the sub-step was not begun.
  void end(std::size_t index, double value) noexcept;

  // Drops the history of one quantity, of all.
  void forget(std::size_t index) noexcept { last_[index] = {}; }
  void clear() noexcept { last_.assign(last_.size(), {}); }

  // Between sub-steps.
  void save(StateWriter& bytes) const { visit(last_, bytes); }
  void load(StateReader& bytes) noexcept { visit(last_, bytes); }
  void add_to(StateHash& hash) const noexcept {
    for (const Last& last : last_) {
      hash.add(last.change);
      hash.add(last.before);
    }
  }

 private:
  struct Last {
    double change = 0, before = 0;  // over the last two sub-steps
    double begun = std::numeric_limits<double>::quiet_NaN();
  };
  template <typename Values, typename Bytes>
  static void visit(Values& values, Bytes& bytes) {
    for (auto& last : values) {
      bytes.number(last.change);
      bytes.number(last.before);
    }
  }
  std::vector<Last> last_;
};

}  // namespace slew::coupling
