// SPDX-License-Identifier: Apache-2.0
// Books of a paced session, with a number as the clock.
#include "io_node/session_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>

namespace slew::io_node {
namespace session_clock_test {

using scene::OverrunPolicy;

constexpr std::int64_t kMs = 1'000'000;
constexpr SimDuration kStep = milliseconds(1);

class Clock : public ::testing::Test {
 protected:
  void rules(OverrunPolicy policy, std::int64_t after = 0, SimDuration grace = {}) {
    scene::SessionDef session;
    session.overrun = policy;
    session.overrun_after = after;
    session.start_grace = grace.seconds();
    clock = std::make_unique<SessionClock>(session, *timing);
    clock->begin(0, now_ns);
  }
  // does the next step, which takes so long, and is not before its time
  std::optional<OverrunAction> step(std::int64_t response_ns) {
    now_ns = std::max(now_ns, clock->due_ns(n));
    std::optional<OverrunAction> verdict = clock->keep_time(n, now_ns);
    clock->ran(n, now_ns);
    now_ns += response_ns;
    ++n;
    if (std::optional<OverrunAction> later = clock->completed(n, n, now_ns)) verdict = later;
    return verdict;
  }
  [[nodiscard]] std::string problem() {
    clock->close(n, now_ns);
    return problem_of_books(timing->books.read(), kStep);
  }

  std::unique_ptr<node::NodeTiming> timing = std::make_unique<node::NodeTiming>();
  std::unique_ptr<SessionClock> clock;
  std::int64_t now_ns = 123'456'789;
  StepIndex n = 0;
};

TEST_F(Clock, AStepLongerThanHOverrunsAndSoDoThoseThatItDelays) {
  rules(OverrunPolicy::slip);
  for (int i = 0; i < 10; ++i) step(kMs / 10);
  EXPECT_EQ(timing->overruns, 0u);
  step(kMs);  // in time to the nanosecond
  EXPECT_EQ(timing->overruns, 0u);
  step(3 * kMs + 1);
  EXPECT_EQ(timing->overruns, 1u);
  for (int i = 0; i < 10; ++i) step(kMs / 10);
  // the next two were due before it was done
  EXPECT_EQ(timing->overruns, 3u);
  EXPECT_EQ(timing->longest_overrun, 3u);
  EXPECT_EQ(timing->overrun_run, 0u);
  EXPECT_EQ(timing->response.count(), 22u);
  EXPECT_EQ(timing->response.max(), 3 * kMs + 1);
  EXPECT_EQ(clock->slip_ns(), 0);
  EXPECT_EQ(problem(), "");
}

TEST_F(Clock, GivesUpWholeStepsOfALagBeyondItsLimit) {
  rules(OverrunPolicy::slip);
  step(kMs / 10);
  step(60 * kMs + kMs / 3);
  const std::optional<OverrunAction> verdict = step(kMs / 10);
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->what, OverrunPolicy::slip);
  EXPECT_EQ(
      verdict->why,
      "session.overrun: slip: at step 2 the session was 59.3 ms behind the wall clock; 59 steps of wall time were "
      "given up");
  EXPECT_EQ(clock->skipped(), 59u);
  EXPECT_EQ(clock->slip_ns(), 59 * kMs);
  EXPECT_EQ(problem(), "");
  // reported once while it lasts, and again when it is over
  step(100 * kMs);
  const std::optional<OverrunAction> again = step(kMs / 10);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->why, "");
  EXPECT_EQ(timing->transitions, 1u);
  std::string over;
  for (int i = 0; i < 1200; ++i) {
    if (const std::optional<OverrunAction> action = step(kMs / 10)) over += action->why;
  }
  EXPECT_NE(over.find("has kept up with the wall clock for 1 s again"), std::string::npos) << over;
  EXPECT_EQ(timing->transitions, 2u);
  EXPECT_EQ(problem(), "");
}

TEST_F(Clock, AStepThatWasGivenUpIsAMissWithTheTimeForWhichItWasDue) {
  rules(OverrunPolicy::slip);
  for (int i = 0; i < 100; ++i) step(kMs / 10);
  step(800 * kMs + kMs / 2);
  for (int i = 0; i < 100; ++i) step(kMs / 10);
  // 799.5 ms behind: the step that lasted, 799 that were due meanwhile, and the next, half a step late and in time
  EXPECT_EQ(clock->skipped(), 799u);
  EXPECT_EQ(timing->overruns, 800u);
  EXPECT_EQ(timing->longest_overrun, 800u);
  EXPECT_EQ(timing->response.count(), 201u + 799u) << "all steps that were due";
  const wire::Quantiles response = node::quantiles_of(timing->response);
  EXPECT_NEAR(response.p50, 0.3, 0.01) << "half of the time nothing came";
  EXPECT_NEAR(response.p99, 0.79, 0.01);
  EXPECT_EQ(timing->response.max(), 800 * kMs + kMs / 2);
  EXPECT_EQ(timing->last_response_ns, kMs / 10);
  wire::Health io;
  io.response = response;
  io.release_jitter = node::quantiles_of(timing->release_jitter);
  EXPECT_EQ(judged_steps_given_up(io), 799u);
  EXPECT_EQ(problem(), "");
}

