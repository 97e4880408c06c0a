// SPDX-License-Identifier: Apache-2.0
#include "node/step_timing.h"

#include <gtest/gtest.h>

#include <memory>

namespace slew::node {
namespace step_timing_test {

using wire::Role;

class Timing : public ::testing::Test {
 protected:
  // one step, released this long ago, then done at once
  void step(StepIndex n, std::int64_t released_ago_ns, Role waits_for = Role::io) {
    const std::int64_t now_ns = monotonic_ns();
    steps.release(n, now_ns - released_ago_ns, now_ns);
    if (waits_for != Role::io) steps.waits_for(waits_for);
    steps.begin(n);
    steps.computed();
    is_late = steps.is_late();
    steps.published();
  }
  std::unique_ptr<NodeTiming> timing = std::make_unique<NodeTiming>();
  StepTiming steps{*timing};
  bool is_late = false;
};

constexpr std::int64_t kHour = 3'600'000'000'000;

TEST_F(Timing, AResponseBeyondTheDeadlineIsAnOverrunAndFlagged) {
  steps.set_deadline({kHour});
  step(0, 0);
  EXPECT_FALSE(is_late);
  step(1, 2 * kHour);
  EXPECT_TRUE(is_late);
  step(2, 2 * kHour);
  step(3, 0);
  EXPECT_EQ(timing->overruns, 2u);
  EXPECT_EQ(timing->longest_overrun, 2u);
  EXPECT_EQ(timing->overrun_run, 0u);
  EXPECT_EQ(timing->response.count(), 4u);
  EXPECT_GE(timing->response.max(), 2 * kHour);
  EXPECT_GE(timing->release_jitter.max(), 2 * kHour);
  EXPECT_EQ(timing->execution.count(), 4u);
  EXPECT_EQ(timing->cpu_time.count(), 3u) << "the first step has none before it";
  EXPECT_GE(timing->response_recent_ns, 2 * kHour);
}

TEST_F(Timing, WithoutADeadlineTheProcessorTimeIsTheMeanOfManySteps) {
  for (StepIndex n = 0; n <= 64; ++n) {
    EXPECT_EQ(timing->cpu_time.count(), 0u) << n;
    step(n, 0);
  }
  EXPECT_EQ(timing->cpu_time.count(), 1u);
  steps.restart();
  for (StepIndex n = 0; n < 64; ++n) step(n, 0);
  EXPECT_EQ(timing->cpu_time.count(), 1u) << "the first step of an epoch has none before it";
  step(64, 0);
  EXPECT_EQ(timing->cpu_time.count(), 2u);
  EXPECT_EQ(timing->execution.count(), 130u);
}

TEST_F(Timing, NothingIsLateWithoutADeadlineAndNothingJudgedInTheGrace) {
  steps.judge_from(2);
  step(0, 2 * kHour);
  step(1, 2 * kHour);
  EXPECT_EQ(timing->response.count(), 0u);
  step(2, 2 * kHour);
  EXPECT_FALSE(is_late);
  EXPECT_EQ(timing->response.count(), 1u);
  EXPECT_EQ(timing->overruns, 0u);
}

TEST_F(Timing, WaitingIsCountedForIoUntilTheReleaseAndThenForThePartner) {
  steps.set_deadline({kHour});
  step(0, 0);
  step(1, 0);
  const std::int64_t for_io = timing->waited_ns[0];
  EXPECT_GT(for_io, 0);
  EXPECT_EQ(timing->waited_ns[2], 0);
  step(2, 0, Role::hydraulics);
  EXPECT_GT(timing->waited_ns[2], 0);
  EXPECT_EQ(timing->wait.count(), 2u);
  const std::int64_t for_partner = timing->waited_ns[2];
  step(3, 0);
  EXPECT_EQ(timing->waited_ns[2], for_partner) << "this one waited for io again";
}

TEST_F(Timing, AReleaseThatAPartnerHeldBackIsWaitedForWithThePartner) {
  steps.set_deadline({kHour});
  step(0, 2 * kHour);
  steps.came(Role::hydraulics, monotonic_ns());
  step(1, 0);
  const std::int64_t late_ns = timing->waited_ns[2];
  EXPECT_GT(late_ns, 0) << "step 1 was due an hour ago";
  steps.came(Role::hydraulics, monotonic_ns());
  step(2, 0);
  EXPECT_EQ(timing->waited_ns[2], late_ns) << "step 2 is due in an hour, whenever the sample comes";
  steps.set_deadline({0});
  steps.came(Role::hydraulics, monotonic_ns());
  step(3, 0);
  EXPECT_GT(timing->waited_ns[2], late_ns) << "as fast as possible";
}

TEST_F(Timing, AStepWithoutReleaseBeginsAtOnce) {
  steps.set_deadline({kHour});
  steps.begin(5);
  steps.computed();
  steps.published();
  EXPECT_EQ(timing->release_jitter.max(), 0);
  EXPECT_EQ(timing->overruns, 0u);
}

TEST(SentTime, IsThatOfTheStampUnlessItCannotBeTrue) {
  const std::int64_t before_ns = monotonic_ns();
  EXPECT_LE(sent_ns(wall_clock_ns() - 1'000'000, monotonic_ns(), WriterClock::same),
            monotonic_ns() - 1'000'000 + 500'000'000);
  EXPECT_LT(sent_ns(wall_clock_ns() - 1'000'000'000, monotonic_ns(), WriterClock::same), before_ns);
  // another clock, a stamp in the future, one an hour old: the time of arrival
  EXPECT_GE(sent_ns(wall_clock_ns() - 1'000'000, monotonic_ns(), WriterClock::other), before_ns);
  EXPECT_GE(sent_ns(wall_clock_ns() + kHour, monotonic_ns(), WriterClock::same), before_ns);
  EXPECT_GE(sent_ns(wall_clock_ns() - kHour, monotonic_ns(), WriterClock::same), before_ns);
}

}  // namespace step_timing_test
}  // namespace slew::node
