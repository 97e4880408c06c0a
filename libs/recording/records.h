// SPDX-License-Identifier: Apache-2.0
// The records of an MCAP file (https://mcap.dev/spec, version 0) that a recording uses, as structs, with their bytes.
//
// A record is  <opcode: 1 byte> <length of content: uint64> <content>. encode* append a whole record to a buffer;
// decode* read the content of one, return false if it is malformed and never read outside of it. Content may be longer
// than the known fields: newer fields are ignored. Chunks and attachments may not be longer: they carry their own
// checksum, and bytes behind it would mean a wrong length.
//
// One record is our own, from the range that the specification leaves to applications:
//   Mark (0x80): uint32 CRC32 of every byte of the file in front of the record.
// It follows every record, or group of records, that carries no checksum of its own, so that any changed bit is located
// without a summary. Other MCAP readers skip it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "recording/byte_order.h"

namespace slew::recording {

inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Opcode : std::uint8_t {
  invalid = 0x00,
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
  mark = 0x80
};

inline constexpr std::size_t kRecordHeadBytes = 9;    // opcode and length
inline constexpr std::size_t kMessageHeadBytes = 22;  // channel, sequence, log time, publish time
inline constexpr std::size_t kFooterBytes = kRecordHeadBytes + 20;

using TextMap = std::map<std::string, std::string>;

struct HeaderRecord {
  static constexpr Opcode kOpcode = Opcode::header;
  std::string profile;
  std::string library;
};

struct SchemaRecord {
  static constexpr Opcode kOpcode = Opcode::schema;
  std::uint16_t id = 0;  // 1 or more
  std::string name;
  std::string encoding;
  std::string text;
};

struct ChannelRecord {
  static constexpr Opcode kOpcode = Opcode::channel;
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;
  std::string topic;
  std::string message_encoding;
  TextMap metadata;
};

struct MessageRecord {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;      // ns
  std::uint64_t publish_time = 0;  // ns
  ByteSpan payload;                // into the buffer it was decoded from
};

struct ChunkRecord {
  static constexpr Opcode kOpcode = Opcode::chunk;
  std::uint64_t start_time = 0;  // ns, smallest log time of a message in it, 0 when there is none
  std::uint64_t end_time = 0;    // ns, largest
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string_view compression;
  ByteSpan records;  // compressed
};

struct MessageIndexEntry {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0;  // in the uncompressed records of the chunk
};

struct ChunkIndexRecord {
  static constexpr Opcode kOpcode = Opcode::chunk_index;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t offset = 0;  // offset of the chunk record in the file
  std::uint64_t length = 0;  // length of the chunk record with its opcode and length
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct AttachmentRecord {
  std::uint64_t log_time = 0;
  std::uint64_t create_time = 0;
  std::string_view name;
  std::string_view media_type;
  ByteSpan content;
};

struct AttachmentIndexRecord {
  static constexpr Opcode kOpcode = Opcode::attachment_index;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint64_t log_time = 0;
  std::uint64_t create_time = 0;
  std::uint64_t size = 0;
  std::string name;
  std::string media_type;
};

struct MetadataRecord {
  static constexpr Opcode kOpcode = Opcode::metadata;
  std::string name;
  TextMap entries;
};

struct MetadataIndexRecord {
  static constexpr Opcode kOpcode = Opcode::metadata_index;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::string name;
};

struct StatisticsRecord {
  static constexpr Opcode kOpcode = Opcode::statistics;
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
};

struct SummaryOffsetRecord {
  static constexpr Opcode kOpcode = Opcode::summary_offset;
  Opcode group = Opcode::invalid;
  std::uint64_t start = 0;
  std::uint64_t length = 0;
};

struct FooterRecord {
  static constexpr Opcode kOpcode = Opcode::footer;
  std::uint64_t summary_start = 0;
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;
};

// Largest content of a record without an inner length field to confirm it: header, schema, channel, metadata and
// unknown records.
inline constexpr std::uint64_t kMaxPlainBytes = 64u << 20;

// Checks a record's length against its inner lengths before reading that many bytes. front: the first bytes of the
// content, kFrontBytes of them or all.
inline constexpr std::uint64_t kFrontBytes = 64 * 1024;
[[nodiscard]] bool is_length_borne_out(Opcode opcode, ByteSpan front, std::uint64_t length) noexcept;

// CRC32 (IEEE 802.3, as in zlib) continued from a former value; 0 starts.
[[nodiscard]] std::uint32_t crc32_of(ByteSpan bytes, std::uint32_t former = 0) noexcept;

// Opens a record: content follows by put calls, end_record sets the length.
[[nodiscard]] std::size_t begin_record(Bytes& out, Opcode opcode);
void end_record(Bytes& out, std::size_t begin) noexcept;

void put_magic(Bytes& out);
void encode_message(Bytes& out, const MessageRecord& record);
void encode_message_index(Bytes& out, std::uint16_t channel_id, const std::vector<MessageIndexEntry>& entries);
void encode_attachment(Bytes& out, const AttachmentRecord& record);
void encode_data_end(Bytes& out, std::uint32_t data_section_crc);
void encode_mark(Bytes& out, std::uint32_t crc_so_far);
// All other records.
template <typename Record>
void encode(Bytes& out, const Record& record);

[[nodiscard]] bool decode_message(ByteSpan content, MessageRecord& record) noexcept;
[[nodiscard]] bool decode_chunk(ByteSpan content, ChunkRecord& record) noexcept;
// Also checks the attachment's checksum.
[[nodiscard]] bool decode_attachment(ByteSpan content, AttachmentRecord& record) noexcept;
// The single uint32 of a Data End or a Mark.
[[nodiscard]] bool decode_crc(ByteSpan content, std::uint32_t& crc) noexcept;
// All other records.
template <typename Record>
[[nodiscard]] bool decode(ByteSpan content, Record& record);

}  // namespace slew::recording
