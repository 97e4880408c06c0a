// SPDX-License-Identifier: Apache-2.0
#include "math/cubic_spline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::math {
namespace cubic_spline_test {

const Table kPoints = {{-1, 2}, {0.5, -1}, {1, 0.3}, {3, 0.1}, {3.5, 2}};

TEST(CubicSpline, PassesThroughItsPointsWithContinuousSlopeAndCurvature) {
  for (const SplineEnds ends : {SplineEnds::natural, SplineEnds::level}) {
    const CubicSpline spline = cubic_spline(kPoints, ends);
    constexpr double kStep = 1e-9;
    for (const auto& [x, y] : kPoints) {
      const SplineValue before = value_at(spline, x - kStep), behind = value_at(spline, x + kStep);
      EXPECT_NEAR(value_at(spline, x).y, y, 1e-12);
      EXPECT_NEAR(before.slope, behind.slope, 1e-6);
      const bool is_inner = x > kPoints.front()[0] && x < kPoints.back()[0];
      if (is_inner || ends == SplineEnds::natural) {
        EXPECT_NEAR(before.second, behind.second, 1e-6);
      }
    }
  }
}

TEST(CubicSpline, EndsNaturalOrLevelAndGoesOnStraight) {
  const CubicSpline natural = cubic_spline(kPoints, SplineEnds::natural);
  EXPECT_NEAR(value_at(natural, -1).second, 0, 1e-12);
  EXPECT_NEAR(value_at(natural, 3.5 - 1e-12).second, 0, 1e-9);
  const SplineValue end = value_at(natural, 3.5), later = value_at(natural, 4.5);
  EXPECT_NEAR(later.y, 2 + end.slope, 1e-12);
  EXPECT_EQ(later.second, 0);
  const CubicSpline level = cubic_spline(kPoints, SplineEnds::level);
  EXPECT_NEAR(value_at(level, -1).slope, 0, 1e-12);
  EXPECT_EQ(value_at(level, 10).y, 2);
  EXPECT_EQ(value_at(level, -10).slope, 0);
}

TEST(CubicSpline, GivesDerivativesAndIntegralOfItsOwnCurve) {
  const CubicSpline spline = cubic_spline(kPoints, SplineEnds::natural);
  constexpr double kStep = 1e-5;
  for (const double x : {-2.0, -0.7, 0.2, 0.9, 2.2, 3.3, 5.0}) {
    const SplineValue here = value_at(spline, x), before = value_at(spline, x - kStep),
                      behind = value_at(spline, x + kStep);
    EXPECT_NEAR((behind.y - before.y) / (2 * kStep), here.slope, 1e-8);
    EXPECT_NEAR((behind.slope - before.slope) / (2 * kStep), here.second, 1e-8);
    EXPECT_NEAR((behind.integral - before.integral) / (2 * kStep), here.y, 1e-8);
  }
  EXPECT_EQ(value_at(spline, -1).integral, 0);
}

TEST(CubicSpline, IsExactForACubicWithLevelEnds) {
  // 3 t^2 - 2 t^3 has slope 0 at 0 and 1
  const auto cubic = [](double t) { return t * t * (3 - 2 * t); };
  Table points;
  for (const double t : {0.0, 0.2, 0.5, 0.9, 1.0}) points.push_back({t, cubic(t)});
  const CubicSpline spline = cubic_spline(points, SplineEnds::level);
  for (double t = 0; t <= 1; t += 0.05) EXPECT_NEAR(value_at(spline, t).y, cubic(t), 1e-14);
}

TEST(CubicSpline, OfTwoPointsIsALine) {
  const CubicSpline line = cubic_spline({{1, 1}, {3, 5}}, SplineEnds::natural);
  EXPECT_DOUBLE_EQ(value_at(line, 2).y, 3);
  EXPECT_DOUBLE_EQ(value_at(line, 4).slope, 2);
}

}  // namespace cubic_spline_test
}  // namespace slew::math
