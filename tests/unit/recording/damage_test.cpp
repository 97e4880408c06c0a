// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <random>

#include "recording/recovery.h"
#include "sample_session.h"
#include "tests/support/nightly.h"

namespace slew::recording {
namespace damage_test {

constexpr StepIndex kSteps = 12;

bool is_prefix(const std::vector<KnownMessage>& part, const std::vector<KnownMessage>& whole) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

TEST(DamagedRecording, CutAtAnyByteGivesEveryWholeChunkInFrontOfTheCut) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "whole.mcap", kSteps, Ending::closed);
  const std::string whole = file_content(scratch / "whole.mcap");
  const std::vector<KnownMessage> messages = sample_messages(kSteps);
  const std::vector<ChunkPlace> chunks = chunks_of(scratch / "whole.mcap");
  ASSERT_GE(chunks.size(), 4u);
  // the identity record ends where the first attachment's begins
  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(scratch / "whole.mcap", reader).text, "");
  const std::size_t identity_end = reader->attachments()[0].offset;

  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    SCOPED_TRACE(cut);
    const std::filesystem::path path = scratch / "cut.mcap";
    write_file(path, std::string_view(whole).substr(0, cut));
    const Status status = Reader::open(path, reader);
    if (cut < identity_end) {
      ASSERT_EQ(status.code, ExitCode::bad_input);
      ASSERT_NE(status.text.find("cannot be read as a recording"), std::string::npos);
      continue;
    }
    ASSERT_EQ(status.text, "");
    ASSERT_TRUE(reader->damage());
    ASSERT_LE(reader->damage()->offset, cut);
    const auto behind = std::ranges::find_if(chunks, [cut](const ChunkPlace& chunk) { return chunk.end > cut; });
    const std::size_t expected = behind == chunks.end() ? messages.size() : behind->first_message;
    const std::vector<KnownMessage> read = read_all(*reader);
    ASSERT_EQ(read.size(), expected);
    ASSERT_TRUE(is_prefix(read, messages));
    ASSERT_EQ(reader->statistics().message_count, expected);
    ASSERT_EQ(reader->verify().code, ExitCode::bad_input);
  }
}

// Result of a file with one changed bit: the messages in front of the damaged chunk, which is named.
void expect_longest_prefix(const std::filesystem::path& path, std::size_t at, std::size_t size,
                           const std::vector<KnownMessage>& messages, const std::vector<ChunkPlace>& chunks) {
  // the full check stops at or in front of the place
  InputFile file;
  ASSERT_EQ(file.open(path).text, "");
  FileScan scan;
  ASSERT_EQ(scan_file(file, scan).text, "");
  ASSERT_TRUE(scan.damage);
  // the end is looked for from behind: a broken footer shows as a missing one
  ASSERT_TRUE(scan.damage->offset <= at || scan.damage->offset == size)
      << scan.damage->offset << " of " << size << ": " << scan.damage->text;

  std::unique_ptr<Reader> reader;
  if (const Status refused = Reader::open(path, reader); !refused.is_ok()) {
    // without an end that can be used and without an identity
    ASSERT_LT(at, 500u) << refused.text;
    ASSERT_NE(refused.text.find("at byte "), std::string::npos) << refused.text;
    return;
  }
  ASSERT_EQ(reader->verify().code, ExitCode::bad_input);
  Status status;
  const std::vector<KnownMessage> read = read_all(*reader, &status);
  ASSERT_TRUE(is_prefix(read, messages));
  const auto hit = std::ranges::find_if(chunks, [at](const ChunkPlace& c) { return c.begin <= at && at < c.end; });
  if (status.is_ok()) {
    // not in a chunk, or where it changes nothing of its messages
    ASSERT_EQ(read.size(), messages.size());
  } else {
    ASSERT_NE(hit, chunks.end()) << status.text;
    ASSERT_EQ(read.size(), hit->first_message);
    const std::string named = fmt::format("at byte {} of {} ", hit->begin, size);
    ASSERT_NE(status.text.find(named), std::string::npos) << status.text;
  }
  // the identity of the session is unchanged, or the damage is reported
  const SessionIdentity& identity = reader->identity();
  const bool is_as_it_was = identity.scene == sample_identity().scene &&
                            identity.session_id == sample_identity().session_id &&
                            identity.build == sample_identity().build &&
                            identity.communication_step == sample_identity().communication_step &&
                            identity.started_ns == sample_identity().started_ns;
  ASSERT_TRUE(is_as_it_was || reader->damage()) << identity.scene;
}

