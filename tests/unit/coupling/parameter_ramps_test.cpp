// SPDX-License-Identifier: Apache-2.0
// Live changes over a time: every one that begins is carried out, however many there are.
#include "coupling/parameter_ramps.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace slew::coupling {
namespace parameter_ramps_test {

constexpr SimDuration kStep = milliseconds(1);

class Ramps : public ::testing::Test {
 protected:
  void apply(StepIndex n) {
    ramps.apply(n, [this](int handle, double value) { values[handle] = value; });
  }
  static constexpr int kParameters = 500;
  ParameterRamps ramps{kParameters};
  std::map<int, double> values;
};

TEST_F(Ramps, HaveTheMeanOfTheLineOverEachStepAndThenTheTarget) {
  ramps.begin(7, 10, 20, 100, milliseconds(5), kStep);
  apply(100);
  EXPECT_DOUBLE_EQ(values[7], 11);
  apply(104);
  EXPECT_DOUBLE_EQ(values[7], 19);
  EXPECT_TRUE(ramps.is_under_way(7));
  apply(105);
  EXPECT_EQ(values[7], 20);
  EXPECT_TRUE(ramps.empty());
}

TEST_F(Ramps, WithoutATimeTakeOneStep) {
  ramps.begin(7, 10, 20, 100, {}, kStep);
  apply(100);
  EXPECT_EQ(values[7], 20);
  EXPECT_TRUE(ramps.empty());
}

TEST_F(Ramps, OfAllParametersAtOnceAreAllCarriedOut) {
  for (int handle = 0; handle < kParameters; ++handle) ramps.begin(handle, 0, handle, 0, milliseconds(10), kStep);
  // a second change of each replaces the first and needs no further room
  for (int handle = 0; handle < kParameters; ++handle) ramps.begin(handle, 0, 2 * handle, 0, milliseconds(10), kStep);
  apply(10);
  for (int handle = 0; handle < kParameters; ++handle) ASSERT_EQ(values[handle], 2 * handle);
  EXPECT_TRUE(ramps.empty());
}

TEST_F(Ramps, OfOneStepHaveHalfOfTheWayInIt) {
  ramps.begin(7, 10, 20, 100, kStep, kStep);
  apply(100);
  EXPECT_DOUBLE_EQ(values[7], 15);
  apply(101);
  EXPECT_EQ(values[7], 20);
}

TEST_F(Ramps, AreReplacedWhereTheirLineIs) {
  ramps.begin(7, 10, 20, 100, milliseconds(5), kStep);
  apply(100);
  apply(101);
  // at 14, held at 13 so far
  ramps.begin(7, values[7], 24, 102, milliseconds(10), kStep);
  apply(102);
  EXPECT_DOUBLE_EQ(values[7], 14.5);
  ramps.begin(7, values[7], 30, 103, {}, kStep);
  apply(103);
  EXPECT_EQ(values[7], 30);
  EXPECT_TRUE(ramps.empty());
}

TEST_F(Ramps, UnderWayArePartOfTheHash) {
  const auto digest = [this] {
    StateHash hash;
    ramps.add_to(hash);
    return hash.digest();
  };
  const std::uint64_t idle = digest();
  ramps.begin(7, 10, 20, 100, milliseconds(5), kStep);
  const std::uint64_t first = digest();
  EXPECT_NE(first, idle);
  ramps.begin(7, 10, 21, 100, milliseconds(5), kStep);
  EXPECT_NE(digest(), first);
  ramps.clear();
  EXPECT_EQ(digest(), idle);
}

}  // namespace parameter_ramps_test
}  // namespace slew::coupling
