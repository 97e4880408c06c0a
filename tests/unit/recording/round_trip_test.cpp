// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/allocation_guard.h"
#include "sample_session.h"

namespace slew::recording {
namespace round_trip_test {

std::unique_ptr<Reader> open(const std::filesystem::path& path) {
  std::unique_ptr<Reader> reader;
  EXPECT_EQ(Reader::open(path, reader).text, "");
  return reader;
}

TEST(Recording, GivesBackWhatWasWritten) {
  const ScratchDirectory scratch;
  const std::unique_ptr<Writer> writer = write_sample(scratch / "a.mcap", 25, Ending::closed);
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  EXPECT_EQ(reader->verify().text, "");
  EXPECT_FALSE(reader->damage());
  EXPECT_TRUE(reader->has_all_messages());
  EXPECT_EQ(read_all(*reader), sample_messages(25));
  EXPECT_GT(reader->statistics().chunk_count, 3u);
  EXPECT_EQ(reader->statistics().message_count, 50u);
  EXPECT_EQ(reader->statistics().end_time, 24'000'000u);
  EXPECT_EQ(writer->counts().messages, 50u);
  EXPECT_EQ(writer->counts().late_messages, 0u);
  EXPECT_EQ(writer->counts().lost_messages, 0u);
}

TEST(Recording, HasItsSessionAndChannels) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 3, Ending::closed);
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  EXPECT_EQ(reader->identity().session_name, "bench 1");
  EXPECT_EQ(reader->identity().session_id, "00112233445566778899aabbccddeeff");
  EXPECT_EQ(reader->identity().scene, "sample");
  EXPECT_EQ(reader->identity().build, "0.1.0+test");
  EXPECT_EQ(reader->identity().communication_step, milliseconds(1));
  EXPECT_EQ(reader->identity().started_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(reader->identity().more, (TextMap{{"pace", "free"}}));
  ASSERT_NE(reader->find_channel(kStateTopic), nullptr);
  const RecordedChannel& channel = *reader->find_channel(kStateTopic);
  EXPECT_EQ(channel.type_name, "sample::State");
  EXPECT_EQ(channel.idl, "module sample { struct State { double q; }; };");
  EXPECT_EQ(channel.message_encoding, "cdr");
  EXPECT_EQ(channel.metadata, (TextMap{{"role", "mechanics"}}));
  EXPECT_EQ(channel.message_count, 3u);
  EXPECT_EQ(reader->find_channel("nowhere"), nullptr);
  ASSERT_NE(reader->find_metadata(kSummaryName), nullptr);
  EXPECT_EQ(*reader->find_metadata(kSummaryName), (TextMap{{"result", "ended"}}));
  EXPECT_EQ(reader->find_metadata("other"), nullptr);
}

TEST(Recording, KeepsAttachments) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 3, Ending::closed);
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  ASSERT_EQ(reader->attachments().size(), 1u);
  EXPECT_EQ(reader->attachments()[0].media_type, "application/yaml");
  Bytes content;
  EXPECT_EQ(reader->read_attachment(kAttachmentName, content).text, "");
  EXPECT_EQ(as_text(content), kAttachmentText);
  const Status missing = reader->read_attachment("manifest.json", content);
  EXPECT_EQ(missing.code, ExitCode::bad_input);
  EXPECT_NE(missing.text.find("there is no attachment manifest.json"), std::string::npos);
}

TEST(Recording, WithoutMessagesIsReadable) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 0, Ending::closed);
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  EXPECT_EQ(reader->verify().text, "");
  EXPECT_TRUE(read_all(*reader).empty());
  EXPECT_EQ(reader->statistics().message_count, 0u);
  EXPECT_EQ(reader->channels().size(), 2u);
}

TEST(Recording, FiltersByTopicAndTime) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 25, Ending::closed);
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  const std::vector<KnownMessage> messages = read_all(*reader, nullptr, {{kTickTopic}, 3'000'000, 5'000'000});
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages.front().payload, "tick 3");
  EXPECT_EQ(messages.back().payload, "tick 5");
  EXPECT_TRUE(read_all(*reader, nullptr, {{"nowhere"}, 0, 5'000'000}).empty());
}

TEST(Recording, VisitorStopsTheReading) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 25, Ending::closed);
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  int visited = 0;
  EXPECT_EQ(
      reader
          ->for_each(
              {}, [&](const RecordedMessage&) { return ++visited == 7 ? Reader::Visit::stop : Reader::Visit::go_on; })
          .text,
      "");
  EXPECT_EQ(visited, 7);
}

