// The recorder of a session, with every other node and the clock played by the test.
#include "recorder_node/recorder_node.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <set>
#include <thread>

#include "recording/reader.h"
#include "tests/support/played_session.h"

namespace slew::recorder {
namespace recorder_node_test {

using testing::kMs;
using testing::PlayedSession;
using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

class RecorderBench {
 public:
  explicit RecorderBench(RecorderConfig config = {}) {
    std::string name = (std::filesystem::temp_directory_path() / "slewring_recorder_XXXXXX").string();
    folder = ::mkdtemp(name.data());
    config.runs_directory = folder;
    node = std::make_unique<RecorderNode>(played.transport(), std::move(config));
  }
  ~RecorderBench() { std::filesystem::remove_all(folder); }
  RecorderBench(const RecorderBench&) = delete;
  RecorderBench& operator=(const RecorderBench&) = delete;

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
    ASSERT_EQ(node->member().state(), NodeState::joining) << "io has not chosen it";
    choose(node->member().header(Phase::join, kJoinStep), NodeState::joining);
    ASSERT_EQ(node->member().state(), NodeState::ready);
  }
  // io has taken the status of this process first
  void choose(const wire::Header& process, NodeState state) {
    played.say_heard(Role::io, state, process, {Topic::node_status});
    poll(kMs);
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

// ---- storage --------------------------------------------------------------------------------------------------

// A disk on which a write fails, by its number: this one alone or all from there on, some after half of their bytes.
class FailingDisk final : public recording::FileCalls {
 public:
  enum class Failure { once, from_then_on, half_way };

  std::int64_t write(int descriptor, recording::ByteSpan bytes, std::uint64_t offset) override {
    ++writes;
    const bool is_half = failure == Failure::half_way && bytes.size() > 1;
    if (is_half && writes == fails_at) return FileCalls::write(descriptor, bytes.first(bytes.size() / 2), offset);
    const bool fails = is_half ? writes == fails_at + 1 : writes == fails_at;
    if (!fails && !(failure == Failure::from_then_on && writes > fails_at && fails_at > 0)) {
      return FileCalls::write(descriptor, bytes, offset);
    }
    errno = error;
    return -1;
  }
  int synchronise(int descriptor) override {
    if (!fails_to_synchronise) return FileCalls::synchronise(descriptor);
    errno = EIO;
    return -1;
  }
  std::uint64_t free_bytes(const std::filesystem::path&) override { return room; }

  int fails_at = 0;  // 0: never
  Failure failure = Failure::once;
  int error = ENOSPC;
  bool fails_to_synchronise = false;
  std::uint64_t room = 1'000'000'000;
  int writes = 0;
};

RecorderConfig on(FailingDisk& disk) {
  RecorderConfig config;
  config.file_calls = &disk;
  config.limits.flush_period = milliseconds(1);  // whatever has come is written at the next look
  config.limits.window_steps = 2;
  return config;
}

// Ten steps and an end. False when the session was refused, because not even the front of the file could be written.
bool play(RecorderBench& bench) {
  bench.played.say(Topic::session, bench.played.session);
  bench.poll();
  if (bench.node->is_finished()) return false;
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
    bench.played.say_status(role, NodeState::joining);
  }
  bench.poll(kMs);
  bench.say_probe();
  bench.poll(kMs);
  for (StepIndex step = 0; step < 10; step += 2) bench.say_steps(step, step + 1);
  EXPECT_FALSE(bench.node->is_finished()) << "the session was not let go on";
  bench.say_end(9);
  EXPECT_TRUE(bench.node->is_finished());
  return true;
}

void expect_valid(const RecorderBench& bench, bool has_end) {
  std::unique_ptr<recording::Reader> reader;
  ASSERT_EQ(recording::Reader::open(bench.node->recording(), reader).text, "");
  const std::set<StepIndex> ticks = bench.recorded(Topic::tick);
  if (has_end) {
    ASSERT_EQ(reader->verify().text, "");
    ASSERT_EQ(bench.summary("exit_code"), "6");
    if (!ticks.empty()) {
      ASSERT_EQ(bench.summary("tick.recorded"), std::to_string(ticks.size()));
    }
    // no step up to the last one is missing
    const StepIndex last = std::stoll(bench.summary("last_step"));
    for (StepIndex step = 0; step <= last; ++step) {
      ASSERT_TRUE(ticks.contains(step) && bench.recorded(Topic::mechanism).contains(step) &&
                  bench.recorded(Topic::actuators).contains(step))
          << step << " of " << last;
    }
  }
  ASSERT_TRUE(ticks.empty() || *ticks.rbegin() < static_cast<StepIndex>(ticks.size())) << "a gap in the middle";
}

TEST(RecorderStorage, AFailureOfAnyWriteEndsTheRecordingAndNotTheSession) {
  FailingDisk whole;
  RecorderBench clean(on(whole));
  ASSERT_TRUE(play(clean));
  ASSERT_EQ(clean.node->member().exit_code(), ExitCode::ok) << clean.node->member().reason();
  ASSERT_GT(whole.writes, 20);
  int refused = 0;
  for (int n = 1; n <= whole.writes; ++n) {
    for (const auto failure :
         {FailingDisk::Failure::once, FailingDisk::Failure::from_then_on, FailingDisk::Failure::half_way}) {
      for (const int error : {ENOSPC, EIO, EDQUOT}) {
        SCOPED_TRACE(std::to_string(n) + " " + std::strerror(error) + " " + std::to_string(static_cast<int>(failure)));
        FailingDisk disk;
        disk.fails_at = n;
        disk.failure = failure;
        disk.error = error;
        RecorderBench bench(on(disk));
        const bool took_place = play(bench);
        ASSERT_EQ(bench.node->member().exit_code(), ExitCode::storage) << bench.node->member().reason();
        ASSERT_NE(bench.node->member().reason().find(std::strerror(error)), std::string::npos);
        if (!took_place) {
          ++refused;
          ASSERT_TRUE(std::filesystem::is_empty(bench.folder)) << "a session that did not begin leaves nothing";
          continue;
        }
        // the end itself is the last thing to be written
        const bool is_end_there = failure != FailingDisk::Failure::from_then_on && n < whole.writes - 1;
        expect_valid(bench, is_end_there);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 9 * whole.writes);
}

TEST(RecorderStorage, ADiskThatDoesNotConfirmIsTold) {
  FailingDisk disk;
  disk.fails_to_synchronise = true;
  RecorderBench bench(on(disk));
  ASSERT_TRUE(play(bench));
  EXPECT_EQ(bench.node->member().exit_code(), ExitCode::storage);
  EXPECT_NE(bench.node->member().reason().find("the disk did not confirm the recording"), std::string::npos);
}

TEST(RecorderStorage, WhenRoomGetsShortAllThatCameIsKeptAndTheSessionGoesOn) {
  FailingDisk disk;
  RecorderBench bench(on(disk));
  bench.join();
  bench.say_steps(0, 9);
  disk.room = kKeepFreeBytes - 1;
  bench.poll(2 * kMs);
  bench.say_steps(10, 19);
  EXPECT_FALSE(bench.node->is_finished());
  EXPECT_EQ(bench.recorded(Topic::tick).size(), 10u);
  expect_valid(bench, true);
  EXPECT_EQ(bench.summary("last_step"), "9");
  bench.say_end(19);
  EXPECT_TRUE(bench.node->is_finished());
  EXPECT_EQ(bench.node->member().exit_code(), ExitCode::storage);
  EXPECT_NE(bench.node->member().reason().find(
                ": 256 MB are free on this file system and 256 MB are to be left to others; the recording was closed; "
                "free space, record elsewhere with --out DIR, or leave less with --keep-free MB"),
            std::string::npos)
      << bench.node->member().reason();
}

TEST(RecorderStorage, WithoutRoomNoSessionBegins) {
  FailingDisk disk;
  disk.room = 1'000'000;
  RecorderBench bench(on(disk));
  EXPECT_FALSE(play(bench));
  EXPECT_EQ(bench.node->member().exit_code(), ExitCode::storage);
  EXPECT_NE(bench.node->member().reason().find(": 1 MB are free on this file system and 256 MB are to be left to "
                                               "others; nothing was recorded;"),
            std::string::npos)
      << bench.node->member().reason();
  EXPECT_TRUE(std::filesystem::is_empty(bench.folder));
}

// A disk that takes nothing while it is held.
class HeldDisk final : public recording::FileCalls {
 public:
  std::int64_t write(int descriptor, recording::ByteSpan bytes, std::uint64_t offset) override {
    std::unique_lock lock(mutex_);
    released_.wait(lock, [this] { return !is_held_; });
    return FileCalls::write(descriptor, bytes, offset);
  }
  void hold() {
    const std::lock_guard lock(mutex_);
    is_held_ = true;
  }
  void release() {
    {
      const std::lock_guard lock(mutex_);
      is_held_ = false;
    }
    released_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable released_;
  bool is_held_ = false;
};

class SlowDisk : public ::testing::Test {
 protected:
  explicit SlowDisk(wire::Pace pace = wire::Pace::real) {
    RecorderConfig config;
    config.file_calls = &disk_;
    config.keep_free = 0;
    config.limits.flush_period = milliseconds(1);
    config.limits.window_steps = 2;
    config.limits.chunk_bytes = 1'000;
    config.limits.backlog_bytes = kBacklog;
    bench_ = std::make_unique<RecorderBench>(std::move(config));
    bench_->played.session.pace = pace;
    bench_->join();
  }
  ~SlowDisk() override { disk_.release(); }

  // one step with a block of variables that do not compress
  void say_step(StepIndex step) {
    bench_->played.say_tick(step);
    bench_->played.say_mechanism(step);
    bench_->played.say_actuators(step);
    wire::VariableBlock block;
    block.header = bench_->played.header(Role::mechanics, step);
    for (int i = 0; i < 20; ++i) block.values.push_back(std::sin(1.7 * static_cast<double>(step) + i));
    bench_->played.say(Topic::variables, block);
    bench_->poll(2 * kMs);
    // the others are alive, whatever the clock says
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
      bench_->played.say_status(role, NodeState::running, step);
    }
  }
  void finish(StepIndex last) {
    bench_->say_end(last);
    ASSERT_TRUE(bench_->node->is_finished());
    ASSERT_EQ(recording::Reader::open(bench_->node->recording(), reader_).text, "");
    ASSERT_EQ(reader_->verify().text, "");
  }
  // Waits until nothing waits for the disk.
  [[nodiscard]] bool is_written() const {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (bench_->node->backlog_bytes() > 0 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
    return bench_->node->backlog_bytes() == 0;
  }
  [[nodiscard]] std::vector<recording::TextMap> gaps() const {
    std::vector<recording::TextMap> found;
    for (const recording::MetadataRecord& record : reader_->metadata()) {
      if (record.name == recording::kGapName) found.push_back(record.entries);
    }
    return found;
  }

  static constexpr std::size_t kBacklog = 40'000;
  HeldDisk disk_;
  std::unique_ptr<RecorderBench> bench_;
  std::unique_ptr<recording::Reader> reader_;
};

TEST_F(SlowDisk, CostsVariablesBeforeSteps) {
  StepIndex step = 0;
  for (; step < 10; ++step) say_step(step);
  disk_.hold();
  // until variables are left out, and a little longer
  while (bench_->node->lost() == 0 && step < 5'000) say_step(step++);
  ASSERT_LT(step, 5'000);
  const StepIndex first_lost = step - 1;
  for (int i = 0; i < 5; ++i) say_step(step++);
  disk_.release();
  // when all that waited is written, variables are recorded again
  for (const StepIndex until = step + 50; step < until; ++step) {
    ASSERT_TRUE(is_written());
    say_step(step);
  }
  finish(step - 1);
  EXPECT_EQ(bench_->recorded(Topic::tick).size(), static_cast<std::size_t>(step)) << "no step was left out";
  EXPECT_EQ(bench_->recorded(Topic::mechanism).size(), static_cast<std::size_t>(step));
  const std::size_t variables = bench_->recorded(Topic::variables).size();
  EXPECT_LE(variables, static_cast<std::size_t>(step) - 6);
  EXPECT_EQ(bench_->summary("variables.lost"), std::to_string(static_cast<std::size_t>(step) - variables));
  EXPECT_EQ(bench_->node->member().exit_code(), ExitCode::losses);
  ASSERT_GE(gaps().size(), 1u);
  const recording::TextMap gap = gaps().front();
  EXPECT_EQ(gap.at("from_step"), std::to_string(first_lost));
  EXPECT_GE(std::stoll(gap.at("to_step")), first_lost + 5);
  EXPECT_GE(std::stoi(gap.at("left_out.variables")), 6);
  EXPECT_EQ(gap.count("left_out.tick"), 0u);
  EXPECT_EQ(gap.at("cause"), "the disk was slower than the session");
}

TEST_F(SlowDisk, ThatStandsStillCostsStepsTooAndNeverMoreMemory) {
  disk_.hold();
  StepIndex step = 0;
  for (; step < 3'000; ++step) {
    say_step(step);
    ASSERT_LE(bench_->node->backlog_bytes(), 40'000u);
  }
  EXPECT_FALSE(bench_->node->is_finished());
  disk_.release();
  finish(step - 1);
  EXPECT_EQ(bench_->node->member().exit_code(), ExitCode::losses);
  const std::set<StepIndex> ticks = bench_->recorded(Topic::tick);
  EXPECT_LT(ticks.size(), 3'000u);
  EXPECT_EQ(*ticks.begin(), 0);
  ASSERT_GE(gaps().size(), 1u);
  EXPECT_GE(std::stoi(gaps().front().at("left_out.tick")), 1);
  // variables had gone before
  EXPECT_LT(bench_->recorded(Topic::variables).size(), ticks.size());
}

class SlowDiskInFreePace : public SlowDisk {
 protected:
  SlowDiskInFreePace() : SlowDisk(wire::Pace::free) {}
};

TEST_F(SlowDiskInFreePace, IsWaitedForAndCostsNothing) {
  constexpr StepIndex kSteps = 1'000;
  disk_.hold();
  std::atomic<bool> is_full = false;
  std::thread releases([&] {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!is_full && std::chrono::steady_clock::now() < deadline) {
      is_full = bench_->node->backlog_bytes() + 2'000 > kBacklog;
      std::this_thread::yield();
    }
    disk_.release();
  });
  for (StepIndex step = 0; step < kSteps; ++step) {
    say_step(step);
    EXPECT_LE(bench_->node->backlog_bytes(), kBacklog);
  }
  releases.join();
  EXPECT_TRUE(is_full);
  finish(kSteps - 1);
  EXPECT_EQ(bench_->node->lost(), 0u);
  EXPECT_EQ(bench_->node->member().exit_code(), ExitCode::ok) << bench_->node->member().reason();
  EXPECT_EQ(bench_->recorded(Topic::variables).size(), static_cast<std::size_t>(kSteps));
  EXPECT_TRUE(gaps().empty());
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
