// SPDX-License-Identifier: Apache-2.0
#include "math/monotone_cubic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace slew::math {
namespace monotone_cubic_test {

const Table kRising = {{-0.5, -3}, {-0.1, -0.2}, {0, 0}, {0.3, 0.4}, {0.4, 5}, {1, 5.5}};
const Table kHill = {{0, 1}, {1, 4}, {2, 3}, {4, -1}};

TEST(MonotoneCubic, GoesThroughItsPoints) {
  for (const Table& table : {kRising, kHill}) {
    const MonotoneCubic curve = monotone_cubic(table, Ends::continued);
    for (const auto& [x, y] : table) EXPECT_NEAR(value_at(curve, x), y, 1e-14);
  }
}

TEST(MonotoneCubic, LiesBetweenNeighbouringPoints) {
  for (const Table& table : {kRising, kHill}) {
    const MonotoneCubic curve = monotone_cubic(table, Ends::hold);
    for (std::size_t i = 1; i < table.size(); ++i) {
      for (int k = 0; k <= 50; ++k) {
        const double x = table[i - 1][0] + (table[i][0] - table[i - 1][0]) * k / 50;
        const auto [low, high] = std::minmax(table[i - 1][1], table[i][1]);
        EXPECT_GE(value_at(curve, x), low - 1e-14);
        EXPECT_LE(value_at(curve, x), high + 1e-14);
      }
    }
  }
}

TEST(MonotoneCubic, IsContinuousWithItsSlope) {
  const MonotoneCubic curve = monotone_cubic(kRising, Ends::continued);
  constexpr double kSmall = 1e-9;
  for (const auto& [x, y] : kRising) {
    EXPECT_NEAR(value_at(curve, x - kSmall), value_at(curve, x + kSmall), 1e-6);
    EXPECT_NEAR(slope_at(curve, x - kSmall), slope_at(curve, x + kSmall), 1e-5);
  }
}

TEST(MonotoneCubic, SlopeAndIntegralAreThoseOfItsValue) {
  const MonotoneCubic curve = monotone_cubic(kRising, Ends::continued);
  constexpr double h = 1e-5;
  for (const double x : {-0.9, -0.3, -0.05, 0.1, 0.33, 0.7, 1.4}) {
    EXPECT_NEAR(slope_at(curve, x), (value_at(curve, x + h) - value_at(curve, x - h)) / (2 * h), 1e-5);
    EXPECT_NEAR(value_at(curve, x), (integral_to(curve, x + h) - integral_to(curve, x - h)) / (2 * h), 1e-7);
  }
  EXPECT_EQ(integral_to(curve, 0), 0);
}

TEST(MonotoneCubic, IntegratesAStraightLineToAParabola) {
  const MonotoneCubic line = monotone_cubic({{-1, -2}, {3, 6}}, Ends::continued);
  for (const double x : {-4.0, -0.5, 0.5, 2.0, 7.0}) {
    EXPECT_NEAR(value_at(line, x), 2 * x, 1e-13);
    EXPECT_NEAR(integral_to(line, x), x * x, 1e-12);
  }
}

TEST(MonotoneCubic, GoesOnBeyondItsEndsAsSet) {
  const MonotoneCubic held = monotone_cubic(kHill, Ends::hold);
  EXPECT_EQ(value_at(held, -7), 1);
  EXPECT_EQ(value_at(held, 9), -1);
  EXPECT_EQ(slope_at(held, 9), 0);
  const MonotoneCubic on = monotone_cubic({{0, 0}, {1, 2}}, Ends::continued);
  EXPECT_NEAR(value_at(on, 3), 6, 1e-14);
  EXPECT_NEAR(value_at(on, -1), -2, 1e-14);
  // falls at its end: level; rises at its begin: goes on
  const MonotoneCubic level = monotone_cubic(kHill, Ends::not_falling);
  EXPECT_EQ(value_at(level, 9), -1);
  EXPECT_LT(value_at(level, -1), 1);
}

TEST(MonotoneCubic, OfNoPointsIsEmpty) {
  EXPECT_TRUE(monotone_cubic({}, Ends::hold).empty());
}

}  // namespace monotone_cubic_test
}  // namespace slew::math
