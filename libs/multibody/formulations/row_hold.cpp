// SPDX-License-Identifier: Apache-2.0
#include "multibody/formulations/row_hold.h"

#include <algorithm>

namespace slew::multibody {

// (3) for a force of (1)
double RowHold::limited(std::size_t row, double force) const noexcept {
  const double speed_change = -force / law_slope[row] - half_mobility[row] * force;
  const double most = laws->change(row, speed_change);
  return std::clamp(force, std::min(0.0, most), std::max(0.0, most));
}

std::span<const double> RowHold::answer() noexcept {
  for (std::size_t k = 0; k < rows_; ++k) {
    double sum = 0;
    for (std::size_t l = 0; l < rows_; ++l) sum += gain[k * rows_ + l] * excess_[l];
    answer_[k] = law_slope[k] > 0 ? limited(k, -sum) : 0.0;
  }
  return answer_;
}

}  // namespace slew::multibody
