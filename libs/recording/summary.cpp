// SPDX-License-Identifier: Apache-2.0
#include "recording/summary.h"

#include <fmt/format.h>

#include <algorithm>

namespace slew::recording {
namespace {

// one group of records of the same kind, and its entry for the summary offset section
template <typename Record>
void encode_group(Bytes& out, std::uint64_t file_size, std::span<const Record> records,
                  std::vector<SummaryOffsetRecord>& groups) {
  const std::size_t begin = out.size();
  for (const Record& record : records) encode(out, record);
  if (out.size() > begin) groups.push_back({Record::kOpcode, file_size + begin, out.size() - begin});
}

template <typename Record>
bool decode_into(std::vector<Record>& records, ByteSpan content) {
  Record record;
  if (!decode(content, record)) return false;
  records.push_back(std::move(record));
  return true;
}

bool decode_summary_record(Opcode opcode, ByteSpan content, FileIndex& index) {
  switch (opcode) {
    case Opcode::schema:
      return decode_into(index.schemas, content);
    case Opcode::channel:
      return decode_into(index.channels, content);
    case Opcode::chunk_index:
      return decode_into(index.chunks, content);
    case Opcode::attachment_index:
      return decode_into(index.attachments, content);
    case Opcode::metadata_index:
      return decode_into(index.metadata, content);
    case Opcode::statistics:
      return decode(content, index.statistics);
    default:
      return opcode != Opcode::invalid;  // summary offsets, and records of later versions
  }
}

bool decode_summary(ByteSpan summary, std::uint64_t file_offset, FileIndex& index, Damage& damage) {
  ByteSource source(summary);
  while (!source.is_empty()) {
    const std::size_t at = source.position();
    const Opcode opcode = Opcode{source.take<std::uint8_t>()};
    const ByteSpan content = source.take_bytes(source.take<std::uint64_t>());
    if (!source.is_valid() || !decode_summary_record(opcode, content, index)) {
      damage = {file_offset + at, "a record of the summary is not well formed"};
      return false;
    }
  }
  return true;
}

}  // namespace

void complete_statistics(FileIndex& index) {
  StatisticsRecord& statistics = index.statistics;
  statistics.schema_count = static_cast<std::uint16_t>(index.schemas.size());
  statistics.channel_count = static_cast<std::uint32_t>(index.channels.size());
  statistics.attachment_count = static_cast<std::uint32_t>(index.attachments.size());
  statistics.metadata_count = static_cast<std::uint32_t>(index.metadata.size());
  statistics.chunk_count = static_cast<std::uint32_t>(index.chunks.size());
  statistics.start_time = index.chunks.empty() ? 0 : index.chunks.front().start_time;
  statistics.end_time = 0;
  for (const ChunkIndexRecord& chunk : index.chunks) {
    statistics.start_time = std::min(statistics.start_time, chunk.start_time);
    statistics.end_time = std::max(statistics.end_time, chunk.end_time);
  }
  statistics.message_count = 0;
  for (const auto& [channel, count] : statistics.channel_message_counts) statistics.message_count += count;
}

void encode_end(Bytes& out, std::uint64_t file_size, std::uint32_t data_section_crc, const FileIndex& index) {
  encode_data_end(out, data_section_crc);

  const std::size_t summary_at = out.size();
  std::vector<SummaryOffsetRecord> groups;
  encode_group(out, file_size, std::span(index.schemas), groups);
  encode_group(out, file_size, std::span(index.channels), groups);
  encode_group(out, file_size, std::span(index.chunks), groups);
  encode_group(out, file_size, std::span(index.attachments), groups);
  encode_group(out, file_size, std::span(index.metadata), groups);
  encode_group(out, file_size, std::span(&index.statistics, 1), groups);

  const std::size_t offsets_at = out.size();
  for (const SummaryOffsetRecord& group : groups) encode(out, group);

  // the summary's checksum covers the footer up to the checksum itself
  encode(out, FooterRecord{file_size + summary_at, file_size + offsets_at, 0});
  const std::size_t crc_at = out.size() - sizeof(std::uint32_t);
  put_at(out, crc_at, crc32_of(ByteSpan(out).subspan(summary_at, crc_at - summary_at)));
  put_magic(out);
}

bool read_summary(const InputFile& file, FileIndex& index, Damage& damage, Status& status) {
  constexpr std::size_t kEndBytes = kFooterBytes + kMagic.size();
  index = {};
  if (file.size() < kMagic.size() + kEndBytes) {
    damage = {file.size(), "the file ends here, without a footer"};
    return false;
  }
  const std::uint64_t footer_at = file.size() - kEndBytes;
  Bytes end;
  status = file.read(footer_at, kEndBytes, end);
  if (!status.is_ok()) return false;

  Bytes expected_magic;
  put_magic(expected_magic);
  ByteSource source(end);
  const Opcode opcode = Opcode{source.take<std::uint8_t>()};
  const std::uint64_t length = source.take<std::uint64_t>();
  FooterRecord footer;
  const bool is_footer = opcode == Opcode::footer && length == kFooterBytes - kRecordHeadBytes &&
                         decode(source.take_bytes(length), footer) &&
                         std::ranges::equal(source.take_bytes(kMagic.size()), expected_magic);
  if (!is_footer) {
    damage = {file.size(), "the file ends here, without a footer"};
    return false;
  }
  if (footer.summary_start < kMagic.size() || footer.summary_start > footer_at) {
    damage = {footer_at, "the footer points outside of the file"};
    return false;
  }
  // the footer must point behind Data End: this is checked before reading
  constexpr std::size_t kDataEndBytes = kRecordHeadBytes + sizeof(std::uint32_t);
  Bytes data_end;
  if (footer.summary_start < kMagic.size() + kDataEndBytes) {
    damage = {footer_at, "the footer does not point to a summary"};
    return false;
  }
  status = file.read(footer.summary_start - kDataEndBytes, kDataEndBytes, data_end);
  if (!status.is_ok()) return false;
  ByteSource before(data_end);
  if (Opcode{before.take<std::uint8_t>()} != Opcode::data_end ||
      before.take<std::uint64_t>() != sizeof(std::uint32_t)) {
    damage = {std::min(footer_at, footer.summary_start - kDataEndBytes), "here no summary begins"};
    return false;
  }
  Bytes summary;
  status = file.read(footer.summary_start, file.size() - kMagic.size() - footer.summary_start, summary);
  if (!status.is_ok()) return false;
  if (crc32_of(ByteSpan(summary).first(summary.size() - sizeof(std::uint32_t))) != footer.summary_crc) {
    damage = {footer.summary_start, "the checksum of the summary differs"};
    return false;
  }
  const ByteSpan records = ByteSpan(summary).first(footer_at - footer.summary_start);
  return decode_summary(records, footer.summary_start, index, damage);
}

}  // namespace slew::recording