TEST_F(Clock, AStepThatWasGivenUpInTheGraceIsNoMiss) {
  rules(OverrunPolicy::slip, 0, milliseconds(20));
  step(kMs / 10);
  step(800 * kMs);
  for (; n < 60;) step(kMs / 10);
  EXPECT_EQ(clock->skipped(), 799u);
  EXPECT_EQ(timing->overruns, 0u);
  EXPECT_EQ(timing->response.count(), 40u);
  // a hold counts what it gives up, and goes on with none in a row
  rules(OverrunPolicy::hold);
  n = 0;
  step(60 * kMs);
  EXPECT_TRUE(step(kMs / 10));
  EXPECT_EQ(timing->overruns, 60u);
  EXPECT_EQ(timing->longest_overrun, 60u);
}

TEST_F(Clock, WhatWasGivenUpInTheGraceIsAnEventAtItsEnd) {
  rules(OverrunPolicy::stop, 0, milliseconds(20));
  step(800 * kMs);
  for (; n < 20;) EXPECT_EQ(step(kMs / 10).value_or(OverrunAction{}).why, "");
  const std::optional<OverrunAction> verdict = step(kMs / 10);
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->what, OverrunPolicy::slip);
  EXPECT_EQ(verdict->why,
            "session.overrun: slip: at step 20 the start-up grace (session.start_grace) is over, in which 799 steps of "
            "wall time were given up");
  EXPECT_TRUE(verdict->is_for_recording_alone);
  EXPECT_EQ(timing->transitions, 1u);
  EXPECT_FALSE(step(kMs / 10));
}

TEST_F(Clock, AProcessThatTakesAPlaceOverHasAGraceToo) {
  rules(OverrunPolicy::slip, 0, milliseconds(20));
  for (; n < 100;) step(kMs / 10);
  EXPECT_EQ(timing->response.count(), 80u);
  clock->begin_grace(n);
  step(10 * kMs);
  for (; n < 130;) step(kMs / 10);
  EXPECT_EQ(timing->response.count(), 90u);
  EXPECT_EQ(timing->overruns, 0u);
  EXPECT_EQ(problem(), "");
}

TEST_F(Clock, ATickThatDidNotGoOutUpsetsTheBooks) {
  rules(OverrunPolicy::slip);
  for (; n < 10;) step(kMs / 10);
  EXPECT_EQ(problem(), "");
  ++n;
  now_ns += kMs;
  EXPECT_NE(problem(), "");
}

TEST_F(Clock, HoldsOrStopsByTheLagOrByTheStepsInARow) {
  for (const OverrunPolicy policy : {OverrunPolicy::hold, OverrunPolicy::stop}) {
    rules(policy);
    step(51 * kMs + kMs);
    const std::optional<OverrunAction> verdict = step(kMs / 10);
    ASSERT_TRUE(verdict);
    EXPECT_EQ(verdict->what, policy);
    EXPECT_NE(
        verdict->why.find("at step 1 the session was 51.0 ms behind the wall clock (session.overrun_lag 50.0 ms)"),
        std::string::npos)
        << verdict->why;
    EXPECT_EQ(clock->skipped(), policy == OverrunPolicy::hold ? 51u : 0u);
    EXPECT_EQ(problem(), "");
    n = 0;
    rules(policy, 3);
    EXPECT_FALSE(step(kMs + 1));
    EXPECT_FALSE(step(kMs));
    const std::optional<OverrunAction> third = step(kMs);
    ASSERT_TRUE(third);
    EXPECT_EQ(third->what, policy);
    EXPECT_NE(third->why.find("the last 3 steps were longer than 1.0 ms (session.overrun_after)"), std::string::npos)
        << third->why;
    n = 0;
  }
}

TEST_F(Clock, JudgesNothingInTheStartUpGrace) {
  rules(OverrunPolicy::stop, 2, milliseconds(20));
  for (int i = 0; i < 10; ++i) {
    const std::optional<OverrunAction> verdict = step(30 * kMs);
    // time is given up, which no policy can help
    if (verdict) {
      EXPECT_EQ(verdict->what, OverrunPolicy::slip);
      EXPECT_EQ(verdict->why, "");
    }
  }
  for (; n < 20;) step(kMs / 10);
  EXPECT_EQ(timing->response.count(), 0u);
  EXPECT_EQ(timing->overruns, 0u);
  for (; n < 400;) step(kMs / 10);
  EXPECT_FALSE(step(kMs + 1));
  EXPECT_TRUE(step(kMs));
  EXPECT_EQ(problem(), "");
}

