// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/curve.h"

#include <cstddef>

namespace slew::hydraulics {
namespace {

constexpr int kParts = 16;  // straight lines per interval: 0.1 % of the interval's rise at most

}  // namespace

CurveFunction::CurveFunction(const CurveDef& curve) {
  if (curve.interpolation == Interpolation::linear) {
    lines_ = curve.points;
  } else {
    cubic_ = math::monotone_cubic(curve.points, math::Ends::hold);
  }
}

ValueSlope CurveFunction::at(double x) const noexcept {
  if (lines_.empty()) return {math::value_at(cubic_, x), math::slope_at(cubic_, x)};
  if (x <= lines_.front()[0]) return {lines_.front()[1], 0};
  for (std::size_t i = 1; i < lines_.size(); ++i) {
    const auto& a = lines_[i - 1];
    const auto& b = lines_[i];
    if (x >= b[0]) continue;
    const double slope = (b[1] - a[1]) / (b[0] - a[0]);
    return {a[1] + slope * (x - a[0]), slope};
  }
  return {lines_.back()[1], 0};
}

Table straight_lines(const CurveDef& curve) {
  const Table& points = curve.points;
  if (curve.interpolation == Interpolation::linear) return points;
  const std::vector<double> slope = math::monotone_slopes(points);
  Table table;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double width = points[i + 1][0] - points[i][0];
    const double y_0 = points[i][1], y_1 = points[i + 1][1];
    for (int k = 0; k < kParts; ++k) {
      // cubic Hermite form on the interval
      const double t = static_cast<double>(k) / kParts, u = 1 - t;
      const double y =
          u * u * (1 + 2 * t) * y_0 + t * t * (3 - 2 * t) * y_1 + t * u * width * (u * slope[i] - t * slope[i + 1]);
      table.push_back({points[i][0] + t * width, y});
    }
  }
  table.push_back(points.back());
  return table;
}

const CurveDef* find_curve(const HydraulicsDef& circuit, std::string_view name) {
  for (const CurveDef& curve : circuit.curves) {
    if (curve.name == name) return &curve;
  }
  return nullptr;
}

}  // namespace slew::hydraulics
