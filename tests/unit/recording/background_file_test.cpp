// SPDX-License-Identifier: Apache-2.0
#include "recording/background_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>

#include "sample_session.h"

namespace slew::recording {
namespace background_file_test {

// A disk that waits for a permitted number of writes, and fails one of them.
class SteppedDisk final : public FileCalls {
 public:
  std::int64_t write(int descriptor, ByteSpan bytes, std::uint64_t offset) override {
    const int number = ++begun_;
    while (number > allowed) std::this_thread::yield();
    if (number != fails_at) return FileCalls::write(descriptor, bytes, offset);
    errno = EIO;
    return -1;
  }
  std::atomic<int> allowed = 1'000'000;
  std::atomic<int> fails_at = 0;

 private:
  std::atomic<int> begun_ = 0;
};

std::string block(int number) {
  return sample_payload(static_cast<std::uint64_t>(number), 1'000);
}

TEST(BackgroundFile, WritesEverythingInOrderWithTheSameSums) {
  const ScratchDirectory scratch;
  BackgroundFile file(system_file_calls(), 5'000);
  ASSERT_EQ(file.create(scratch / "a").text, "");
  std::string expected;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(file.append(as_byte_span(block(i))).text, "");
    expected += block(i);
    ASSERT_LE(file.backlog(), 5'000u);
    ASSERT_EQ(file.size(), expected.size());
  }
  EXPECT_EQ(file.crc(), crc32_of(as_byte_span(expected)));
  EXPECT_EQ(file.drain().text, "");
  EXPECT_EQ(file.written(), expected.size());
  EXPECT_EQ(file.close().text, "");
  EXPECT_EQ(file_content(scratch / "a"), expected);
}

TEST(BackgroundFile, ABlockLargerThanTheBacklogIsWritten) {
  const ScratchDirectory scratch;
  BackgroundFile file(system_file_calls(), 10);
  ASSERT_EQ(file.create(scratch / "a").text, "");
  ASSERT_EQ(file.append(as_byte_span(block(1))).text, "");
  ASSERT_EQ(file.append(as_byte_span(block(2))).text, "");
  EXPECT_EQ(file.close().text, "");
  EXPECT_EQ(file_content(scratch / "a"), block(1) + block(2));
}

TEST(BackgroundFile, AFailureIsReportedOnceAndWhatWaitedIsNotWritten) {
  const ScratchDirectory scratch;
  SteppedDisk disk;
  disk.allowed = 2;
  disk.fails_at = 3;
  BackgroundFile file(disk, 100'000);
  ASSERT_EQ(file.create(scratch / "a").text, "");
  for (int i = 0; i < 10; ++i) ASSERT_EQ(file.append(as_byte_span(block(i))).text, "");
  EXPECT_EQ(file.size(), 10'000u);
  disk.allowed = 1'000;
  const Status failed = file.drain();
  EXPECT_EQ(failed.code, ExitCode::storage);
  EXPECT_NE(failed.text.find("the file was cut back to 2000 bytes"), std::string::npos) << failed.text;
  EXPECT_EQ(file.size(), 2'000u);
  EXPECT_EQ(file.crc(), crc32_of(as_byte_span(block(0) + block(1))));
  EXPECT_EQ(file.backlog(), 0u);
  // there may be room for something small
  EXPECT_EQ(file.append(as_byte_span("end")).text, "");
  EXPECT_EQ(file.close().text, "");
  EXPECT_EQ(file_content(scratch / "a"), block(0) + block(1) + "end");
}

// The writer counts the waiting messages as lost, and its index holds those in the file.
TEST(BackgroundFile, AWriterWithWaitingChunksCountsWhatIsInTheFileAfterAFailure) {
  const ScratchDirectory scratch;
  for (int fails_at = 5; fails_at < 12; ++fails_at) {
    SCOPED_TRACE(fails_at);
    const std::filesystem::path path = scratch / fmt::format("{}.mcap", fails_at);
    SteppedDisk disk;
    disk.fails_at = fails_at;
    WriterLimits limits = small_limits();
    limits.backlog_bytes = 100'000;
    std::unique_ptr<Writer> writer;
    ASSERT_EQ(Writer::create(path, sample_identity(), limits, writer, disk).text, "");
    ChannelId channel{};
    ASSERT_EQ(writer->add_channel({kStateTopic, "t::T", "", {}}, channel).text, "");
    ASSERT_EQ(writer->settle().text, "");
    disk.allowed = fails_at - 1;
    for (StepIndex step = 0; step < 200; ++step) {
      const std::string payload = sample_payload(static_cast<std::uint64_t>(step), 40);
      ASSERT_EQ(writer->write(channel, {0, step, static_cast<std::uint32_t>(step), 0}, as_byte_span(payload)).text, "");
    }
    disk.allowed = 1'000'000;
    EXPECT_EQ(writer->flush().code, ExitCode::storage);
    ASSERT_TRUE(writer->first_lost_step());
    EXPECT_EQ(writer->close({{"result", "storage"}}).code, ExitCode::storage);
    EXPECT_EQ(writer->counts().messages + writer->counts().lost_messages, 200u);
    std::unique_ptr<Reader> reader;
    ASSERT_EQ(Reader::open(path, reader).text, "");
    EXPECT_EQ(reader->verify().text, "");
    const std::vector<KnownMessage> read = read_all(*reader);
    EXPECT_EQ(read.size(), writer->counts().messages);
    EXPECT_EQ(read.size(), writer->messages_in_file(channel));
    EXPECT_EQ(static_cast<StepIndex>(read.size()), *writer->first_lost_step());
    for (std::size_t i = 0; i < read.size(); ++i) ASSERT_EQ(read[i].payload, sample_payload(i, 40));
  }
}

}  // namespace background_file_test
}  // namespace slew::recording
