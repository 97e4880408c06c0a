// SPDX-License-Identifier: Apache-2.0
#include "recording/recovery.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "recording/records.h"
#include "sample_session.h"
#include "tests/support/nightly.h"

namespace slew::recording {
namespace recovery_test {

constexpr StepIndex kSteps = 12;

class RecoveredRecording : public ::testing::Test {
 protected:
  RecoveredRecording() {
    std::ignore = write_sample(scratch_ / "whole.mcap", kSteps, Ending::closed);
    whole_ = file_content(scratch_ / "whole.mcap");
    chunks_ = chunks_of(scratch_ / "whole.mcap");
    std::unique_ptr<Reader> reader;
    EXPECT_EQ(Reader::open(scratch_ / "whole.mcap", reader).text, "");
    attachment_at_ = reader->attachments()[0].offset;
  }

  Status recover_content(std::string_view content) {
    write_file(scratch_ / "damaged.mcap", content);
    std::filesystem::remove(recovered());
    recovery_ = {};
    const Status status = recover(scratch_ / "damaged.mcap", recovered(), recovery_);
    EXPECT_EQ(file_content(scratch_ / "damaged.mcap"), content) << "the damaged file was touched";
    return status;
  }

  [[nodiscard]] std::filesystem::path recovered() const { return scratch_ / "recovered.mcap"; }

  // The new file is whole and holds these messages, under any topics.
  void expect_messages(const std::vector<KnownMessage>& expected, bool are_topics_kept = true) {
    std::unique_ptr<Reader> reader;
    ASSERT_EQ(Reader::open(recovered(), reader).text, "");
    ASSERT_EQ(reader->verify().text, "");
    ASSERT_FALSE(reader->damage());
    ASSERT_TRUE(reader->has_all_messages());
    std::vector<KnownMessage> read = read_all(*reader);
    ASSERT_EQ(read.size(), expected.size());
    for (std::size_t i = 0; i < read.size() && !are_topics_kept; ++i) read[i].topic = expected[i].topic;
    ASSERT_EQ(read, expected);
    ASSERT_EQ(recovery_.messages, expected.size());
    ASSERT_EQ(reader->statistics().message_count, expected.size());
    ASSERT_EQ(reader->identity().session_id, sample_identity().session_id);
    ASSERT_EQ(reader->find_metadata(kSummaryName), nullptr) << "how it ended is not copied";
    ASSERT_NE(reader->find_metadata(kRecoveryName), nullptr);
    // the index finds the contents of the chunks
    std::vector<KnownMessage> by_topic = read_all(*reader, nullptr, {{kTickTopic}, 3'000'000, 5'000'000});
    for (const KnownMessage& message : by_topic) ASSERT_EQ(message.topic, kTickTopic);
  }

  ScratchDirectory scratch_;
  std::string whole_;
  std::vector<ChunkPlace> chunks_;
  std::size_t attachment_at_ = 0;
  const std::vector<KnownMessage> messages_ = sample_messages(kSteps);
  Recovery recovery_;
};

TEST_F(RecoveredRecording, NamesItsSessionInTheFirstOfSeveralRecords) {
  // cut behind the first chunk's Mark, and another record of the name behind that
  std::string content = whole_.substr(0, chunks_[1].begin);
  Bytes more;
  encode(more, MetadataRecord{kIdentityName, {{"format_version", "1"}}});
  content += as_text(more);
  Bytes mark;
  encode_mark(mark, crc32_of(as_byte_span(content)));
  content += as_text(mark);
  ASSERT_EQ(recover_content(content).text, "");
  std::vector<KnownMessage> expected = sample_messages(kSteps);
  expected.resize(chunks_[1].first_message);
  expect_messages(expected);
}

TEST_F(RecoveredRecording, OfAWholeFileIsNotNeededAndNothingIsWritten) {
  ASSERT_EQ(recover_content(whole_).text, "");
  EXPECT_TRUE(recovery_.was_whole);
  EXPECT_FALSE(std::filesystem::exists(recovered()));
}

TEST_F(RecoveredRecording, HoldsEveryWholeChunkAfterACutAtAnyByte) {
  for (std::size_t cut = 0; cut < whole_.size(); ++cut) {
    SCOPED_TRACE(cut);
    const Status status = recover_content(std::string_view(whole_).substr(0, cut));
    if (cut < attachment_at_) {
      ASSERT_EQ(status.code, ExitCode::bad_input);
      ASSERT_NE(status.text.find("recovery is not possible"), std::string::npos) << status.text;
      ASSERT_FALSE(std::filesystem::exists(recovered()));
      continue;
    }
    ASSERT_EQ(status.text, "");
    const auto behind = std::ranges::find_if(chunks_, [cut](const ChunkPlace& chunk) { return chunk.end > cut; });
    const std::size_t expected = behind == chunks_.end() ? messages_.size() : behind->first_message;
    expect_messages({messages_.begin(), messages_.begin() + static_cast<std::ptrdiff_t>(expected)});
    if (HasFatalFailure()) return;
    for (const LostBytes& lost : recovery_.lost) ASSERT_LE(lost.offset + lost.size, cut);
  }
}

// Also what lies behind the damage. Every byte, each with one bit in CI and with all eight nightly.
TEST_F(RecoveredRecording, LosesNoMoreThanTheChunkInWhichABitChanged) {
  const std::size_t bits = testing::rounds<std::size_t>(1, 8);
  for (std::size_t i = 0; i < whole_.size() * bits; ++i) {
    const std::size_t at = i / bits, bit = (i + i / bits) % 8;
    SCOPED_TRACE(fmt::format("byte {}, bit {}", at, bit));
    std::string flipped = whole_;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << bit));
    const Status status = recover_content(flipped);
    if (!status.is_ok()) {
      // the identity, or a Mark beside it
      ASSERT_LT(at, attachment_at_ + 100) << status.text;
      ASSERT_NE(status.text.find("recovery is not possible: from byte "), std::string::npos) << status.text;
      ASSERT_FALSE(std::filesystem::exists(recovered()));
      continue;
    }
    std::vector<KnownMessage> expected = messages_;
    const auto hit =
        std::ranges::find_if(chunks_, [at = at](const ChunkPlace& c) { return c.begin <= at && at < c.end; });
    if (hit != chunks_.end() && recovery_.messages != messages_.size()) {
      const auto first = expected.begin() + static_cast<std::ptrdiff_t>(hit->first_message);
      expected.erase(first, first + static_cast<std::ptrdiff_t>(hit->messages));
      const auto names = [&](const LostBytes& lost) { return lost.offset <= at && at < lost.offset + lost.size; };
      ASSERT_TRUE(std::ranges::any_of(recovery_.lost, names));
    }
    expect_messages(expected, at > chunks_.front().begin);
    if (HasFatalFailure()) return;
  }
}

