// SPDX-License-Identifier: Apache-2.0
#include "recording/writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "recording/reader.h"

namespace slew::recording {
namespace {

constexpr const char* kSchemaEncoding = "omgidl";
constexpr const char* kMessageEncoding = "cdr";

// times stay below 2^62 ns (146 years), so that sums of two fit
constexpr std::int64_t kMostNanoseconds = std::int64_t{1} << 62;

}  // namespace

Writer::Writer(const SessionIdentity& identity, const WriterLimits& limits, FileCalls& calls)
    : limits_(limits),
      communication_step_(identity.communication_step),
      file_(calls, limits.backlog_bytes),
      window_(limits.window_steps, limits.window_bytes, limits.window_messages),
      chunk_(limits.chunk_bytes, limits.compression_level, limits.coding) {}

Writer::~Writer() {
  if (file_.is_open()) std::ignore = close({});
}

Status Writer::create(const std::filesystem::path& path, const SessionIdentity& identity, const WriterLimits& limits,
                      std::unique_ptr<Writer>& writer, FileCalls& calls) {
  if (identity.communication_step.ns < 1) {
    return Status::error(ExitCode::bad_input, fmt::format("{}: a recording needs the session's communication step; "
                                                          "nothing was written; give a step of at least 1 ns",
                                                          path.string()));
  }
  std::unique_ptr<Writer> created(new Writer(identity, limits, calls));
  Status status = created->file_.create(path);
  if (!status.is_ok()) return status;
  status = created->write_front(identity);
  if (!status.is_ok()) return status;
  writer = std::move(created);
  return status;
}

Status Writer::write_front(const SessionIdentity& identity) {
  buffer_.clear();
  put_magic(buffer_);
  encode(buffer_, HeaderRecord{kProfile, fmt::format("slewring {}", identity.build)});
  const Status status = append_marked();
  if (!status.is_ok()) return status;
  SessionIdentity written = identity;
  const bool is_reduced = limits_.coding == ChunkCoding::columns || identity.steps != RecordedSteps::all;
  written.format_version = is_reduced ? kReducedFormatVersion : kFirstFormatVersion;
  return add_metadata(kIdentityName, to_entries(written));
}

Status Writer::remember(Status status) {
  if (!status.is_ok() && failure_.is_ok()) {
    failure_ = status;
    roll_back();
  }
  return status;
}

Status Writer::append_marked(std::uint64_t room_behind) {
  return remember(file_.append_marked(buffer_, room_behind));
}

// Upper bound of the end's size: a full disk must leave room for the end behind the last chunk.
std::uint64_t Writer::room_for_end() const noexcept {
  constexpr std::uint64_t kSummaryBytes = 16 * 1024;  // metadata, statistics, offsets, footer
  const std::uint64_t chunk_index = 128 + 10 * index_.channels.size();
  return declared_bytes_ + kSummaryBytes + (index_.chunks.size() + 1) * chunk_index;
}

Status Writer::add_attachment(std::string_view name, std::string_view media_type, ByteSpan content) {
  if (!failure_.is_ok()) return failure_;
  if (content.size() > kMaxAttachmentBytes) {
    return Status::error(ExitCode::bad_input,
                         fmt::format("{}: {} has {} bytes and an attachment at most {}; it was left out of the "
                                     "recording",
                                     path().string(), name, content.size(), kMaxAttachmentBytes));
  }
  buffer_.clear();
  encode_attachment(buffer_, {last_log_time_, 0, name, media_type, content});
  const AttachmentIndexRecord index = {file_.size(),   buffer_.size(),    last_log_time_,         0,
                                       content.size(), std::string(name), std::string(media_type)};
  Status status = append_marked();
  if (status.is_ok()) index_.attachments.push_back(index);
  return status;
}

Status Writer::add_metadata(std::string_view name, const TextMap& entries) {
  if (!failure_.is_ok()) return failure_;
  buffer_.clear();
  encode(buffer_, MetadataRecord{std::string(name), entries});
  const MetadataIndexRecord index = {file_.size(), buffer_.size(), std::string(name)};
  Status status = append_marked();
  if (status.is_ok()) index_.metadata.push_back(index);
  return status;
}

Status Writer::schema_of(const ChannelDef& channel, std::uint16_t& id) {
  const auto same = std::find_if(index_.schemas.begin(), index_.schemas.end(), [&](const SchemaRecord& schema) {
    return schema.name == channel.type_name && schema.text == channel.idl;
  });
  if (same != index_.schemas.end()) {
    id = same->id;
    return Status::ok();
  }
  id = static_cast<std::uint16_t>(index_.schemas.size() + 1);
  SchemaRecord schema = {id, channel.type_name, kSchemaEncoding, channel.idl};
  buffer_.clear();
  encode(buffer_, schema);
  Status status = append_marked();
  declared_bytes_ += buffer_.size();
  if (status.is_ok()) index_.schemas.push_back(std::move(schema));
  return status;
}

Status Writer::add_channel(const ChannelDef& channel, ChannelId& id) {
  if (!failure_.is_ok()) return failure_;
  if (index_.channels.size() >= kMaxChannels) {
    return Status::error(ExitCode::bad_input, fmt::format("{}: a recording has at most {} channels; {} is left out",
                                                          path().string(), kMaxChannels, channel.topic));
  }
  ChannelRecord record = {static_cast<std::uint16_t>(index_.channels.size()), 0, channel.topic, kMessageEncoding,
                          channel.metadata};
  Status status = schema_of(channel, record.schema_id);
  if (!status.is_ok()) return status;
  buffer_.clear();
  encode(buffer_, record);
  status = append_marked();
  if (!status.is_ok()) return status;
  declared_bytes_ += buffer_.size();
  id = ChannelId{record.id};
  index_.channels.push_back(std::move(record));
  pending_counts_.push_back(0);
  return status;
}

Status Writer::write(ChannelId channel, const MessageStamp& stamp, ByteSpan payload) {
  if (!failure_.is_ok()) {
    ++counts_.lost_messages;
    return failure_;
  }
  const std::uint16_t id = static_cast<std::uint16_t>(channel);
  if (id >= index_.channels.size() || payload.size() > kMaxMessageBytes || stamp.step < kJoinStep ||
      stamp.step > kMostNanoseconds / communication_step_.ns) {
    return Status::error(ExitCode::failed,
                         fmt::format("{}: a message of channel {}, step {}, {} bytes cannot be recorded; it was left "
                                     "out; please report it",
                                     path().string(), id, stamp.step, payload.size()));
  }
  SortWindow::PushResult result = window_.push(stamp, id, payload);
  Status status;
  while (result != SortWindow::PushResult::taken && !window_.is_empty() && status.is_ok()) {
    status = emit_first();
    result = window_.push(stamp, id, payload);
  }
  if (result != SortWindow::PushResult::taken) {
    // the message exceeds the empty window, or the recording has just failed
    if (status.is_ok()) return emit(stamp, id, payload);
    ++counts_.lost_messages;
  }
  while (status.is_ok() && window_.is_first_due()) status = emit_first();
  return status;
}

Status Writer::emit_first() {
  const WindowEntry& entry = window_.first();
  const Status status = emit(entry.stamp, entry.channel, window_.payload_of(entry));
  window_.pop_first();
  return status;
}

std::uint64_t Writer::log_time_of(const MessageStamp& stamp) {
  // a new epoch begins one step behind the last time of the one before
  auto start = epoch_start_.find(stamp.epoch);
  if (start == epoch_start_.end()) {
    EpochStart begin;
    if (!epoch_start_.empty()) {
      begin.time = last_log_time_ + static_cast<std::uint64_t>(communication_step_.ns);
      const auto first = first_steps_.find(stamp.epoch);
      if (first != first_steps_.end()) begin.step = first->second;
    }
    start = epoch_start_.emplace(stamp.epoch, begin).first;
  }
  const SimTime since_begin = start_of(std::max<StepIndex>(stamp.step - start->second.step, 0), communication_step_);
  return start->second.time + static_cast<std::uint64_t>(since_begin.ns);
}

Status Writer::emit(const MessageStamp& stamp, std::uint16_t channel, ByteSpan payload) {
  const std::uint64_t log_time = log_time_of(stamp);
  const std::uint64_t publish_time =
      stamp.publish_time_ns > 0 ? static_cast<std::uint64_t>(stamp.publish_time_ns) : log_time;
  return put_message({channel, stamp.sequence, log_time, publish_time, payload});
}

Status Writer::append(ChannelId channel, const RecordedMessage& message) {
  if (!failure_.is_ok()) {
    ++counts_.lost_messages;
    return failure_;
  }
  const std::uint16_t id = static_cast<std::uint16_t>(channel);
  if (id >= index_.channels.size() || message.payload.size() > kMaxMessageBytes) {
    return Status::error(ExitCode::failed, fmt::format("{}: a message of channel {} with {} bytes cannot be copied; "
                                                       "please report it",
                                                       path().string(), id, message.payload.size()));
  }
  return put_message({id, message.sequence, message.log_time_ns, message.publish_time_ns, message.payload});
}

Status Writer::put_message(const MessageRecord& message) {
  if (message.log_time < last_log_time_) ++counts_.late_messages;
  last_log_time_ = std::max(last_log_time_, message.log_time);
  chunk_.add(message);
  counts_.payload_bytes += message.payload.size();
  ++pending_counts_[message.channel_id];
  return chunk_.uncompressed_size() >= limits_.chunk_bytes ? write_chunk() : Status::ok();
}

Status Writer::write_chunk() {
  if (chunk_.is_empty()) return Status::ok();
  ChunkIndexRecord chunk;
  buffer_.clear();
  Status status = remember(chunk_.finish(buffer_, file_.size(), chunk));
  if (status.is_ok()) status = append_marked(room_for_end());
  const bool is_written = status.is_ok();
  if (is_written && limits_.backlog_bytes > 0) {
    forget_written();
    handed_over_.push_back({file_.size(), chunk.start_time, pending_counts_});
  }
  for (std::size_t channel = 0; channel < pending_counts_.size(); ++channel) {
    const std::uint64_t count = std::exchange(pending_counts_[channel], 0);
    (is_written ? counts_.messages : counts_.lost_messages) += count;
    if (is_written && count > 0) {
      index_.statistics.channel_message_counts[static_cast<std::uint16_t>(channel)] += count;
    }
  }
  if (!is_written) {
    note_lost(chunk.start_time);
    return status;
  }
  index_.chunks.push_back(std::move(chunk));
  ++counts_.chunks;
  return status;
}

void Writer::forget_written() {
  const std::uint64_t written = file_.written();
  while (!handed_over_.empty() && handed_over_.front().end <= written) handed_over_.pop_front();
}

// messages that were handed over and did not reach the file
void Writer::roll_back() {
  forget_written();
  for (const HandedOver& chunk : handed_over_) {
    note_lost(chunk.start_time);
    for (std::size_t channel = 0; channel < chunk.counts.size(); ++channel) {
      counts_.messages -= chunk.counts[channel];
      counts_.lost_messages += chunk.counts[channel];
      if (chunk.counts[channel] > 0) {
        index_.statistics.channel_message_counts[static_cast<std::uint16_t>(channel)] -= chunk.counts[channel];
      }
    }
    --counts_.chunks;
  }
  handed_over_.clear();
  const auto is_lost = [this](const auto& entry) { return entry.offset >= file_.size(); };
  std::erase_if(index_.chunks, is_lost);
  std::erase_if(index_.metadata, is_lost);
  std::erase_if(index_.attachments, is_lost);
}

void Writer::note_lost(std::uint64_t log_time) {
  if (first_lost_step_) return;
  // place in the newest epoch that begins at or before that time
  EpochStart newest;
  for (const auto& [epoch, start] : epoch_start_) {
    if (start.time <= log_time && start.time >= newest.time) newest = start;
  }
  first_lost_step_ = newest.step + static_cast<StepIndex>((log_time - newest.time) /
                                                          static_cast<std::uint64_t>(communication_step_.ns));
}

std::uint64_t Writer::messages_in_file(ChannelId channel) const {
  const auto& counts = index_.statistics.channel_message_counts;
  const auto found = counts.find(static_cast<std::uint16_t>(channel));
  return found == counts.end() ? 0 : found->second;
}

Status Writer::flush_if_due(std::int64_t monotonic_ns) {
  if (!failure_.is_ok()) return failure_;
  if (!last_flush_ns_) last_flush_ns_ = monotonic_ns;
  if (monotonic_ns - *last_flush_ns_ < limits_.flush_period.ns) return Status::ok();
  last_flush_ns_ = monotonic_ns;
  // a step that was present one period ago is complete now
  Status status;
  while (status.is_ok() && window_.is_first_up_to(flushed_epoch_, flushed_step_)) status = emit_first();
  flushed_epoch_ = window_.newest_epoch();
  flushed_step_ = window_.newest_step();
  return status.is_ok() ? write_chunk() : status;
}

Status Writer::flush() {
  if (!failure_.is_ok()) return failure_;
  Status status;
  while (status.is_ok() && !window_.is_empty()) status = emit_first();
  if (status.is_ok()) status = write_chunk();
  return status.is_ok() ? settle() : status;
}

Status Writer::settle() {
  return failure_.is_ok() ? remember(file_.drain()) : failure_;
}

Status Writer::close(const TextMap& summary) {
  if (!file_.is_open()) return failure_;
  if (failure_.is_ok()) std::ignore = flush();
  for (; !window_.is_empty(); window_.pop_first()) ++counts_.lost_messages;
  const Status end = write_end(summary);
  const Status closed = file_.close();
  if (!failure_.is_ok()) return failure_;
  return remember(end.is_ok() ? closed : end);
}

Status Writer::write_end(const TextMap& summary) {
  // after a failure there may be room for the small end, even if not for a chunk
  Bytes metadata;
  if (!summary.empty()) {
    encode(metadata, MetadataRecord{kSummaryName, summary});
    const MetadataIndexRecord index = {file_.size(), metadata.size(), kSummaryName};
    const Status status = file_.append_marked(metadata);
    if (!status.is_ok()) return status;
    index_.metadata.push_back(index);
  }
  complete_statistics(index_);
  buffer_.clear();
  encode_end(buffer_, file_.size(), file_.crc(), index_);
  return file_.append(buffer_);
}

}  // namespace slew::recording