TEST(Recording, SameMessagesInAnyOrderGiveTheSameBytes) {
  const ScratchDirectory scratch;
  std::vector<std::string> contents;
  for (const int direction : {1, -1}) {
    const std::filesystem::path path = scratch / fmt::format("{}.mcap", direction);
    std::unique_ptr<Writer> writer;
    ASSERT_EQ(Writer::create(path, sample_identity(), small_limits(), writer).text, "");
    std::vector<ChannelId> channels(3);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      ASSERT_EQ(writer->add_channel({fmt::format("topic{}", i), "t::T", "", {}}, channels[i]).text, "");
    }
    for (StepIndex step = 0; step < 40; ++step) {
      for (int i = 0; i < 3; ++i) {
        const std::size_t channel = static_cast<std::size_t>(direction > 0 ? i : 2 - i);
        // within the window a channel may be up to two steps ahead of another
        const StepIndex shifted = direction > 0 ? step : (step / 2 * 2 + 1 - step % 2);
        for (std::uint32_t part = 0; part < 2; ++part) {
          const std::uint32_t sequence = direction > 0 ? part : 1 - part;
          const std::string payload = fmt::format("{} {} {}", channel, shifted, sequence);
          ASSERT_EQ(writer->write(channels[channel], {0, shifted, sequence, 0}, as_byte_span(payload)).text, "");
        }
      }
    }
    ASSERT_EQ(writer->close({}).text, "");
    EXPECT_EQ(writer->counts().late_messages, 0u);
    contents.push_back(file_content(path));
  }
  EXPECT_EQ(contents[0], contents[1]);
}

TEST(Recording, TimeGoesOnAfterAReset) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), small_limits(), writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({"t", "t::T", "", {}}, channel).text, "");
  // the last message of epoch 1 comes after the first ones of epoch 2
  for (const auto& [epoch, step] : std::vector<std::pair<std::uint32_t, StepIndex>>{
           {1, -1}, {1, 0}, {1, 1}, {2, -1}, {2, 0}, {1, 2}, {2, 1}, {2, 2}}) {
    ASSERT_EQ(writer->write(channel, {epoch, step, 0, 0}, {}).text, "");
  }
  ASSERT_EQ(writer->close({}).text, "");
  std::vector<std::uint64_t> times;
  for (const KnownMessage& message : read_all(*open(scratch / "a.mcap")))
    times.push_back(message.log_time_ns / 1'000'000);
  EXPECT_EQ(times, (std::vector<std::uint64_t>{0, 0, 1, 2, 3, 3, 4, 5}));
}

TEST(Recording, TimeGoesOnWithoutAGapAfterALoad) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), small_limits(), writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({"t", "t::T", "", {}}, channel).text, "");
  // epoch 2 begins with the state of step 500, epoch 3 with that of step 70, epoch 4 with INIT
  writer->begin_epoch(2, 500);
  writer->begin_epoch(3, 70);
  for (const auto& [epoch, step] : std::vector<std::pair<std::uint32_t, StepIndex>>{
           {1, -1}, {1, 0}, {1, 1}, {2, -1}, {2, 500}, {2, 501}, {3, -1}, {3, 70}, {3, 71}, {4, -1}, {4, 0}, {4, 1}}) {
    ASSERT_EQ(writer->write(channel, {epoch, step, 0, 0}, {}).text, "");
  }
  ASSERT_EQ(writer->close({}).text, "");
  std::vector<std::uint64_t> times;
  for (const KnownMessage& message : read_all(*open(scratch / "a.mcap")))
    times.push_back(message.log_time_ns / 1'000'000);
  EXPECT_EQ(times, (std::vector<std::uint64_t>{0, 0, 1, 2, 2, 3, 4, 4, 5, 6, 6, 7}));
}

TEST(Recording, LateMessagesAreKeptAndCounted) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), small_limits(), writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({"t", "t::T", "", {}}, channel).text, "");
  for (StepIndex step = 0; step < 20; ++step) ASSERT_EQ(writer->write(channel, {0, step, 0, 0}, {}).text, "");
  ASSERT_EQ(writer->write(channel, {0, 3, 7, 0}, {}).text, "");
  ASSERT_EQ(writer->close({}).text, "");
  EXPECT_EQ(writer->counts().late_messages, 1u);
  const std::vector<KnownMessage> messages = read_all(*open(scratch / "a.mcap"));
  ASSERT_EQ(messages.size(), 21u);
  EXPECT_EQ(std::count_if(messages.begin(), messages.end(), [](const KnownMessage& m) { return m.sequence == 7; }), 1);
}

