// The recorder of a session, with every other node and the clock played by the test.
#include "recorder_node/recorder_node.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "recording/reader.h"
#include "tests/support/played_session.h"

namespace slew::recorder {
namespace {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

class Recorder : public ::testing::Test {
 protected:
  Recorder() {
    std::string name = (std::filesystem::temp_directory_path() / "slewring_recorder_XXXXXX").string();
    folder = ::mkdtemp(name.data());
    RecorderConfig config;
    config.runs_directory = folder;
    node = std::make_unique<RecorderNode>(played.carrier(), std::move(config));
  }
  ~Recorder() override { std::filesystem::remove_all(folder); }

  void poll(std::int64_t after_ns = 0) { node->poll(now_ns += after_ns); }
  void say_probe() {
    wire::Tick probe;
    probe.header = played.header(Role::io, kJoinStep, Phase::join);
    played.say(Topic::tick, probe);
  }
  void join() {
    played.say(Topic::session, played.session);
    poll();
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) played.say_status(role, NodeState::joining);
    poll(kMs);
    say_probe();
    poll(kMs);
    ASSERT_EQ(node->member().state(), NodeState::ready);
  }
  // ticks and samples of [from, to]
  void say_steps(StepIndex from, StepIndex to) {
    for (StepIndex step = from; step <= to; ++step) {
      played.say_tick(step);
      played.say_mechanism(step);
      played.say_actuators(step);
    }
    poll(101 * kMs);
  }
  // mechanics' variables at a step
  void say_block(StepIndex step) {
    wire::VariableBlock block;
    block.header = played.header(Role::mechanics, step);
    block.values.resize(3);
    played.say(Topic::variables, block);
    poll();
  }
  void say_end(StepIndex last, NodeState state = NodeState::ended) {
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) played.say_status(role, state, last);
    poll(kMs);
  }
  // another process of the role
  wire::NodeStatus other_recorder(NodeState state, StepIndex recorded, std::int64_t started_ns) const {
    wire::NodeStatus status = played.status(Role::recorder, state);
    status.header.incarnation = 999;
    status.recorded_step = recorded;
    status.started_ns = started_ns;
    return status;
  }

  // ---- what is in the file
  // steps of a topic by epoch
  [[nodiscard]] std::set<StepIndex> recorded(Topic topic, std::uint32_t epoch = 0) const {
    std::unique_ptr<recording::Reader> reader;
    EXPECT_TRUE(recording::Reader::open(node->recording(), reader).is_ok());
    std::set<StepIndex> steps;
    if (reader == nullptr) return steps;
    EXPECT_TRUE(reader
                    ->for_each({},
                               [&](const recording::RecordedMessage& message) {
                                 wire::Header header;
                                 const bool is_wanted = message.channel->topic == node::to_text(topic);
                                 if (is_wanted && transport::decode_header(message.payload, header) &&
                                     header.epoch == epoch) {
                                   steps.insert(header.step);
                                 }
                                 return recording::Reader::Visit::go_on;
                               })
                    .is_ok());
    return steps;
  }
  [[nodiscard]] std::string summary(const std::string& key) const {
    std::unique_ptr<recording::Reader> reader;
    EXPECT_TRUE(recording::Reader::open(node->recording(), reader).is_ok());
    const recording::TextMap* entries = reader == nullptr ? nullptr : reader->find_metadata("slewring.summary");
    if (entries == nullptr || entries->count(key) == 0) return "none";
    return entries->at(key);
  }

  PlayedSession played{bit(Role::io) | bit(Role::mechanics) | bit(Role::hydraulics) | bit(Role::recorder)};
  std::filesystem::path folder;
  std::unique_ptr<RecorderNode> node;
  std::int64_t now_ns = 1000 * kMs;
};

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

TEST_F(Recorder, KeepsWhatItHasRecordedWhenItMustGiveWay) {
  join();
  say_steps(0, 9);
  played.say(Topic::node_status, other_recorder(NodeState::running, 100, 0));
  poll(kMs);
  EXPECT_TRUE(node->is_finished());
  EXPECT_EQ(node->member().exit_code(), ExitCode::bad_input);
  EXPECT_EQ(recorded(Topic::tick).size(), 10u);
}

TEST_F(Recorder, LeavesNothingBehindWhenItGivesWayBeforeTheFirstStep) {
  join();
  played.say(Topic::node_status, other_recorder(NodeState::ready, kJoinStep, 0));
  poll(kMs);
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
  played.say_status(Role::io, NodeState::running);
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

}  // namespace
}  // namespace slew::recorder
