// SPDX-License-Identifier: Apache-2.0
// Chunks in columns: no bit is lost, what hardly changes takes hardly any room, and no damage is taken for messages.
#include "recording/column_coding.h"

#include <cmath>

#include "recording/recovery.h"
#include "sample_session.h"

namespace slew::recording {
namespace column_coding_test {

constexpr int kLevel = 1;

Bytes encoded(const Bytes& records) {
  Bytes coded;
  EXPECT_TRUE(ColumnEncoder(kLevel).encode(records, coded));
  return coded;
}

Bytes decoded(const Bytes& coded, std::size_t size) {
  Bytes records;
  std::string problem;
  EXPECT_TRUE(ColumnDecoder().decode(coded, size, records, problem)) << problem;
  return records;
}

// Payload as the wire has it: encapsulation, a Header with the writer's role, then numbers.
Bytes payload(std::uint32_t role, const std::vector<double>& numbers) {
  Bytes bytes;
  put(bytes, std::uint32_t{0x0100});
  for (int i = 0; i < 4; ++i) put(bytes, std::uint32_t{0x11223344});
  put(bytes, role);
  for (int i = 0; i < 5; ++i) put(bytes, std::uint32_t{0});
  for (const double number : numbers) put(bytes, std::bit_cast<std::uint64_t>(number));
  return bytes;
}

TEST(Columns, GiveBackTheRecordsOfEveryMixOfMessages) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    std::uint64_t x = seed * 2 + 1;
    const auto next = [&x](std::uint64_t below) {
      x = x * 6364136223846793005u + 1442695040888963407u;
      return (x >> 33) % below;
    };
    Bytes records;
    const std::uint64_t messages = 1 + next(200);
    for (std::uint64_t i = 0; i < messages; ++i) {
      const std::string bytes = sample_payload(next(3), next(4) == 0 ? next(70) : 8 * next(6) + 44);
      encode_message(records, {static_cast<std::uint16_t>(next(3)), static_cast<std::uint32_t>(next(5)), next(1u << 20),
                               next(1u << 30) * next(1u << 30), as_byte_span(bytes)});
    }
    EXPECT_EQ(decoded(encoded(records), records.size()), records) << "seed " << seed;
  }
}

TEST(Columns, GiveBackNumbersOfEveryKind) {
  const std::vector<double> kinds = {0.0, -0.0, 1.0, -1.0, 1e308, -1e308, 5e-324, std::nan(""), INFINITY, -INFINITY};
  Bytes records;
  for (std::uint32_t i = 0; i < 300; ++i) {
    std::vector<double> numbers;
    for (std::size_t k = 0; k < kinds.size(); ++k) numbers.push_back(kinds[(i * (k + 1) + k) % kinds.size()]);
    encode_message(records, {0, i, i, ~std::uint64_t{0} - i, payload(1, numbers)});
  }
  EXPECT_EQ(decoded(encoded(records), records.size()), records);
}

// Ticks at rest: time goes on, nothing else changes.
TEST(Columns, OfMessagesThatOnlyCountOnTakeAlmostNothing) {
  Bytes records;
  constexpr std::uint32_t kMessages = 4000;
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    encode_message(records, {0, 7, i * 1'000'000ull, 1'700'000'000'000'000'000ull + i * 1'000'000ull,
                             payload(0, {0.25, static_cast<double>(i), 3.5})});
  }
  // the number as a double counts on evenly between two powers of two only
  EXPECT_LT(encoded(records).size(), kMessages / 4);
}

// A smooth curve, rounded to 24 bits, against the size of its numbers.
TEST(Columns, OfSmoothCurvesTakeAFractionOfTheirNumbers) {
  Bytes records;
  constexpr std::uint32_t kMessages = 500;
  for (std::uint32_t i = 0; i < kMessages; ++i) {
    const auto smooth = static_cast<double>(static_cast<float>(2 + std::sin(0.01 * i)));
    encode_message(records, {0, 7, i, i, payload(0, std::vector<double>(50, smooth))});
  }
  EXPECT_LT(encoded(records).size(), records.size() / 50);
}

