// SPDX-License-Identifier: Apache-2.0
#include "coupling/trends.h"

#include <algorithm>
#include <cmath>

namespace slew::coupling {

double Trends::begin(std::size_t index, double value) noexcept {
  Last& last = last_[index];
  last.begun = value;
  if (!(last.change * last.before > 0)) return 0;
  return std::copysign(std::min(std::fabs(last.change), 2 * std::fabs(last.before)), last.change);
}

void Trends::end(std::size_t index, double value) noexcept {
  Last& last = last_[index];
  if (std::isnan(last.begun)) return;
  last.before = last.change;
  last.change = value - last.begun;
  last.begun = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace slew::coupling
