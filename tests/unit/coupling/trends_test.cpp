#include "coupling/trends.h"

#include <gtest/gtest.h>

namespace slew::coupling {
namespace trends_test {

TEST(Trends, ContinueWhatChangesSmoothly) {
  Trends trends(1);
  EXPECT_EQ(trends.next(0, 1.0), 0.0);
  EXPECT_EQ(trends.next(0, 1.5), 0.0);
  EXPECT_EQ(trends.next(0, 2.25), 0.75);
  EXPECT_EQ(trends.next(0, 3.0), 0.75);
  EXPECT_EQ(trends.next(0, 3.5), 0.5);
}

TEST(Trends, DoNotCarryOnAJump) {
  Trends trends(1);
  for (const double value : {0.0, 1.0, 2.0}) static_cast<void>(trends.next(0, value));
  EXPECT_EQ(trends.next(0, 1000.0), 2.0);  // twice the change before
  EXPECT_EQ(trends.next(0, 999.0), 0.0);
  EXPECT_EQ(trends.next(0, 998.0), -1.0);
}

TEST(Trends, DoNotCarryOnWhatAlternatesOrStands) {
  Trends trends(1);
  for (const double value : {1.0, -1.0, 1.0, -1.0, -1.0, -1.0}) EXPECT_EQ(trends.next(0, value), 0.0);
}

TEST(Trends, AreOfOneQuantityEachAndForget) {
  Trends trends(2);
  for (const double value : {1.0, 2.0, 3.0}) static_cast<void>(trends.next(0, value));
  EXPECT_EQ(trends.next(1, 7.0), 0.0);
  trends.forget(0);
  EXPECT_EQ(trends.next(0, 9.0), 0.0);
  EXPECT_EQ(trends.next(0, 10.0), 0.0);
  EXPECT_EQ(trends.next(0, 11.0), 1.0);
  trends.clear();
  EXPECT_EQ(trends.next(0, 12.0), 0.0);
}

}  // namespace trends_test
}  // namespace slew::coupling
