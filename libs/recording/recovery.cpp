// SPDX-License-Identifier: Apache-2.0
#include "recording/recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "recording/chunk_reader.h"
#include "recording/output_file.h"
#include "recording/reader.h"
#include "recording/summary.h"

namespace slew::recording {
namespace {

class Copy {
 public:
  Copy(const InputFile& from, OutputFile& to) : from_(from), to_(to) {}

  Status start(const std::string& library) {
    buffer_.clear();
    put_magic(buffer_);
    encode(buffer_, HeaderRecord{kProfile, library});
    return to_.append_marked(buffer_);
  }

  Status take(const ProvedRecord& record) {
    const Status status = from_.read(record.offset, record.length, buffer_);
    if (!status.is_ok()) return status;
    const ByteSpan content = ByteSpan(buffer_).subspan(kRecordHeadBytes);
    switch (record.opcode) {
      case Opcode::metadata:
        return take_metadata(content);
      case Opcode::attachment:
        return take_attachment(content);
      case Opcode::schema:
        return take_schema(content);
      case Opcode::channel:
        return take_channel(content);
      case Opcode::chunk:
        return take_chunk(content);
      default:
        return Status::ok();  // the header is rewritten
    }
  }

  Status add_metadata(const char* name, const TextMap& entries) {
    buffer_.clear();
    encode(buffer_, MetadataRecord{name, entries});
    index_.metadata.push_back({to_.size(), buffer_.size(), name});
    return to_.append_marked(buffer_);
  }

  Status finish() {
    complete_statistics(index_);
    buffer_.clear();
    encode_end(buffer_, to_.size(), to_.crc(), index_);
    const Status status = to_.append(buffer_);
    return status.is_ok() ? to_.close() : status;
  }

  [[nodiscard]] const StatisticsRecord& statistics() {
    complete_statistics(index_);
    return index_.statistics;
  }
  [[nodiscard]] std::size_t lost_channels() const noexcept { return lost_channels_; }

 private:
  // the end of the session and an earlier recovery do not apply to this file
  Status take_metadata(ByteSpan content) {
    MetadataRecord record;
    if (!decode(content, record) || record.name == kSummaryName || record.name == kRecoveryName) {
      return Status::ok();
    }
    // the first of several records is the one read
    if (record.name == kIdentityName && std::exchange(has_identity_, true)) return Status::ok();
    index_.metadata.push_back({to_.size(), buffer_.size(), record.name});
    return to_.append_marked(buffer_);
  }

  Status take_attachment(ByteSpan content) {
    AttachmentRecord record;
    if (!decode_attachment(content, record)) return Status::ok();
    index_.attachments.push_back({to_.size(), buffer_.size(), record.log_time, record.create_time,
                                  record.content.size(), std::string(record.name), std::string(record.media_type)});
    return to_.append_marked(buffer_);
  }

  Status take_schema(ByteSpan content) {
    SchemaRecord record;
    const auto same = [&](const SchemaRecord& known) { return known.id == record.id; };
    if (!decode(content, record) || std::ranges::any_of(index_.schemas, same)) return Status::ok();
    index_.schemas.push_back(std::move(record));
    return to_.append_marked(buffer_);
  }

  Status take_channel(ByteSpan content) {
    ChannelRecord record;
    if (!decode(content, record) || is_known(record.id)) return Status::ok();
    const auto same = [&](const SchemaRecord& known) { return known.id == record.schema_id; };
    if (std::ranges::none_of(index_.schemas, same)) record.schema_id = 0;  // none
    return add_channel(std::move(record));
  }

  Status add_channel(ChannelRecord record) {
    Bytes bytes;
    encode(bytes, record);
    index_.channels.push_back(std::move(record));
    return to_.append_marked(bytes);
  }

  [[nodiscard]] bool is_known(std::uint16_t id) const {
    return std::ranges::any_of(index_.channels, [id](const ChannelRecord& channel) { return channel.id == id; });
  }

  Status take_chunk(ByteSpan content) {
    ChunkRecord chunk;
    std::string problem;
    ChunkContents contents;
    const auto is_any = [](std::uint16_t) { return true; };
    if (!decode_chunk(content, chunk) || !reader_.unpack(chunk, unpacked_, problem) ||
        !examine(unpacked_, is_any, contents, problem)) {
      return Status::ok();
    }
    for (const auto& [id, count] : contents.message_counts) {
      if (is_known(id)) continue;
      ++lost_channels_;
      const Status status = add_channel({id, 0, kLostChannelTopic + std::to_string(id), "cdr", {}});
      if (!status.is_ok()) return status;
    }
    // the head's times have no checksum
    put_at(buffer_, kRecordHeadBytes, contents.start_time);
    put_at(buffer_, kRecordHeadBytes + sizeof contents.start_time, contents.end_time);
    ChunkIndexRecord index;
    index.start_time = contents.start_time;
    index.end_time = contents.end_time;
    index.offset = to_.size();
    index.length = buffer_.size();
    index.compression = chunk.compression;
    index.compressed_size = chunk.records.size();
    index.uncompressed_size = chunk.uncompressed_size;
    if (chunk.compression != kColumns) add_message_indexes(index);
    for (const auto& [id, count] : contents.message_counts) index_.statistics.channel_message_counts[id] += count;
    index_.chunks.push_back(std::move(index));
    return to_.append_marked(buffer_);
  }