// Every byte, each with one bit in CI and with all eight nightly.
TEST(DamagedRecording, AnyChangedBitIsNamedAndTheLongestPrefixIsRead) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "whole.mcap", kSteps, Ending::closed);
  const std::string whole = file_content(scratch / "whole.mcap");
  const std::vector<KnownMessage> messages = sample_messages(kSteps);
  const std::vector<ChunkPlace> chunks = chunks_of(scratch / "whole.mcap");
  const std::size_t bits = testing::rounds<std::size_t>(1, 8);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (std::size_t bit = 0; bit < bits; ++bit) {
      SCOPED_TRACE(fmt::format("byte {}, bit {}", at, (at + bit) % 8));
      const std::filesystem::path path = scratch / "flipped.mcap";
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << ((at + bit) % 8)));
      write_file(path, flipped);
      expect_longest_prefix(path, at, whole.size(), messages, chunks);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(DamagedRecording, FlippedByteInAChunkIsNamedWithItsOffset) {
  const ScratchDirectory scratch;
  const std::filesystem::path path = scratch / "a.mcap";
  std::ignore = write_sample(path, kSteps, Ending::closed);
  const std::vector<ChunkPlace> chunks = chunks_of(path);
  std::string content = file_content(path);
  const std::size_t inside = chunks[2].end - 10;
  content[inside] = static_cast<char>(content[inside] ^ 1);
  write_file(path, content);

  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(path, reader).text, "");
  Status status;
  const std::vector<KnownMessage> read = read_all(*reader, &status);
  EXPECT_EQ(read.size(), chunks[2].first_message);
  EXPECT_EQ(status.code, ExitCode::bad_input);
  EXPECT_NE(status.text.find("at byte "), std::string::npos) << status.text;
  EXPECT_TRUE(status.text.find("checksum of the chunk differs") != std::string::npos ||
              status.text.find("cannot be decompressed") != std::string::npos)
      << status.text;
}

TEST(DamagedRecording, NoMutationCrashesTheReader) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "whole.mcap", kSteps, Ending::closed);
  const std::string whole = file_content(scratch / "whole.mcap");
  std::mt19937 random(11);
  const std::filesystem::path path = scratch / "mutated.mcap";
  for (int round = 0; round < 3'000; ++round) {
    std::string mutated = whole;
    const int changes = 1 + static_cast<int>(random() % 8);
    for (int i = 0; i < changes && !mutated.empty(); ++i) {
      const std::size_t at = random() % mutated.size();
      const std::size_t length = std::min<std::size_t>(1 + random() % 16, mutated.size() - at);
      switch (random() % 5) {
        case 0:
          mutated[at] = static_cast<char>(random());
          break;
        case 1:  // large numbers where lengths may be
          std::fill_n(mutated.begin() + static_cast<std::ptrdiff_t>(at), length, '\xff');
          break;
        case 2:
          std::fill_n(mutated.begin() + static_cast<std::ptrdiff_t>(at), length, '\0');
          break;
        case 3:
          mutated.erase(at, length);
          break;
        default:
          mutated.insert(at, whole, random() % whole.size(), length);
      }
    }
    write_file(path, mutated);
    std::unique_ptr<Reader> reader;
    if (!Reader::open(path, reader).is_ok()) continue;
    Status status;
    std::ignore = read_all(*reader, &status);
    std::ignore = reader->verify();
    Bytes content;
    std::ignore = reader->read_attachment(kAttachmentName, content);
  }
}

// In a child with 96 MiB more memory: result of opening a file of 3 GiB with a wrong length. 0: opened, with the damage
// reported.
int open_with_little_memory(const std::filesystem::path& path) {
  std::ifstream statistics("/proc/self/statm");
  std::uint64_t pages = 0;
  statistics >> pages;
  const rlim_t limit = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + (96u << 20);
  const rlimit memory = {limit, limit};
  if (setrlimit(RLIMIT_AS, &memory) != 0) return 77;
  try {
    std::unique_ptr<Reader> reader;
    if (!Reader::open(path, reader).is_ok()) return 1;
    Status status;
    std::ignore = read_all(*reader, &status);
    if (reader->verify().code != ExitCode::bad_input) return 2;
    Recovery recovery;
    return recover(path, path.string() + ".recovered", recovery).is_ok() && recovery.messages > 0 ? 0 : 3;
  } catch (const std::bad_alloc&) {
    return 4;
  }
}

