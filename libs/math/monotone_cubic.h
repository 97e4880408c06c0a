// SPDX-License-Identifier: Apache-2.0
// A function given by points, as the monotone cubic through them: continuous with its slope, no overshoot between two
// points. Value, slope and integral from 0 are exact for this one curve, so that a spring of it has an exact energy.
//
// On an interval of width h with t = (x - x_i)/h, u = 1 - t and slopes m at the points
//   y = u^2 (1 + 2t) y_i + t^2 (3 - 2t) y_i+1 + t u h (u m_i - t m_i+1)                              (1)
// Slopes: weighted harmonic mean of the neighbouring intervals, zero at an extremum of the points (Fritsch and Butland
// 1984), three-point formula at the ends; two points give a straight line. Ends selects the continuation beyond the
// points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/field.h"

namespace slew::math {

// Slopes at the points. Pre-condition: at least two points, arguments strictly increasing.
[[nodiscard]] std::vector<double> monotone_slopes(const Table& points);

enum class Ends : std::uint8_t {
  hold,        // the last value
  continued,   // the last slope
  not_falling  // the last slope, but level where it falls
};

struct CurvePoint {
  double x = 0, y = 0;
  double slope = 0;
  double integral = 0;  // from the first point
};

struct MonotoneCubic {
  std::vector<CurvePoint> points;  // empty: no curve
  double slope_before = 0;         // slopes beyond the ends
  double slope_behind = 0;
  double zero_integral = 0;  // from the first point to x = 0

  [[nodiscard]] bool empty() const noexcept { return points.empty(); }
};

// An empty table gives an empty curve; else the pre-condition of monotone_slopes(). Allocates.
[[nodiscard]] MonotoneCubic monotone_cubic(const Table& points, Ends ends);

// Value at any finite x of a non-empty curve; at most log2(points) comparisons.
[[nodiscard]] double value_at(const MonotoneCubic& curve, double x) noexcept;
[[nodiscard]] double slope_at(const MonotoneCubic& curve, double x) noexcept;
[[nodiscard]] double integral_to(const MonotoneCubic& curve, double x) noexcept;  // from 0 to x

}  // namespace slew::math