TEST_F(Clock, ALagInTheGraceIsForTheRecordingAndALaterOneForTheUserToo) {
  rules(OverrunPolicy::slip, 0, milliseconds(200));
  step(60 * kMs);
  std::string reasons;
  for (int i = 0; i < 1500; ++i) {
    const std::optional<OverrunAction> verdict = step(kMs / 10);
    if (verdict && !verdict->is_for_recording_alone) reasons += verdict->why;
  }
  EXPECT_EQ(reasons, "");
  EXPECT_EQ(timing->transitions, 1u);
  EXPECT_EQ(clock->skipped(), 59u);
  step(60 * kMs);
  const std::optional<OverrunAction> verdict = step(kMs / 10);
  ASSERT_TRUE(verdict);
  EXPECT_NE(verdict->why.find("steps of wall time were given up"), std::string::npos) << verdict->why;
  EXPECT_FALSE(verdict->is_for_recording_alone);
  EXPECT_EQ(timing->transitions, 2u);
  // a pause is no time in which the machine keeps up
  now_ns += 5000 * kMs;
  clock->excuse(n, now_ns);
  for (int i = 0; i < 500; ++i) {
    if (const std::optional<OverrunAction> again = step(kMs / 10)) {
      EXPECT_EQ(again->why, "");
    }
  }
  EXPECT_EQ(timing->transitions, 2u);
}

TEST_F(Clock, HoldsAgainWhenItIsStillTooSlowAfterAResume) {
  rules(OverrunPolicy::hold, 3);
  for (int round = 1; round <= 3; ++round) {
    EXPECT_FALSE(step(kMs + 1));
    EXPECT_FALSE(step(kMs + 1));
    EXPECT_TRUE(step(kMs + 1)) << "round " << round;
    EXPECT_EQ(timing->transitions, static_cast<std::uint64_t>(round));
    now_ns += 1000 * kMs;
    clock->excuse(n, now_ns);
    EXPECT_EQ(problem(), "");
  }
  EXPECT_EQ(timing->longest_overrun, 3u);
}

TEST_F(Clock, BeginsAtALaterStepWithTheSameBooksAndAGraceOfItsOwn) {
  rules(OverrunPolicy::slip, 0, milliseconds(20));
  n = 5000;
  clock->begin(n, now_ns);
  EXPECT_EQ(problem(), "");
  for (int i = 0; i < 20; ++i) step(3 * kMs);
  EXPECT_EQ(timing->response.count(), 0u);
  EXPECT_EQ(problem(), "");
  step(kMs / 10);
  EXPECT_EQ(timing->response.count(), 1u);
  step(70 * kMs);
  step(kMs / 10);
  EXPECT_GT(clock->skipped(), 60u);
  EXPECT_EQ(problem(), "");
  EXPECT_EQ(timing->books.read().run, n);
}

TEST_F(Clock, APauseIsNoLag) {
  rules(OverrunPolicy::slip);
  for (int i = 0; i < 10; ++i) step(kMs / 10);
  now_ns += 3'600'000 * kMs;
  clock->excuse(n, now_ns);
  for (int i = 0; i < 10; ++i) step(kMs / 10);
  EXPECT_EQ(timing->overruns, 0u);
  EXPECT_EQ(clock->slip_ns(), 0);
  EXPECT_EQ(problem(), "");
}

TEST_F(Clock, BooksBalanceWhateverTheStepsTake) {
  std::mt19937_64 random(7);
  for (int session = 0; session < 50; ++session) {
    n = 0;
    rules(OverrunPolicy::slip);
    for (int i = 0; i < 300; ++i) {
      const auto dice = random() % 100;
      const auto part = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(kMs));
      step(dice < 90 ? part / 2 : dice < 98 ? 3 * part : 100 * part);
      if (random() % 40 == 0) {
        now_ns += static_cast<std::int64_t>(random() % 1000) * kMs / 7;
        clock->excuse(n, now_ns);
      }
      ASSERT_EQ(problem(), "") << "session " << session << " step " << n;
    }
  }
}

TEST_F(Clock, BooksThatDoNotBalanceAreNamed) {
  wire::Health io;
  io.header.step = 100;
  io.steps_due = 103;
  io.steps_skipped = 2;
  io.lag_ns = 1'500'000;
  io.rest_ns = -500'000;
  EXPECT_EQ(problem_of_books(io, kStep), "103 steps were due, but 100 run, 2 skipped and 0 behind");
  io.steps_due = 102;
  EXPECT_EQ(problem_of_books(io, kStep), "");
  io.lag_ns = 1'500'001;
  EXPECT_EQ(problem_of_books(io, kStep), "a lag of 1500001 ns, but 2000000 ns given up and a rest of -500000 ns");
}

TEST_F(Clock, AControllersValueIsMeasuredToTheFirstSamplesThatUsedIt) {
  rules(OverrunPolicy::slip);
  step(kMs / 10);
  now_ns = clock->due_ns(1);
  const std::int64_t came_ns = now_ns - kMs / 4;
  clock->ran(1, now_ns);
  clock->used_input(1, came_ns);
  static_cast<void>(clock->completed(2, 2, now_ns + kMs / 2));
  EXPECT_EQ(timing->input_latency.count(), 1u);
  EXPECT_EQ(timing->input_latency.max(), 3 * kMs / 4);
}

}  // namespace session_clock_test
}  // namespace slew::io_node
