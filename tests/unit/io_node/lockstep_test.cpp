// SPDX-License-Identifier: Apache-2.0
// Controllers that the ticks wait for.
#include "tests/unit/io_node/played_io.h"

namespace slew::io_node {
namespace lockstep_test {

class LockstepController : public Io {
 protected:
  void start(StepIndex delay, StepIndex every = 1) {
    IoConfig lever = config();
    lever.channels.push_back({.name = "Lever", .controller = scene::ControllerMode::lockstep, .delay = delay});
    lever.variables_every = every;
    lever.join_timeout = milliseconds(1000);
    restart(std::move(lever));
    join_all();
  }
  void send(wire::ControllerAction action, double value = 0, StepIndex based_on = kJoinStep) {
    played.publish(Topic::controller_input, wire::ControllerInput{"s", "pid", "Lever", action, value, 1, based_on});
    poll();
  }
  // every sample is there: what may hold the next tick back is the controller
  void publish_next_samples() {
    publish_samples(node->next_step());
    poll(kMs);
  }
  std::vector<wire::ControllerLease> leases() {
    return played.received<wire::ControllerLease>(Topic::controller_lease);
  }
};

TEST_F(LockstepController, StepZeroWaitsUntilItsChannelIsTaken) {
  start(1);
  live(900);
  EXPECT_EQ(node->next_step(), 0);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  EXPECT_EQ(node->member().reason(), "step 0 waits for a controller on channel Lever");
  send(wire::ControllerAction::acquire);
  EXPECT_EQ(node->member().state(), NodeState::running);
  EXPECT_EQ(node->next_step(), 1);
}

TEST_F(LockstepController, ASessionWithoutItsControllerEndsWithTheReason) {
  start(1);
  live(1200);
  EXPECT_EQ(node->next_step(), 0);
  EXPECT_EQ(node->member().exit_code(), ExitCode::failed);
  EXPECT_EQ(node->member().reason(),
            "no controller took channel Lever within 1 s, and the scene has it as controller: lockstep; nothing was "
            "computed; start the controller with the session (--join-timeout waits longer), or run with --set "
            "Lever.controller=sampled");
}

TEST_F(LockstepController, APausedSessionWaitsForItWithoutEnd) {
  start(1);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  live(3000);
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok);
  EXPECT_EQ(node->next_step(), 0);
}

TEST_F(LockstepController, TheTickWaitsForTheValueOfItsStepAndTakesNoOther) {
  start(2);
  send(wire::ControllerAction::acquire);
  publish_next_samples();
  ASSERT_EQ(node->next_step(), 2) << "ticks 0 and 1 are within the delay";
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 2);
  send(wire::ControllerAction::write, 0.9, 1);
  EXPECT_EQ(node->next_step(), 2) << "that is the value of the tick after the next";
  send(wire::ControllerAction::write, 0.4, 0);
  EXPECT_EQ(node->next_step(), 3);
  send(wire::ControllerAction::write, -1, 0);  // too late
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 4);
  const auto ticks = played.received<wire::Tick>(Topic::tick);
  ASSERT_GE(ticks.size(), 4u);
  const std::size_t first = ticks.size() - 4;
  EXPECT_EQ(ticks[first].controls[0], 0);
  EXPECT_EQ(ticks[first + 1].controls[0], 0);
  EXPECT_EQ(ticks[first + 2].controls[0], 0.4);
  EXPECT_EQ(ticks[first + 3].controls[0], 0.9);
  EXPECT_EQ(ticks[first + 3].age[0], 2u);
}

TEST_F(LockstepController, TheTimeForWhichTicksWaitForItIsCounted) {
  start(1);
  send(wire::ControllerAction::acquire);
  for (StepIndex n = 0; n < 5; ++n) {
    send(wire::ControllerAction::write, 0.5, n);
    publish_next_samples();
  }
  const std::int64_t before_ns = node->timing().waited_ns[0];
  publish_next_samples();
  poll(30 * kMs);
  send(wire::ControllerAction::write, 0.5, 5);
  EXPECT_EQ(node->next_step(), 7);
  EXPECT_NEAR(static_cast<double>(node->timing().waited_ns[0] - before_ns), 30.0 * kMs, 1.0 * kMs);
  EXPECT_EQ(node->timing().waited_ns[1], 0) << "mechanics' sample was there";
}

