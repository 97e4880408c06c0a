// SPDX-License-Identifier: Apache-2.0
#include "recording/reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace slew::recording {
namespace {

// Content of the record at an offset from the index; false if the record is not there.
bool read_record(const InputFile& file, std::uint64_t offset, std::uint64_t length, Opcode expected, Bytes& record,
                 ByteSpan& content, Status& status) {
  if (length < kRecordHeadBytes || offset > file.size() || length > file.size() - offset) return false;
  status = file.read(offset, length, record);
  if (!status.is_ok()) return false;
  ByteSource source(record);
  const Opcode opcode = Opcode{source.take<std::uint8_t>()};
  const std::uint64_t content_length = source.take<std::uint64_t>();
  content = source.take_bytes(length - kRecordHeadBytes);
  return source.is_valid() && opcode == expected && content_length == content.size();
}

constexpr std::uint64_t kMarkBytes = kRecordHeadBytes + sizeof(std::uint32_t);

// The Marks in front of and behind a record prove it: the checksum of the first, continued over the record, equals that
// of the second. The file is not read from its beginning.
bool is_between_marks(const InputFile& file, std::uint64_t offset, std::uint64_t length, Status& status) {
  if (offset < kMarkBytes || offset > file.size() || length > file.size() - offset - kMarkBytes) return false;
  Bytes bytes;
  status = file.read(offset - kMarkBytes, length + 2 * kMarkBytes, bytes);
  if (!status.is_ok()) return false;
  const auto mark_at = [&bytes](std::size_t at, std::uint32_t& crc) {
    ByteSource source(ByteSpan(bytes).subspan(at, kMarkBytes));
    const Opcode opcode = Opcode{source.take<std::uint8_t>()};
    const std::uint64_t content = source.take<std::uint64_t>();
    crc = source.take<std::uint32_t>();
    return opcode == Opcode::mark && content == sizeof crc;
  };
  std::uint32_t before = 0, behind = 0;
  return mark_at(0, before) && mark_at(kMarkBytes + length, behind) &&
         crc32_of(ByteSpan(bytes).first(kMarkBytes + length), before) == behind;
}

}  // namespace

Status Reader::open(const std::filesystem::path& path, std::unique_ptr<Reader>& reader) {
  std::unique_ptr<Reader> opened(new Reader);
  Status status = opened->file_.open(path);
  if (status.is_ok()) status = opened->load();
  if (status.is_ok()) reader = std::move(opened);
  return status;
}

Status Reader::not_a_recording(const std::string& problem) const {
  return Status::error(ExitCode::bad_input, fmt::format("{}: cannot be read as a recording: {}; nothing was read; name "
                                                        "the .mcap file that slewring has written",
                                                        path().string(), problem));
}

Status Reader::load() {
  Damage damage;
  Status status;
  std::string problem;
  has_all_messages_ = read_summary(file_, index_, damage, status) && load_metadata(status) &&
                      find_metadata(kIdentityName) != nullptr &&
                      (!damage_ || from_entries(*find_metadata(kIdentityName), identity_, problem));
  if (!status.is_ok()) return status;
  // no usable end: scan every byte
  if (!has_all_messages_) {
    FileScan scan;
    status = scan_file(file_, scan);
    if (!status.is_ok()) return status;
    index_ = std::move(scan.index);
    has_all_messages_ = scan.has_data_end;
    const bool is_loaded = load_metadata(status);
    damage_ = std::move(scan.damage);
    if (!status.is_ok()) return status;
    if (!is_loaded || find_metadata(kIdentityName) == nullptr) {
      return not_a_recording(damage_ ? fmt::format("at byte {} {}", damage_->offset, damage_->text)
                                     : "the identity of its session is missing");
    }
  }
  if (!from_entries(*find_metadata(kIdentityName), identity_, problem)) {
    return Status::error(ExitCode::bad_input, fmt::format("{}: {}", path().string(), problem));
  }
  list_channels();
  return status;
}

