// SPDX-License-Identifier: Apache-2.0
// Conditions under which a tick can go out, and its times, without a node.
#include <gtest/gtest.h>

#include <memory>

#include "io_node/sample_progress.h"
#include "io_node/tick_hold.h"
#include "io_node/tick_times.h"

namespace slew::io_node {
namespace tick_conditions_test {

using wire::Role;
using Receipt = SampleProgress::Receipt;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::uint32_t kRoles = bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics);

scene::SessionDef free_pace() {
  scene::SessionDef session;
  session.pace = Pace::free;
  return session;
}

TEST(SampleProgress, ATickNeedsTheSamplesOfTheWindow) {
  SampleProgress samples(free_pace(), 1, 10, kRoles);
  samples.restart(0);
  EXPECT_FALSE(samples.missing(2)) << "tick 2 needs sample -1";
  EXPECT_EQ(samples.missing(3), Role::mechanics);
  EXPECT_EQ(samples.receive(Role::mechanics, 0, 0), Receipt::next);
  EXPECT_EQ(samples.missing(3), Role::hydraulics);
  EXPECT_EQ(samples.receive(Role::hydraulics, 0, 0), Receipt::next);
  EXPECT_FALSE(samples.missing(3));
  EXPECT_EQ(samples.complete_up_to(3), 0);
}

TEST(SampleProgress, ALaterSampleProvesTheEarlierOnes) {
  SampleProgress samples({}, 1, 10, kRoles);
  samples.restart(0);
  EXPECT_EQ(samples.receive(Role::mechanics, 2, 2), Receipt::later);
  EXPECT_EQ(samples.receive(Role::mechanics, 1, 2), Receipt::repeated);
  EXPECT_EQ(samples.newest(Role::mechanics), 2);
}

TEST(SampleProgress, OnlyAFreeRunningNodeCanBeAheadOfTheTicks) {
  scene::SessionDef session;
  session.window = 5;
  SampleProgress lockstep(session, 1, 10, kRoles);
  EXPECT_EQ(lockstep.receive(Role::mechanics, 11, 10), Receipt::too_far_ahead);
  EXPECT_EQ(lockstep.newest(Role::mechanics), kJoinStep);
  session.mode = scene::ExchangeMode::free_running;
  SampleProgress free_running(session, 1, 10, kRoles);
  EXPECT_EQ(free_running.receive(Role::mechanics, 15, 10), Receipt::later);
  EXPECT_EQ(free_running.receive(Role::mechanics, 16, 10), Receipt::too_far_ahead);
}

TEST(SampleProgress, AFlexNodeFollowsAndDoesNotDelayTheStatistics) {
  SampleProgress samples({}, 4, 10, kRoles | bit(Role::flex));
  samples.restart(0);
  for (const Role role : {Role::mechanics, Role::hydraulics}) samples.receive(role, 100, 100);
  EXPECT_EQ(samples.needed(Role::flex, 63), kJoinStep);
  EXPECT_EQ(samples.needed(Role::flex, 71), 4) << "64 steps behind, at a multiple of 4";
  EXPECT_EQ(samples.missing(100), Role::flex);
  EXPECT_EQ(samples.complete_up_to(101), 100);
}

TEST(Pause, WithholdsTicksExceptSingleSteps) {
  Pause pause(false);
  EXPECT_FALSE(pause.withholds_tick());
  EXPECT_FALSE(pause.stops_at(5));
  EXPECT_FALSE(pause.count_tick());
  pause.begin();
  EXPECT_TRUE(pause.withholds_tick());
  EXPECT_EQ(pause.stops_at(5), 5);
  pause.add_steps(2);
  EXPECT_EQ(pause.stops_at(5), 7);
  EXPECT_FALSE(pause.count_tick());
  EXPECT_FALSE(pause.withholds_tick());
  EXPECT_TRUE(pause.count_tick());
  EXPECT_TRUE(pause.withholds_tick());
  pause.add_steps(9);
  pause.begin();
  EXPECT_TRUE(pause.withholds_tick()) << "a pause drops the steps that are left";
  pause.end();
  EXPECT_FALSE(pause.withholds_tick());
}

TEST(ControllerWait, ForHoldersBeginsOnceAndTimesOut) {
  using Event = ControllerWait::Event;
  ControllerWait wait;
  EXPECT_EQ(wait.look_for_holders(false, kMs, milliseconds(10)), Event::none);
  EXPECT_EQ(wait.look_for_holders(true, 2 * kMs, milliseconds(10)), Event::begins);
  EXPECT_TRUE(wait.is_waiting());
  EXPECT_EQ(wait.look_for_holders(true, 12 * kMs, milliseconds(10)), Event::none);
  EXPECT_EQ(wait.look_for_holders(true, 12 * kMs + 1, milliseconds(10)), Event::times_out);
  EXPECT_EQ(wait.look_for_holders(true, 13 * kMs, milliseconds(10)), Event::begins);
  EXPECT_EQ(wait.look_for_holders(false, 14 * kMs, milliseconds(10)), Event::ends);
  EXPECT_FALSE(wait.is_waiting());
}

TEST(ControllerWait, ForValuesHoldsATickForTheLongestTimeAtMost) {
  ControllerWait wait;
  EXPECT_FALSE(wait.look_for_values({}, kMs));
  EXPECT_TRUE(wait.look_for_values(milliseconds(5), 2 * kMs));
  EXPECT_TRUE(wait.look_for_values(milliseconds(5), 7 * kMs - 1));
  EXPECT_FALSE(wait.look_for_values(milliseconds(5), 7 * kMs));
  EXPECT_EQ(wait.end_values(8 * kMs), 6 * kMs);
  EXPECT_EQ(wait.end_values(9 * kMs), 0);
}

TEST(TickTimes, AWaitCountsForTheRoleFromTheTimeAtWhichTheTickIsDue) {
  const auto timing = std::make_unique<node::NodeTiming>();
  const auto waited = [&](Role role) { return timing->waited_ns[static_cast<std::size_t>(role)].load(); };
  TickTimes times(0, milliseconds(1));
  times.count_wait(Role::mechanics, 3 * kMs, kMs, *timing);
  times.count_wait(Role::mechanics, 3 * kMs, 2 * kMs, *timing);
  EXPECT_EQ(waited(Role::mechanics), 0) << "the tick is not due";
  times.count_wait(Role::hydraulics, 3 * kMs, 5 * kMs, *timing);
  EXPECT_EQ(waited(Role::mechanics), 2 * kMs);
  times.count_wait(std::nullopt, 3 * kMs, 6 * kMs, *timing);
  EXPECT_EQ(waited(Role::hydraulics), kMs);
  times.count_wait(std::nullopt, 3 * kMs, 9 * kMs, *timing);
  EXPECT_EQ(waited(Role::mechanics) + waited(Role::hydraulics), 3 * kMs);
}

TEST(TickTimes, ATickUsesEveryValueOnceAndDatesItByTheOldest) {
  TickTimes times(3, milliseconds(1));
  EXPECT_EQ(times.use_values(), 0);
  times.receive_value(2, 5 * kMs);
  times.receive_value(0, 4 * kMs);
  EXPECT_EQ(times.use_values(), 4 * kMs);
  EXPECT_EQ(times.use_values(), 0);
  times.receive_value(1, 5 * kMs);
  times.restart_values(9 * kMs);
  EXPECT_EQ(times.use_values(), 9 * kMs) << "only a value that waits is dated again";
  times.receive_value(1, 10 * kMs);
  times.drop_values();
  EXPECT_EQ(times.use_values(), 0);
}

TEST(TickTimes, ALoopGoesFromTheTickOfItsVariables) {
  TickTimes times(1, milliseconds(1));
  times.begin(100 * kMs);
  EXPECT_EQ(times.last_tick_ns(), 99 * kMs);
  for (StepIndex n = 0; n < 10; ++n) times.count_tick(n, (100 + 2 * n) * kMs);
  EXPECT_EQ(times.since_tick_ns(7, 10, 120 * kMs), 6 * kMs);
  EXPECT_EQ(times.since_tick_ns(7, 7 + 2000, 0), 2000 * kMs) << "beyond the memory: by the step";
}

}  // namespace tick_conditions_test
}  // namespace slew::io_node
