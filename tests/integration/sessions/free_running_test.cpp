// SPDX-License-Identifier: Apache-2.0
// Free-running sessions of real processes: no node waits longer than the budget.
#include "free_running.h"

#include <gtest/gtest.h>

namespace slew::testing {
namespace free_running_test {

using coupling::Quality;

// how many of the samples are in time is in wall_time_test.cpp
TEST(FreeRunning, BridgesAPartnerThatStandsStillForAWhile) {
  const RecordedSession recorded = run_with_a_partner_that_stands_still();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.last_complete_step(), 3000);
  // the mechanics went on by its copy, and took up the samples again
  EXPECT_GT(count(recorded.mechanisms, Quality::extrapolated) + count(recorded.mechanisms, Quality::degraded), 5);
  const auto last = std::find_if(recorded.mechanisms.rbegin(), recorded.mechanisms.rend(),
                                 [](const auto& sample) { return sample.state.quality == Quality::ok; });
  ASSERT_NE(last, recorded.mechanisms.rend());
  EXPECT_GT(last->header.step, 1000);
  for (const wire::MechanismMessage& sample : recorded.mechanisms) {
    EXPECT_LE(sample.state.used_step, sample.header.step - 1);
  }
  EXPECT_GE(recorded.largest.at("mechanics.partner_age"), 5);
}

// whether it is green or amber is in wall_time_test.cpp
TEST(FreeRunning, NightlyOverACableThatLosesOnePercentGoesOnToItsEnd) {
  const LossyRun run = run_over_a_lossy_cable(3);
  if (!run.problem.empty()) GTEST_SKIP() << run.problem;
  EXPECT_EQ(run.recorded.last_complete_step(), 3000);
}

}  // namespace free_running_test
}  // namespace slew::testing
