// SPDX-License-Identifier: Apache-2.0
// RecorderNode's part that writes the file: its front, its messages, the gaps of a slow or full disk, its end.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <tuple>

#include "core/state_hash.h"
#include "recorder_node/recorder_node.h"
#include "recording/run_directory.h"
#include "transport/cdr/sample_state.h"
#include "transport/idl_text.h"
#include "transport/topics.h"

namespace slew::recorder_node {

using node::to_text;
using wire::Topic;

namespace {

std::string end_text(const SessionEnd& session) {
  if (!session.reason.empty()) return session.reason;
  switch (session.code) {
    case ExitCode::ok:
      return "in order";
    case ExitCode::interrupted:
      return "interrupted by SIGINT";
    case ExitCode::terminated:
      return "terminated by SIGTERM";
    default:
      return "failed";
  }
}

std::string manifest_text(const wire::SessionDescription& session) {
  std::string text = "[";
  for (const wire::Asset& asset : session.assets) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string sum;
    for (const std::uint8_t byte : asset.sha256) sum += {kDigits[byte >> 4], kDigits[byte & 15]};
    text += (text.size() > 1 ? ",\n " : "") + std::string("{\"name\": \"") + asset.name +
            "\", \"size\": " + std::to_string(asset.size) + ", \"sha256\": \"" + sum + "\"}";
  }
  return text + "]\n";
}

recording::ByteSpan bytes_of(const std::string& text) {
  return std::as_bytes(std::span<const char>(text.data(), text.size()));
}

}  // namespace

Status RecorderNode::create(const wire::SessionDescription& session) {
  RecordedPart part;
  if (config_.part) {
    if (const Status known = config_.part(session, part); !known.is_ok()) return known;
  }
  std::filesystem::path directory;
  Status status =
      recording::create_run_directory(config_.runs_directory, session.scene_name, session.started_ns, directory);
  if (!status.is_ok()) return status;
  status = problem_of_room(directory);
  if (!status.is_ok()) {
    std::error_code ignored;
    std::filesystem::remove(directory, ignored);
    return status;
  }
  const std::filesystem::path path = directory / recording::kRecordingFileName;
  recording::SessionIdentity identity;
  identity.scene = session.scene_name;
  identity.session_name = session.name;
  identity.session_id = to_text(session.header.session);
  identity.build = session.build;
  identity.communication_step = {session.step_ns};
  identity.started_ns = session.started_ns;
  identity.more["pace"] = session.pace == Pace::free ? "free" : "real";
  identity.more["protocol"] = std::to_string(session.protocol);
  selection_ = Selection(part);
  identity.steps = selection_.part().steps;
  recording::WriterLimits limits = config_.limits;
  limits.coding = selection_.part().coding;
  if (limits.coding == recording::ChunkCoding::columns) {
    limits.flush_period = kColumnsFlushPeriod;
    limits.compression_level = kColumnsLevel;
  }
  status = recording::Writer::create(path, identity, limits, writer_, *config_.file_calls);
  if (!status.is_ok()) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    std::filesystem::remove(directory, ignored);
    return status;
  }
  path_ = path;
  ticks_.emplace(identity.communication_step);
  status = add_attachments(session);
  for (std::size_t i = 0; status.is_ok() && i < wire::kTopics; ++i) {
    const recording::ChannelDef channel{std::string(to_text(static_cast<Topic>(i))),
                                        transport::traits(static_cast<Topic>(i)).type_name,
                                        std::string(transport::idl_text()),
                                        {}};
    status = writer_->add_channel(channel, channels_[i]);
  }
  if (status.is_ok() && identity.steps == recording::RecordedSteps::ticks) {
    status = writer_->add_channel(
        {recording::kStateHashesTopic, recording::kStateHashesType, recording::kStateHashesIdl, {}}, hashes_channel_);
  }
  // if the front cannot be written, the session does not begin
  return status.is_ok() ? writer_->settle() : status;
}

Status RecorderNode::add_attachments(const wire::SessionDescription& session) {
  Status status = writer_->add_attachment("scene.yaml", "application/yaml", bytes_of(session.scene_text));
  if (status.is_ok()) {
    status = writer_->add_attachment("manifest.json", "application/json", bytes_of(manifest_text(session)));
  }
  if (status.is_ok()) status = writer_->add_attachment("build.txt", "text/plain", bytes_of(session.build + "\n"));
  return status;
}