  // behind the chunk in the buffer
  void add_message_indexes(ChunkIndexRecord& index) {
    std::map<std::uint16_t, std::vector<MessageIndexEntry>> entries;
    ChunkRecords records(unpacked_);
    Opcode opcode = Opcode::invalid;
    ByteSpan content;
    while (records.next(opcode, content)) {
      MessageRecord message;
      if (opcode != Opcode::message || !decode_message(content, message)) continue;
      const auto at = static_cast<std::uint64_t>(content.data() - unpacked_.data()) - kRecordHeadBytes;
      entries[message.channel_id].push_back({message.log_time, at});
    }
    const std::size_t begin = buffer_.size();
    for (const auto& [id, of_channel] : entries) {
      index.message_index_offsets[id] = to_.size() + buffer_.size();
      encode_message_index(buffer_, id, of_channel);
    }
    index.message_index_length = buffer_.size() - begin;
  }

  const InputFile& from_;
  OutputFile& to_;
  FileIndex index_;
  ChunkReader reader_;
  Bytes buffer_;
  Bytes unpacked_;
  bool has_identity_ = false;
  std::size_t lost_channels_ = 0;
};

// The record with the session's identity, and the library that wrote it.
Status read_identity(const InputFile& file, const Salvage& salvage, SessionIdentity& identity, std::string& library) {
  library = "slewring";
  Bytes bytes;
  for (const ProvedRecord& record : salvage.records) {
    if (record.opcode != Opcode::metadata && record.opcode != Opcode::header) continue;
    const Status status = file.read(record.offset + kRecordHeadBytes, record.length - kRecordHeadBytes, bytes);
    if (!status.is_ok()) return status;
    HeaderRecord header;
    if (record.opcode == Opcode::header && decode(bytes, header)) library = header.library;
    MetadataRecord metadata;
    if (record.opcode != Opcode::metadata || !decode(bytes, metadata) || metadata.name != kIdentityName) {
      continue;
    }
    std::string problem;
    if (from_entries(metadata.entries, identity, problem)) return Status::ok();
    return Status::error(ExitCode::bad_input, fmt::format("{}: {}", file.path().string(), problem));
  }
  const std::uint64_t at = salvage.lost.empty() ? file.size() : salvage.lost.front().offset;
  return Status::error(
      ExitCode::bad_input,
      fmt::format("{}: recovery is not possible: from byte {} of {} on the record with the identity of "
                  "its session is lost; nothing was written; look for an intact copy of the file",
                  file.path().string(), at, file.size()));
}

TextMap entries_of(const Recovery& recovery, const InputFile& from) {
  TextMap entries;
  entries["from"] = from.path().filename().string();
  entries["from_bytes"] = fmt::to_string(from.size());
  entries["was_cut"] = recovery.was_cut ? "yes" : "no";
  std::uint64_t bytes = 0;
  std::string places;
  for (const LostBytes& lost : recovery.lost) {
    bytes += lost.size;
    places += fmt::format("{}{} bytes at byte {}", places.empty() ? "" : ", ", lost.size, lost.offset);
  }
  entries["lost_bytes"] = fmt::to_string(bytes);
  entries["lost"] = places;
  return entries;
}

bool is_whole(const InputFile& file, const Salvage& salvage, Status& status) {
  FileIndex ignored;
  Damage damage;
  return salvage.has_data_end && !salvage.is_damaged && salvage.lost.empty() &&
         read_summary(file, ignored, damage, status);
}

}  // namespace

Status recover(const std::filesystem::path& from, const std::filesystem::path& to, Recovery& recovery) {
  recovery = {};
  InputFile file;
  Status status = file.open(from);
  Salvage salvage;
  if (status.is_ok()) status = salvage_file(file, salvage);
  std::string library;
  if (status.is_ok()) status = read_identity(file, salvage, recovery.identity, library);
  if (!status.is_ok()) return status;
  recovery.lost = salvage.lost;
  recovery.was_cut = !salvage.has_data_end;
  recovery.was_whole = is_whole(file, salvage, status);
  if (!status.is_ok() || recovery.was_whole) return status;

  OutputFile out;
  status = out.create(to);
  if (!status.is_ok()) return status;
  Copy copy(file, out);
  status = copy.start(library);
  for (const ProvedRecord& record : salvage.records) {
    if (status.is_ok()) status = copy.take(record);
  }
  if (status.is_ok()) status = copy.add_metadata(kRecoveryName, entries_of(recovery, file));
  if (status.is_ok()) status = copy.finish();
  if (!status.is_ok()) {
    std::error_code ignored;
    std::filesystem::remove(to, ignored);
    status.text += fmt::format("; the new file was removed again, {} is as it was", from.string());
    return status;
  }
  recovery.chunks = copy.statistics().chunk_count;
  recovery.messages = copy.statistics().message_count;
  recovery.end_time = copy.statistics().end_time;
  recovery.lost_channels = copy.lost_channels();
  return status;
}

}  // namespace slew::recording
