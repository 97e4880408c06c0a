// SPDX-License-Identifier: Apache-2.0
// Thins out a curve to the resolution of a plot: of every pixel column the first, smallest, largest and last value.
//
// No peak is lost, however many samples there are. Values that cannot be shown and steps back in time part the curve.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
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

// Replaces the samples of long curves by the least and the largest value of each of at most most_values / 2 bins of as
// many samples, in their order, at the times of the bin's first and middle sample: curves with common times keep common
// times. A bin with a gap, or across a step back in time, keeps the gap. Returns the samples of a bin of the longest
// curve; 1: no curve has more than most_values samples, nothing was changed.
[[nodiscard]] std::size_t thin_out(std::span<Series> curves, std::size_t most_values);

}  // namespace slew::plotting