void RecorderNode::write(const transport::Received& message, std::uint32_t epoch, StepIndex step,
                         std::uint32_t sequence) {
  const node::DiskWait disk(health());
  const auto topic = static_cast<std::size_t>(message.topic);
  if (!stopped_.is_ok()) {
    ++counts_[topic].lost;
    return;
  }
  has_step_ = has_step_ || message.topic == Topic::tick;
  const Selection::Stored stored = selection_.take(message);
  if (stored.hashes) write_hashes(*stored.hashes);
  if (stored.bytes.empty() || !stopped_.is_ok()) return count(message);
  if (is_left_out(message.topic, step, epoch)) {
    ++counts_[topic].lost;
    return;
  }
  const Status status = writer_->write(
      channels_[topic], {epoch, step, sequence, selection_.publish_time(message.source_ns)}, stored.bytes);
  if (status.is_ok()) {
    ++counts_[topic].recorded;
    count(message);
  } else if (status.code == ExitCode::failed) {
    // no recording can hold this message; the session goes on
    ++counts_[topic].lost;
  } else {
    ++counts_[topic].lost;
    stop_recording(status);
  }
}

// The digests of samples that are not stored. A failure is found by the next message that is.
void RecorderNode::write_hashes(const recording::StateHashes& hashes) {
  recording::encode_state_hashes(hashes, hashes_bytes_);
  const recording::MessageStamp stamp{hashes.epoch, hashes.last_step, hashes.role, 0};
  const Status status = writer_->write(hashes_channel_, stamp, hashes_bytes_);
  if (!status.is_ok()) stop_recording(status);
}

void RecorderNode::count(const transport::Received& message) {
  switch (message.topic) {
    case Topic::tick:
      if (!transport::decode(message.bytes, tick_)) return;
      ticks_->take(tick_.header, tick_.flags);
      return ticks_->take_time(message.source_ns);
    case Topic::node_status:
      if (transport::decode(message.bytes, status_)) ticks_->take_status(status_, message.source_ns);
      return;
    case Topic::mechanism:
    case Topic::actuators:
    case Topic::sensors: {
      wire::Header header;
      wire::SampleState state;
      if (transport::decode_sample_state(message.bytes, header, state)) flags_.take(header, state);
      return;
    }
    case Topic::variables:
      variables_digest_ += digest_of(message.bytes);
      return;
    default:
      return;
  }
}

// In real pace no node waits for the recorder: messages beyond the disk's rate are left out, variables and health
// first.
bool RecorderNode::is_left_out(Topic topic, StepIndex step, std::uint32_t epoch) {
  const std::size_t most = config_.limits.backlog_bytes;
  if (most == 0) return false;
  const std::size_t waiting = writer_->backlog_bytes();
  const bool is_full = waiting + config_.limits.chunk_bytes > most;
  if (member_.session().pace == Pace::free) {
    if (is_full && !std::exchange(has_warned_of_waiting_, true)) {
      std::fprintf(stderr,
                   "recorder: warning: the disk is slower than the session, which waits for it from step %lld on; "
                   "nothing is lost; record elsewhere with --out DIR, or less with recording.every\n",
                   static_cast<long long>(step));
    }
    return false;
  }
  const bool is_slow = is_full || waiting > most / 2 || (gap_ && waiting > most / 4);
  if (!is_slow) {
    end_gap();
    return false;
  }
  const bool is_visual = topic == Topic::variables || topic == Topic::health;
  if (!is_visual && !is_full) return false;
  if (!gap_) {
    gap_ = Gap{epoch, step, step, {}};
    std::fprintf(stderr,
                 "recorder: warning: the disk is slower than the session; from step %lld on variables are left out of "
                 "the recording, and steps too when that is not enough; record elsewhere with --out DIR, or less with "
                 "recording.every\n",
                 static_cast<long long>(step));
  }
  if (gap_->epoch == epoch) gap_->to = std::max(gap_->to, step);
  ++gap_->messages[static_cast<std::size_t>(topic)];
  return true;
}

void RecorderNode::end_gap() {
  if (const auto gap = std::exchange(gap_, std::nullopt)) mark(*gap, "the disk was slower than the session");
}

void RecorderNode::end_lost_steps() {
  if (const auto lost = std::exchange(lost_, std::nullopt)) mark(*lost, "no node could send them again");
}

// After a gap in the ticks the session can be computed again from the next states on.
void RecorderNode::mark(const Gap& gap, const char* cause) {
  recording::TextMap entries;
  entries["cause"] = cause;
  entries["epoch"] = std::to_string(gap.epoch);
  entries["from_step"] = std::to_string(gap.from);
  entries["to_step"] = std::to_string(gap.to);
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    if (gap.messages[i] > 0)
      entries["left_out." + std::string(to_text(static_cast<Topic>(i)))] = std::to_string(gap.messages[i]);
  }
  // the next write returns the error
  std::ignore = writer_->add_metadata(recording::kGapName, entries);
  const bool lacks_ticks = gap.messages[static_cast<std::size_t>(Topic::tick)] > 0;
  if (!lacks_ticks || gap.epoch != member_.epoch() || gap.to < states_step_) return;
  wants_states_ = true;
  gap_end_ = gap.to;
  states_deadline_ns_ = now_ns_ + node::kJoinTimeout.ns;
}

