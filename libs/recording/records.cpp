#include "recording/records.h"

#include <zlib.h>

#include <algorithm>
#include <tuple>

namespace slew::recording {
namespace {

template <typename PutEntries>
void put_sized(Bytes& out, const PutEntries& put_entries) {
  const std::size_t size_at = out.size();
  put(out, std::uint32_t{0});
  put_entries();
  put_at(out, size_at, static_cast<std::uint32_t>(out.size() - size_at - sizeof(std::uint32_t)));
}

void put_text_map(Bytes& out, const TextMap& map) {
  put_sized(out, [&] {
    for (const auto& [key, value] : map) {
      put_string(out, key);
      put_string(out, value);
    }
  });
}

void put_number_map(Bytes& out, const std::map<std::uint16_t, std::uint64_t>& map) {
  put_sized(out, [&] {
    for (const auto& [key, value] : map) {
      put(out, key);
      put(out, value);
    }
  });
}

bool take_text_map(ByteSource& source, TextMap& map) {
  map.clear();
  ByteSource entries(source.take_bytes(source.take<std::uint32_t>()));
  while (!entries.is_empty()) {
    const std::string_view key = entries.take_string();
    const std::string_view value = entries.take_string();
    if (!entries.is_valid()) return false;
    map.emplace(key, value);
  }
  return source.is_valid();
}

bool take_number_map(ByteSource& source, std::map<std::uint16_t, std::uint64_t>& map) {
  map.clear();
  ByteSource entries(source.take_bytes(source.take<std::uint32_t>()));
  while (!entries.is_empty()) {
    const std::uint16_t key = entries.take<std::uint16_t>();
    const std::uint64_t value = entries.take<std::uint64_t>();
    if (!entries.is_valid()) return false;
    map.emplace(key, value);
  }
  return source.is_valid();
}

}  // namespace

std::uint32_t crc32_of(ByteSpan bytes, std::uint32_t former) noexcept {
  uLong crc = former;
  // zlib takes 32-bit lengths
  while (!bytes.empty()) {
    const std::size_t size = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
    crc = crc32(crc, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(size));
    bytes = bytes.subspan(size);
  }
  return static_cast<std::uint32_t>(crc);
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

void encode_header(Bytes& out, const HeaderRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::header);
  put_string(out, record.profile);
  put_string(out, record.library);
  end_record(out, begin);
}

void encode_schema(Bytes& out, const SchemaRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::schema);
  put(out, record.id);
  put_string(out, record.name);
  put_string(out, record.encoding);
  put_string(out, record.text);
  end_record(out, begin);
}

void encode_channel(Bytes& out, const ChannelRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::channel);
  put(out, record.id);
  put(out, record.schema_id);
  put_string(out, record.topic);
  put_string(out, record.message_encoding);
  put_text_map(out, record.metadata);
  end_record(out, begin);
}

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

void encode_chunk_index(Bytes& out, const ChunkIndexRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::chunk_index);
  put(out, record.start_time);
  put(out, record.end_time);
  put(out, record.offset);
  put(out, record.length);
  put_number_map(out, record.message_index_offsets);
  put(out, record.message_index_length);
  put_string(out, record.compression);
  put(out, record.compressed_size);
  put(out, record.uncompressed_size);
  end_record(out, begin);
}

void encode_attachment(Bytes& out, const AttachmentRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::attachment);
  put(out, record.log_time);
  put(out, record.create_time);
  put_string(out, record.name);
  put_string(out, record.media_type);
  put(out, static_cast<std::uint64_t>(record.content.size()));
  put_bytes(out, record.content);
  put(out, crc32_of(ByteSpan(out).subspan(begin + kRecordHeadBytes)));
  end_record(out, begin);
}

void encode_attachment_index(Bytes& out, const AttachmentIndexRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::attachment_index);
  put(out, record.offset);
  put(out, record.length);
  put(out, record.log_time);
  put(out, record.create_time);
  put(out, record.size);
  put_string(out, record.name);
  put_string(out, record.media_type);
  end_record(out, begin);
}

void encode_metadata(Bytes& out, const MetadataRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::metadata);
  put_string(out, record.name);
  put_text_map(out, record.entries);
  end_record(out, begin);
}

void encode_metadata_index(Bytes& out, const MetadataIndexRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::metadata_index);
  put(out, record.offset);
  put(out, record.length);
  put_string(out, record.name);
  end_record(out, begin);
}

void encode_statistics(Bytes& out, const StatisticsRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::statistics);
  put(out, record.message_count);
  put(out, record.schema_count);
  put(out, record.channel_count);
  put(out, record.attachment_count);
  put(out, record.metadata_count);
  put(out, record.chunk_count);
  put(out, record.start_time);
  put(out, record.end_time);
  put_number_map(out, record.channel_message_counts);
  end_record(out, begin);
}

