// SPDX-License-Identifier: Apache-2.0
#include "coupling/own_past.h"

#include <gtest/gtest.h>

#include <array>

namespace slew::coupling {
namespace own_past_test {

OwnPast with_steps(StepIndex count) {
  OwnPast past(2);
  for (StepIndex n = 0; n < count; ++n) {
    const auto t = static_cast<double>(n);
    past.keep(n, std::array{t, 10 * t}, std::array{100 + t, 200 + t});
  }
  return past;
}

TEST(OwnPast, HasTheLastStepsOnly) {
  const OwnPast past = with_steps(kRememberedSteps + 5);
  EXPECT_FALSE(past.has(4));
  EXPECT_TRUE(past.has(5));
  EXPECT_TRUE(past.has(kRememberedSteps + 4));
  EXPECT_FALSE(past.has(kRememberedSteps + 5));
  EXPECT_FALSE(past.has(-1));
  EXPECT_EQ(past.first(7, 1), 70);
  EXPECT_EQ(past.second(7, 1), 207);
}

TEST(OwnPast, CorrectsFromTheStepToNowAndNothingBefore) {
  OwnPast past = with_steps(10);
  past.correct(6, 1, 0.5, -2);
  EXPECT_EQ(past.first(5, 1), 50);
  for (StepIndex n = 6; n < 10; ++n) {
    EXPECT_EQ(past.first(n, 1), 10 * static_cast<double>(n) + 0.5);
    EXPECT_EQ(past.second(n, 1), 198 + static_cast<double>(n));
    EXPECT_EQ(past.first(n, 0), static_cast<double>(n));
  }
}

// the same news twice corrects once
TEST(OwnPast, LearnsNothingFromWhatItHasLearned) {
  OwnPast past = with_steps(10);
  const double stated = 65;
  past.correct(6, 1, stated - past.first(6, 1), 0);
  EXPECT_EQ(stated - past.first(6, 1), 0);
  EXPECT_EQ(past.first(9, 1), 95);
}

TEST(OwnPast, ForgetsEverything) {
  OwnPast past = with_steps(10);
  past.clear();
  EXPECT_FALSE(past.has(9));
}

}  // namespace own_past_test
}  // namespace slew::coupling
