// SPDX-License-Identifier: Apache-2.0
// The node around a subsystem, with io, the partner and the clock played by the test.
#include "node/physics_node.h"

#include <gtest/gtest.h>

#include "tests/support/played_session.h"

namespace slew::node {
namespace physics_node_test {

using testing::kMs;
using testing::PlayedSession;
using testing::StillSubsystem;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::TickFlag;
using wire::Topic;

class Physics : public ::testing::Test {
 protected:
  static Status build(const wire::SessionDescription&, BuiltSubsystem& built) {
    built.session.start_grace = 0;
    built.subsystem = std::make_unique<StillSubsystem>();
    return Status::ok();
  }
  void poll(std::int64_t after_ns = 0) { node.poll(now_ns += after_ns); }

  // mechanics has joined, has published sample 0 and waits for tick 0
  void get_ready() {
    played.join(node, now_ns, {Topic::mechanism});
    played.publish_actuators(0);
    poll(kMs);
    ASSERT_EQ(node.member().state(), NodeState::ready);
    played.publish_status(Role::hydraulics, NodeState::ready, 0);
    played.publish_status(Role::io, NodeState::running, 0);
    poll();
  }
  // step of the node's newest sample
  StepIndex newest_sample() {
    for (const auto& sample : played.received<wire::MechanismMessage>(Topic::mechanism)) newest_ = sample.header.step;
    return newest_;
  }