TEST(Columns, NameTheirChannelsInFront) {
  Bytes records;
  for (const std::uint16_t channel : std::initializer_list<std::uint16_t>{5, 2, 5, 9})
    encode_message(records, {channel, 0, 0, 0, payload(0, {1})});
  std::vector<std::uint16_t> channels;
  EXPECT_TRUE(channels_of_columns(encoded(records), channels));
  EXPECT_EQ(channels, (std::vector<std::uint16_t>{2, 5, 9}));
  EXPECT_FALSE(channels_of_columns(ByteSpan(), channels));
}

TEST(Columns, RefuseOtherRecords) {
  Bytes records, coded;
  encode_message(records, {0, 0, 0, 0, payload(0, {1})});
  encode(records, ChannelRecord{});
  EXPECT_FALSE(ColumnEncoder(kLevel).encode(records, coded));
  EXPECT_TRUE(coded.empty());
  EXPECT_FALSE(ColumnEncoder(kLevel).encode(ByteSpan(), coded));
}

TEST(Columns, OfDamagedBytesAreRefusedOrOfTheStatedSize) {
  Bytes records;
  for (std::uint32_t i = 0; i < 60; ++i) encode_message(records, {0, i, i, i, payload(i % 2, {1.0 * i, 2, 3})});
  const Bytes whole = encoded(records);
  ColumnDecoder decoder;
  Bytes back;
  std::string problem;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = whole;
      damaged[at] ^= std::byte{1} << bit;
      const bool is_taken = decoder.decode(damaged, records.size(), back, problem);
      EXPECT_TRUE(is_taken ? back.size() == records.size() : !problem.empty());
    }
    EXPECT_FALSE(decoder.decode(ByteSpan(whole).first(at), records.size(), back, problem));
  }
  EXPECT_FALSE(decoder.decode(whole, records.size() + 1, back, problem));
  EXPECT_FALSE(decoder.decode(whole, 0, back, problem));
}

// ---- a recording ----------------------------------------------------------------------------------------------

WriterLimits in_columns() {
  WriterLimits limits = small_limits();
  limits.coding = ChunkCoding::columns;
  return limits;
}

std::unique_ptr<Reader> open(const std::filesystem::path& path) {
  std::unique_ptr<Reader> reader;
  EXPECT_EQ(Reader::open(path, reader).text, "");
  return reader;
}

TEST(RecordingInColumns, GivesBackWhatWasWritten) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 25, Ending::closed, in_columns());
  const std::unique_ptr<Reader> reader = open(scratch / "a.mcap");
  EXPECT_EQ(reader->verify().text, "");
  EXPECT_EQ(reader->identity().format_version, 2);
  EXPECT_EQ(read_all(*reader), sample_messages(25));
  EXPECT_GT(reader->statistics().chunk_count, 3u);
  const std::vector<KnownMessage> ticks = read_all(*reader, nullptr, {{kTickTopic}, 3'000'000, 5'000'000});
  ASSERT_EQ(ticks.size(), 3u);
  EXPECT_EQ(ticks.front().payload, "tick 3");
}

TEST(RecordingInColumns, OfTheUsualCodingHasTheFirstVersion) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 5, Ending::closed);
  EXPECT_EQ(open(scratch / "a.mcap")->identity().format_version, 1);
}

TEST(RecordingInColumns, IsReadableUpToACutAndRecovered) {
  const ScratchDirectory scratch;
  std::ignore = write_sample(scratch / "a.mcap", 25, Ending::closed, in_columns());
  const std::string whole = file_content(scratch / "a.mcap");
  const std::vector<KnownMessage> all = sample_messages(25);
  std::size_t longest = 0;
  for (std::size_t size = 600; size < whole.size(); size += 37) {
    write_file(scratch / "cut.mcap", std::string_view(whole).substr(0, size));
    std::unique_ptr<Reader> reader;
    if (!Reader::open(scratch / "cut.mcap", reader).is_ok()) continue;
    const std::vector<KnownMessage> readable = read_all(*reader);
    ASSERT_LE(readable.size(), all.size());
    EXPECT_TRUE(std::equal(readable.begin(), readable.end(), all.begin()));
    longest = std::max(longest, readable.size());
    Recovery recovery;
    std::filesystem::remove(scratch / "recovered.mcap");
    ASSERT_EQ(recover(scratch / "cut.mcap", scratch / "recovered.mcap", recovery).text, "");
    EXPECT_EQ(read_all(*open(scratch / "recovered.mcap")), readable);
  }
  EXPECT_EQ(longest, all.size());
}

}  // namespace column_coding_test
}  // namespace slew::recording
