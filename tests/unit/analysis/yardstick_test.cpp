// SPDX-License-Identifier: Apache-2.0
// The bare loops of a stress test: which of their steps are judged. No claim about their speed.
#include "analysis/stress/yardstick.h"

#include <gtest/gtest.h>

#include "analysis/stress/stress.h"

namespace slew::analysis {
namespace yardstick_test {

constexpr SimDuration kStep{100'000};

YardstickRules rules(SimDuration work) {
  YardstickRules rules;
  rules.session.step = kStep.seconds();
  rules.session.start_grace = 0;
  rules.loops.resize(2);
  for (YardstickLoop& loop : rules.loops) loop.work = loop.computing = work;
  return rules;
}

wire::Health run(const YardstickRules& rules, StepIndex steps) {
  Yardstick yardstick;
  yardstick.start(rules, {steps * kStep.ns});
  yardstick.wait();
  EXPECT_EQ(yardstick.problem(), "");
  return yardstick.result();
}

TEST(Yardstick, TheFirstStepsOfASliceAreNotJudged) {
  YardstickRules with_grace = rules({1000});
  with_grace.session.start_grace = SimDuration{2 * kStep.ns + 1}.seconds();
  const wire::Health health = run(with_grace, 20);
  EXPECT_EQ(health.steps_done, 23u) << "three more than were requested";
  EXPECT_EQ(health.response.count - given_up(health), 20u);
}

TEST(Yardstick, StepsThatItGivesUpAreMisses) {
  YardstickRules slow = rules({4 * kStep.ns});
  slow.session.overrun_lag = kStep.seconds();
  const wire::Health health = run(slow, 10);
  EXPECT_GE(health.steps_skipped, 20u) << "three of four";
  EXPECT_EQ(given_up(health), health.steps_skipped);
  EXPECT_EQ(health.response.count, 10u + health.steps_skipped);
  EXPECT_EQ(health.overruns, health.response.count);
  EXPECT_EQ(health.longest_overrun, health.response.count);
}

}  // namespace yardstick_test
}  // namespace slew::analysis
