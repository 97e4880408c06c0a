// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <new>
#include <random>

#include "core/file_size_limit.h"
#include "recording/recovery.h"
#include "sample_session.h"
#include "tests/support/nightly.h"

namespace slew::recording {
namespace storage_test {

// No file of this process grows beyond the size while this lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    former_action_ = std::signal(SIGXFSZ, SIG_DFL);
    let_writes_fail_at_the_size_limit();  // as every program of ours
    getrlimit(RLIMIT_FSIZE, &former_);
    const rlimit limit = {bytes, former_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &former_);
    std::signal(SIGXFSZ, former_action_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit former_{};
  void (*former_action_)(int) = SIG_DFL;
};

// Writes the sample without expectations on the results; gives the first failure.
Status write_until_failure(const std::filesystem::path& path, StepIndex steps, WriterCounts& counts) {
  std::unique_ptr<Writer> writer;
  Status status = Writer::create(path, sample_identity(), small_limits(), writer);
  if (!status.is_ok()) return status;
  ChannelId channel{};
  status = writer->add_channel({kStateTopic, "t::T", "", {}}, channel);
  for (StepIndex step = 0; step < steps; ++step) {
    const std::string payload = sample_payload(static_cast<std::uint64_t>(step), 40);
    std::ignore = writer->write(channel, {0, step, static_cast<std::uint32_t>(step), 0}, as_byte_span(payload));
  }
  status = writer->close({{"result", "storage full"}});
  counts = writer->counts();
  return status;
}

TEST(RecordingStorage, AFileThatExistsIsNeverTouched) {
  const ScratchDirectory scratch;
  write_file(scratch / "a.mcap", "precious");
  std::unique_ptr<Writer> writer;
  const Status status = Writer::create(scratch / "a.mcap", sample_identity(), {}, writer);
  EXPECT_EQ(status.code, ExitCode::storage);
  EXPECT_NE(status.text.find("exists already; recordings are never overwritten"), std::string::npos);
  EXPECT_EQ(file_content(scratch / "a.mcap"), "precious");
}

TEST(RecordingStorage, AMissingDirectoryIsNamedWithTheRemedy) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  const Status status = Writer::create(scratch / "none/a.mcap", sample_identity(), {}, writer);
  EXPECT_EQ(status.code, ExitCode::storage);
  EXPECT_NE(status.text.find("No such file or directory"), std::string::npos);
  EXPECT_NE(status.text.find("--out DIR"), std::string::npos);
}

TEST(RecordingStorage, FailureAtAnyByteLeavesAReadableFileAndCountsTheRest) {
  const ScratchDirectory scratch;
  constexpr StepIndex kSteps = 12;
  WriterCounts counts;
  ASSERT_EQ(write_until_failure(scratch / "whole.mcap", kSteps, counts).text, "");
  const std::uint64_t whole = std::filesystem::file_size(scratch / "whole.mcap");
  for (std::uint64_t limit = 0; limit < whole; ++limit) {
    SCOPED_TRACE(limit);
    const std::filesystem::path path = scratch / fmt::format("{}.mcap", limit);
    counts = {};
    Status status;
    {
      const FileSizeLimit file_size_limit(limit);
      status = write_until_failure(path, kSteps, counts);
    }
    ASSERT_EQ(status.code, ExitCode::storage);
    ASSERT_NE(status.text.find("File too large"), std::string::npos) << status.text;
    ASSERT_LE(std::filesystem::file_size(path), limit);
    std::unique_ptr<Reader> reader;
    if (!Reader::open(path, reader).is_ok()) {
      ASSERT_LT(limit, 400u) << "only a file without its identity is refused";
      continue;
    }
    const std::vector<KnownMessage> read = read_all(*reader);
    ASSERT_EQ(read.size(), counts.messages);
    if (!reader->channels().empty()) {
      ASSERT_EQ(counts.messages + counts.lost_messages, std::uint64_t{kSteps});
    }
    for (std::size_t i = 0; i < read.size(); ++i) ASSERT_EQ(read[i].payload, sample_payload(i, 40));
  }
}

TEST(RecordingStorage, AfterAFailedChunkTheEndIsStillWrittenWhenItFits) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), {}, writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({"t", "t::T", "", {}}, channel).text, "");
  {
    // the first chunk does not fit, the end does
    const FileSizeLimit file_size_limit(20'000);
    const std::string payload = sample_payload(1, 40'000);
    ASSERT_EQ(writer->write(channel, {0, 0, 0, 0}, as_byte_span(payload)).text, "");
    EXPECT_EQ(writer->flush().code, ExitCode::storage);
    EXPECT_EQ(writer->write(channel, {0, 1, 1, 0}, as_byte_span(payload)).code, ExitCode::storage);
    EXPECT_EQ(writer->close({{"result", "storage"}}).code, ExitCode::storage);
  }
  EXPECT_EQ(writer->counts().lost_messages, 2u);
  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(scratch / "a.mcap", reader).text, "");
  EXPECT_EQ(reader->verify().text, "");
  EXPECT_EQ(reader->statistics().message_count, 0u);
  ASSERT_NE(reader->find_metadata(kSummaryName), nullptr);
}

// As root at once, otherwise as root of a user namespace of its own.
bool enter_mount_namespace() {
  const uid_t user = getuid();
  const gid_t group = getgid();
  if (unshare(CLONE_NEWNS) == 0) return true;
  if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) return false;
  write_file("/proc/self/uid_map", fmt::format("0 {} 1", user));
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/gid_map", fmt::format("0 {} 1", group));
  return true;
}