  PlayedSession played{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics)};
  testing::BreakableTransport transport{played.transport()};
  PhysicsNode node{Role::mechanics, transport, build};
  std::int64_t now_ns = 1000 * kMs;
  StepIndex newest_ = kJoinStep;
};

TEST_F(Physics, WaitsForJoinTenSecondsAndWithoutTimeoutAsLongAsItTakes) {
  PhysicsNode patient{Role::mechanics, transport, build, {kNoTimeout, kNoTimeout, std::nullopt}};
  for (PhysicsNode* waiting : {&node, &patient}) {
    played.publish(Topic::session, played.session);
    waiting->poll(now_ns);
    waiting->poll(now_ns + kMs);
    ASSERT_EQ(waiting->member().state(), NodeState::joining);
    waiting->poll(now_ns + 3'600'000 * kMs);
  }
  EXPECT_EQ(node.member().exit_code(), ExitCode::failed);
  EXPECT_EQ(patient.member().state(), NodeState::joining);
}

TEST_F(Physics, DoesAStepForATickAndTheSampleOfItsPartner) {
  get_ready();
  EXPECT_EQ(newest_sample(), 0);
  played.publish_tick(0);
  poll(kMs);
  EXPECT_EQ(newest_sample(), 1);
  played.publish_tick(1);
  poll(kMs);
  EXPECT_EQ(newest_sample(), 1);
  played.publish_actuators(1);
  poll(kMs);
  EXPECT_EQ(newest_sample(), 2);
}

TEST_F(Physics, AfterAFaultTickSleepsUntilIoPublishesTheReason) {
  get_ready();
  played.publish_tick(0, static_cast<std::uint32_t>(TickFlag::end) | static_cast<std::uint32_t>(TickFlag::fault));
  for (int i = 0; i < 5; ++i) {
    poll(50 * kMs);
    EXPECT_GT(node.next_deadline(now_ns), now_ns) << "poll " << i << " would spin";
  }
  wire::NodeStatus fault = played.status(Role::io, NodeState::fault, 0);
  fault.exit_code = static_cast<std::int32_t>(ExitCode::storage);
  fault.reason = "disk";
  played.publish(Topic::node_status, fault);
  poll(kMs);
  EXPECT_EQ(node.member().exit_code(), ExitCode::storage);
  EXPECT_EQ(node.member().reason(), "io ended the session: disk");
}

TEST_F(Physics, FlagsAStepThatWasTooLongAndHashesTheSame) {
  played.session.pace = Pace::real;
  node.add_work({3 * played.session.step_ns});
  get_ready();
  played.publish_tick(0);
  poll(kMs);
  const auto samples = played.received<wire::MechanismMessage>(Topic::mechanism);
  ASSERT_FALSE(samples.empty());
  EXPECT_EQ(samples.back().header.step, 1);
  EXPECT_EQ(samples.back().state.flags, static_cast<std::uint32_t>(StepFlag::overrun));
  EXPECT_EQ(samples.back().state.state_hash, StillSubsystem().state_hash());
  EXPECT_EQ(node.timing().overruns, 1u);
  EXPECT_GE(node.timing().execution.min(), 3 * played.session.step_ns);
}

TEST_F(Physics, HasNoDeadlineInFreePace) {
  played.session.pace = Pace::free;
  node.add_work({3 * played.session.step_ns});
  get_ready();
  played.publish_tick(0);
  poll(kMs);
  const auto samples = played.received<wire::MechanismMessage>(Topic::mechanism);
  ASSERT_FALSE(samples.empty());
  EXPECT_EQ(samples.back().state.flags, 0u);
  EXPECT_EQ(node.timing().overruns, 0u);
  EXPECT_EQ(node.timing().response.count(), 1u);
}

TEST_F(Physics, LeavesOutTheValuesOfItsVariablesWhereTheTickOrdersIt) {
  PhysicsNode observed(Role::mechanics, played.transport(), [](const wire::SessionDescription&, BuiltSubsystem& built) {
    built.subsystem = std::make_unique<testing::ObservedSubsystem>();
    built.published_variables = {0};
    built.variables_every = 1;
    return Status::ok();
  });
  const auto go_on = [&] { observed.poll(now_ns += kMs); };
  played.join(observed, now_ns, {Topic::mechanism, Topic::variables});
  const auto view = static_cast<std::uint32_t>(TickFlag::shed_view);
  const auto all = view | static_cast<std::uint32_t>(TickFlag::shed_variables);
  const std::uint32_t flags[] = {0, view, all, 0};
  for (StepIndex step = 0; step < 4; ++step) {
    played.publish_actuators(step);
    played.publish_tick(step, flags[step]);
    go_on();
    go_on();
  }
  std::map<StepIndex, std::size_t> values;
  for (const auto& block : played.received<wire::VariableBlock>(Topic::variables)) {
    if (block.header.phase == Phase::running) values[block.header.step] = block.values.size();
  }
  // a block has the step after its tick; shed_view concerns the flex node only
  EXPECT_EQ(values, (std::map<StepIndex, std::size_t>{{0, 1}, {1, 1}, {2, 1}, {3, 0}, {4, 1}}));
}

TEST_F(Physics, EndsAtTheFirstSampleThatCannotBeSent) {
  get_ready();
  for (StepIndex step = 0; step < 4; ++step) {
    played.publish_tick(step);
    if (step > 0) played.publish_actuators(step);
  }
  transport.break_down(Topic::mechanism);
  poll(kMs);
  poll(kMs);
  EXPECT_EQ(node.member().state(), NodeState::fault);
  EXPECT_EQ(node.member().exit_code(), ExitCode::failed);
  EXPECT_EQ(node.member().reason(), "message not sent");
  EXPECT_EQ(node.health().steps_done.load(), 1u);
  const auto statuses = played.received<wire::NodeStatus>(Topic::node_status);
  ASSERT_FALSE(statuses.empty());
  EXPECT_EQ(statuses.back().reason, "message not sent");
}

TEST_F(Physics, PublishesNothingMoreInASessionThatIsWithdrawn) {
  played.publish(Topic::session, played.session);
  poll();
  ASSERT_EQ(node.member().state(), NodeState::joining);
  played.forget();
  played.session.header.phase = Phase::ended;
  played.publish(Topic::session, played.session);
  poll(kMs);
  EXPECT_TRUE(node.is_finished());
  EXPECT_TRUE(node.member().is_withdrawn());
  EXPECT_TRUE(played.received<wire::NodeStatus>(Topic::node_status).empty());
}

// ---- requests for missing messages ----------------------------------------------------------------------------

TEST_F(Physics, RequestsATickThreeMillisecondsAfterItWasDue) {
  played.session.step_ns = 10 * kMs;
  get_ready();
  played.publish_tick(0);
  poll(kMs);
  played.publish_actuators(1);
  const std::int64_t done_ns = now_ns;
  played.forget();
  while (now_ns < done_ns + 12 * kMs) poll(kMs);
  EXPECT_TRUE(played.received<wire::ResendRequest>(Topic::resend).empty());
  while (now_ns < done_ns + 14 * kMs) poll(kMs);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].role, Role::io);
  EXPECT_EQ(requests[0].header.step, 1);
}

TEST_F(Physics, RequestsNothingWhileTheSessionIsPaused) {
  get_ready();
  played.publish_tick(0);
  poll(kMs);
  played.publish_actuators(1);
  played.publish_status(Role::io, NodeState::holding, 1);
  poll(kMs);
  played.forget();
  for (int i = 0; i < 100; ++i) poll(2 * kMs);
  EXPECT_TRUE(played.received<wire::ResendRequest>(Topic::resend).empty());
  // a tick that io sent before it held is missing too
  played.publish_status(Role::io, NodeState::holding, 2);
  for (int i = 0; i < 60; ++i) poll(2 * kMs);
  EXPECT_FALSE(played.received<wire::ResendRequest>(Topic::resend).empty());
}

