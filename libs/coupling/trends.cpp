#include "coupling/trends.h"

#include <algorithm>
#include <cmath>

namespace slew::coupling {

double Trends::next(std::size_t index, double value) noexcept {
  Last& last = last_[index];
  const double change = std::isnan(last.value) ? 0.0 : value - last.value;
  const double before = last.change;
  last = {value, change};
  if (!(change * before > 0)) return 0;
  return std::copysign(std::min(std::fabs(change), 2 * std::fabs(before)), change);
}

}  // namespace slew::coupling
