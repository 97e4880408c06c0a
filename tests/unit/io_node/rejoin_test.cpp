// SPDX-License-Identifier: Apache-2.0
// The role of a lost physics node; the test plays the nodes and the clock.
#include <gtest/gtest.h>

#include "io_node/io_node.h"
#include "tests/support/played_session.h"

namespace slew::io_node {
namespace rejoin_test {

using testing::kMs;
using testing::PlayedSession;
using wire::ControlAction;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

class Rejoin : public ::testing::Test {
 protected:
  static IoConfig config(SimDuration rejoin, bool is_recording = false) {
    IoConfig config;
    config.session_name = "s";
    config.session.duration = 0;  // until it is stopped
    config.session.start_grace = 0;
    config.session.controller_timeout = 0.2;
    config.scene_name = "still";
    config.required_roles = bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics);
    if (is_recording) config.required_roles |= bit(Role::recorder);
    config.name_check = {};
    config.session.rejoin = rejoin.seconds();
    return config;
  }
  void poll(std::int64_t after_ns = 0) { node->poll(now_ns += after_ns); }

  // every node is ready and has its first sample
  void get_ready(IoConfig with) {
    node = std::make_unique<IoNode>(played.transport(), std::move(with));
    poll();
    const auto sessions = played.received<wire::SessionDescription>(Topic::session);
    ASSERT_FALSE(sessions.empty());
    EXPECT_EQ(sessions.back().header.step, kJoinStep);
    played.session.header = sessions.back().header;
    for (const Role role : {Role::mechanics, Role::hydraulics, Role::recorder}) {
      played.acknowledge(role, NodeState::joining, node->member().header(Phase::join, kJoinStep),
                         {Topic::tick, Topic::variables});
    }
    poll(kMs);
    for (const Role role : {Role::mechanics, Role::hydraulics, Role::recorder}) {
      played.publish_status(role, NodeState::ready, 0);
    }
    poll(kMs);
    played.publish_mechanism(0);
    played.publish_actuators(0);
    poll(kMs);
  }
  void get_running(IoConfig with) {
    const bool holds_places = with.session.rejoin > 0;
    get_ready(std::move(with));
    if (HasFatalFailure()) return;
    if (holds_places) {
      EXPECT_EQ(node->next_step(), 0) << "a tick before every node can be replaced";
      publish_checkpoint(Role::mechanics, 0);
      publish_checkpoint(Role::hydraulics, 0);
      poll(kMs);
    }
    ASSERT_EQ(node->next_step(), 1);
  }
  void run_to(StepIndex step) {
    while (node->next_step() < step) {
      const StepIndex n = node->next_step();
      played.publish_mechanism(n);
      played.publish_actuators(n);
      if (n % 50 == 0) {
        played.publish_status(Role::mechanics, NodeState::running, n);
        played.publish_status(Role::hydraulics, NodeState::running, n);
        publish_recorded(recorded);
      }
      poll(kMs);
    }
  }
  void publish_recorded(StepIndex step) {
    wire::NodeStatus status = played.status(Role::recorder, NodeState::running, step);
    status.recorded_step = step;
    played.publish(Topic::node_status, status);
  }
  void publish_checkpoint(Role role, StepIndex step) {
    wire::StatePart part;
    part.header = played.header(role, step);
    part.role = role;
    part.state_hash = static_cast<std::uint64_t>(step);
    part.total = 10;
    part.bytes.resize(10);
    part.bytes[0] = static_cast<std::uint8_t>(step % 251);
    played.publish(Topic::checkpoint, part);
    poll();
  }
  // mechanics alone lives on for so long
  void lose_hydraulics(std::int64_t ms) {
    for (const std::int64_t end_ns = now_ns + ms * kMs; now_ns < end_ns;) {
      played.publish_status(Role::mechanics, NodeState::holding, node->next_step());
      publish_recorded(recorded);
      poll(100 * kMs);
    }
  }
  wire::NodeStatus second(NodeState state, std::uint32_t incarnation = 99) {
    wire::NodeStatus status = played.status(Role::hydraulics, state, 0);
    status.header.incarnation = incarnation;
    status.pid = 4711;
    return status;
  }
  std::vector<wire::StatePart> request_state(std::uint32_t incarnation = 99) {
    wire::ResendRequest request;
    request.header = played.header(Role::hydraulics, kJoinStep);
    request.header.incarnation = incarnation;
    request.role = Role::hydraulics;
    request.topic = static_cast<std::uint8_t>(Topic::state);
    request.last_step = kJoinStep;
    played.publish(Topic::resend, request);
    poll(kMs);
    return played.received<wire::StatePart>(Topic::state);
  }

