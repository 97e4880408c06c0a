// SPDX-License-Identifier: Apache-2.0
// Extracts the messages of an untrusted chunk.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "recording/column_coding.h"
#include "recording/records.h"

struct ZSTD_DCtx_s;

namespace slew::recording {

// Largest uncompressed chunk that is read; the writer's largest is a full chunk and one message of 16 MiB.
inline constexpr std::uint64_t kMaxChunkBytes = 64u << 20;

class ChunkReader {
 public:
  ChunkReader();
  ~ChunkReader();

  // Decompresses into records and compares size and checksum. False, with the problem in words, when they differ.
  [[nodiscard]] bool unpack(const ChunkRecord& chunk, Bytes& records, std::string& problem);

 private:
  struct FreeContext {
    void operator()(ZSTD_DCtx_s* context) const noexcept;
  };
  std::unique_ptr<ZSTD_DCtx_s, FreeContext> context_;
  ColumnDecoder columns_;
};

// Goes through the uncompressed records of a chunk.
class ChunkRecords {
 public:
  explicit ChunkRecords(ByteSpan records) noexcept : source_(records) {}

  // The next record; false at the end or when what follows is not well formed.
  [[nodiscard]] bool next(Opcode& opcode, ByteSpan& content) noexcept;
  [[nodiscard]] bool is_well_formed() const noexcept { return source_.is_valid(); }

 private:
  ByteSource source_;
};

// Counts and times of a chunk's messages, for comparison with its header and the index.
struct ChunkContents {
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::map<std::uint16_t, std::uint64_t> message_counts;
};

// False, with the problem in words, when a record is not well formed or names a channel that is_known denies.
template <typename IsKnown>
[[nodiscard]] bool examine(ByteSpan records, const IsKnown& is_known, ChunkContents& contents, std::string& problem) {
  contents = {};
  ChunkRecords source(records);
  Opcode opcode = Opcode::invalid;
  ByteSpan content;
  while (source.next(opcode, content)) {
    if (opcode != Opcode::message) continue;
    MessageRecord message;
    if (!decode_message(content, message)) {
      problem = "a message in the chunk is not well formed";
      return false;
    }
    if (!is_known(message.channel_id)) {
      problem = "a message in the chunk names a channel that the file does not declare";
      return false;
    }
    const bool is_first = contents.message_counts.empty();
    contents.start_time = is_first ? message.log_time : std::min(contents.start_time, message.log_time);
    contents.end_time = std::max(contents.end_time, message.log_time);
    ++contents.message_counts[message.channel_id];
  }
  if (!source.is_well_formed()) problem = "a record in the chunk is not well formed";
  return source.is_well_formed();
}

}  // namespace slew::recording
