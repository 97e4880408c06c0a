// SPDX-License-Identifier: Apache-2.0
#include "core/reductions.h"

#include <cmath>

#include "core/check.h"

namespace slew {

double fixed_dot(std::span<const double> a, std::span<const double> b) noexcept {
  SLEW_ASSERT(a.size() == b.size());
  double s[4] = {0, 0, 0, 0};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) s[k] += a[i + k] * b[i + k];
  }
  double sum = (s[0] + s[1]) + (s[2] + s[3]);
  for (; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double fixed_max_abs(std::span<const double> a) noexcept {
  double largest = 0;
  for (const double value : a) {
    if (std::isnan(value)) return value;
    largest = std::fmax(largest, std::fabs(value));
  }
  return largest;
}

bool all_finite(std::span<const double> a) noexcept {
  for (const double value : a) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

}  // namespace slew