TEST_F(Physics, ReportsThatItWaitsWhenAMessageIsOverdue) {
  get_ready();
  played.publish_tick(0);
  poll(kMs);
  EXPECT_FALSE(node.health().is_waiting.load());
  for (int i = 0; i < 10; ++i) poll(kMs);
  EXPECT_TRUE(node.health().is_waiting.load());
  played.publish_tick(1);
  played.publish_actuators(1);
  poll(kMs);
  EXPECT_FALSE(node.health().is_waiting.load());
}

TEST_F(Physics, CountsAnInitThatCannotBeDecoded) {
  PlayedSession other{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics)};
  PhysicsNode hydraulics{Role::hydraulics, other.transport(), build};
  other.publish(Topic::session, other.session);
  hydraulics.poll(now_ns);
  other.publish_status(Role::mechanics, NodeState::initialising);
  wire::MechanismMessage init;
  init.header = other.header(Role::mechanics, kJoinStep, Phase::init);
  std::vector<std::byte> bytes;
  ASSERT_TRUE(transport::encode(init, bytes));
  bytes.resize(bytes.size() / 2);
  other.publish_bytes(Topic::mechanism, bytes);
  hydraulics.poll(now_ns);
  EXPECT_EQ(hydraulics.member().refusals().undecodable, 1u);
}

// ---- which writer is accepted on which topic ------------------------------------------------------------------

TEST_F(Physics, DoesNotFollowATickOfAnObserverOrAPartner) {
  get_ready();
  const std::uint64_t refused = node.member().refusals().unexpected_writer;
  wire::Tick tick;
  tick.header = played.header(Role::observer, 0);
  played.publish(Topic::tick, tick);
  tick.header = played.header(Role::hydraulics, 0);
  played.publish(Topic::tick, tick);
  poll(kMs);
  EXPECT_EQ(newest_sample(), 0);
  EXPECT_EQ(node.member().refusals().unexpected_writer, refused + 2);
}

TEST_F(Physics, BeginsAnEpochForIoAlone) {
  get_ready();
  wire::Tick init;
  init.header = played.header(Role::observer, kJoinStep, Phase::init, 1);
  played.publish(Topic::tick, init);
  init.header = played.header(Role::io, kJoinStep, Phase::init, 1);
  init.header.incarnation += 1;
  played.publish(Topic::tick, init);
  poll(kMs);
  EXPECT_EQ(node.member().epoch(), 0u);
  EXPECT_EQ(node.member().refusals().unexpected_writer, 2u);
  init.header.incarnation -= 1;
  played.publish(Topic::tick, init);
  poll(kMs);
  EXPECT_EQ(node.member().epoch(), 1u);
}

// no node waits for sensors: poses far ahead of one that catches up are requested again, and are no fault
TEST(Inbox, PosesFarAheadOfSensorsAreNoFault) {
  Refusals refusals;
  Inbox<wire::PoseMessage> poses(reading_of(Topic::poses));
  poses.need({.sensor_every = 10});
  poses.keep({}, 1280, 0, refusals);
  EXPECT_EQ(refusals.early, 1u);
  EXPECT_EQ(refusals.refused(), 0u);
  Inbox<wire::MechanismMessage> mechanism(reading_of(Topic::mechanism));
  mechanism.need({});
  mechanism.keep({}, 128, 0, refusals);
  EXPECT_EQ(refusals.refused(), 1u);
}

TEST_F(Physics, RefusesToPublishMoreVariablesThanTheWireNumbers) {
  const auto build_many = [](const wire::SessionDescription&, BuiltSubsystem& built) {
    built.subsystem = std::make_unique<StillSubsystem>();
    built.published_variables.resize(wire::kMaxVariables + 1);
    return Status::ok();
  };
  PlayedSession other{bit(Role::io) | bit(Role::mechanics)};
  PhysicsNode many{Role::mechanics, other.transport(), build_many};
  other.publish(Topic::session, other.session);
  many.poll(now_ns);
  EXPECT_TRUE(many.is_finished());
  EXPECT_EQ(many.member().exit_code(), ExitCode::bad_input);
  EXPECT_NE(many.member().reason().find("65537 variables"), std::string::npos) << many.member().reason();
}

}  // namespace physics_node_test
}  // namespace slew::node
