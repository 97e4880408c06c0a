// SPDX-License-Identifier: Apache-2.0
// A recorder whose disk fails, is full or is slow.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "recorder_bench.h"

namespace slew::recorder_node {
namespace recorder_storage_test {

// A disk on which write number n fails, alone or with all later ones; some writes fail after half of their bytes.
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
  config.limits.flush_period = milliseconds(1);  // each poll writes all messages
  config.limits.window_steps = 2;
  return config;
}

// Ten steps and an end. False: the session was refused, because the front of the file could not be written.
bool play(RecorderBench& bench) {
  bench.played.publish(Topic::session, bench.played.session);
  bench.poll();
  if (bench.node->is_finished()) return false;
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
    bench.played.publish_status(role, NodeState::joining);
  }
  bench.poll(kMs);
  bench.publish_probe();
  bench.poll(kMs);
  for (StepIndex step = 0; step < 10; step += 2) bench.publish_steps(step, step + 1);
  EXPECT_FALSE(bench.node->is_finished()) << "the session was not let go on";
  bench.publish_end(9);
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
        // the end is written last
        const bool is_end_there = failure != FailingDisk::Failure::from_then_on && n < whole.writes - 1;
        expect_valid(bench, is_end_there);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 9 * whole.writes);
}

TEST(RecorderStorage, ADiskThatDoesNotConfirmIsReported) {
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
  bench.publish_steps(0, 9);
  disk.room = kKeepFreeBytes - 1;
  bench.poll(2 * kMs);
  bench.publish_steps(10, 19);
  EXPECT_FALSE(bench.node->is_finished());
  EXPECT_EQ(bench.recorded(Topic::tick).size(), 10u);
  expect_valid(bench, true);
  EXPECT_EQ(bench.summary("last_step"), "9");
  bench.publish_end(19);
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
  explicit SlowDisk(Pace pace = Pace::real) {
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
  void publish_step(StepIndex step) {
    bench_->played.publish_tick(step);
    bench_->played.publish_mechanism(step);
    bench_->played.publish_actuators(step);
    wire::VariableBlock block;
    block.header = bench_->played.header(Role::mechanics, step);
    for (int i = 0; i < 20; ++i) block.values.push_back(std::sin(1.7 * static_cast<double>(step) + i));
    bench_->played.publish(Topic::variables, block);
    bench_->poll(2 * kMs);
    // the peers stay alive at any time on the clock
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) {
      bench_->played.publish_status(role, NodeState::running, step);
    }
  }
  void finish(StepIndex last) {
    bench_->publish_end(last);
    ASSERT_TRUE(bench_->node->is_finished());
    ASSERT_EQ(recording::Reader::open(bench_->node->recording(), reader_).text, "");
    ASSERT_EQ(reader_->verify().text, "");
  }
  // Waits until the backlog is empty.
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
  for (; step < 10; ++step) publish_step(step);
  disk_.hold();
  // until variables are left out, and a little longer
  while (bench_->node->lost() == 0 && step < 5'000) publish_step(step++);
  ASSERT_LT(step, 5'000);
  const StepIndex first_lost = step - 1;
  for (int i = 0; i < 5; ++i) publish_step(step++);
  disk_.release();
  // when the backlog is written, variables are recorded again
  for (const StepIndex until = step + 50; step < until; ++step) {
    ASSERT_TRUE(is_written());
    publish_step(step);
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
    publish_step(step);
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
  // variables had been left out before
  EXPECT_LT(bench_->recorded(Topic::variables).size(), ticks.size());
}

class SlowDiskInFreePace : public SlowDisk {
 protected:
  SlowDiskInFreePace() : SlowDisk(Pace::free) {}
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
    publish_step(step);
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

}  // namespace recorder_storage_test
}  // namespace slew::recorder_node