TEST_F(LockstepController, AfterItsDeathTheChannelHoldsThenGoesToNeutralWithANoticeEach) {
  start(1);
  send(wire::ControllerAction::acquire);
  for (StepIndex n = 0; n < 5; ++n) {
    send(wire::ControllerAction::write, 0.5, n);
    publish_next_samples();
  }
  ASSERT_EQ(node->next_step(), 6);
  static_cast<void>(leases());
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 6) << "it waits for 100 ms";
  poll(98 * kMs);
  EXPECT_EQ(node->next_step(), 6);
  poll(2 * kMs);
  EXPECT_EQ(node->next_step(), 7);
  auto replies = leases();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_TRUE(replies[0].is_granted);
  EXPECT_EQ(replies[0].controller, "pid");
  EXPECT_EQ(replies[0].reason,
            "tick 6 waited 100 ms for the value of 'pid' from step 5, its last one is from step 4; channel Lever holds "
            "its value until it is in step again, for 200 ms");
  EXPECT_EQ(played.received<wire::Tick>(Topic::tick).back().controls[0], 0.5);
  run_to(220);  // nothing waits for it now
  replies = leases();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].reason, "'pid' has been out of step for 200 ms: channel Lever goes to neutral");
  EXPECT_EQ(played.received<wire::Tick>(Topic::tick).back().controls[0], 0);
  run_to(5300);
  replies = leases();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].is_granted);
  EXPECT_EQ(replies[0].reason, "no value came for 5000 ms: channel Lever is free; acquire it again to go on");
  const std::vector<std::string> printed = node->member().take_warnings();
  ASSERT_FALSE(printed.empty());
  EXPECT_EQ(printed.back(), replies[0].reason);
}

TEST_F(LockstepController, OneThatIsBackInTimeIsWaitedForAgain) {
  start(1);
  send(wire::ControllerAction::acquire);
  send(wire::ControllerAction::write, 0.5, 0);
  publish_next_samples();
  publish_next_samples();
  poll(100 * kMs);
  run_to(50);
  static_cast<void>(leases());
  send(wire::ControllerAction::write, 0.7, 30);  // too late still
  run_to(51);
  EXPECT_TRUE(leases().empty());
  send(wire::ControllerAction::write, 0.6, 50);
  publish_next_samples();
  const auto replies = leases();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_EQ(replies[0].reason, "'pid' is in step from tick 51 on; channel Lever had been without it since tick 2");
  EXPECT_EQ(played.received<wire::Tick>(Topic::tick).back().controls[0], 0.6);
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 52);
}

TEST_F(LockstepController, ValuesOfStepsWithoutVariablesAreNotWaitedFor) {
  start(1, 10);
  send(wire::ControllerAction::acquire);
  send(wire::ControllerAction::write, 0.5, 0);
  run_to(11);
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 11) << "tick 11 takes the value of step 10";
  send(wire::ControllerAction::write, 0.6, 10);
  EXPECT_EQ(node->next_step(), 12);
  run_to(21);
}

TEST_F(LockstepController, AValueThatIsNoNumberHoldsTheLastOneAndDoesNotStopTheTicks) {
  start(1);
  send(wire::ControllerAction::acquire);
  send(wire::ControllerAction::write, 0.5, 0);
  publish_next_samples();
  send(wire::ControllerAction::write, std::numeric_limits<double>::quiet_NaN(), 1);
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 3);
  EXPECT_EQ(played.received<wire::Tick>(Topic::tick).back().controls[0], 0.5);
}

