// SPDX-License-Identifier: Apache-2.0
// The recorder of a session, with every other node and the clock played by the test.
#include "recorder_node/recorder_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "recorder_bench.h"

namespace slew::recorder_node {
namespace recorder_node_test {

class Recorder : public ::testing::Test, public RecorderBench {};

TEST_F(Recorder, RecordsEveryStepUpToTheEndThatEachNodeNamed) {
  join();
  publish_steps(0, 9);
  publish_end(9);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(recorded(Topic::tick).size(), 10u);
  EXPECT_EQ(recorded(Topic::mechanism).size(), 10u);
  EXPECT_EQ(summary("tick.lost"), "0");
}

TEST_F(Recorder, RequestsAGapAsSoonAsItIsDue) {
  join();
  publish_steps(0, 5);
  poll(kMs);
  played.forget();
  played.publish_tick(7);
  poll();
  const std::int64_t due_ns = node->next_deadline(now_ns);
  EXPECT_LE(due_ns, now_ns + node::kResendAfter.ns);
  poll(due_ns - now_ns);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_EQ(requests.size(), 1u);
  EXPECT_EQ(requests[0].header.step, 6);
  EXPECT_EQ(requests[0].last_step, 6);
  EXPECT_GT(node->next_deadline(now_ns), now_ns);
}

TEST_F(Recorder, RequestsAGapWhileAllElseComesInOrder) {
  join();
  publish_steps(0, 5);
  static_cast<void>(played.received<wire::ResendRequest>(Topic::resend));
  const auto publish_step = [&](StepIndex step, bool has_mechanism) {
    played.publish_tick(step);
    if (has_mechanism) played.publish_mechanism(step);
    played.publish_actuators(step);
    poll(kMs);
  };
  // samples 6 and 9 of the mechanics are lost
  for (StepIndex step = 6; step <= 20; ++step) publish_step(step, step != 6 && step != 9);
  const auto requests = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_GE(requests.size(), 2u);
  EXPECT_EQ(requests[0].header.step, 6);
  // once a gap is filled the next one is requested as soon as the first
  played.publish_mechanism(6);
  poll();
  for (StepIndex step = 21; step <= 25; ++step) publish_step(step, true);
  const auto next = played.received<wire::ResendRequest>(Topic::resend);
  ASSERT_GE(next.size(), 1u);
  EXPECT_EQ(next[0].header.step, 9);
}

// Ticks that no node can resend: the recorder was further behind than the other nodes' caches reach.
TEST_F(Recorder, BehindAGapInTheTicksRecordsTheStatesOfAllNodes) {
  join();
  publish_steps(0, 9);
  for (StepIndex step = 10; step < 3000; ++step) {
    if (step < 13 || step > 15) played.publish_tick(step);
    played.publish_mechanism(step);
    played.publish_actuators(step);
    if (step % 100 == 0) poll(100 * kMs);
  }
  poll(kMs);
  // requests the states as a late recorder does
  const auto has_requested = [&](Role role, StepIndex step) {
    const auto requests = played.received<wire::ResendRequest>(Topic::resend);
    return std::any_of(requests.begin(), requests.end(), [&](const wire::ResendRequest& request) {
      return request.topic == static_cast<std::uint8_t>(Topic::state) && request.role == role &&
             request.header.step == step;
    });
  };
  EXPECT_TRUE(has_requested(Role::io, kJoinStep));
  wire::StatePart part;
  part.total = 5;
  part.bytes.resize(5);
  const auto publish_state = [&](Role role, StepIndex step) {
    part.header = played.header(Role::io, step);
    part.role = role;
    played.publish(Topic::state, part);
    poll(kMs);
  };
  publish_state(Role::io, 14);  // a state of a step in the gap is useless
  publish_state(Role::io, 3000);
  publish_state(Role::mechanics, 3000);
  played.forget();
  poll(200 * kMs);
  EXPECT_TRUE(has_requested(Role::hydraulics, 3000));
  publish_state(Role::hydraulics, 3000);
  publish_state(Role::hydraulics, 3000);
  publish_state(Role::io, 3100);  // a request to save the session
  played.forget();
  publish_steps(3000, 3010);
  EXPECT_FALSE(has_requested(Role::io, kJoinStep)) << "once";
  publish_end(3010);
  ASSERT_TRUE(node->is_finished());
  EXPECT_EQ(recorded(Topic::state), std::set<StepIndex>{3000});
  EXPECT_EQ(summary("state.recorded"), "3");
  EXPECT_EQ(summary("state.lost"), "0");
  EXPECT_EQ(summary("tick.lost"), "3");
  EXPECT_EQ(node->member().exit_code(), ExitCode::losses);
  std::unique_ptr<recording::Reader> reader;
  ASSERT_EQ(recording::Reader::open(node->recording(), reader).text, "");
  std::vector<recording::TextMap> gaps;
  for (const recording::MetadataRecord& record : reader->metadata()) {
    if (record.name == recording::kGapName) gaps.push_back(record.entries);
  }
  ASSERT_EQ(gaps.size(), 1u);
  EXPECT_EQ(gaps[0], (recording::TextMap{{"cause", "no node could send them again"},
                                         {"epoch", "0"},
                                         {"from_step", "13"},
                                         {"to_step", "15"},
                                         {"left_out.tick", "3"}}));
}

// A session with a missing sample can be computed again.
TEST_F(Recorder, AfterAGapInTheSamplesRequestsNoStates) {
  join();
  publish_steps(0, 9);
  for (StepIndex step = 10; step < 3000; ++step) {
    played.publish_tick(step);
    if (step != 13) played.publish_mechanism(step);
    played.publish_actuators(step);
    if (step % 100 == 0) poll(100 * kMs);
  }
  poll(kMs);
  for (const wire::ResendRequest& request : played.received<wire::ResendRequest>(Topic::resend)) {
    EXPECT_NE(request.topic, static_cast<std::uint8_t>(Topic::state));
  }
  publish_end(2999);
  EXPECT_EQ(summary("mechanism.lost"), "1");
}

TEST_F(Recorder, NamesNoFileThatItCouldNotCreate) {
  played.session.step_ns = 0;
  played.publish(Topic::session, played.session);
  poll();
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_TRUE(node->recording().empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

// ---- losses ---------------------------------------------------------------------------------------------------

TEST_F(Recorder, CountsVariableBlocksThatNeverCame) {
  join();
  for (const StepIndex step : {0, 10, 40, 50}) publish_block(step);
  publish_steps(0, 59);
  publish_end(59);
  // 20 and 30 are missing, and no block follows the last one
  poll(2000 * kMs);
  EXPECT_EQ(summary("variables.recorded"), "4");
  EXPECT_EQ(summary("variables.lost"), "2");
  EXPECT_EQ(node->member().exit_code(), ExitCode::losses);
  EXPECT_EQ(node->member().reason(), "2 messages are missing in the recording");
}

// ---- others of the name ---------------------------------------------------------------------------------------

TEST_F(Recorder, DoesNotFileMessagesOfAnotherSessionOfTheName) {
  join();
  const auto publish_all = [&](std::uint8_t session) {
    wire::NodeStatus status = played.status(Role::mechanics, NodeState::running, 1);
    wire::Health health;
    wire::ControllerLease lease;
    status.header.session[0] ^= session;
    health.header = lease.header = status.header;
    played.publish(Topic::node_status, status);
    played.publish(Topic::health, health);
    played.publish(Topic::controller_lease, lease);
    poll(kMs);
  };
  publish_all(0);
  publish_all(1);
  publish_all(1);
  publish_steps(0, 9);
  publish_end(9);
  EXPECT_EQ(summary("health.recorded"), "1");
  EXPECT_EQ(summary("controller_lease.recorded"), "1");
}

TEST_F(Recorder, WaitsForTheLastVariableBlock) {
  join();
  for (const StepIndex step : {0, 10, 20}) publish_block(step);
  publish_steps(0, 35);
  publish_end(35);
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  publish_block(30);
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(summary("variables.lost"), "0");
}

// Samples from and to flexible bodies are published every k-th step, as blocks are.
TEST_F(Recorder, CountsSamplesOfFlexibleBodiesThatNeverCame) {
  played.session.required_roles |= bit(Role::flex);
  played.publish_status(Role::flex, NodeState::joining);
  join();
  for (const StepIndex step : {0, 10, 20, 50}) {
    wire::FlexibleMessage flexible;
    flexible.header = played.header(Role::mechanics, step);
    played.publish(Topic::flexible, flexible);
    wire::ElasticMessage elastic;
    elastic.header = played.header(Role::flex, step);
    if (step != 20) played.publish(Topic::elastic, elastic);
  }
  publish_steps(0, 59);
  played.publish_status(Role::flex, NodeState::ended, 50);
  publish_end(59);
  poll(2000 * kMs);
  EXPECT_EQ(summary("flexible.recorded"), "4");
  EXPECT_EQ(summary("flexible.lost"), "2");
  EXPECT_EQ(summary("elastic.recorded"), "3");
  EXPECT_EQ(summary("elastic.lost"), "3");
}

TEST_F(Recorder, RecordsWhatComesAfterTheResetThatEndedItsEpoch) {
  join();
  for (StepIndex step = 0; step <= 9; ++step) played.publish_tick(step);
  for (StepIndex step = 0; step <= 5; ++step) {
    played.publish_mechanism(step);
    played.publish_actuators(step);
  }
  wire::Tick init;
  init.header = played.header(Role::io, kJoinStep, Phase::init, 1);
  played.publish(Topic::tick, init);
  // io's tick overtook these; samples 7 of both nodes never arrive
  for (const StepIndex step : {6, 8}) {
    played.publish_mechanism(step);
    played.publish_actuators(step);
  }
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
    wire::NodeStatus ended = played.status(role, NodeState::ended, -1);
    ended.header.epoch = 1;
    played.publish(Topic::node_status, ended);
  }
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(recorded(Topic::mechanism), (std::set<StepIndex>{0, 1, 2, 3, 4, 5, 6, 8}));
  EXPECT_EQ(summary("mechanism.lost"), "1");
  EXPECT_EQ(summary("actuators.lost"), "1");
  EXPECT_EQ(summary("tick.lost"), "0");
}

// ---- how it ended ---------------------------------------------------------------------------------------------

TEST_F(Recorder, WritesHowTheSessionEnded) {
  join();
  publish_steps(0, 9);
  wire::NodeStatus io = played.status(Role::io, NodeState::fault, 9);
  io.exit_code = static_cast<std::int32_t>(ExitCode::diverged);
  io.reason = "hydraulics (process 1 on here): diverged in step 8";
  played.publish_status(Role::mechanics, NodeState::fault, 9);
  played.publish_status(Role::hydraulics, NodeState::fault, 9);
  played.publish(Topic::node_status, io);
  poll(kMs);
  EXPECT_EQ(summary("exit_code"), "5");
  EXPECT_EQ(summary("end"), io.reason);
  EXPECT_EQ(summary("last_step"), "9");
}

TEST_F(Recorder, WritesThatASignalEndedTheSession) {
  join();
  publish_steps(0, 9);
  wire::NodeStatus io = played.status(Role::io, NodeState::ended, 9);
  io.exit_code = static_cast<std::int32_t>(ExitCode::interrupted);
  played.publish_status(Role::mechanics, NodeState::ended, 9);
  played.publish_status(Role::hydraulics, NodeState::ended, 9);
  played.publish(Topic::node_status, io);
  poll(kMs);
  EXPECT_EQ(summary("exit_code"), "130");
  EXPECT_EQ(summary("end"), "interrupted by SIGINT");
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok);
}

// All nodes may have acknowledged mechanics before they acknowledge io.
TEST_F(Recorder, RecordsAnInitThatComesBeforeIosProbe) {
  played.publish(Topic::session, played.session);
  poll();
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) played.publish_status(role, NodeState::joining);
  played.publish_mechanism(kJoinStep, Phase::join);
  played.publish_mechanism(kJoinStep, Phase::init);
  played.publish_mechanism(0);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::joining);
  publish_probe();
  poll(kMs);
  choose(node->member().header(Phase::join, kJoinStep), NodeState::joining);
  ASSERT_EQ(node->member().state(), NodeState::ready);
  played.publish_tick(0);
  played.publish_actuators(0);
  publish_steps(1, 9);
  publish_end(9);
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(recorded(Topic::mechanism).size(), 11u) << "INIT and ten samples";
}