  PlayedSession played{0};
  std::unique_ptr<IoNode> node;
  std::int64_t now_ns = 1000 * kMs;
  StepIndex recorded = kJoinStep;
};

TEST_F(Rejoin, HoldsThePlaceGivesTheStateAndGoesOn) {
  get_running(config(milliseconds(30'000)));
  run_to(140);
  publish_checkpoint(Role::hydraulics, 128);
  played.publish_mechanism(140);
  poll(kMs);
  played.forget();
  lose_hydraulics(2500);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  EXPECT_NE(node->member().reason().find("hydraulics (process "), std::string::npos) << node->member().reason();
  EXPECT_NE(node->member().reason().find("gone at step 140; its place is held for 30 s"), std::string::npos)
      << node->member().reason();
  EXPECT_NE(node->member().reason().find("the state of step 128"), std::string::npos);
  // the session is published with the process that is ignored, and with its step
  const auto sessions = played.received<wire::SessionDescription>(Topic::session);
  ASSERT_EQ(sessions.size(), 1u);
  EXPECT_EQ(sessions[0].header.step, 140);
  ASSERT_EQ(sessions[0].given_up.size(), 1u);
  EXPECT_EQ(sessions[0].given_up[0], (wire::GivenUp{Role::hydraulics, PlayedSession::incarnation(Role::hydraulics)}));
  EXPECT_EQ(sessions[0].rejoin_ns, 30'000 * kMs);
  // no other process gets the state
  EXPECT_TRUE(request_state().empty());
  played.publish(Topic::node_status, second(NodeState::joining));
  poll(kMs);
  const auto parts = request_state();
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].header.step, 128);
  EXPECT_EQ(parts[0].role, Role::hydraulics);
  EXPECT_EQ(parts[0].state_hash, 128u);
  EXPECT_EQ(parts[0].bytes[0], 128);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  played.publish(Topic::node_status, second(NodeState::ready));
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::running);
  EXPECT_EQ(node->next_step(), 140);
  wire::ActuatorMessage message;
  for (StepIndex step = 128; step <= 140; ++step) {
    message.header = played.header(Role::hydraulics, step);
    message.header.incarnation = 99;
    played.publish(Topic::actuators, message);
  }
  poll(kMs);
  EXPECT_EQ(node->next_step(), 141);
  EXPECT_EQ(node->member().refusals().too_far_ahead, 0u);
  const std::vector<std::string> warnings = node->member().take_warnings();
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("(process 4711 on elsewhere) goes on in the place of hydraulics (process "),
            std::string::npos)
      << warnings.back();
}

TEST_F(Rejoin, WarnsOfAFirstStateThatIsMissing) {
  get_ready(config(milliseconds(30'000)));
  publish_checkpoint(Role::mechanics, 0);
  static_cast<void>(node->member().take_warnings());  // of other builds
  for (std::int64_t ms = 0; ms < 2 * kSaveTimeout.ns / kMs && node->next_step() == 0; ms += 100) {
    EXPECT_TRUE(node->member().take_warnings().empty());
    for (const Role role : {Role::mechanics, Role::hydraulics}) played.publish_status(role, NodeState::ready, 0);
    poll(100 * kMs);
  }
  EXPECT_EQ(node->next_step(), 1) << "the session goes on";
  const std::vector<std::string> warnings = node->member().take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("hydraulics (process "), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("has not given its state of step 0 within 5 s, or one above 4 MiB; the session goes on, "
                             "but until a state of it has come no other process can take its place"),
            std::string::npos)
      << warnings[0];
}

TEST_F(Rejoin, TheHoldAndWhatIsComputedAgainAreNoLagOfTheMachine) {
  IoConfig strict = config(milliseconds(30'000));
  strict.session.overrun = scene::OverrunPolicy::stop;
  get_running(std::move(strict));
  run_to(140);
  publish_checkpoint(Role::hydraulics, 128);
  played.publish_mechanism(140);
  poll(kMs);
  const std::uint64_t judged = node->timing().response.count();
  lose_hydraulics(2500);
  EXPECT_EQ(problem_of_books(node->timing().books.read(), milliseconds(1)), "");
  for (const NodeState state : {NodeState::joining, NodeState::ready}) {
    played.publish(Topic::node_status, second(state));
    poll(kMs);
  }
  wire::ActuatorMessage message;
  for (StepIndex step = 128; step <= 140; ++step) {
    message.header = played.header(Role::hydraulics, step);
    message.header.incarnation = 99;
    played.publish(Topic::actuators, message);
    poll(40 * kMs);
  }
  for (int i = 0; i < 50; ++i) {
    message.header = played.header(Role::hydraulics, node->next_step());
    message.header.incarnation = 99;
    played.publish(Topic::actuators, message);
    played.publish_mechanism(node->next_step());
    poll(kMs);
  }
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(node->member().state(), NodeState::running);
  EXPECT_GT(node->next_step(), 180);
  EXPECT_GT(node->timing().response.count(), judged + 30);
  EXPECT_LT(node->timing().response.max(), 100 * kMs) << "the hold is no step's response";
  EXPECT_EQ(node->timing().books.read().skipped, 0u);
  EXPECT_EQ(problem_of_books(node->timing().books.read(), milliseconds(1)), "");
}

TEST_F(Rejoin, GivesNoStateFromWhichTheOthersWouldMissASample) {
  get_running(config(milliseconds(30'000)));
  run_to(140);
  // it was ahead: its last samples may have been lost with it
  publish_checkpoint(Role::hydraulics, 128);
  publish_checkpoint(Role::hydraulics, 141);
  lose_hydraulics(2500);
  EXPECT_NE(node->member().reason().find("the state of step 128"), std::string::npos) << node->member().reason();
}

TEST_F(Rejoin, TwoLostNodesBeginAtTheSameStep) {
  get_running(config(milliseconds(30'000)));
  run_to(140);
  publish_checkpoint(Role::hydraulics, 128);
  static_cast<void>(node->member().take_warnings());
  for (int i = 0; i < 25; ++i) poll(100 * kMs);
  const std::vector<std::string> warnings = node->member().take_warnings();
  ASSERT_EQ(warnings.size(), 2u);
  // mechanics cannot resend its samples between 0 and 128, so hydraulics must not begin there
  for (const std::string& warning : warnings) {
    EXPECT_NE(warning.find("gets the state of step 0"), std::string::npos) << warning;
  }
}

TEST_F(Rejoin, OneThatIsLostWhileItsPartnerCatchesUpBeginsWhereThatBegan) {
  get_running(config(milliseconds(30'000)));
  for (const StepIndex step : {0, 128, 256}) {
    run_to(step + 2);
    publish_checkpoint(Role::mechanics, step);
    if (step < 256) publish_checkpoint(Role::hydraulics, step);
  }
  run_to(300);
  played.publish_mechanism(300);
  played.publish_actuators(300);
  lose_hydraulics(2500);
  EXPECT_NE(node->member().reason().find("the state of step 128"), std::string::npos) << node->member().reason();
  // the replacement has resent its samples up to 200 when mechanics is lost
  for (int i = 0; i < 25; ++i) {
    played.publish(Topic::node_status, second(NodeState::running));
    wire::ActuatorMessage message;
    message.header = played.header(Role::hydraulics, 176 + i);
    message.header.incarnation = 99;
    played.publish(Topic::actuators, message);
    poll(100 * kMs);
  }
  const std::vector<std::string> warnings = node->member().take_warnings();
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("mechanics (process "), std::string::npos) << warnings.back();
  EXPECT_NE(warnings.back().find("gets the state of step 128"), std::string::npos) << warnings.back();
}

TEST_F(Rejoin, GivesTheStateFromWhichTheRecorderMissesNothing) {
  get_running(config(milliseconds(30'000), true));
  for (const StepIndex step : {0, 128, 256}) {
    run_to(step + 2);
    publish_checkpoint(Role::hydraulics, step);
  }
  recorded = 127;
  run_to(300);
  lose_hydraulics(2500);
  EXPECT_NE(node->member().reason().find("the state of step 128"), std::string::npos) << node->member().reason();
}

TEST_F(Rejoin, WithACheckpointThatIsTooOldOrWithoutRejoinTheSessionEnds) {
  get_running(config(milliseconds(30'000)));
  run_to(1000);
  lose_hydraulics(2500);
  EXPECT_EQ(node->member().exit_code(), ExitCode::node_lost);
  EXPECT_NE(node->member().reason().find("is gone; the session was held after step 1000 and ended"), std::string::npos)
      << node->member().reason();

  get_running(config({}));
  run_to(20);
  lose_hydraulics(2500);
  EXPECT_EQ(node->member().exit_code(), ExitCode::node_lost);
}

TEST_F(Rejoin, EndsWithoutAReplacementInTime) {
  get_running(config(milliseconds(3000)));
  run_to(20);
  lose_hydraulics(4000);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  lose_hydraulics(2000);
  EXPECT_EQ(node->member().exit_code(), ExitCode::node_lost);
  EXPECT_NE(node->member().reason().find("no other process took its place within 3 s; the session was held after "
                                         "step 20"),
            std::string::npos)
      << node->member().reason();
}

TEST_F(Rejoin, OneThatComesAndFailsLeavesThePlaceToTheNext) {
  get_running(config(milliseconds(30'000)));
  run_to(20);
  lose_hydraulics(2500);
  wire::NodeStatus failed = second(NodeState::fault);
  failed.reason = "asset 'x.stl' cannot be read";
  failed.exit_code = 2;
  played.publish(Topic::node_status, failed);
  poll(kMs);
  lose_hydraulics(200);
  EXPECT_EQ(node->member().state(), NodeState::holding);
  played.publish(Topic::node_status, second(NodeState::joining, 100));
  poll(kMs);
  EXPECT_EQ(request_state(100).size(), 1u);
  played.publish(Topic::node_status, second(NodeState::ready, 100));
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::running);
}

TEST_F(Rejoin, AResetWaitsUntilTheRoleIsTaken) {
  get_running(config(milliseconds(30'000)));
  run_to(20);
  lose_hydraulics(2500);
  wire::ControlRequest request;
  request.session = "s";
  request.request = 5;
  request.action = ControlAction::reset;
  played.publish(Topic::control_request, request);
  poll();
  const auto replies = played.received<wire::ControlReply>(Topic::control_reply);
  ASSERT_EQ(replies.size(), 1u);
  EXPECT_FALSE(replies[0].is_accepted);
  EXPECT_NE(replies[0].reason.find("its place is held"), std::string::npos) << replies[0].reason;
}

}  // namespace rejoin_test
}  // namespace slew::io_node
