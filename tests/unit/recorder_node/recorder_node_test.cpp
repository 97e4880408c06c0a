// The recorder of a session, with every other node and the clock played by the test.
#include "recorder_node/recorder_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "recorder_bench.h"

namespace slew::recorder {
namespace recorder_node_test {

class Recorder : public ::testing::Test, public RecorderBench {};

TEST_F(Recorder, RecordsEveryStepUpToTheEndThatEachNodeNamed) {
  join();
  say_steps(0, 9);
  say_end(9);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(recorded(Topic::tick).size(), 10u);
  EXPECT_EQ(recorded(Topic::mechanism).size(), 10u);
  EXPECT_EQ(summary("tick.lost"), "0");
}

TEST_F(Recorder, AsksForAGapAsSoonAsItIsDue) {
  join();
  say_steps(0, 5);
  poll(kMs);
  played.forget();
  played.say_tick(7);
  poll();
  const std::int64_t due_ns = node->next_deadline(now_ns);
  EXPECT_LE(due_ns, now_ns + node::kResendAfter.ns);
  poll(due_ns - now_ns);
  const auto asked = played.said<wire::ResendRequest>(Topic::resend);
  ASSERT_EQ(asked.size(), 1u);
  EXPECT_EQ(asked[0].header.step, 6);
  EXPECT_EQ(asked[0].last_step, 6);
  EXPECT_GT(node->next_deadline(now_ns), now_ns);
}

TEST_F(Recorder, AsksForAGapWhileAllElseComesInOrder) {
  join();
  say_steps(0, 5);
  static_cast<void>(played.said<wire::ResendRequest>(Topic::resend));
  const auto say_step = [&](StepIndex step, bool has_mechanism) {
    played.say_tick(step);
    if (has_mechanism) played.say_mechanism(step);
    played.say_actuators(step);
    poll(kMs);
  };
  // samples 6 and 9 of the mechanics are lost
  for (StepIndex step = 6; step <= 20; ++step) say_step(step, step != 6 && step != 9);
  const auto asked = played.said<wire::ResendRequest>(Topic::resend);
  ASSERT_GE(asked.size(), 2u);
  EXPECT_EQ(asked[0].header.step, 6);
  // once a gap is filled the next one is asked for as fast as the first
  played.say_mechanism(6);
  poll();
  for (StepIndex step = 21; step <= 25; ++step) say_step(step, true);
  const auto next = played.said<wire::ResendRequest>(Topic::resend);
  ASSERT_GE(next.size(), 1u);
  EXPECT_EQ(next[0].header.step, 9);
}

// Ticks that no node can send again, as a recorder sees them that was behind by more than the others keep.
TEST_F(Recorder, BehindAGapInTheTicksRecordsTheStatesOfAllNodes) {
  join();
  say_steps(0, 9);
  for (StepIndex step = 10; step < 3000; ++step) {
    if (step < 13 || step > 15) played.say_tick(step);
    played.say_mechanism(step);
    played.say_actuators(step);
    if (step % 100 == 0) poll(100 * kMs);
  }
  poll(kMs);
  // asked for as a recorder does that comes late
  const auto has_asked = [&](Role role, StepIndex step) {
    const auto asked = played.said<wire::ResendRequest>(Topic::resend);
    return std::any_of(asked.begin(), asked.end(), [&](const wire::ResendRequest& request) {
      return request.topic == static_cast<std::uint8_t>(Topic::state) && request.role == role &&
             request.header.step == step;
    });
  };
  EXPECT_TRUE(has_asked(Role::io, kJoinStep));
  wire::StatePart part;
  part.total = 5;
  part.bytes.resize(5);
  const auto say_state = [&](Role role, StepIndex step) {
    part.header = played.header(Role::io, step);
    part.role = role;
    played.say(Topic::state, part);
    poll(kMs);
  };
  say_state(Role::io, 14);  // of a step in the gap: no use
  say_state(Role::io, 3000);
  say_state(Role::mechanics, 3000);
  played.forget();
  poll(200 * kMs);
  EXPECT_TRUE(has_asked(Role::hydraulics, 3000));
  say_state(Role::hydraulics, 3000);
  say_state(Role::hydraulics, 3000);
  say_state(Role::io, 3100);  // of somebody who saves the session
  played.forget();
  say_steps(3000, 3010);
  EXPECT_FALSE(has_asked(Role::io, kJoinStep)) << "once";
  say_end(3010);
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

// A sample that is missing is no obstacle for who computes the session again.
TEST_F(Recorder, BehindAGapInTheSamplesAsksForNoStates) {
  join();
  say_steps(0, 9);
  for (StepIndex step = 10; step < 3000; ++step) {
    played.say_tick(step);
    if (step != 13) played.say_mechanism(step);
    played.say_actuators(step);
    if (step % 100 == 0) poll(100 * kMs);
  }
  poll(kMs);
  for (const wire::ResendRequest& request : played.said<wire::ResendRequest>(Topic::resend)) {
    EXPECT_NE(request.topic, static_cast<std::uint8_t>(Topic::state));
  }
  say_end(2999);
  EXPECT_EQ(summary("mechanism.lost"), "1");
}

TEST_F(Recorder, NamesNoFileThatItCouldNotCreate) {
  played.session.step_ns = 0;
  played.say(Topic::session, played.session);
  poll();
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_TRUE(node->recording().empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

// ---- losses ---------------------------------------------------------------------------------------------------

TEST_F(Recorder, CountsVariableBlocksThatNeverCame) {
  join();
  for (const StepIndex step : {0, 10, 40, 50}) say_block(step);
  say_steps(0, 59);
  say_end(59);
  // 20 and 30 are missing, and nothing comes behind the last one
  poll(2000 * kMs);
  EXPECT_EQ(summary("variables.recorded"), "4");
  EXPECT_EQ(summary("variables.lost"), "2");
  EXPECT_EQ(node->member().exit_code(), ExitCode::losses);
  EXPECT_EQ(node->member().reason(), "2 messages are missing in the recording");
}

// ---- others of the name ---------------------------------------------------------------------------------------

TEST_F(Recorder, DoesNotFileWhatAnotherSessionOfTheNameSays) {
  join();
  const auto say_all = [&](std::uint8_t session) {
    wire::NodeStatus status = played.status(Role::mechanics, NodeState::running, 1);
    wire::Health health;
    wire::ControllerLease lease;
    status.header.session[0] ^= session;
    health.header = lease.header = status.header;
    played.say(Topic::node_status, status);
    played.say(Topic::health, health);
    played.say(Topic::controller_lease, lease);
    poll(kMs);
  };
  say_all(0);
  say_all(1);
  say_all(1);
  say_steps(0, 9);
  say_end(9);
  EXPECT_EQ(summary("health.recorded"), "1");
  EXPECT_EQ(summary("controller_lease.recorded"), "1");
}

TEST_F(Recorder, WaitsForTheLastVariableBlock) {
  join();
  for (const StepIndex step : {0, 10, 20}) say_block(step);
  say_steps(0, 35);
  say_end(35);
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  say_block(30);
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(summary("variables.lost"), "0");
}

// samples of and for flexible bodies come every k-th step, as blocks do
TEST_F(Recorder, CountsSamplesOfFlexibleBodiesThatNeverCame) {
  played.session.required_roles |= bit(Role::flex);
  played.say_status(Role::flex, NodeState::joining);
  join();
  for (const StepIndex step : {0, 10, 20, 50}) {
    wire::FlexibleMessage flexible;
    flexible.header = played.header(Role::mechanics, step);
    played.say(Topic::flexible, flexible);
    wire::ElasticMessage elastic;
    elastic.header = played.header(Role::flex, step);
    if (step != 20) played.say(Topic::elastic, elastic);
  }
  say_steps(0, 59);
  played.say_status(Role::flex, NodeState::ended, 50);
  say_end(59);
  poll(2000 * kMs);
  EXPECT_EQ(summary("flexible.recorded"), "4");
  EXPECT_EQ(summary("flexible.lost"), "2");
  EXPECT_EQ(summary("elastic.recorded"), "3");
  EXPECT_EQ(summary("elastic.lost"), "3");
}

TEST_F(Recorder, RecordsWhatComesAfterTheResetThatEndedItsEpoch) {
  join();
  for (StepIndex step = 0; step <= 9; ++step) played.say_tick(step);
  for (StepIndex step = 0; step <= 5; ++step) {
    played.say_mechanism(step);
    played.say_actuators(step);
  }
  wire::Tick init;
  init.header = played.header(Role::io, kJoinStep, Phase::init, 1);
  played.say(Topic::tick, init);
  // io's tick overtook these; the samples 7 of both nodes never come
  for (const StepIndex step : {6, 8}) {
    played.say_mechanism(step);
    played.say_actuators(step);
  }
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
    wire::NodeStatus ended = played.status(role, NodeState::ended, -1);
    ended.header.epoch = 1;
    played.say(Topic::node_status, ended);
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
  say_steps(0, 9);
  wire::NodeStatus io = played.status(Role::io, NodeState::fault, 9);
  io.exit_code = static_cast<std::int32_t>(ExitCode::diverged);
  io.reason = "hydraulics (process 1 on here): diverged in step 8";
  played.say_status(Role::mechanics, NodeState::fault, 9);
  played.say_status(Role::hydraulics, NodeState::fault, 9);
  played.say(Topic::node_status, io);
  poll(kMs);
  EXPECT_EQ(summary("exit_code"), "5");
  EXPECT_EQ(summary("end"), io.reason);
  EXPECT_EQ(summary("last_step"), "9");
}

TEST_F(Recorder, WritesThatASignalEndedTheSession) {
  join();
  say_steps(0, 9);
  wire::NodeStatus io = played.status(Role::io, NodeState::ended, 9);
  io.exit_code = static_cast<std::int32_t>(ExitCode::interrupted);
  played.say_status(Role::mechanics, NodeState::ended, 9);
  played.say_status(Role::hydraulics, NodeState::ended, 9);
  played.say(Topic::node_status, io);
  poll(kMs);
  EXPECT_EQ(summary("exit_code"), "130");
  EXPECT_EQ(summary("end"), "interrupted by SIGINT");
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok);
}

// mechanics may have been heard by all before io was
TEST_F(Recorder, RecordsAnInitThatComesBeforeIosProbe) {
  played.say(Topic::session, played.session);
  poll();
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) played.say_status(role, NodeState::joining);
  played.say_mechanism(kJoinStep, Phase::join);
  played.say_mechanism(kJoinStep, Phase::init);
  played.say_mechanism(0);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::joining);
  say_probe();
  poll(kMs);
  choose(node->member().header(Phase::join, kJoinStep), NodeState::joining);
  ASSERT_EQ(node->member().state(), NodeState::ready);
  played.say_tick(0);
  played.say_actuators(0);
  say_steps(1, 9);
  say_end(9);
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(recorded(Topic::mechanism).size(), 11u) << "INIT and ten samples";
}

// ---- a second recorder ----------------------------------------------------------------------------------------

TEST_F(Recorder, IsNotDisturbedByAnEmptyOneWhoseClockIsBehind) {
  join();
  say_steps(0, 9);
  played.say(Topic::node_status, other_recorder(NodeState::ready, kJoinStep, 0));
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  say_steps(10, 12);
  say_end(12);
  EXPECT_EQ(recorded(Topic::tick).size(), 13u);
}

// Directly after READY, whatever the other one says.
TEST_F(Recorder, ThatIsReadyYieldsToNoStatus) {
  join();
  played.say(Topic::node_status, other_recorder(NodeState::running, 100, 0));
  poll(kMs);
  EXPECT_FALSE(node->is_finished());
  say_steps(0, 9);
  played.say(Topic::node_status, other_recorder(NodeState::running, 200, 0));
  say_end(9);
  EXPECT_EQ(node->member().exit_code(), ExitCode::ok) << node->member().reason();
  EXPECT_EQ(recorded(Topic::tick).size(), 10u);
}

TEST_F(Recorder, LeavesNothingBehindWhenIoHasChosenAnotherOne) {
  played.say(Topic::session, played.session);
  poll();
  played.say(Topic::node_status, other_recorder(NodeState::joining, kJoinStep, 0));
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
  played.say(Topic::session, played.session);
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_TRUE(node->member().is_withdrawn());
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_TRUE(node->recording().empty());
}

TEST_F(Recorder, ThatComesToARunningSessionIsNoRivalBeforeItHasHeardTheFirst) {
  played.say(Topic::session, played.session);
  poll();
  choose(other_recorder(NodeState::running, 499, INT64_MAX).header, NodeState::running);
  played.say_tick(500);
  poll(kMs);
  EXPECT_EQ(node->member().state(), NodeState::joining);
  // on a machine whose clock is behind: the first is younger, and stays all the same
  played.say(Topic::node_status, other_recorder(NodeState::running, 499, INT64_MAX));
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
  const auto say_from = [&](std::uint32_t first) {
    part.first = first;
    played.say(Topic::state, part);
    poll(kMs);
  };
  say_from(3);
  say_from(0);
  part.bytes.resize(5);
  say_from(0);
  say_from(0);
  say_steps(100, 101);
  say_end(101);
  poll(node::kLinger.ns);
  ASSERT_TRUE(node->is_finished());
  EXPECT_EQ(summary("state.recorded"), "1");
  EXPECT_EQ(summary("state.lost"), "2") << "those of io and of the hydraulics";
}

TEST_F(Recorder, ThatComesLateAndHearsOfNoFirstOneSaysSo) {
  played.say(Topic::session, played.session);
  poll();
  for (int i = 0; i < 110; ++i) {
    played.say_status(Role::io, NodeState::running);
    played.say_tick(500 + i);
    poll(100 * kMs);
  }
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_NE(node->member().reason().find("had begun before this recorder came"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace recorder_node_test
}  // namespace slew::recorder
