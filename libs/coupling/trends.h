// What quantities that follow the motion will change by over the sub-step to come.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "core/state_bytes.h"
#include "core/state_hash.h"

namespace slew::coupling {

// The change over the last sub-step goes on, limited to twice the one before it, and not where the two differ in sign
// (the limiter of van Leer 1977, J. Comput. Phys. 23, 276): what changes smoothly is continued to second order, what
// alternates from sub-step to sub-step is taken as it stands. Both are changes from the beginning of a sub-step to its
// own end, under the inputs that were held in it: a jump between two sub-steps is in neither. Who changes an input, or
// finds that one has changed, forgets.
class Trends {
 public:
  explicit Trends(std::size_t count) : last_(count) {}

  // The value at the beginning of a sub-step; the change expected until its end. None before two sub-steps are known.
  [[nodiscard]] double begin(std::size_t index, double value) noexcept;
  // The value at its end, less what is known to have come from elsewhere; of a sub-step that was not begun: nothing.
  void end(std::size_t index, double value) noexcept;

  // Nothing is known any more of one, of all.
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
