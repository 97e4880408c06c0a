// SPDX-License-Identifier: Apache-2.0
#include "sample_session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

namespace slew::recording {

ScratchDirectory::ScratchDirectory() {
  // in memory where there is such a place: thousands of small files are synchronised
  const std::filesystem::path memory = "/dev/shm";
  const bool is_usable = ::access(memory.c_str(), W_OK) == 0;
  const std::filesystem::path parent = is_usable ? memory : std::filesystem::temp_directory_path();
  std::string pattern = (parent / "slewring-recording-XXXXXX").string();
  path_ = ::mkdtemp(pattern.data());
}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

SessionIdentity sample_identity() {
  SessionIdentity identity;
  identity.scene = "sample";
  identity.session_name = "bench 1";
  identity.session_id = "00112233445566778899aabbccddeeff";
  identity.build = "0.1.0+test";
  identity.communication_step = milliseconds(1);
  identity.started_ns = 1'700'000'000'000'000'000;
  identity.more = {{"pace", "free"}};
  return identity;
}

WriterLimits small_limits() {
  WriterLimits limits;
  limits.chunk_bytes = 300;
  limits.window_steps = 4;
  limits.window_bytes = 4096;
  limits.window_messages = 64;
  return limits;
}

std::string sample_payload(std::uint64_t seed, std::size_t size) {
  std::string payload = {0, 1, 0, 0};
  std::uint64_t x = seed * 2 + 1;
  while (payload.size() < size) {
    x = x * 6364136223846793005u + 1442695040888963407u;
    payload += static_cast<char>(x >> 56);
  }
  return payload;
}

std::unique_ptr<Writer> write_sample(const std::filesystem::path& path, StepIndex steps, Ending ending,
                                     const WriterLimits& limits) {
  std::unique_ptr<Writer> writer;
  EXPECT_EQ(Writer::create(path, sample_identity(), limits, writer).text, "");
  EXPECT_EQ(writer->add_attachment(kAttachmentName, "application/yaml", as_byte_span(kAttachmentText)).text, "");
  ChannelId tick{};
  ChannelId state{};
  const ChannelDef tick_def = {kTickTopic, "sample::Tick", "module sample { struct Tick { int64 step; }; };", {}};
  const ChannelDef state_def = {
      kStateTopic, "sample::State", "module sample { struct State { double q; }; };", {{"role", "mechanics"}}};
  EXPECT_EQ(writer->add_channel(tick_def, tick).text, "");
  EXPECT_EQ(writer->add_channel(state_def, state).text, "");
  for (StepIndex step = 0; step < steps; ++step) {
    const std::uint32_t sequence = static_cast<std::uint32_t>(step);
    // the sample comes before the tick of its step: the writer sorts
    const std::string sample = sample_payload(static_cast<std::uint64_t>(step), 40);
    EXPECT_EQ(writer->write(state, {0, step, sequence, 0}, as_byte_span(sample)).text, "");
    EXPECT_EQ(writer->write(tick, {0, step, sequence, 0}, as_byte_span(fmt::format("tick {}", step))).text, "");
  }
  if (ending == Ending::closed) {
    EXPECT_EQ(writer->close({{"result", "ended"}}).text, "");
  }
  return writer;
}

std::vector<KnownMessage> sample_messages(StepIndex steps) {
  std::vector<KnownMessage> messages;
  for (StepIndex step = 0; step < steps; ++step) {
    const std::uint64_t time = static_cast<std::uint64_t>(step) * 1'000'000;
    const std::uint32_t sequence = static_cast<std::uint32_t>(step);
    messages.push_back({kTickTopic, time, sequence, fmt::format("tick {}", step)});
    messages.push_back({kStateTopic, time, sequence, sample_payload(static_cast<std::uint64_t>(step), 40)});
  }
  return messages;
}

std::vector<KnownMessage> read_all(const Reader& reader, Status* status, const MessageFilter& filter) {
  std::vector<KnownMessage> messages;
  const Status result = reader.for_each(filter, [&](const RecordedMessage& m) {
    messages.push_back({m.channel->topic, m.log_time_ns, m.sequence, std::string(as_text(m.payload))});
    return Reader::Visit::go_on;
  });
  if (status != nullptr) {
    *status = result;
  } else {
    EXPECT_EQ(result.text, "");
  }
  return messages;
}

std::vector<ChunkPlace> chunks_of(const std::filesystem::path& path) {
  InputFile file;
  EXPECT_EQ(file.open(path).text, "");
  FileScan scan;
  EXPECT_EQ(scan_file(file, scan).text, "");
  std::vector<ChunkPlace> places;
  std::size_t messages = 0;
  ChunkReader chunk_reader;
  for (const ChunkIndexRecord& index : scan.index.chunks) {
    Bytes record, records;
    EXPECT_EQ(file.read(index.offset + kRecordHeadBytes, index.length - kRecordHeadBytes, record).text, "");
    ChunkRecord chunk;
    EXPECT_TRUE(decode_chunk(record, chunk));
    std::string problem;
    EXPECT_TRUE(chunk_reader.unpack(chunk, records, problem));
    ChunkContents contents;
    EXPECT_TRUE(examine(
        records, [](std::uint16_t) { return true; }, contents, problem));
    ChunkPlace place = {index.offset, index.offset + index.length, messages, 0};
    for (const auto& [channel, count] : contents.message_counts) place.messages += count;
    messages += place.messages;
    places.push_back(place);
  }
  return places;
}

std::string file_content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace slew::recording