// In a child with a mount namespace of its own: a file system of 64 KiB. Exit code 77: not permitted here.
int record_onto_a_full_disk(const std::filesystem::path& where) {
  if (!enter_mount_namespace()) return 77;
  if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return 77;
  if (mount("slewring", where.c_str(), "tmpfs", 0, "size=64k") != 0) return 77;
  WriterCounts counts;
  const Status status = write_until_failure(where / "a.mcap", 3'000, counts);
  if (status.code != ExitCode::storage) return 1;
  if (status.text.find("No space left on device") == std::string::npos) return 2;
  if (status.text.find("free space on that file system") == std::string::npos) return 3;
  std::unique_ptr<Reader> reader;
  if (!Reader::open(where / "a.mcap", reader).is_ok()) return 4;
  if (read_all(*reader).size() != counts.messages || counts.messages == 0) return 5;
  // room for the end was kept
  if (!reader->verify().is_ok() || reader->find_metadata(kSummaryName) == nullptr) return 7;
  return counts.messages + counts.lost_messages == 3'000 ? 0 : 6;
}

TEST(RecordingStorage, FullDiskStopsTheRecordingAndKeepsWhatIsThere) {
  const ScratchDirectory scratch;
  const pid_t child = fork();
  if (child == 0) _exit(record_onto_a_full_disk(scratch.path()));
  int result = 0;
  ASSERT_EQ(waitpid(child, &result, 0), child);
  ASSERT_TRUE(WIFEXITED(result));
  if (WEXITSTATUS(result) == 77) GTEST_SKIP() << "mounting a small tmpfs is not permitted here";
  EXPECT_EQ(WEXITSTATUS(result), 0);
}

TEST(RecordingStorage, AKilledWriterLosesNothingThatWasFlushed) {
  const ScratchDirectory scratch;
  const std::filesystem::path path = scratch / "a.mcap";
  const pid_t child = fork();
  if (child == 0) {
    const std::unique_ptr<Writer> writer = write_sample(path, 25, Ending::open);
    std::ignore = writer->flush();
    std::ignore = writer->write(ChannelId{0}, {0, 25, 25, 0}, as_byte_span("tick 25"));
    raise(SIGKILL);
  }
  int result = 0;
  ASSERT_EQ(waitpid(child, &result, 0), child);
  ASSERT_TRUE(WIFSIGNALED(result));
  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(path, reader).text, "");
  EXPECT_EQ(read_all(*reader), sample_messages(25));
}

// Progress that a writing process reported before it was killed.
struct Progress {
  std::atomic<std::uint64_t> in_file;  // messages of chunks that were written
  std::atomic<std::uint64_t> chunks;
};

// A process that writes for ever, killed somewhere: 5 times in CI, 100 times nightly.
TEST(RecordingStorage, AWriterKilledInMidWriteLosesOneChunkAtMost) {
  const ScratchDirectory scratch;
  auto* progress = static_cast<Progress*>(
      mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(progress, MAP_FAILED);
  std::mt19937_64 random(5);
  for (int round = 0; round < testing::rounds(5, 100); ++round) {
    SCOPED_TRACE(round);
    const std::filesystem::path path = scratch / fmt::format("{}.mcap", round);
    new (progress) Progress{};
    const pid_t child = fork();
    if (child == 0) {
      WriterLimits limits;
      limits.chunk_bytes = 200'000;  // most of the time is spent in write
      std::unique_ptr<Writer> writer;
      ChannelId channel{};
      if (!Writer::create(path, sample_identity(), limits, writer).is_ok()) _exit(1);
      if (!writer->add_channel({kStateTopic, "t::T", "", {}}, channel).is_ok()) _exit(1);
      for (StepIndex step = 0;; ++step) {
        const std::string payload = sample_payload(static_cast<std::uint64_t>(step), 10'000);
        if (!writer->write(channel, {0, step, static_cast<std::uint32_t>(step), 0}, as_byte_span(payload)).is_ok()) {
          _exit(1);
        }
        progress->in_file = writer->counts().messages;
        progress->chunks = writer->counts().chunks;
      }
    }
    const std::uint64_t chunks = 1 + random() % 30;
    while (progress->chunks < chunks && waitpid(child, nullptr, WNOHANG) == 0) {
    }
    for (std::uint64_t spins = random() % 200'000; spins > 0; --spins) progress->chunks.load();
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int result = 0;
    ASSERT_EQ(waitpid(child, &result, 0), child);
    ASSERT_TRUE(WIFSIGNALED(result));

    std::unique_ptr<Reader> reader;
    ASSERT_EQ(Reader::open(path, reader).text, "");
    const std::vector<KnownMessage> read = read_all(*reader);
    constexpr std::uint64_t kOfAChunk = 21;
    ASSERT_GE(read.size(), progress->in_file) << "more than the chunk in hand was lost";
    ASSERT_LE(read.size(), progress->in_file + kOfAChunk);
    Recovery recovery;
    ASSERT_EQ(recover(path, scratch / "recovered.mcap", recovery).text, "");
    ASSERT_EQ(Reader::open(scratch / "recovered.mcap", reader).text, "");
    ASSERT_EQ(reader->verify().text, "");
    ASSERT_EQ(read_all(*reader), read);
    std::filesystem::remove(scratch / "recovered.mcap");
    std::filesystem::remove(path);
  }
  munmap(progress, sizeof(Progress));
}

}  // namespace storage_test
}  // namespace slew::recording