// ---- a second recorder ----------------------------------------------------------------------------------------

TEST_F(Recorder, IsNotDisturbedByAnEmptyOneWhoseClockIsBehind) {
  join();
  publish_steps(0, 9);
  played.publish(Topic::node_status, other_recorder(NodeState::ready, kJoinStep, 0));
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  publish_steps(10, 12);
  publish_end(12);
  EXPECT_EQ(recorded(Topic::tick).size(), 13u);
}

// Directly after READY, whatever the other one publishes.
TEST_F(Recorder, ThatIsReadyYieldsToNoStatus) {
  join();
  played.publish(Topic::node_status, other_recorder(NodeState::running, 100, 0));
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  publish_steps(0, 9);
  played.publish(Topic::node_status, other_recorder(NodeState::running, 200, 0));
  publish_end(9);
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(recorded(Topic::tick).size(), 10u);
}

TEST_F(Recorder, LeavesNothingBehindWhenIoHasChosenAnotherOne) {
  played.publish(Topic::session, played.session);
  poll();
  played.publish(Topic::node_status, other_recorder(NodeState::joining, kJoinStep, 0));
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  choose(other_recorder(NodeState::joining, kJoinStep, 0).header, NodeState::joining);
  EXPECT_TRUE(node->is_finished());
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_TRUE(node->recording().empty());
}

