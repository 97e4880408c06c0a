// SPDX-License-Identifier: Apache-2.0
// Recordings of every format version that was ever written, kept in tests/unit/recording/golden: this and every later
// reader must give the same values. A file is added with each new version, and none is ever changed.
#include <fmt/format.h>

#include "build_paths.h"
#include "recording/recovery.h"
#include "recording/state_hashes.h"
#include "sample_session.h"

namespace slew::recording {
namespace golden_test {

const std::filesystem::path kGolden = SLEWRING_SOURCE_DIR "/tests/unit/recording/golden";

std::unique_ptr<Reader> open(const std::filesystem::path& path) {
  std::unique_ptr<Reader> reader;
  EXPECT_EQ(Reader::open(path, reader).text, "");
  return reader;
}

TEST(GoldenRecording, OfVersion1IsReadToTheSameValues) {
  const std::unique_ptr<Reader> reader = open(kGolden / "version_1.mcap");
  ASSERT_NE(reader, nullptr);
  EXPECT_EQ(reader->verify().text, "");
  EXPECT_FALSE(reader->damage());
  EXPECT_TRUE(reader->has_all_messages());
  EXPECT_EQ(reader->identity().scene, "sample");
  EXPECT_EQ(reader->identity().session_name, "bench 1");
  EXPECT_EQ(reader->identity().session_id, "00112233445566778899aabbccddeeff");
  EXPECT_EQ(reader->identity().build, "0.1.0+test");
  EXPECT_EQ(reader->identity().communication_step, milliseconds(1));
  EXPECT_EQ(reader->identity().started_ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(reader->identity().more, (TextMap{{"pace", "free"}}));
  Bytes content;
  EXPECT_EQ(reader->read_attachment("scene.yaml", content).text, "");
  EXPECT_EQ(as_text(content), "scene: {name: sample}\nbodies: {}\n");
  ASSERT_NE(reader->find_metadata("slewring.summary"), nullptr);
  EXPECT_EQ(*reader->find_metadata("slewring.summary"), (TextMap{{"result", "ended"}}));
  ASSERT_EQ(reader->channels().size(), 2u);
  EXPECT_EQ(reader->channels()[0].topic, "session/tick");
  EXPECT_EQ(reader->channels()[0].type_name, "sample::Tick");
  EXPECT_EQ(reader->channels()[0].idl, "module sample { struct Tick { int64 step; }; };");
  EXPECT_EQ(reader->channels()[0].message_encoding, "cdr");
  EXPECT_EQ(reader->channels()[1].metadata, (TextMap{{"role", "mechanics"}}));
  EXPECT_EQ(reader->statistics().chunk_count, 4u);

  const std::vector<KnownMessage> messages = read_all(*reader);
  ASSERT_EQ(messages.size(), 24u);
  for (std::size_t step = 0; step < 12; ++step) {
    const KnownMessage& tick = messages[2 * step];
    const KnownMessage& state = messages[2 * step + 1];
    EXPECT_EQ(tick, (KnownMessage{"session/tick", step * 1'000'000, static_cast<std::uint32_t>(step),
                                  fmt::format("tick {}", step)}));
    EXPECT_EQ(state.topic, "mechanics/sample");
    EXPECT_EQ(state.log_time_ns, step * 1'000'000);
    EXPECT_EQ(state.payload.size(), 40u);
  }
  // all payloads together
  std::uint32_t crc = 0;
  for (const KnownMessage& message : messages) crc = crc32_of(as_byte_span(message.payload), crc);
  EXPECT_EQ(crc, 0xf3c7181cu);
}

TEST(GoldenRecording, OfVersion1IsReadToTheSameValuesWithoutItsEnd) {
  const ScratchDirectory scratch;
  const std::string whole = file_content(kGolden / "version_1.mcap");
  write_file(scratch / "cut.mcap", std::string_view(whole).substr(0, whole.size() - 40));
  EXPECT_EQ(read_all(*open(scratch / "cut.mcap")), read_all(*open(kGolden / "version_1.mcap")));
  Recovery recovery;
  ASSERT_EQ(recover(scratch / "cut.mcap", scratch / "recovered.mcap", recovery).text, "");
  EXPECT_EQ(read_all(*open(scratch / "recovered.mcap")), read_all(*open(kGolden / "version_1.mcap")));
}

// Ticks and digests in columns.
TEST(GoldenRecording, OfVersion2IsReadToTheSameValues) {
  const std::unique_ptr<Reader> reader = open(kGolden / "version_2.mcap");
  ASSERT_NE(reader, nullptr);
  EXPECT_EQ(reader->verify().text, "");
  EXPECT_TRUE(reader->has_all_messages());
  EXPECT_EQ(reader->identity().format_version, 2);
  EXPECT_EQ(reader->identity().steps, RecordedSteps::ticks);
  EXPECT_EQ(reader->identity().more, (TextMap{{"pace", "free"}}));
  ASSERT_EQ(reader->channels().size(), 2u);
  EXPECT_EQ(reader->channels()[1].topic, "state_hashes");
  EXPECT_EQ(reader->channels()[1].type_name, "slewring::StateHashes");
  for (const ChunkIndexRecord& chunk : reader->chunks()) EXPECT_EQ(chunk.compression, "slewring-columns");
  StepIndex step = 0;
  std::vector<StateHashes> blocks;
  EXPECT_EQ(reader
                ->for_each({},
                           [&](const RecordedMessage& message) {
                             if (message.channel->topic == "state_hashes") {
                               EXPECT_TRUE(decode_state_hashes(message.payload, blocks.emplace_back()));
                               return Reader::Visit::go_on;
                             }
                             EXPECT_EQ(as_text(message.payload), fmt::format("tick {:3}", step));
                             EXPECT_EQ(message.publish_time_ns, 1'700'000'000'000'000'000u + step * 1'000'003u);
                             EXPECT_EQ(message.log_time_ns, static_cast<std::uint64_t>(step++) * 1'000'000u);
                             return Reader::Visit::go_on;
                           })
                .text,
            "");
  EXPECT_EQ(step, 45);
  ASSERT_EQ(blocks.size(), 3u);
  StateHashes expected;
  for (StepIndex k = 20; k < 40; ++k) expected.add(k, 1000u + static_cast<std::uint64_t>(k));
  EXPECT_EQ(blocks[1].digest, expected.digest);
  EXPECT_EQ(blocks[1].digest, 4940368301105932621u);
  EXPECT_EQ(blocks[2].count, 5u);
}

// A file that a later program wrote: as version 1, with what that version might add.
void write_newer(const std::filesystem::path& path, const std::string& version, bool is_whole) {
  Bytes bytes;
  put_magic(bytes);
  encode(bytes, HeaderRecord{kProfile, "slewring 9"});
  encode_mark(bytes, crc32_of(bytes));
  FileIndex index;
  TextMap entries = to_entries(sample_identity());
  entries["format_version"] = version;
  const std::size_t at = bytes.size();
  encode(bytes, MetadataRecord{kIdentityName, entries});
  index.metadata.push_back({at, bytes.size() - at, kIdentityName});
  encode_mark(bytes, crc32_of(bytes));
  const std::size_t record = begin_record(bytes, Opcode{0x91});
  put_string(bytes, "unknown to this program");
  end_record(bytes, record);
  encode_mark(bytes, crc32_of(bytes));
  complete_statistics(index);
  if (is_whole) encode_end(bytes, 0, crc32_of(bytes), index);
  write_file(path, as_text(bytes));
}

TEST(NewerRecording, IsRefusedInOneSentence) {
  const ScratchDirectory scratch;
  const std::filesystem::path path = scratch / "newer.mcap";
  for (const bool is_whole : {true, false}) {
    write_newer(path, "3", is_whole);
    std::unique_ptr<Reader> reader;
    const Status status = Reader::open(path, reader);
    EXPECT_EQ(status.code, ExitCode::bad_input);
    EXPECT_EQ(status.text, path.string() +
                               ": the recording has format version 3 and this program reads versions up to 2; nothing "
                               "was read; use the slewring that wrote it, or a newer one");
    Recovery recovery;
    EXPECT_EQ(recover(path, scratch / "recovered.mcap", recovery).text, status.text);
    EXPECT_FALSE(std::filesystem::exists(scratch / "recovered.mcap"));
  }
}

TEST(NewerRecording, OfTheSameVersionMayHoldRecordsThatAreNotKnown) {
  const ScratchDirectory scratch;
  for (const bool is_whole : {true, false}) {
    write_newer(scratch / "newer.mcap", "1", is_whole);
    EXPECT_EQ(open(scratch / "newer.mcap")->identity().scene, "sample");
    EXPECT_EQ(open(scratch / "newer.mcap")->verify().is_ok(), is_whole);
  }
}

}  // namespace golden_test
}  // namespace slew::recording