TEST_F(LockstepController, APauseIsNotItsFault) {
  start(1);
  send(wire::ControllerAction::acquire);
  send(wire::ControllerAction::write, 0.5, 0);
  publish_next_samples();
  ASSERT_EQ(node->next_step(), 2);
  ASSERT_TRUE(request(wire::ControlAction::pause).is_accepted);
  live(8000);
  ASSERT_TRUE(request(wire::ControlAction::resume).is_accepted);
  publish_next_samples();
  EXPECT_EQ(node->next_step(), 2);
  send(wire::ControllerAction::write, 0.4, 1);
  EXPECT_EQ(node->next_step(), 3);
  for (const auto& lease : leases()) EXPECT_EQ(lease.reason, "");
}

TEST_F(LockstepController, AResetWaitsForItAgain) {
  start(1);
  send(wire::ControllerAction::acquire);
  send(wire::ControllerAction::write, 0.5, 0);
  publish_next_samples();
  ASSERT_TRUE(request(wire::ControlAction::reset).is_accepted);
  poll(kMs);
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    wire::NodeStatus ready = played.status(role, NodeState::ready, 0);
    ready.header.epoch = 1;
    played.publish(Topic::node_status, ready);
  }
  publish_samples(0);
  poll(kMs);
  poll(kMs);
  EXPECT_EQ(node->next_step(), 0);
  send(wire::ControllerAction::write, 0.5, 0);
  EXPECT_EQ(node->next_step(), 0) << "it has no channel";
  send(wire::ControllerAction::acquire);
  EXPECT_EQ(node->next_step(), 1);
}

TEST_F(LockstepController, OneThatLeavesInMidRunIsAnEventAndAWarning) {
  start(1);
  send(wire::ControllerAction::acquire);
  for (StepIndex n = 0; n < 5; ++n) {
    send(wire::ControllerAction::write, 0.5, n);
    publish_next_samples();
  }
  static_cast<void>(leases());
  static_cast<void>(node->member().take_warnings());
  send(wire::ControllerAction::release, 0, 4);
  run_to(20);
  const std::string expected =
      "'pid' has released channel Lever (controller: lockstep): it is free from tick 6 on, and no tick waits for a "
      "controller until one is in step with it";
  EXPECT_EQ(node->member().take_warnings(), std::vector<std::string>{expected});
  const auto events = played.received<wire::ControlReply>(Topic::control_reply);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].reason, expected);
  const auto replies = leases();
  ASSERT_EQ(replies.size(), 1u) << "the answer to the release";
  EXPECT_TRUE(replies[0].is_granted);
}

TEST_F(LockstepController, AControllerThatMissedAResetIsRefusedWhenItWrites) {
  start(1);
  send(wire::ControllerAction::acquire);
  send(wire::ControllerAction::write, 0.5, 0);
  publish_next_samples();
  ASSERT_TRUE(request(wire::ControlAction::reset).is_accepted);
  static_cast<void>(leases());
  poll(1500 * kMs);
  send(wire::ControllerAction::write, 0.5, 1);
  send(wire::ControllerAction::write, 0.5, 2);
  const auto replies = leases();
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].is_granted);
  EXPECT_EQ(replies[0].controller, "pid");
  EXPECT_EQ(replies[0].holder, "");
  EXPECT_EQ(replies[0].reason, "'pid' does not hold channel Lever: it is free; acquire it again to go on");
}

TEST_F(LockstepController, LoopDelayIsAVariableInStepsAndInMilliseconds) {
  start(2);
  send(wire::ControllerAction::acquire);
  for (StepIndex n = 0; n < 5; ++n) {
    send(wire::ControllerAction::write, 0.5, n);
    publish_next_samples();
  }
  const auto values = last_variables();
  EXPECT_EQ(values.at("Lever.loop_delay"), 2);
  EXPECT_NEAR(values.at("Lever.loop_time_ms"), 2, 1e-9);
  EXPECT_EQ(values.at("Lever.age"), 2);
  EXPECT_EQ(values.at("session.late_controllers"), 0);
}

}  // namespace lockstep_test
}  // namespace slew::io_node
