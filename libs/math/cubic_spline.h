// SPDX-License-Identifier: Apache-2.0
// A function given by points, as the cubic spline through them: with continuous slope and curvature, so that a motion
// along it has no jump of acceleration. Unlike the monotone cubic it may overshoot between points.
//
// On an interval of width h with B = (x - x_i)/h, A = 1 - B and second derivatives M at the points
//   y = A y_i + B y_i+1 + h^2/6 ((A^3 - A) M_i + (B^3 - B) M_i+1)                                      (1)
// M solves the tridiagonal system of continuous slopes, closed by M = 0 at both ends (natural) or by slope 0 there
// (level). Beyond the points the curve continues straight with the slope of its end: a natural spline then has no jump
// in its second derivative, a level one holds its last value.
// Source: de Boor 1978, chapter IV.
#pragma once

#include <cstdint>
#include <vector>

#include "core/field.h"

namespace slew::math {

enum class SplineEnds : std::uint8_t { natural, level };

struct SplinePoint {
  double x = 0, y = 0;
  double second = 0;    // M
  double integral = 0;  // from the first point
};

struct CubicSpline {
  std::vector<SplinePoint> points;  // empty: no curve
  double slope_before = 0;          // slopes beyond the ends
  double slope_behind = 0;

  [[nodiscard]] bool empty() const noexcept { return points.empty(); }
};

// Pre-condition: at least two points, arguments strictly increasing. Allocates.
[[nodiscard]] CubicSpline cubic_spline(const Table& points, SplineEnds ends);

struct SplineValue {
  double y = 0, slope = 0, second = 0;
  double integral = 0;  // from the first point
};

// Value at any finite x of a non-empty spline; at most log2(points) comparisons.
[[nodiscard]] SplineValue value_at(const CubicSpline& spline, double x) noexcept;

}  // namespace slew::math
