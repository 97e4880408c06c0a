// SPDX-License-Identifier: Apache-2.0
#include "recording/chunk_reader.h"

#include <fmt/format.h>
#include <zstd.h>

#include "recording/chunk_builder.h"

namespace slew::recording {

void ChunkReader::FreeContext::operator()(ZSTD_DCtx_s* context) const noexcept {
  ZSTD_freeDCtx(context);
}

ChunkReader::ChunkReader() : context_(ZSTD_createDCtx()) {}
ChunkReader::~ChunkReader() = default;

bool ChunkReader::unpack(const ChunkRecord& chunk, Bytes& records, std::string& problem) {
  if (chunk.uncompressed_size > kMaxChunkBytes) {
    problem =
        fmt::format("the chunk claims {} uncompressed bytes, more than {}", chunk.uncompressed_size, kMaxChunkBytes);
    return false;
  }
  if (chunk.compression.empty()) {
    records.assign(chunk.records.begin(), chunk.records.end());
  } else if (chunk.compression == kZstd) {
    // the frame repeats its size: no memory is allocated for a contradicted claim
    const unsigned long long size_in_frame = ZSTD_getFrameContentSize(chunk.records.data(), chunk.records.size());
    if (size_in_frame != chunk.uncompressed_size && size_in_frame != ZSTD_CONTENTSIZE_UNKNOWN) {
      problem = "the chunk cannot be decompressed: its size is not that in its header";
      return false;
    }
    records.resize(chunk.uncompressed_size);
    const std::size_t size = context_ ? ZSTD_decompressDCtx(context_.get(), records.data(), records.size(),
                                                            chunk.records.data(), chunk.records.size())
                                      : static_cast<std::size_t>(-1);
    if (ZSTD_isError(size) != 0) {
      problem = fmt::format("the chunk cannot be decompressed: {}", ZSTD_getErrorName(size));
      return false;
    }
    records.resize(size);
  } else if (chunk.compression == kColumns) {
    if (!columns_.decode(chunk.records, chunk.uncompressed_size, records, problem)) return false;
  } else {
    problem = "the chunk has a compression that is not supported; expected zstd or slewring-columns";
    return false;
  }
  if (records.size() != chunk.uncompressed_size) {
    problem = fmt::format("the chunk has {} uncompressed bytes, its header states {}", records.size(),
                          chunk.uncompressed_size);
    return false;
  }
  if (crc32_of(records) != chunk.uncompressed_crc) {
    problem = "the checksum of the chunk differs";
    return false;
  }
  return true;
}

bool ChunkRecords::next(Opcode& opcode, ByteSpan& content) noexcept {
  if (source_.is_empty()) return false;
  opcode = Opcode{source_.take<std::uint8_t>()};
  content = source_.take_bytes(source_.take<std::uint64_t>());
  return source_.is_valid();
}

}  // namespace slew::recording