bool Reader::load_metadata(Status& status) {
  metadata_.clear();
  damage_.reset();
  Bytes buffer;
  for (const MetadataIndexRecord& index : index_.metadata) {
    ByteSpan content;
    MetadataRecord record;
    if (!read_record(file_, index.offset, index.length, Opcode::metadata, buffer, content, status)) return false;
    if (!decode(content, record)) return false;
    if (!damage_ && !is_between_marks(file_, index.offset, index.length, status)) {
      damage_ = Damage{index.offset, fmt::format("the record '{}' differs from what was written", record.name)};
    }
    if (!status.is_ok()) return false;
    metadata_.push_back(std::move(record));
  }
  return true;
}

void Reader::list_channels() {
  for (const ChannelRecord& record : index_.channels) {
    RecordedChannel channel = {record.id, record.topic, {}, {}, record.message_encoding, record.metadata, 0};
    for (const SchemaRecord& schema : index_.schemas) {
      if (schema.id != record.schema_id) continue;
      channel.type_name = schema.name;
      channel.idl = schema.text;
    }
    const auto count = index_.statistics.channel_message_counts.find(record.id);
    if (count != index_.statistics.channel_message_counts.end()) channel.message_count = count->second;
    channels_.push_back(std::move(channel));
  }
  for (const RecordedChannel& channel : channels_) {
    if (channel.id >= channel_of_id_.size()) channel_of_id_.resize(std::size_t{channel.id} + 1);
    channel_of_id_[channel.id] = &channel;
  }
}

const RecordedChannel* Reader::find_channel(std::string_view topic) const noexcept {
  const auto found =
      std::find_if(channels_.begin(), channels_.end(), [topic](const RecordedChannel& c) { return c.topic == topic; });
  return found == channels_.end() ? nullptr : &*found;
}

const TextMap* Reader::find_metadata(std::string_view name) const noexcept {
  const auto found =
      std::find_if(metadata_.rbegin(), metadata_.rend(), [name](const MetadataRecord& m) { return m.name == name; });
  return found == metadata_.rend() ? nullptr : &found->entries;
}

Status Reader::read_attachment(std::string_view name, Bytes& content) const {
  const auto found = std::find_if(index_.attachments.begin(), index_.attachments.end(),
                                  [name](const AttachmentIndexRecord& a) { return a.name == name; });
  if (found == index_.attachments.end()) {
    return Status::error(ExitCode::bad_input, fmt::format("{}: there is no attachment {}; nothing was read; slewring "
                                                          "info lists them",
                                                          path().string(), name));
  }
  Bytes buffer;
  ByteSpan record;
  AttachmentRecord attachment;
  Status status;
  if (!read_record(file_, found->offset, found->length, Opcode::attachment, buffer, record, status) ||
      !decode_attachment(record, attachment)) {
    if (!status.is_ok()) return status;
    return Status::error(ExitCode::bad_input, fmt::format("{}: attachment {} at byte {} is damaged; it was not read; "
                                                          "look for an intact copy of the file",
                                                          path().string(), name, found->offset));
  }
  content.assign(attachment.content.begin(), attachment.content.end());
  return status;
}

std::string Reader::damage_text() const {
  if (!damage_) return {};
  return fmt::format("{}: at byte {} of {} {}; {} messages until {:.6f} s are readable{}", path().string(),
                     damage_->offset, file_.size(), damage_->text, statistics().message_count,
                     SimTime{static_cast<std::int64_t>(statistics().end_time)}.seconds(),
                     has_all_messages_ ? ", which is all of them" : "");
}

Status Reader::for_each(const MessageFilter& filter, const std::function<Visit(const RecordedMessage&)>& visit) const {
  MessageCursor cursor(*this, filter);
  RecordedMessage message;
  while (cursor.next(message)) {
    if (visit(message) == Visit::stop) break;
  }
  return cursor.status();
}

Status Reader::verify() const {
  FileScan scan;
  Status status = scan_file(file_, scan);
  if (!status.is_ok() || !scan.damage) return status;
  return Status::error(ExitCode::bad_input,
                       fmt::format("{}: at byte {} of {} {}; {} messages in front of it are as they were written; look "
                                   "for an intact copy of the file",
                                   path().string(), scan.damage->offset, file_.size(), scan.damage->text,
                                   scan.index.statistics.message_count));
}

