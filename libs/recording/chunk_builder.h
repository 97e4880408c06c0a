// SPDX-License-Identifier: Apache-2.0
// Gathers messages into one MCAP chunk: compressed, checksummed, followed by an index per channel. A chunk in columns
// has no such index: it would be larger than the chunk.
//
// Buffers keep their size from chunk to chunk: after the first full chunk nothing allocates.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "recording/column_coding.h"
#include "recording/records.h"

struct ZSTD_CCtx_s;

namespace slew::recording {

inline constexpr std::string_view kZstd = "zstd";

[[nodiscard]] constexpr bool is_written_compression(std::string_view name) noexcept {
  return name == kZstd || name == kColumns;
}

// How the messages of a chunk are compressed.
enum class ChunkCoding : std::uint8_t {
  zstd,    // as they are: every MCAP program reads them
  columns  // column_coding.h: a third of that or less, for programs with a decoder
};

class ChunkBuilder {
 public:
  // expected_bytes: size at which the owner closes a chunk; the buffers are sized for it.
  // level: compression level of zstd, 1 (fast) to 19.
  ChunkBuilder(std::size_t expected_bytes, int level, ChunkCoding coding = ChunkCoding::zstd);
  ~ChunkBuilder();

  void add(const MessageRecord& message);

  [[nodiscard]] std::size_t uncompressed_size() const noexcept { return records_.size(); }
  [[nodiscard]] bool is_empty() const noexcept { return records_.empty(); }

  // Appends the chunk record and its message indexes to out, for a file that ends at file_size; fills the entry for
  // the summary and starts an empty chunk. Errors: resources, if zstd fails; then no bytes are appended.
  [[nodiscard]] Status finish(Bytes& out, std::uint64_t file_size, ChunkIndexRecord& index);

 private:
  struct FreeContext {
    void operator()(ZSTD_CCtx_s* context) const noexcept;
  };

  void start_empty() noexcept;
  [[nodiscard]] std::string_view compress(Bytes& out, Status& status);
  void put_indexes(Bytes& out, std::uint64_t file_size, ChunkIndexRecord& index);

  std::unique_ptr<ZSTD_CCtx_s, FreeContext> context_;
  std::optional<ColumnEncoder> columns_;  // none: coding zstd
  Bytes records_;
  Bytes compressed_;
  std::vector<std::vector<MessageIndexEntry>> entries_;  // by channel
  std::vector<std::uint16_t> channels_;                  // channels with messages in this chunk
  std::uint64_t start_time_ = 0;
  std::uint64_t end_time_ = 0;
};

}  // namespace slew::recording
