// SPDX-License-Identifier: Apache-2.0
// The end of a recording: Data End, the summary section (schemas, channels, index, statistics) and the Footer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/status.h"
#include "recording/input_file.h"
#include "recording/records.h"

namespace slew::recording {

// Index of a file. Built by the writer as it writes, read from the summary, or rebuilt by a scan.
struct FileIndex {
  std::vector<SchemaRecord> schemas;
  std::vector<ChannelRecord> channels;
  std::vector<ChunkIndexRecord> chunks;  // in the order of the file
  std::vector<AttachmentIndexRecord> attachments;
  std::vector<MetadataIndexRecord> metadata;
  StatisticsRecord statistics;
};

// Counts of the lists and the span of times; the owner keeps message counts by channel.
void complete_statistics(FileIndex& index);

// Appends Data End, summary, footer and magic for a file that ends at file_size.
// data_section_crc: CRC32 of the file so far.
void encode_end(Bytes& out, std::uint64_t file_size, std::uint32_t data_section_crc, const FileIndex& index);

// End of the proved bytes, and the problem behind them in words.
struct Damage {
  std::uint64_t offset = 0;
  std::string text;
};

// Reads the index from the end of the file. False, with the damage, if the end is missing or its checksum differs.
// Errors of the disk are in status.
[[nodiscard]] bool read_summary(const InputFile& file, FileIndex& index, Damage& damage, Status& status);

}  // namespace slew::recording
