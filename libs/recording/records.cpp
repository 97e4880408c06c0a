// SPDX-License-Identifier: Apache-2.0
#include "recording/records.h"

#include <libdeflate.h>

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <utility>

namespace slew::recording {
namespace {

// ---- fields of the records, once for both directions ----------------------------------------------------------

// An archive is called with the fields of a record; Of<T> is `const T` in the one that reads the record, T in the one
// that fills it.

class FieldWriter {
 public:
  template <typename T>
  using Of = const T;

  explicit FieldWriter(Bytes& out) noexcept : out_(out) {}

  template <typename... T>
  void operator()(const T&... values) {
    (item(values), ...);
  }

 private:
  template <typename T>
  requires std::is_integral_v<T>
  void item(T value) { put(out_, value); }
  void item(Opcode opcode) { put(out_, static_cast<std::uint8_t>(opcode)); }
  void item(std::string_view text) { put_string(out_, text); }
  void item(ByteSpan bytes) {
    put(out_, static_cast<std::uint64_t>(bytes.size()));
    put_bytes(out_, bytes);
  }
  template <typename Key, typename Value>
  void item(const std::map<Key, Value>& map) {
    const std::size_t size_at = out_.size();
    put(out_, std::uint32_t{0});
    for (const auto& [key, value] : map) (*this)(key, value);
    put_at(out_, size_at, static_cast<std::uint32_t>(out_.size() - size_at - sizeof(std::uint32_t)));
  }

  Bytes& out_;
};

class FieldReader {
 public:
  template <typename T>
  using Of = T;

  explicit FieldReader(ByteSpan content) noexcept : source_(content) {}

  template <typename... T>
  void operator()(T&... values) {
    (item(values), ...);
  }

  [[nodiscard]] bool is_good() const noexcept { return is_good_ && source_.is_valid(); }
  [[nodiscard]] bool is_through() const noexcept { return is_good() && source_.is_empty(); }
  [[nodiscard]] std::size_t position() const noexcept { return source_.position(); }

 private:
  template <typename T>
  requires std::is_integral_v<T>
  void item(T& value) { value = source_.take<T>(); }
  void item(Opcode& opcode) { opcode = Opcode{source_.take<std::uint8_t>()}; }
  template <typename Text>
  requires std::is_same_v<Text, std::string> || std::is_same_v<Text, std::string_view>
  void item(Text& text) { text = source_.take_string(); }
  void item(ByteSpan& bytes) { bytes = source_.take_bytes(source_.take<std::uint64_t>()); }
  template <typename Key, typename Value>
  void item(std::map<Key, Value>& map) {
    map.clear();
    FieldReader entries(source_.take_bytes(source_.take<std::uint32_t>()));
    while (!entries.source_.is_empty()) {
      Key key{};
      Value value{};
      entries(key, value);
      if (entries.is_good()) map.emplace(std::move(key), std::move(value));
    }
    is_good_ = is_good_ && entries.is_good();
  }

