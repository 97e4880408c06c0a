// SPDX-License-Identifier: Apache-2.0
// The compression "slewring-columns" of a chunk, for messages of which one is nearly like the one before it.
//
// Messages are rows of 8-byte words: log time, publish time, sequence, and the payload from its byte 4 on, where CDR
// aligns its 8-byte numbers. Rows of one channel and one length, from one writer, form a group. Each column of a group
// is written as its first word and the differences of first, second or third order that follow, byte plane by byte
// plane; the whole is a zstd frame. A column that stays the same, or grows evenly, takes a few bytes a chunk. No bit is
// lost: decoding gives the bytes of the records that the other compressions have. Layout: docs/recording-format.md.
//
// Not thread-safe. Buffers keep their size from chunk to chunk.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "recording/records.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace slew::recording {

inline constexpr std::string_view kColumns = "slewring-columns";

class ColumnEncoder {
 public:
  explicit ColumnEncoder(int level);
  ~ColumnEncoder();

  // Appends the compressed form of a chunk's records. False, with nothing appended, when they have none: they are not
  // all messages, or are of too many kinds, or zstd fails.
  [[nodiscard]] bool encode(ByteSpan records, Bytes& out);

 private:
  struct FreeContext {
    void operator()(ZSTD_CCtx_s* context) const noexcept;
  };
  // Messages of one channel and length with the same words where a writer's role and the first field behind the Header
  // are: rows that follow each other closely.
  struct Group {
    std::uint16_t channel = 0;
    std::uint32_t payload_bytes = 0;
    std::uint32_t role = 0;
    std::uint32_t kind = 0;
    std::uint32_t next = 0;                 // group that followed the last row
    std::vector<const std::byte*> records;  // content of each message record
  };

  [[nodiscard]] bool sort_into_groups(ByteSpan records);
  [[nodiscard]] std::size_t group_of(const Group& wanted);
  void put_channels(Bytes& out) const;
  void put_group(const Group& group);
  void put_column(const std::uint64_t* column, std::size_t rows, std::size_t head_at);

  std::unique_ptr<ZSTD_CCtx_s, FreeContext> context_;
  std::vector<Group> groups_;  // those from group_count_ on are spare
  std::size_t group_count_ = 0;
  std::vector<std::uint16_t> order_;  // group of each message
  std::vector<std::uint64_t> words_;  // of a group, column by column
  Bytes table_;
};

class ColumnDecoder {
 public:
  ColumnDecoder();
  ~ColumnDecoder();

  // Restores the records. size: their number of bytes, which has been found acceptable. False, with the problem in
  // words, when the content is not well formed.
  [[nodiscard]] bool decode(ByteSpan coded, std::size_t size, Bytes& records, std::string& problem);

 private:
  struct FreeContext {
    void operator()(ZSTD_DCtx_s* context) const noexcept;
  };
  struct Group {
    std::uint16_t channel = 0;
    std::uint32_t payload_bytes = 0;
    std::uint32_t rows = 0;
    std::size_t words_at = 0;  // place of its words in words_, row by row
    std::uint32_t taken = 0;
  };

  [[nodiscard]] bool unpack(ByteSpan coded, std::size_t size);
  [[nodiscard]] bool read_groups(ByteSource& table, std::size_t size);
  [[nodiscard]] bool read_group(ByteSource& table, const Group& group);
  [[nodiscard]] bool write_records(ByteSpan order, std::size_t size, Bytes& records);

  std::unique_ptr<ZSTD_DCtx_s, FreeContext> context_;
  Bytes table_;
  std::vector<Group> groups_;
  std::vector<std::uint64_t> words_;
};

// Channels with messages in a chunk of this compression, from the first bytes of its content; false when these are not
// enough.
[[nodiscard]] bool channels_of_columns(ByteSpan front, std::vector<std::uint16_t>& channels);
// That many bytes are enough for 256 channels.
inline constexpr std::size_t kColumnsFrontBytes = 2 + 2 * 256;

}  // namespace slew::recording