// A chunk, an attachment, a message index and a summary that claim almost 3 GiB, in a file that is as large.
TEST(DamagedRecording, ADamagedLengthTakesNoMemory) {
#ifdef SLEWRING_SANITIZED
  GTEST_SKIP() << "a sanitizer takes more than is allowed here";
#endif
  const ScratchDirectory scratch;
  constexpr std::uint64_t kFileBytes = 3ull << 30;
  const std::filesystem::path path = scratch / "large.mcap";
  std::ignore = write_sample(scratch / "whole.mcap", kSteps, Ending::closed);
  const std::string whole = file_content(scratch / "whole.mcap");
  const std::vector<ChunkPlace> chunks = chunks_of(scratch / "whole.mcap");
  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(scratch / "whole.mcap", reader).text, "");
  // bytes of lengths in the file, and their false values
  struct Claim {
    const char* what;
    std::size_t length_at;
    std::uint64_t length;
  };
  const std::uint64_t most = kFileBytes - whole.size();
  for (const Claim& claim : {Claim{"chunk", chunks[2].begin + 1, most}, Claim{"message index", chunks[2].end + 1, most},
                             Claim{"uncompressed chunk", chunks[2].begin + kRecordHeadBytes + 16, most},
                             Claim{"attachment", reader->attachments()[0].offset + 1, most}}) {
    SCOPED_TRACE(claim.what);
    std::string content = whole;
    std::memcpy(content.data() + claim.length_at, &claim.length, sizeof claim.length);
    write_file(path, content);
    std::filesystem::resize_file(path, kFileBytes);  // a hole: the end is missing too
    std::filesystem::remove(path.string() + ".recovered");
    const pid_t child = fork();
    if (child == 0) _exit(open_with_little_memory(path));
    int result = 0;
    ASSERT_EQ(waitpid(child, &result, 0), child);
    ASSERT_TRUE(WIFEXITED(result)) << "killed by signal " << WTERMSIG(result);
    EXPECT_EQ(WEXITSTATUS(result), 0);
  }
}

// A footer that points to the beginning of a large file must not have it all read.
TEST(DamagedRecording, AFooterThatPointsElsewhereIsNotFollowed) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", kSteps, Ending::closed);
  std::string content = file_content(scratch / "a.mcap");
  const std::uint64_t front = 100;
  std::memcpy(content.data() + content.size() - kMagic.size() - kFooterBytes + kRecordHeadBytes, &front, sizeof front);
  write_file(scratch / "a.mcap", content);
  InputFile file;
  ASSERT_EQ(file.open(scratch / "a.mcap").text, "");
  FileIndex index;
  Damage damage;
  Status status;
  EXPECT_FALSE(read_summary(file, index, damage, status));
  EXPECT_EQ(damage.text, "here no summary begins");
}

TEST(DamagedRecording, WhatIsNoRecordingIsRefused) {
  const ScratchDirectory scratch;
  std::unique_ptr<Reader> reader;
  const auto refusal = [&](const std::filesystem::path& path) {
    const Status status = Reader::open(path, reader);
    EXPECT_EQ(status.code, ExitCode::bad_input);
    return status.text;
  };
  EXPECT_NE(refusal(scratch / "missing.mcap").find("No such file or directory"), std::string::npos);
  EXPECT_NE(refusal(scratch.path()).find("this is not a file"), std::string::npos);
  write_file(scratch / "empty.mcap", "");
  EXPECT_NE(refusal(scratch / "empty.mcap").find("at byte 0 the file ends before the first record"), std::string::npos);
  write_file(scratch / "text.mcap", "scene: {name: not a recording}\n");
  EXPECT_NE(refusal(scratch / "text.mcap").find("this is not an MCAP file"), std::string::npos);
  // a well-formed MCAP file of another program
  Bytes other;
  put_magic(other);
  encode(other, HeaderRecord{"ros2", "other"});
  encode_end(other, 0, crc32_of(other), {});
  write_file(scratch / "other.mcap", as_text(other));
  EXPECT_NE(refusal(scratch / "other.mcap").find("the identity of its session is missing"), std::string::npos);
}

}  // namespace damage_test
}  // namespace slew::recording
