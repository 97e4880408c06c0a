// SPDX-License-Identifier: Apache-2.0
#include "recording/chunk_builder.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>

namespace slew::recording {
namespace {

// a chunk is closed once it is full, so one message more than expected must fit without growing
constexpr std::size_t kSpareBytes = 64 * 1024;

}  // namespace

void ChunkBuilder::FreeContext::operator()(ZSTD_CCtx_s* context) const noexcept {
  ZSTD_freeCCtx(context);
}

ChunkBuilder::ChunkBuilder(std::size_t expected_bytes, int level, ChunkCoding coding) : context_(ZSTD_createCCtx()) {
  if (coding == ChunkCoding::columns) columns_.emplace(level);
  if (context_) {
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, level);
  }
  records_.reserve(expected_bytes + kSpareBytes);
}

ChunkBuilder::~ChunkBuilder() = default;

void ChunkBuilder::add(const MessageRecord& message) {
  if (message.channel_id >= entries_.size()) entries_.resize(std::size_t{message.channel_id} + 1);
  std::vector<MessageIndexEntry>& entries = entries_[message.channel_id];
  if (entries.empty()) channels_.push_back(message.channel_id);
  entries.push_back({message.log_time, records_.size()});
  start_time_ = is_empty() ? message.log_time : std::min(start_time_, message.log_time);
  end_time_ = std::max(end_time_, message.log_time);
  encode_message(records_, message);
}

// Appends the compressed records and returns the name of their compression. A chunk that has no columns is compressed
// as it is.
std::string_view ChunkBuilder::compress(Bytes& out, Status& status) {
  if (columns_ && columns_->encode(records_, out)) return kColumns;
  const std::size_t begin = out.size();
  out.resize(begin + ZSTD_compressBound(records_.size()));
  const std::size_t size = context_ ? ZSTD_compress2(context_.get(), out.data() + begin, out.size() - begin,
                                                     records_.data(), records_.size())
                                    : static_cast<std::size_t>(-1);
  if (ZSTD_isError(size) != 0) {
    status = Status::error(ExitCode::resources, fmt::format("cannot compress {} bytes of messages ({}); they were not "
                                                            "written; end other programs to free memory",
                                                            records_.size(), ZSTD_getErrorName(size)));
    return kZstd;
  }
  out.resize(begin + size);
  return kZstd;
}

Status ChunkBuilder::finish(Bytes& out, std::uint64_t file_size, ChunkIndexRecord& index) {
  Status status;
  compressed_.clear();
  const std::string_view compression = compress(compressed_, status);
  if (!status.is_ok()) return status;
  const std::size_t begin = out.size();
  encode(out, ChunkRecord{start_time_, end_time_, records_.size(), crc32_of(records_), compression, compressed_});

  index.start_time = start_time_;
  index.end_time = end_time_;
  index.offset = file_size + begin;
  index.length = out.size() - begin;
  index.compression = compression;
  index.compressed_size = compressed_.size();
  index.uncompressed_size = records_.size();
  if (compression != kColumns) put_indexes(out, file_size, index);
  start_empty();
  return status;
}

// message indexes, by ascending channel
void ChunkBuilder::put_indexes(Bytes& out, std::uint64_t file_size, ChunkIndexRecord& index) {
  const std::size_t indexes_at = out.size();
  std::sort(channels_.begin(), channels_.end());
  for (const std::uint16_t channel : channels_) {
    index.message_index_offsets[channel] = file_size + out.size();
    encode_message_index(out, channel, entries_[channel]);
  }
  index.message_index_length = out.size() - indexes_at;
}

void ChunkBuilder::start_empty() noexcept {
  for (const std::uint16_t channel : channels_) entries_[channel].clear();
  channels_.clear();
  records_.clear();
  start_time_ = 0;
  end_time_ = 0;
}

}  // namespace slew::recording
