// SPDX-License-Identifier: Apache-2.0
// Thins out a curve to the resolution of a plot: of every pixel column the first, smallest, largest and last value.
//
// No peak is lost, however many samples there are. Values that cannot be shown and steps back in time part the curve.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "plotting/series.h"

namespace slew::plotting {

using Polyline = std::vector<std::pair<double, double>>;  // time, value

// Finite, and small enough for differences of two to be finite too.
[[nodiscard]] inline bool is_shown(double value) noexcept {
  return std::abs(value) < 1e300;
}

// Parts of the curve between t_low and t_high, each of at most 4 points per column.
[[nodiscard]] std::vector<Polyline> decimate(const Series& series, double t_low, double t_high, std::size_t columns);

}  // namespace slew::plotting
