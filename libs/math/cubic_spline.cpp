// SPDX-License-Identifier: Apache-2.0
#include "math/cubic_spline.h"

#include <algorithm>
#include <cstddef>

#include "core/check.h"

namespace slew::math {
namespace {

// slopes of (1) at the two ends of an interval
double slope_at_begin(const SplinePoint& a, const SplinePoint& b) noexcept {
  const double h = b.x - a.x;
  return (b.y - a.y) / h - h / 6 * (2 * a.second + b.second);
}

double slope_at_end(const SplinePoint& a, const SplinePoint& b) noexcept {
  const double h = b.x - a.x;
  return (b.y - a.y) / h + h / 6 * (a.second + 2 * b.second);
}

// second derivatives by elimination of the tridiagonal system
void find_seconds(std::vector<SplinePoint>& points, SplineEnds ends) {
  const std::size_t n = points.size();
  std::vector<double> diagonal(n), upper(n), right(n);
  const auto width = [&](std::size_t i) { return points[i + 1].x - points[i].x; };
  const auto rise = [&](std::size_t i) { return (points[i + 1].y - points[i].y) / width(i); };
  const bool is_level = ends == SplineEnds::level;
  diagonal[0] = is_level ? width(0) / 3 : 1;
  upper[0] = is_level ? width(0) / 6 : 0;
  right[0] = is_level ? rise(0) : 0;
  for (std::size_t i = 1; i < n; ++i) {
    const bool is_last = i + 1 == n;
    const double lower = is_last && !is_level ? 0 : width(i - 1) / 6;
    diagonal[i] = is_last ? (is_level ? width(i - 1) / 3 : 1) : (width(i - 1) + width(i)) / 3;
    upper[i] = is_last ? 0 : width(i) / 6;
    right[i] = is_last ? (is_level ? -rise(i - 1) : 0) : rise(i) - rise(i - 1);
    const double factor = lower / diagonal[i - 1];
    diagonal[i] -= factor * upper[i - 1];
    right[i] -= factor * right[i - 1];
  }
  for (std::size_t i = n; i-- > 0;) {
    const double later = i + 1 < n ? upper[i] * points[i + 1].second : 0.0;
    points[i].second = (right[i] - later) / diagonal[i];
  }
}

// straight continuation beyond an end
SplineValue beyond(const SplinePoint& end, double slope, double x) noexcept {
  const double dx = x - end.x;
  return {end.y + slope * dx, slope, 0, end.integral + dx * (end.y + 0.5 * slope * dx)};
}

}  // namespace

CubicSpline cubic_spline(const Table& table, SplineEnds ends) {
  SLEW_CHECK(table.size() >= 2);
  CubicSpline spline;
  for (const auto& [x, y] : table) spline.points.push_back({.x = x, .y = y});
  std::vector<SplinePoint>& points = spline.points;
  find_seconds(points, ends);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double h = points[i].x - points[i - 1].x;
    points[i].integral = points[i - 1].integral + 0.5 * h * (points[i - 1].y + points[i].y) -
                         h * h * h / 24 * (points[i - 1].second + points[i].second);
  }
  if (ends == SplineEnds::natural) {
    spline.slope_before = slope_at_begin(points[0], points[1]);
    spline.slope_behind = slope_at_end(points[points.size() - 2], points.back());
  }
  return spline;
}

SplineValue value_at(const CubicSpline& spline, double x) noexcept {
  const std::vector<SplinePoint>& points = spline.points;
  if (x < points.front().x) return beyond(points.front(), spline.slope_before, x);
  if (x >= points.back().x) return beyond(points.back(), spline.slope_behind, x);
  const auto next =
      std::upper_bound(points.begin(), points.end(), x, [](double at, const SplinePoint& p) { return at < p.x; });
  const SplinePoint &a = *(next - 1), &b = *next;
  const double h = b.x - a.x, B = (x - a.x) / h, A = 1 - B;
  const double A2 = A * A, B2 = B * B, sixth = h * h / 6;
  SplineValue value;
  // (1), its derivatives and its integral
  value.y = A * a.y + B * b.y + sixth * (A * (A2 - 1) * a.second + B * (B2 - 1) * b.second);
  value.slope = (b.y - a.y) / h + h / 6 * ((1 - 3 * A2) * a.second + (3 * B2 - 1) * b.second);
  value.second = A * a.second + B * b.second;
  value.integral = a.integral + h * (a.y * (B - 0.5 * B2) + 0.5 * b.y * B2 -
                                     sixth * 0.25 * ((1 - A2) * (1 - A2) * a.second + B2 * (2 - B2) * b.second));
  return value;
}

}  // namespace slew::math
