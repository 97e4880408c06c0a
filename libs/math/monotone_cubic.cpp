// SPDX-License-Identifier: Apache-2.0
#include "math/monotone_cubic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace slew::math {
namespace {

// Slope at an end from the two nearest intervals, kept monotone (one-sided three-point formula).
double end_slope(double h_0, double h_1, double d_0, double d_1) {
  const double slope = ((2 * h_0 + h_1) * d_0 - h_0 * d_1) / (h_0 + h_1);
  if (slope * d_0 <= 0) return 0;
  if (d_0 * d_1 <= 0 && std::fabs(slope) > 3 * std::fabs(d_0)) return 3 * d_0;
  return slope;
}

double slope_beyond(double slope, Ends ends) {
  switch (ends) {
    case Ends::hold:
      return 0;
    case Ends::continued:
      return slope;
    case Ends::not_falling:
      return std::max(0.0, slope);
  }
  return 0;
}

// integral of (1) from x_i to x_i + t h
double integral_within(const CurvePoint& a, const CurvePoint& b, double t) noexcept {
  const double h = b.x - a.x, t2 = t * t, t3 = t2 * t, t4 = t2 * t2;
  return h * (a.y * (t - t3 + t4 / 2) + b.y * (t3 - t4 / 2) +
              h * (a.slope * (t2 / 2 - 2 * t3 / 3 + t4 / 4) - b.slope * (t3 / 3 - t4 / 4)));
}

// first point of the interval that holds x
const CurvePoint& interval_of(const MonotoneCubic& curve, double x) noexcept {
  const auto behind = std::upper_bound(curve.points.begin() + 1, curve.points.end() - 1, x,
                                       [](double value, const CurvePoint& point) { return value < point.x; });
  return *(behind - 1);
}

double integral_from_first(const MonotoneCubic& curve, double x) noexcept {
  const CurvePoint& first = curve.points.front();
  const CurvePoint& last = curve.points.back();
  if (x < first.x) return (x - first.x) * (first.y + 0.5 * curve.slope_before * (x - first.x));
  if (x > last.x) return last.integral + (x - last.x) * (last.y + 0.5 * curve.slope_behind * (x - last.x));
  const CurvePoint& a = interval_of(curve, x);
  const CurvePoint& b = *(&a + 1);
  return a.integral + integral_within(a, b, (x - a.x) / (b.x - a.x));
}

}  // namespace

std::vector<double> monotone_slopes(const Table& points) {
  const std::size_t n = points.size();
  std::vector<double> h(n - 1), d(n - 1), slope(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = points[i + 1][0] - points[i][0];
    d[i] = (points[i + 1][1] - points[i][1]) / h[i];
  }
  if (n == 2) return {d[0], d[0]};
  slope.front() = end_slope(h[0], h[1], d[0], d[1]);
  slope.back() = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (d[i - 1] * d[i] <= 0) continue;
    const double w_1 = 2 * h[i] + h[i - 1], w_2 = h[i] + 2 * h[i - 1];
    slope[i] = (w_1 + w_2) / (w_1 / d[i - 1] + w_2 / d[i]);
  }
  return slope;
}

MonotoneCubic monotone_cubic(const Table& points, Ends ends) {
  MonotoneCubic curve;
  if (points.empty()) return curve;
  const std::vector<double> slopes = monotone_slopes(points);
  for (std::size_t i = 0; i < points.size(); ++i) curve.points.push_back({points[i][0], points[i][1], slopes[i], 0});
  for (std::size_t i = 1; i < points.size(); ++i) {
    curve.points[i].integral = curve.points[i - 1].integral + integral_within(curve.points[i - 1], curve.points[i], 1);
  }
  curve.slope_before = slope_beyond(slopes.front(), ends);
  curve.slope_behind = slope_beyond(slopes.back(), ends);
  curve.zero_integral = integral_from_first(curve, 0);
  return curve;
}

double value_at(const MonotoneCubic& curve, double x) noexcept {
  const CurvePoint& first = curve.points.front();
  const CurvePoint& last = curve.points.back();
  if (x < first.x) return first.y + curve.slope_before * (x - first.x);
  if (x > last.x) return last.y + curve.slope_behind * (x - last.x);
  const CurvePoint& a = interval_of(curve, x);
  const CurvePoint& b = *(&a + 1);
  const double h = b.x - a.x, t = (x - a.x) / h, u = 1 - t;
  return u * u * (1 + 2 * t) * a.y + t * t * (3 - 2 * t) * b.y + t * u * h * (u * a.slope - t * b.slope);
}

double slope_at(const MonotoneCubic& curve, double x) noexcept {
  if (x < curve.points.front().x) return curve.slope_before;
  if (x > curve.points.back().x) return curve.slope_behind;
  const CurvePoint& a = interval_of(curve, x);
  const CurvePoint& b = *(&a + 1);
  const double h = b.x - a.x, t = (x - a.x) / h, u = 1 - t;
  return 6 * t * u * (b.y - a.y) / h + u * (1 - 3 * t) * a.slope + t * (3 * t - 2) * b.slope;
}

double integral_to(const MonotoneCubic& curve, double x) noexcept {
  return integral_from_first(curve, x) - curve.zero_integral;
}

}  // namespace slew::math