void encode_summary_offset(Bytes& out, const SummaryOffsetRecord& record) {
  const std::size_t begin = begin_record(out, Opcode::summary_offset);
  put(out, static_cast<std::uint8_t>(record.group));
  put(out, record.start);
  put(out, record.length);
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

bool decode_header(ByteSpan content, HeaderRecord& record) {
  ByteSource source(content);
  record.profile = source.take_string();
  record.library = source.take_string();
  return source.is_valid();
}

bool decode_schema(ByteSpan content, SchemaRecord& record) {
  ByteSource source(content);
  record.id = source.take<std::uint16_t>();
  record.name = source.take_string();
  record.encoding = source.take_string();
  record.text = source.take_string();
  return source.is_valid() && record.id != 0;
}

bool decode_channel(ByteSpan content, ChannelRecord& record) {
  ByteSource source(content);
  record.id = source.take<std::uint16_t>();
  record.schema_id = source.take<std::uint16_t>();
  record.topic = source.take_string();
  record.message_encoding = source.take_string();
  return take_text_map(source, record.metadata);
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
  ByteSource source(content);
  record.start_time = source.take<std::uint64_t>();
  record.end_time = source.take<std::uint64_t>();
  record.uncompressed_size = source.take<std::uint64_t>();
  record.uncompressed_crc = source.take<std::uint32_t>();
  record.compression = source.take_string();
  record.records = source.take_bytes(source.take<std::uint64_t>());
  return source.is_valid() && source.is_empty();
}

bool decode_chunk_index(ByteSpan content, ChunkIndexRecord& record) {
  ByteSource source(content);
  record.start_time = source.take<std::uint64_t>();
  record.end_time = source.take<std::uint64_t>();
  record.offset = source.take<std::uint64_t>();
  record.length = source.take<std::uint64_t>();
  if (!take_number_map(source, record.message_index_offsets)) return false;
  record.message_index_length = source.take<std::uint64_t>();
  record.compression = source.take_string();
  record.compressed_size = source.take<std::uint64_t>();
  record.uncompressed_size = source.take<std::uint64_t>();
  return source.is_valid();
}

bool decode_attachment(ByteSpan content, AttachmentRecord& record) noexcept {
  ByteSource source(content);
  record.log_time = source.take<std::uint64_t>();
  record.create_time = source.take<std::uint64_t>();
  record.name = source.take_string();
  record.media_type = source.take_string();
  record.content = source.take_bytes(source.take<std::uint64_t>());
  const std::size_t covered = source.position();
  const std::uint32_t crc = source.take<std::uint32_t>();
  return source.is_valid() && source.is_empty() && crc == crc32_of(content.first(covered));
}

bool decode_attachment_index(ByteSpan content, AttachmentIndexRecord& record) {
  ByteSource source(content);
  record.offset = source.take<std::uint64_t>();
  record.length = source.take<std::uint64_t>();
  record.log_time = source.take<std::uint64_t>();
  record.create_time = source.take<std::uint64_t>();
  record.size = source.take<std::uint64_t>();
  record.name = source.take_string();
  record.media_type = source.take_string();
  return source.is_valid();
}

bool decode_metadata(ByteSpan content, MetadataRecord& record) {
  ByteSource source(content);
  record.name = source.take_string();
  return take_text_map(source, record.entries);
}

bool decode_metadata_index(ByteSpan content, MetadataIndexRecord& record) {
  ByteSource source(content);
  record.offset = source.take<std::uint64_t>();
  record.length = source.take<std::uint64_t>();
  record.name = source.take_string();
  return source.is_valid();
}

bool decode_statistics(ByteSpan content, StatisticsRecord& record) {
  ByteSource source(content);
  record.message_count = source.take<std::uint64_t>();
  record.schema_count = source.take<std::uint16_t>();
  record.channel_count = source.take<std::uint32_t>();
  record.attachment_count = source.take<std::uint32_t>();
  record.metadata_count = source.take<std::uint32_t>();
  record.chunk_count = source.take<std::uint32_t>();
  record.start_time = source.take<std::uint64_t>();
  record.end_time = source.take<std::uint64_t>();
  return take_number_map(source, record.channel_message_counts);
}

bool decode_footer(ByteSpan content, FooterRecord& record) noexcept {
  ByteSource source(content);
  record.summary_start = source.take<std::uint64_t>();
  record.summary_offset_start = source.take<std::uint64_t>();
  record.summary_crc = source.take<std::uint32_t>();
  return source.is_valid();
}

bool decode_crc(ByteSpan content, std::uint32_t& crc) noexcept {
  ByteSource source(content);
  crc = source.take<std::uint32_t>();
  return source.is_valid();
}

}  // namespace slew::recording