MessageCursor::MessageCursor(const Reader& reader, const MessageFilter& filter)
    : reader_(reader),
      from_ns_(filter.from_ns),
      to_ns_(filter.to_ns),
      is_channel_wanted_(reader.channel_of_id_.size(), false) {
  for (const RecordedChannel& channel : reader.channels_) {
    const bool is_named = std::find(filter.topics.begin(), filter.topics.end(), channel.topic) != filter.topics.end();
    is_channel_wanted_[channel.id] = filter.topics.empty() || is_named;
  }
}

// Chunks in columns have no message index; their channels are the first bytes of their content.
bool MessageCursor::has_wanted_column(const ChunkIndexRecord& chunk) {
  constexpr std::size_t kHeadBytes = kRecordHeadBytes + 3 * sizeof(std::uint64_t) + sizeof(std::uint32_t) +
                                     sizeof(std::uint32_t) + kColumns.size() + sizeof(std::uint64_t);
  const std::uint64_t size = std::min<std::uint64_t>(chunk.length, kHeadBytes + kColumnsFrontBytes);
  // whatever is wrong here is found and named when the chunk is read
  if (size <= kHeadBytes || !reader_.file_.read(chunk.offset, size, record_).is_ok()) return true;
  if (!channels_of_columns(ByteSpan(record_).subspan(kHeadBytes), chunk_channels_)) return true;
  return std::any_of(chunk_channels_.begin(), chunk_channels_.end(), [this](std::uint16_t channel) {
    return channel >= is_channel_wanted_.size() || is_channel_wanted_[channel];
  });
}

bool MessageCursor::is_wanted(const ChunkIndexRecord& chunk) {
  if (chunk.end_time < from_ns_ || chunk.start_time > to_ns_) return false;
  if (chunk.compression == kColumns) return has_wanted_column(chunk);
  if (chunk.message_index_offsets.empty()) return true;  // unknown
  return std::any_of(chunk.message_index_offsets.begin(), chunk.message_index_offsets.end(), [this](const auto& entry) {
    // an undeclared channel is not skipped here: reading the chunk names it
    return entry.first >= is_channel_wanted_.size() || is_channel_wanted_[entry.first];
  });
}

bool MessageCursor::damaged(std::uint64_t offset, const std::string& problem) {
  if (status_.is_ok()) {
    status_ = Status::error(ExitCode::bad_input,
                            fmt::format("{}: at byte {} of {} {}; the messages in front of it were read; look for an "
                                        "intact copy of the file",
                                        reader_.path().string(), offset, reader_.file_.size(), problem));
  }
  records_ = ChunkRecords(ByteSpan{});
  next_chunk_ = reader_.index_.chunks.size();
  return false;
}

bool MessageCursor::open_next_chunk() {
  const std::vector<ChunkIndexRecord>& chunks = reader_.index_.chunks;
  while (next_chunk_ < chunks.size() && !is_wanted(chunks[next_chunk_])) ++next_chunk_;
  if (next_chunk_ >= chunks.size()) return false;
  const ChunkIndexRecord& index = chunks[next_chunk_++];
  ByteSpan content;
  ChunkRecord chunk;
  if (!read_record(reader_.file_, index.offset, index.length, Opcode::chunk, record_, content, status_) ||
      !decode_chunk(content, chunk)) {
    return damaged(index.offset, "a chunk is not well formed");
  }
  std::string problem;
  ChunkContents contents;
  const auto is_known = [this](std::uint16_t id) {
    return id < reader_.channel_of_id_.size() && reader_.channel_of_id_[id] != nullptr;
  };
  if (!chunk_reader_.unpack(chunk, unpacked_, problem) || !examine(unpacked_, is_known, contents, problem)) {
    return damaged(index.offset, problem);
  }
  records_ = ChunkRecords(unpacked_);
  return true;
}

bool MessageCursor::next(RecordedMessage& message) {
  while (true) {
    Opcode opcode = Opcode::invalid;
    ByteSpan content;
    if (!records_.next(opcode, content)) {
      if (!open_next_chunk()) return false;
      continue;
    }
    MessageRecord record;
    if (opcode != Opcode::message || !decode_message(content, record)) continue;
    if (!is_channel_wanted_[record.channel_id] || record.log_time < from_ns_ || record.log_time > to_ns_) continue;
    message = {reader_.channel_of_id_[record.channel_id], record.sequence, record.log_time, record.publish_time,
               record.payload};
    return true;
  }
}

}  // namespace slew::recording
