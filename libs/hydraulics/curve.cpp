#include "hydraulics/curve.h"

#include <cmath>
#include <cstddef>

namespace slew::hydraulics {
namespace {

constexpr int kParts = 16;  // straight lines per interval: 0.1 % of the interval's rise at most

// Slope at an end from the two nearest intervals, kept monotone (one-sided three-point formula).
double end_slope(double h_0, double h_1, double d_0, double d_1) {
  const double slope = ((2 * h_0 + h_1) * d_0 - h_0 * d_1) / (h_0 + h_1);
  if (slope * d_0 <= 0) return 0;
  if (d_0 * d_1 <= 0 && std::fabs(slope) > 3 * std::fabs(d_0)) return 3 * d_0;
  return slope;
}

// Slopes at the points: weighted harmonic mean of the neighbours, zero at an extremum.
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

}  // namespace

Table straight_lines(const CurveDef& curve) {
  const Table& points = curve.points;
  if (curve.interpolation == Interpolation::linear) return points;
  const std::vector<double> slope = monotone_slopes(points);
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
