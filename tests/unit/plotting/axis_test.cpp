// SPDX-License-Identifier: Apache-2.0
#include "plotting/axis.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::plotting {
namespace axis_test {

std::vector<std::string> labels(const Axis& axis) {
  std::vector<std::string> texts;
  for (const double tick : axis.ticks()) texts.push_back(axis.label(tick));
  return texts;
}

TEST(Axis, TicksAreRoundNumbersAndContainTheRange) {
  const Axis axis = value_axis(-12.3, 51.7, 4);
  EXPECT_EQ(labels(axis), (std::vector<std::string>{"\u221220", "0", "20", "40", "60"}));
  EXPECT_EQ(axis.low, -20);
  EXPECT_EQ(axis.high, 60);
}

TEST(Axis, LabelsHaveTheDigitsOfTheStep) {
  EXPECT_EQ(labels(value_axis(1.2, 1.31, 5)),
            (std::vector<std::string>{"1.20", "1.22", "1.24", "1.26", "1.28", "1.30", "1.32"}));
  EXPECT_EQ(labels(value_axis(0.1, 0.9, 5)), (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
}

TEST(Axis, LargeAndSmallNumbersGetAPowerOfTen) {
  const Axis large = value_axis(9e6, 11e6, 4);
  EXPECT_EQ(large.exponent, 6);
  EXPECT_EQ(large.label(9.5e6), "9.5");
  EXPECT_EQ(value_axis(0, 3e-5, 4).exponent, -6);
  EXPECT_EQ(value_axis(0, 79'000, 4).exponent, 0);
}

TEST(Axis, AConstantGetsARangeAroundIt) {
  for (const double value : {0.0, 7.0, -7.0, 1e-300, 1e299}) {
    const Axis axis = value_axis(value, value, 4);
    EXPECT_LT(axis.low, axis.high);
    EXPECT_LE(axis.low, value);
    EXPECT_GE(axis.high, value);
    EXPECT_GE(axis.ticks().size(), 2u);
  }
}

TEST(Axis, HoldsForAnyRange) {
  for (int i = -280; i < 299; ++i) {
    for (const double factor : {-3.0, 0.0, 0.5, 0.999'999}) {
      const double high = 1.7 * std::pow(10.0, i);
      const Axis axis = value_axis(factor * high, high, 4);
      ASSERT_LE(axis.low, factor * high + 1e-6 * axis.step) << i;
      ASSERT_GE(axis.high, high - 1e-6 * axis.step) << i;
      ASSERT_GE(axis.ticks().size(), 2u) << i;
      ASSERT_LE(axis.ticks().size(), 12u) << i;
      ASSERT_LT(axis.label(axis.ticks().back()).size(), 16u) << i;
    }
  }
}

TEST(Axis, TimeEndsAtTheLastSampleOrTheTickCloseBehindIt) {
  EXPECT_EQ(tight_axis(0, 19.999, 9).high, 20);
  EXPECT_EQ(tight_axis(0, 19.3, 9).high, 19.3);
  EXPECT_GT(tight_axis(3, 3, 9).high, 3);
}

}  // namespace axis_test
}  // namespace slew::plotting
