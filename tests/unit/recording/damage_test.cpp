#include <algorithm>
#include <random>

#include "sample_session.h"

namespace slew::recording {
namespace {

constexpr StepIndex kSteps = 12;

bool is_prefix(const std::vector<KnownMessage>& part, const std::vector<KnownMessage>& whole) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

// Byte behind each chunk of an intact file, with the number of messages up to there.
std::vector<std::pair<std::size_t, std::size_t>> chunk_ends(const std::filesystem::path& path) {
  InputFile file;
  EXPECT_EQ(file.open(path).text, "");
  FileScan scan;
  EXPECT_EQ(scan_file(file, scan).text, "");
  std::unique_ptr<Reader> reader;
  EXPECT_EQ(Reader::open(path, reader).text, "");
  std::vector<std::pair<std::size_t, std::size_t>> ends = {{0, 0}};
  ChunkReader chunk_reader;
  for (const ChunkIndexRecord& index : scan.index.chunks) {
    Bytes record;
    EXPECT_EQ(file.read(index.offset + kRecordHeadBytes, index.length - kRecordHeadBytes, record).text, "");
    ChunkRecord chunk;
    EXPECT_TRUE(decode_chunk(record, chunk));
    Bytes records;
    std::string problem;
    EXPECT_TRUE(chunk_reader.unpack(chunk, records, problem));
    ChunkContents contents;
    EXPECT_TRUE(examine(
        records, [](std::uint16_t) { return true; }, contents, problem));
    std::size_t messages = ends.back().second;
    for (const auto& [channel, count] : contents.message_counts) messages += count;
    ends.emplace_back(index.offset + index.length, messages);
  }
  return ends;
}

TEST(DamagedRecording, CutAtAnyByteGivesEveryWholeChunkInFrontOfTheCut) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "whole.mcap", kSteps, Ending::closed);
  const std::string whole = file_content(scratch / "whole.mcap");
  const std::vector<KnownMessage> messages = sample_messages(kSteps);
  const auto ends = chunk_ends(scratch / "whole.mcap");
  ASSERT_GE(ends.size(), 5u);
  ASSERT_EQ(ends.back().second, messages.size());
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
    const auto behind = std::find_if(ends.begin(), ends.end(), [cut](const auto& end) { return end.first > cut; });
    const std::size_t expected = std::prev(behind)->second;
    const std::vector<KnownMessage> read = read_all(*reader);
    ASSERT_EQ(read.size(), expected);
    ASSERT_TRUE(is_prefix(read, messages));
    ASSERT_EQ(reader->statistics().message_count, expected);
    ASSERT_EQ(reader->verify().code, ExitCode::bad_input);
  }
}

TEST(DamagedRecording, AnyChangedByteIsNamedAndWhatIsReadWasWritten) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "whole.mcap", kSteps, Ending::closed);
  const std::string whole = file_content(scratch / "whole.mcap");
  const std::vector<KnownMessage> messages = sample_messages(kSteps);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    SCOPED_TRACE(at);
    const std::filesystem::path path = scratch / "flipped.mcap";
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
    write_file(path, flipped);

    // the full check stops at or in front of the place
    InputFile file;
    ASSERT_EQ(file.open(path).text, "");
    FileScan scan;
    ASSERT_EQ(scan_file(file, scan).text, "");
    ASSERT_TRUE(scan.damage);
    // the end is looked for from behind: a broken footer shows as a missing one
    ASSERT_TRUE(scan.damage->offset <= at || scan.damage->offset == whole.size())
        << scan.damage->offset << " of " << whole.size() << ": " << scan.damage->text;

    std::unique_ptr<Reader> reader;
    if (!Reader::open(path, reader).is_ok()) continue;
    ASSERT_EQ(reader->verify().code, ExitCode::bad_input);
    Status status;
    const std::vector<KnownMessage> read = read_all(*reader, &status);
    ASSERT_TRUE(is_prefix(read, messages));
    if (status.is_ok() && !reader->damage()) {
      ASSERT_EQ(read.size(), messages.size());
    }
  }
}

TEST(DamagedRecording, FlippedByteInAChunkIsNamedWithItsOffset) {
  const ScratchDirectory scratch;
  const std::filesystem::path path = scratch / "a.mcap";
  std::ignore = write_sample(path, kSteps, Ending::closed);
  const auto ends = chunk_ends(path);
  std::string content = file_content(path);
  const std::size_t inside = ends[3].first - 10;
  content[inside] = static_cast<char>(content[inside] ^ 1);
  write_file(path, content);

  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(path, reader).text, "");
  Status status;
  const std::vector<KnownMessage> read = read_all(*reader, &status);
  EXPECT_EQ(read.size(), ends[2].second);
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
  // a well formed MCAP file of somebody else
  Bytes other;
  put_magic(other);
  encode_header(other, {"ros2", "other"});
  encode_end(other, 0, crc32_of(other), {});
  write_file(scratch / "other.mcap", as_text(other));
  EXPECT_NE(refusal(scratch / "other.mcap").find("it does not say which session it holds"), std::string::npos);
}

}  // namespace
}  // namespace slew::recording