  ByteSource source_;
  bool is_good_ = true;
};

template <typename A>
void fields(A& a, typename A::template Of<HeaderRecord>& r) {
  a(r.profile, r.library);
}

template <typename A>
void fields(A& a, typename A::template Of<SchemaRecord>& r) {
  a(r.id, r.name, r.encoding, r.text);
}

template <typename A>
void fields(A& a, typename A::template Of<ChannelRecord>& r) {
  a(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata);
}

template <typename A>
void fields(A& a, typename A::template Of<ChunkRecord>& r) {
  a(r.start_time, r.end_time, r.uncompressed_size, r.uncompressed_crc, r.compression, r.records);
}

template <typename A>
void fields(A& a, typename A::template Of<ChunkIndexRecord>& r) {
  a(r.start_time, r.end_time, r.offset, r.length, r.message_index_offsets, r.message_index_length, r.compression);
  a(r.compressed_size, r.uncompressed_size);
}

template <typename A>
void fields(A& a, typename A::template Of<AttachmentRecord>& r) {
  a(r.log_time, r.create_time, r.name, r.media_type, r.content);
}

template <typename A>
void fields(A& a, typename A::template Of<AttachmentIndexRecord>& r) {
  a(r.offset, r.length, r.log_time, r.create_time, r.size, r.name, r.media_type);
}

template <typename A>
void fields(A& a, typename A::template Of<MetadataRecord>& r) {
  a(r.name, r.entries);
}

template <typename A>
void fields(A& a, typename A::template Of<MetadataIndexRecord>& r) {
  a(r.offset, r.length, r.name);
}

template <typename A>
void fields(A& a, typename A::template Of<StatisticsRecord>& r) {
  a(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count, r.chunk_count);
  a(r.start_time, r.end_time, r.channel_message_counts);
}

template <typename A>
void fields(A& a, typename A::template Of<SummaryOffsetRecord>& r) {
  a(r.group, r.start, r.length);
}

template <typename A>
void fields(A& a, typename A::template Of<FooterRecord>& r) {
  a(r.summary_start, r.summary_offset_start, r.summary_crc);
}

}  // namespace

std::uint32_t crc32_of(ByteSpan bytes, std::uint32_t former) noexcept {
  // a null pointer would start a new checksum
  return bytes.empty() ? former : libdeflate_crc32(former, bytes.data(), bytes.size());
}

bool is_length_borne_out(Opcode opcode, ByteSpan front, std::uint64_t length) noexcept {
  ByteSource source(front);
  std::uint64_t behind = 0;  // offset behind the bytes that the inner length counts
  switch (opcode) {
    case Opcode::chunk:
      std::ignore = source.take_bytes(3 * sizeof(std::uint64_t) + sizeof(std::uint32_t));
      std::ignore = source.take_string();
      break;
    case Opcode::attachment:
      std::ignore = source.take_bytes(2 * sizeof(std::uint64_t));
      std::ignore = source.take_string();
      std::ignore = source.take_string();
      behind = sizeof(std::uint32_t);
      break;
    case Opcode::message_index: {
      std::ignore = source.take_bytes(sizeof(std::uint16_t));
      const std::uint64_t inner = source.take<std::uint32_t>();
      return source.is_valid() && length <= kMaxPlainBytes && inner <= length - source.position();
    }
    default:
      return length <= kMaxPlainBytes;
  }
  const std::uint64_t inner = source.take<std::uint64_t>();
  if (!source.is_valid() || length < source.position() + behind) return false;
  return inner == length - source.position() - behind;
}

std::size_t begin_record(Bytes& out, Opcode opcode) {
  const std::size_t begin = out.size();
  put(out, static_cast<std::uint8_t>(opcode));
  put(out, std::uint64_t{0});
  return begin;
}

void end_record(Bytes& out, std::size_t begin) noexcept {
  put_at(out, begin + 1, static_cast<std::uint64_t>(out.size() - begin - kRecordHeadBytes));
}

void put_magic(Bytes& out) {
  put_bytes(out, std::as_bytes(std::span(kMagic)));
}

template <typename Record>
void encode(Bytes& out, const Record& record) {
  const std::size_t begin = begin_record(out, Record::kOpcode);
  FieldWriter writer(out);
  fields(writer, record);
  end_record(out, begin);
}

template <typename Record>
bool decode(ByteSpan content, Record& record) {
  FieldReader reader(content);
  fields(reader, record);
  if constexpr (std::is_same_v<Record, SchemaRecord>) return reader.is_good() && record.id != 0;
  return reader.is_good();
}

template void encode(Bytes&, const HeaderRecord&);
template void encode(Bytes&, const SchemaRecord&);
template void encode(Bytes&, const ChannelRecord&);
template void encode(Bytes&, const ChunkRecord&);
template void encode(Bytes&, const ChunkIndexRecord&);
template void encode(Bytes&, const AttachmentIndexRecord&);
template void encode(Bytes&, const MetadataRecord&);
template void encode(Bytes&, const MetadataIndexRecord&);
template void encode(Bytes&, const StatisticsRecord&);
template void encode(Bytes&, const SummaryOffsetRecord&);
template void encode(Bytes&, const FooterRecord&);

template bool decode(ByteSpan, HeaderRecord&);
template bool decode(ByteSpan, SchemaRecord&);
template bool decode(ByteSpan, ChannelRecord&);
template bool decode(ByteSpan, ChunkIndexRecord&);
template bool decode(ByteSpan, AttachmentIndexRecord&);
template bool decode(ByteSpan, MetadataRecord&);
template bool decode(ByteSpan, MetadataIndexRecord&);
template bool decode(ByteSpan, StatisticsRecord&);
template bool decode(ByteSpan, FooterRecord&);

void encode_message(Bytes& out, const MessageRecord& record) {
  // one resize: this is the path of every recorded sample
  const std::uint64_t length = kMessageHeadBytes + record.payload.size();
  const std::size_t begin = out.size();
  out.resize(begin + kRecordHeadBytes + length);
  std::byte* at = out.data() + begin;
  const auto store = [&at](const auto& value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  store(static_cast<std::uint8_t>(Opcode::message));
  store(length);
  store(record.channel_id);
  store(record.sequence);
  store(record.log_time);
  store(record.publish_time);
  if (!record.payload.empty()) std::memcpy(at, record.payload.data(), record.payload.size());
}

void encode_message_index(Bytes& out, std::uint16_t channel_id, const std::vector<MessageIndexEntry>& entries) {
  const std::size_t begin = begin_record(out, Opcode::message_index);
  put(out, channel_id);
  put(out, static_cast<std::uint32_t>(entries.size() * sizeof(MessageIndexEntry)));
  static_assert(sizeof(MessageIndexEntry) == 16);
  put_bytes(out, std::as_bytes(std::span(entries)));
  end_record(out, begin);
}

void encode_attachment(Bytes& out, const AttachmentRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::attachment);
  FieldWriter writer(out);
  fields(writer, record);
  put(out, crc32_of(ByteSpan(out).subspan(begin + kRecordHeadBytes)));
  end_record(out, begin);
}

void encode_data_end(Bytes& out, std::uint32_t data_section_crc) {
  const std::size_t begin = begin_record(out, Opcode::data_end);
  put(out, data_section_crc);
  end_record(out, begin);
}

void encode_mark(Bytes& out, std::uint32_t crc_so_far) {
  const std::size_t begin = begin_record(out, Opcode::mark);
  put(out, crc_so_far);
  end_record(out, begin);
}

bool decode_message(ByteSpan content, MessageRecord& record) noexcept {
  ByteSource source(content);
  record.channel_id = source.take<std::uint16_t>();
  record.sequence = source.take<std::uint32_t>();
  record.log_time = source.take<std::uint64_t>();
  record.publish_time = source.take<std::uint64_t>();
  record.payload = source.take_bytes(source.left());
  return source.is_valid();
}

bool decode_chunk(ByteSpan content, ChunkRecord& record) noexcept {
  FieldReader reader(content);
  fields(reader, record);
  return reader.is_through();
}

bool decode_attachment(ByteSpan content, AttachmentRecord& record) noexcept {
  FieldReader reader(content);
  fields(reader, record);
  const std::size_t covered = reader.position();
  std::uint32_t crc = 0;
  reader(crc);
  return reader.is_through() && crc == crc32_of(content.first(covered));
}

bool decode_crc(ByteSpan content, std::uint32_t& crc) noexcept {
  ByteSource source(content);
  crc = source.take<std::uint32_t>();
  return source.is_valid();
}

}  // namespace slew::recording
