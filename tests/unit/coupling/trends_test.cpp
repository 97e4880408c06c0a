// SPDX-License-Identifier: Apache-2.0
#include "coupling/trends.h"

#include <gtest/gtest.h>

namespace slew::coupling {
namespace trends_test {

// a sub-step from one value to another; the change that was expected of it
double take(Trends& trends, std::size_t index, double from, double to) {
  const double expected = trends.begin(index, from);
  trends.end(index, to);
  return expected;
}

TEST(Trends, ContinueWhatChangesSmoothly) {
  Trends trends(1);
  EXPECT_EQ(take(trends, 0, 1.0, 1.5), 0.0);
  EXPECT_EQ(take(trends, 0, 1.5, 2.25), 0.0);
  EXPECT_EQ(take(trends, 0, 2.25, 3.0), 0.75);
  EXPECT_EQ(take(trends, 0, 3.0, 3.5), 0.75);
  EXPECT_EQ(take(trends, 0, 3.5, 4.0), 0.5);
}

TEST(Trends, DoNotCarryOnAJump) {
  Trends trends(1);
  for (const double value : {0.0, 1.0, 2.0}) static_cast<void>(take(trends, 0, value, value + 1));
  EXPECT_EQ(take(trends, 0, 3.0, 1000.0), 1.0);
  EXPECT_EQ(take(trends, 0, 1000.0, 999.0), 2.0);  // twice the change before
  EXPECT_EQ(take(trends, 0, 999.0, 998.0), 0.0);
  EXPECT_EQ(take(trends, 0, 998.0, 997.0), -1.0);
}

// a staircase of an input: each value is held over a sub-step
TEST(Trends, SeeNothingOfWhatJumpsBetweenTwoSubsteps) {
  Trends trends(1);
  for (const double value : {1.0, 2.0, 3.0, 4.0, 5.0}) EXPECT_EQ(take(trends, 0, value, value), 0.0);
  // beside what changes within them
  static_cast<void>(take(trends, 0, 10.0, 10.5));
  static_cast<void>(take(trends, 0, 20.5, 21.0));
  EXPECT_EQ(trends.begin(0, 31.0), 0.5);
}

TEST(Trends, DoNotCarryOnWhatAlternatesOrStands) {
  Trends trends(1);
  double value = 1;
  for (int i = 0; i < 6; ++i, value = -value) EXPECT_EQ(take(trends, 0, value, -value), 0.0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(take(trends, 0, value, value), 0.0);
}

TEST(Trends, AreOfOneQuantityEachAndForget) {
  Trends trends(2);
  for (const double value : {1.0, 2.0, 3.0}) static_cast<void>(take(trends, 0, value, value + 1));
  EXPECT_EQ(take(trends, 1, 7.0, 8.0), 0.0);
  trends.forget(0);
  EXPECT_EQ(take(trends, 0, 9.0, 10.0), 0.0);
  EXPECT_EQ(take(trends, 0, 10.0, 11.0), 0.0);
  EXPECT_EQ(take(trends, 0, 11.0, 12.0), 1.0);
  trends.clear();
  EXPECT_EQ(trends.begin(0, 12.0), 0.0);
}

// forgotten on the way: no half of a sub-step counts
TEST(Trends, TakeNoEndThatWasNotBegun) {
  Trends trends(1);
  static_cast<void>(trends.begin(0, 5.0));
  trends.forget(0);
  trends.end(0, 100.0);
  EXPECT_EQ(take(trends, 0, 1.0, 2.0), 0.0);
  EXPECT_EQ(take(trends, 0, 2.0, 3.0), 0.0);
  EXPECT_EQ(take(trends, 0, 3.0, 4.0), 1.0);
}

}  // namespace trends_test
}  // namespace slew::coupling