// The next place to continue is behind hundreds of kilobytes of meaningless bytes.
TEST_F(RecoveredRecording, GoesOnBehindALargeChunk) {
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch_ / "large.mcap", sample_identity(), WriterLimits{}, writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({kStateTopic, "t::T", "", {}}, channel).text, "");
  for (StepIndex step = 0; step < 5'000; ++step) {
    const std::string payload = sample_payload(static_cast<std::uint64_t>(step), 1'000);
    ASSERT_EQ(writer->write(channel, {0, step, 0, 0}, as_byte_span(payload)).text, "");
  }
  ASSERT_EQ(writer->close({}).text, "");
  const std::vector<ChunkPlace> chunks = chunks_of(scratch_ / "large.mcap");
  ASSERT_GE(chunks.size(), 4u);
  std::string damaged = file_content(scratch_ / "large.mcap");
  damaged[chunks[1].begin + 100] ^= 1;
  ASSERT_EQ(recover_content(damaged).text, "");
  EXPECT_EQ(recovery_.messages, 5'000 - chunks[1].messages);
  ASSERT_EQ(recovery_.lost.size(), 1u);
  EXPECT_EQ(recovery_.lost[0].offset, chunks[1].begin);
  EXPECT_GT(recovery_.lost[0].size, 500'000u);
  EXPECT_FALSE(recovery_.was_cut);
}

TEST_F(RecoveredRecording, KeepsMessagesOfALostChannelUnderItsNumber) {
  // the second channel's record: one letter of its topic
  std::string damaged = whole_;
  const std::size_t topic_at = damaged.find(kStateTopic);
  ASSERT_NE(topic_at, std::string::npos);
  damaged[topic_at] = 'x';
  ASSERT_EQ(recover_content(damaged).text, "");
  EXPECT_EQ(recovery_.lost_channels, 1u);
  expect_messages(messages_, false);
  std::unique_ptr<Reader> reader;
  ASSERT_EQ(Reader::open(recovered(), reader).text, "");
  ASSERT_NE(reader->find_channel("lost_channel_1"), nullptr);
  EXPECT_EQ(reader->find_channel("lost_channel_1")->message_count, static_cast<std::uint64_t>(kSteps));
  ASSERT_NE(reader->find_channel(kTickTopic), nullptr);
  EXPECT_EQ(reader->find_channel(kTickTopic)->type_name, "sample::Tick");
}

TEST_F(RecoveredRecording, TakesNeitherIndexNorSummaryFromTheFile) {
  // an end that is sound in itself and belongs to another file
  std::ignore = write_sample(scratch_ / "other.mcap", 4, Ending::closed);
  const std::string other = file_content(scratch_ / "other.mcap");
  const std::vector<ChunkPlace> others = chunks_of(scratch_ / "other.mcap");
  const std::size_t cut = chunks_[2].begin + 20;
  ASSERT_EQ(recover_content(whole_.substr(0, cut) + other.substr(others.back().end)).text, "");
  expect_messages({messages_.begin(), messages_.begin() + static_cast<std::ptrdiff_t>(chunks_[2].first_message)});
}

TEST_F(RecoveredRecording, ReportsWhereBytesAreLost) {
  std::string damaged = whole_;
  damaged[chunks_[1].begin + 60] ^= 4;
  damaged.resize(chunks_[3].begin + 30);
  ASSERT_EQ(recover_content(damaged).text, "");
  ASSERT_EQ(recovery_.lost.size(), 2u);
  EXPECT_EQ(recovery_.lost[0].offset, chunks_[1].begin);
  EXPECT_EQ(recovery_.lost[1].offset, chunks_[3].begin);
  EXPECT_EQ(recovery_.lost[1].size, 30u);
  EXPECT_EQ(recovery_.lost[1].text, "the file ends inside a record");
  EXPECT_TRUE(recovery_.was_cut);
  EXPECT_EQ(recovery_.messages, messages_.size() - chunks_[1].messages - (messages_.size() - chunks_[3].first_message));
}

TEST_F(RecoveredRecording, NeverTouchesAFileThatExists) {
  write_file(scratch_ / "damaged.mcap", whole_.substr(0, whole_.size() - 30));
  write_file(recovered(), "precious");
  const Status status = recover(scratch_ / "damaged.mcap", recovered(), recovery_);
  EXPECT_EQ(status.code, ExitCode::storage);
  EXPECT_EQ(file_content(recovered()), "precious");
}

}  // namespace recovery_test
}  // namespace slew::recording