TEST(Recording, IsInTheFileAfterTwoFlushPeriods) {
  const ScratchDirectory scratch;
  WriterLimits limits;
  const std::unique_ptr<Writer> writer = write_sample(scratch / "a.mcap", 25, Ending::open, limits);
  EXPECT_EQ(writer->flush_if_due(1'000'000'000).text, "");
  EXPECT_TRUE(read_all(*open(scratch / "a.mcap")).empty());
  EXPECT_EQ(writer->flush_if_due(1'499'999'999).text, "");
  EXPECT_TRUE(read_all(*open(scratch / "a.mcap")).empty());
  EXPECT_EQ(writer->flush_if_due(1'500'000'000).text, "");
  EXPECT_EQ(writer->flush_if_due(2'000'000'000).text, "");
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  EXPECT_EQ(read_all(*reader), sample_messages(25));
  EXPECT_FALSE(reader->has_all_messages());
  EXPECT_NE(reader->damage_text().find("the file ends here, without an end; 50 messages until 0.024000 s are readable"),
            std::string::npos)
      << reader->damage_text();
}

TEST(Recording, TakesMessagesLargerThanWindowAndChunk) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), small_limits(), writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({"t", "t::T", "", {}}, channel).text, "");
  const std::string large = sample_payload(5, 100'000);
  for (StepIndex step = 0; step < 6; ++step) {
    const std::string payload = step % 2 == 0 ? "small" : large;
    ASSERT_EQ(writer->write(channel, {0, step, 0, 0}, as_byte_span(payload)).text, "");
  }
  ASSERT_EQ(writer->close({}).text, "");
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  EXPECT_EQ(reader->verify().text, "");
  const std::vector<KnownMessage> messages = read_all(*reader);
  ASSERT_EQ(messages.size(), 6u);
  EXPECT_EQ(messages[3].payload, large);
  EXPECT_EQ(messages[4].payload, "small");
}

TEST(Recording, RefusesWhatCannotBeRecorded) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer = write_sample(scratch / "a.mcap", 3, Ending::open);
  EXPECT_EQ(writer->write(ChannelId{9}, {0, 0, 0, 0}, {}).code, ExitCode::failed);
  EXPECT_EQ(writer->write(ChannelId{0}, {0, -2, 0, 0}, {}).code, ExitCode::failed);
  EXPECT_EQ(writer->write(ChannelId{0}, {0, std::int64_t{1} << 60, 0, 0}, {}).code, ExitCode::failed);
  EXPECT_EQ(writer->write(ChannelId{0}, {0, 0, 0, 0}, Bytes(kMaxMessageBytes + 1)).code, ExitCode::failed);
  EXPECT_EQ(writer->close({}).text, "");
  EXPECT_EQ(read_all(*open(scratch / "a.mcap")), sample_messages(3));
  SessionIdentity without_step = sample_identity();
  without_step.communication_step = {0};
  EXPECT_EQ(Writer::create(scratch / "b.mcap", without_step, {}, writer).code, ExitCode::bad_input);
}

TEST(Recording, ChannelsOfOneTypeShareItsSchema) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), small_limits(), writer).text, "");
  ChannelId channel{};
  ASSERT_EQ(writer->add_channel({"a", "t::T", "text", {}}, channel).text, "");
  ASSERT_EQ(writer->add_channel({"b", "t::T", "text", {}}, channel).text, "");
  ASSERT_EQ(writer->add_channel({"c", "t::U", "text", {}}, channel).text, "");
  ASSERT_EQ(writer->close({}).text, "");
  EXPECT_EQ(open(scratch / "a.mcap")->statistics().schema_count, 2u);
}

TEST(Recording, WritingAMessageDoesNotAllocate) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  ASSERT_EQ(Writer::create(scratch / "a.mcap", sample_identity(), WriterLimits{}, writer).text, "");
  std::vector<ChannelId> channels(5);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    ASSERT_EQ(writer->add_channel({fmt::format("topic{}", i), "t::T", "", {}}, channels[i]).text, "");
  }
  const std::string payload = sample_payload(3, 400);
  const auto write_steps = [&](StepIndex from, StepIndex to) {
    bool is_ok = true;
    for (StepIndex step = from; step < to; ++step) {
      for (const ChannelId channel : channels) {
        is_ok = writer->write(channel, {0, step, static_cast<std::uint32_t>(step), 0}, as_byte_span(payload)).is_ok() &&
                is_ok;
      }
    }
    return is_ok;
  };
  ASSERT_TRUE(write_steps(0, 2'000));  // more than three chunks
  const std::uint64_t chunks = writer->counts().chunks;
  ASSERT_GE(chunks, 3u);
  const AllocationGuard guard;
  ASSERT_TRUE(write_steps(2'000, 4'000));
  const std::uint64_t allocations = guard.allocations();
  // the remainder are the few entries of each chunk in the index
  EXPECT_LE(allocations, 12 * (writer->counts().chunks - chunks)) << "for 10000 messages";
}

TEST(Recording, RefusesANewerFormatVersionByName) {
  const ScratchDirectory scratch;
  std::unique_ptr<Writer> writer;
  TextMap entries = to_entries(sample_identity());
  entries["format_version"] = "3";
  SessionIdentity identity;
  std::string problem;
  EXPECT_FALSE(from_entries(entries, identity, problem));
  EXPECT_EQ(problem,
            "the recording has format version 3 and this program reads versions up to 2; nothing was read; use the "
            "slewring that wrote it, or a newer one");
}

}  // namespace round_trip_test
}  // namespace slew::recording
