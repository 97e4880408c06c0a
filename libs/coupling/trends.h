// What quantities that are known once a sub-step will change by until the next.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "core/state_bytes.h"

namespace slew::coupling {

// The last change goes on, limited to twice the one before it, and not where the two differ in sign (the limiter of
// van Leer 1977, J. Comput. Phys. 23, 276): what changes smoothly is continued to second order, while a jump (a touch,
// a stop) and what alternates from sub-step to sub-step are taken as they stand.
class Trends {
 public:
  explicit Trends(std::size_t count) : last_(count) { clear(); }

  // Takes the value at this instant; the change expected until the next one. None before three values are known.
  double next(std::size_t index, double value) noexcept;

  // Nothing is known any more of one, of all.
  void forget(std::size_t index) noexcept { last_[index] = {}; }
  void clear() noexcept { last_.assign(last_.size(), {}); }

  void save(StateWriter& bytes) const { visit(last_, bytes); }
  void load(StateReader& bytes) noexcept { visit(last_, bytes); }

 private:
  struct Last {
    double value = std::numeric_limits<double>::quiet_NaN();
    double change = 0;
  };
  template <typename Values, typename Bytes>
  static void visit(Values& values, Bytes& bytes) {
    for (auto& last : values) {
      bytes.number(last.value);
      bytes.number(last.change);
    }
  }
  std::vector<Last> last_;
};

}  // namespace slew::coupling
