// SPDX-License-Identifier: Apache-2.0
// Smooth functions that replace the kinks of fluid-power laws, with their slopes.
//
//   ramp(x, w) = 0 for x <= 0;  w t^2 (2 - t), t = x/w, for 0 < x < w;  x for x >= w                            (1)
//     positive part with a continuous slope, exact outside (0, w); below by at most 4/27 w inside
//   root(d, d_t) = d / (d^2 + d_t^2)^(1/4)                                                                      (2)
//     sgn(d) sqrt|d| for |d| >> d_t, d / sqrt(d_t) for |d| << d_t
//   least(a, b, w) = a - ramp(a - b, w_a),  w_a = a - a^2/(4 w) for a < 2 w, else w                             (3)
//     lower of a, b >= 0 as smooth_min, with a width that shrinks with a: 0 if either is 0
//   underlap(x, w) = 0 for x <= -w;  (x + w)^2/(4 w) for -w < x < w;  x for x >= w                              (4)
//     edge of a spool that is still open by w/4 in the middle, exact outside (-w, w)
#pragma once

#include <cmath>

namespace slew::hydraulics {

struct ValueSlope {
  double value, slope;
};

[[nodiscard]] inline ValueSlope ramp(double x, double w) noexcept {
  if (x <= 0) return {0, 0};
  if (x >= w) return {x, 1};
  const double t = x / w;
  return {x * t * (2 - t), t * (4 - 3 * t)};
}

[[nodiscard]] inline ValueSlope underlap(double x, double w) noexcept {
  if (x <= -w) return {0, 0};
  if (x >= w) return {x, 1};
  const double t = (x + w) / (2 * w);
  return {w * t * t, t};
}

// Largest slope of (1), inside (0, w): the steeper side of the switch.
inline constexpr double kSteepestRamp = 4.0 / 3;

// x limited to [0, 1], smooth over w above 0 and above 1.
[[nodiscard]] inline ValueSlope unit_clip(double x, double w) noexcept {
  const ValueSlope low = ramp(x, w), high = ramp(x - 1, w);
  return {low.value - high.value, low.slope - high.slope};
}

// Lower of a and b, smooth over w; slope with respect to a (to b: one minus it). Equals a where a <= b.
[[nodiscard]] inline ValueSlope smooth_min(double a, double b, double w) noexcept {
  const ValueSlope over = ramp(a - b, w);
  return {a - over.value, 1 - over.slope};
}

// Higher of a and b, smooth over w; slope with respect to a. Equals a where a >= b.
[[nodiscard]] inline ValueSlope smooth_max(double a, double b, double w) noexcept {
  const ValueSlope over = ramp(b - a, w);
  return {a + over.value, 1 - over.slope};
}

struct ValueSlopes {
  double value, slope_a, slope_b;
};

// Equation (3); pre-condition: a, b >= 0.
[[nodiscard]] inline ValueSlopes least(double a, double b, double w) noexcept {
  const bool is_narrow = a < 2 * w;
  const double width = is_narrow ? a - a * a / (4 * w) : w;
  const ValueSlope over = ramp(a - b, width);
  double slope_a = 1 - over.slope;
  if (is_narrow && a > b && a - b < width) {
    // d ramp(x, w)/dw = -2 t^2 (1 - t)
    const double t = (a - b) / width;
    slope_a += 2 * t * t * (1 - t) * (1 - a / (2 * w));
  }
  return {a - over.value, slope_a, over.slope};
}

[[nodiscard]] inline ValueSlope root(double d, double transition) noexcept {
  const double q = d * d + transition * transition;
  const double inverse = 1 / std::sqrt(std::sqrt(q));
  return {d * inverse, inverse * (1 - 0.5 * d * d / q)};
}

}  // namespace slew::hydraulics