// The session goes on without its recording; messages from now on are counted as lost.
void RecorderNode::stop_recording(const Status& why) {
  last_step_ = complete_up_to();
  stopped_ = why;
  close_file({ExitCode::storage, why.text});
  std::fprintf(stderr, "recorder: warning: %s; the session goes on without its recording and ends with code %d\n",
               why.text.c_str(), static_cast<int>(ExitCode::storage));
}

Status RecorderNode::problem_of_room(const std::filesystem::path& place) const {
  constexpr double kMega = 1e6;
  if (config_.keep_free == 0) return Status::ok();
  const std::uint64_t free = config_.file_calls->free_bytes(place);
  if (free >= config_.keep_free) return Status::ok();
  char room[160];
  std::snprintf(room, sizeof room, ": %.0f MB are free on this file system and %.0f MB are to be left to others; ",
                static_cast<double>(free) / kMega, static_cast<double>(config_.keep_free) / kMega);
  return Status::error(ExitCode::storage,
                       place.string() + room +
                           (writer_ == nullptr ? "nothing was recorded" : "the recording was closed") +
                           "; free space, record elsewhere with --out DIR, or leave less with "
                           "--keep-free MB");
}

// Messages held in memory are still written: there is space for them.
void RecorderNode::stop_when_room_is_short(std::int64_t now_ns) {
  if (writer_ == nullptr || !stopped_.is_ok() || now_ns - room_checked_ns_ < config_.limits.flush_period.ns) return;
  room_checked_ns_ = now_ns;
  const Status status = problem_of_room(path_);
  if (!status.is_ok()) stop_recording(status);
}

void RecorderNode::close(const SessionEnd& session) {
  if (writer_ == nullptr) return;
  const node::DiskWait disk(health());
  if (stopped_.is_ok()) close_file(session);
  writer_.reset();
}

void RecorderNode::close_file(SessionEnd session) {
  const node::DiskWait disk(health());
  end_gap();
  end_lost_steps();
  if (stopped_.is_ok()) {
    for (const recording::StateHashes& hashes : selection_.take_rest()) {
      recording::encode_state_hashes(hashes, hashes_bytes_);
      // the flush that follows returns the error
      std::ignore = writer_->write(hashes_channel_, {hashes.epoch, hashes.last_step, hashes.role, 0}, hashes_bytes_);
    }
  }
  // an error of this flush is in the summary too
  const Status flushed = writer_->flush();
  if (stopped_.is_ok()) stopped_ = flushed;
  if (!stopped_.is_ok() && session.code == ExitCode::ok) session = {stopped_.code, stopped_.text};
  recording::TextMap summary;
  const std::optional<StepIndex> first_lost = writer_->first_lost_step();
  summary["last_step"] = std::to_string(first_lost ? std::min(last_step_, *first_lost - 1) : last_step_);
  summary["exit_code"] = std::to_string(static_cast<int>(session.code));
  summary["end"] = end_text(session);
  for (std::size_t i = 0; i < wire::kTopics; ++i) {
    if (counts_[i].recorded == 0 && counts_[i].lost == 0) continue;
    const std::string name(to_text(static_cast<Topic>(i)));
    // a failed writer took messages that are not in the file
    const std::uint64_t in_file = first_lost ? writer_->messages_in_file(channels_[i]) : counts_[i].recorded;
    summary[name + ".recorded"] = std::to_string(in_file);
    summary[name + ".lost"] = std::to_string(counts_[i].lost + counts_[i].recorded - in_file);
    summary[name + ".duplicates"] = std::to_string(counts_[i].duplicates);
  }
  const bool is_counted = !first_lost && stopped_.is_ok() && ticks_ && ticks_->is_in_order() && flags_.is_in_order();
  if (is_counted) {
    char digest[24];
    std::snprintf(digest, sizeof digest, "%016llx", static_cast<unsigned long long>(variables_digest_));
    summary[recording::kTicksKey] = text_of(ticks_->span());
    summary[recording::kFlagsKey] = flags_.text();
    summary[recording::kVariablesKey] = digest;
  }
  const Status status = writer_->close(summary);
  if (!status.is_ok() && stopped_.is_ok()) stopped_ = status;
}

}  // namespace slew::recorder_node