TEST_F(Recorder, LeavesNothingBehindOfASessionThatIsWithdrawn) {
  join();
  EXPECT_FALSE(std::filesystem::is_empty(folder));
  played.session.header.phase = Phase::ended;
  played.publish(Topic::session, played.session);
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_TRUE(node->member().is_withdrawn());
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_TRUE(node->recording().empty());
}

TEST_F(Recorder, ThatJoinsARunningSessionClaimsNoRoleBeforeItHasReceivedTheFirst) {
  played.publish(Topic::session, played.session);
  poll();
  choose(other_recorder(NodeState::running, 499, INT64_MAX).header, NodeState::running);
  played.publish_tick(500);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::joining);
  // on a machine whose clock is behind: the first seems younger, and stays all the same
  played.publish(Topic::node_status, other_recorder(NodeState::running, 499, INT64_MAX));
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_NE(node->member().reason().find("is held by process"), std::string::npos) << node->member().reason();
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST_F(Recorder, OfASessionThatGoesOnTakesNoPartOfAStateThatHasNoPlace) {
  played.session.header.step = 100;
  join();
  wire::StatePart part;
  part.header = played.header(Role::io, 100);
  part.role = Role::mechanics;
  part.total = 5;
  part.bytes.resize(2);
  const auto publish_from = [&](std::uint32_t first) {
    part.first = first;
    played.publish(Topic::state, part);
    poll(kMs);
  };
  publish_from(3);
  publish_from(0);
  part.bytes.resize(5);
  publish_from(0);
  publish_from(0);
  publish_steps(100, 101);
  publish_end(101);
  poll(node::kLinger.ns);
  ASSERT_TRUE(node->is_finished());
  EXPECT_EQ(summary("state.recorded"), "1");
  EXPECT_EQ(summary("state.lost"), "2") << "those of io and of the hydraulics";
}

TEST_F(Recorder, ThatIsLateAndReceivesNoStatusOfAFirstOneReportsIt) {
  played.publish(Topic::session, played.session);
  poll();
  for (int i = 0; i < 110; ++i) {
    played.publish_status(Role::io, NodeState::running);
    played.publish_tick(500 + i);
    poll(100 * kMs);
  }
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_NE(node->member().reason().find("had begun before this recorder came"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace recorder_node_test
}  // namespace slew::recorder_node
