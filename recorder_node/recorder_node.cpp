// SPDX-License-Identifier: Apache-2.0
#include "recorder_node/recorder_node.h"

#include <algorithm>
#include <utility>

#include "transport/topics.h"

namespace slew::recorder_node {
namespace {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// longest distance between two reports of the recorded step
constexpr StepIndex kReportSteps = 64;
constexpr std::int64_t kReportNs = 100'000'000;

}  // namespace

RecorderNode::RecorderNode(transport::Transport& transport, RecorderConfig config)
    : member_(Role::recorder, transport, {}, config.join.session), config_(std::move(config)) {}

RecorderNode::~RecorderNode() {
  count_all_losses();
  close({ExitCode::failed, "the recorder ended before the session"});
}

bool RecorderNode::poll(std::int64_t now_ns) {
  now_ns_ = now_ns;
  bool any = false;
  transport::Received message;
  while (stage_ != Stage::finished && member_.transport().take(message)) {
    health().turn();
    receive(message, now_ns);
    any = true;
  }
  if (stage_ == Stage::waiting_for_session) {
    if (deadline_ns_ == 0) deadline_ns_ = now_ns + config_.join.session_timeout.ns;
    if (now_ns > deadline_ns_) {
      member_.fail(ExitCode::failed,
                   "no session was found; start the io node first, and compare --session, --domain, "
                   "--interface, --peer and --keys on both sides");
      stage_ = Stage::finished;
    }
  } else if (stage_ != Stage::finished) {
    become_ready();
    give_up_unanswerable();
    request_gaps(now_ns);
    request_states(now_ns);
    watch(now_ns);
    report_progress(now_ns);
    const node::DiskWait disk(health());
    if (writer_ != nullptr && stopped_.is_ok()) {
      const Status status = writer_->flush_if_due(now_ns);
      if (!status.is_ok()) stop_recording(status);
    }
    stop_when_room_is_short(now_ns);
  }
  if (const Status& failure = member_.send_failure(); !failure.is_ok()) begin_ending(failure.code, failure.text);
  member_.publish_status_if_changed();
  update_health();
  return any;
}

std::int64_t RecorderNode::next_deadline(std::int64_t now_ns) const {
  std::int64_t deadline_ns = now_ns + (is_ending() ? node::kResendAfter.ns : node::kProbeInterval.ns);
  for (const auto& [key, stream] : streams_.steps) {
    if (stream.gaps.has_gap()) deadline_ns = std::min(deadline_ns, stream.resend.due_ns());
  }
  return std::max(now_ns, deadline_ns);
}

void RecorderNode::request_stop(ExitCode code) {
  if (stage_ == Stage::finished) return;
  count_all_losses();
  close({code, "the recorder was ended by a signal"});
  member_.fail(code, "ended by a signal");
  member_.publish_status_if_changed();
  stage_ = Stage::finished;
}

void RecorderNode::update_health() noexcept {
  node::HealthState& h = health();
  h.state = static_cast<std::uint8_t>(member_.state());
  if (stage_ != Stage::finished) h.step = complete_up_to();
  h.epoch = member_.epoch();
  h.refused = member_.refusals().refused();
  h.has_session.store(member_.has_session(), std::memory_order_release);
}

std::uint64_t RecorderNode::lost() const noexcept {
  std::uint64_t sum = 0;
  for (const TopicCounts& counts : counts_) sum += counts.lost;
  return sum;
}

// ---- progress -------------------------------------------------------------------------------------------------

// Every stream is complete up to this step.
StepIndex RecorderNode::complete_up_to() const noexcept {
  StepIndex least = -1;
  bool is_first = true;
  for (const auto& [key, stream] : streams_.steps) {
    least = is_first ? stream.gaps.next() - 1 : std::min(least, stream.gaps.next() - 1);
    is_first = false;
  }
  return least;
}

// Last step of a stream: the step that its writer reported at its end; before that, or if the writer is gone, the
// newest step that arrived.
StepIndex RecorderNode::final_step(Role writer, StepIndex newest) const noexcept {
  const node::Peer& peer = member_.peer(writer);
  const bool has_reported = peer.is_known && !peer.is_lost && peer.status.state >= NodeState::ended &&
                            peer.status.header.epoch == member_.epoch();
  return has_reported ? peer.status.header.step : newest;
}

// Step of a writer's last variable block. io's last tick is END and has none.
StepIndex RecorderNode::last_block(const BlockSource& source, StepIndex newest) const noexcept {
  const StepIndex every = block_every_[static_cast<std::size_t>(source.topic)];
  if (every == 0) return newest;
  const StepIndex final = final_step(source.writer, newest);
  const StepIndex last = source.writer == Role::io && final > newest ? final - 1 : final;
  return last < 0 ? newest : last - last % every;
}

bool RecorderNode::is_ending() const noexcept {
  return member_.peer(Role::io).status.state >= NodeState::ended || lost_node_;
}

// Every node that is not lost has ended, and all its messages have arrived.
bool RecorderNode::has_everything() const noexcept {
  return member_.all_required(NodeState::ended) && missing_states_.empty() &&
         std::all_of(streams_.steps.begin(), streams_.steps.end(),
                     [&](const auto& entry) {
                       const auto& [key, stream] = entry;
                       return stream.gaps.next() > final_step(key.second, stream.gaps.newest());
                     }) &&
         std::all_of(streams_.blocks.begin(), streams_.blocks.end(), [&](const auto& entry) {
           const auto& [source, stream] = entry;
           return stream.newest >= last_block(source, stream.newest);
         });
}

void RecorderNode::report_progress(std::int64_t now_ns) {
  const StepIndex at = complete_up_to();
  if (at != reported_step_ && (at - reported_step_ >= kReportSteps || now_ns - reported_ns_ >= kReportNs)) {
    reported_step_ = at;
    reported_ns_ = now_ns;
    member_.set_recorded_step(at);
    member_.set_step(at);
    member_.mark_status_changed();
  }
}

// Gives up steps that no writer keeps any more. They form one gap until all streams continue after it.
void RecorderNode::give_up_unanswerable() {
  if (writer_ == nullptr || !stopped_.is_ok() || streams_.steps.empty()) return;
  const std::size_t depth = node::sent_depth(member_.give_up_after(), {member_.session().step_ns});
  // a wrong number in one stream is not a step of the session
  StepIndex newest = wire::kMaxStep;
  for (const auto& [key, stream] : streams_.steps) newest = std::min(newest, stream.gaps.newest());
  for (auto& [key, stream] : streams_.steps) {
    stream.gaps.give_up_before(newest - static_cast<StepIndex>(depth) + 1);
    const StreamGaps::Lost lost = stream.gaps.take_lost();
    if (lost.steps == 0) continue;
    if (!lost_) lost_ = Gap{member_.epoch(), lost.first, lost.last, {}};
    lost_->from = std::min(lost_->from, lost.first);
    lost_->to = std::max(lost_->to, lost.last);
    lost_->messages[static_cast<std::size_t>(key.first)] += lost.steps;
  }
  if (!lost_) return;
  const bool is_over = std::all_of(streams_.steps.begin(), streams_.steps.end(), [this](const auto& entry) {
    const StreamGaps& gaps = entry.second.gaps;
    return !gaps.has_gap() || gaps.next() > lost_->to + 1;
  });
  if (is_over) end_lost_steps();
}

void RecorderNode::request_gaps(std::int64_t now_ns) {
  for (auto& [key, stream] : streams_.steps) {
    const StreamGaps& gaps = stream.gaps;
    if (!stream.resend.is_due(now_ns)) continue;
    const StepIndex last = gaps.has_gap() ? gaps.gap_end() : final_step(key.second, gaps.newest());
    if (gaps.next() > last) {
      stream.resend.restart(now_ns);
      continue;
    }
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, gaps.next());
    request.role = key.second;
    request.topic = static_cast<std::uint8_t>(key.first);
    request.last_step = last;
    member_.publish(Topic::resend, request);
    ++health().resends_asked;
    stream.resend.requested(now_ns);
  }
}

// ---- ending ---------------------------------------------------------------------------------------------------

void RecorderNode::watch(std::int64_t now_ns) {
  if (stage_ != Stage::recording) return;
  Role about = Role::io;
  if (member_.watch_peers(now_ns, about) == node::PeerEvent::lost && !lost_node_) {
    lost_node_ = about;
    deadline_ns_ = now_ns + node::kSilentAfter.ns;
  }
  const bool is_late = late_deadline_ns_ != 0;
  if (is_late && (is_ending() || now_ns > late_deadline_ns_)) return refuse_late();
  if (!is_ending()) {
    deadline_ns_ = 0;
    return;
  }
  // the last messages of the other nodes may be in flight
  if (deadline_ns_ == 0) deadline_ns_ = now_ns + member_.linger().ns / 2;
  if (!has_everything() && now_ns < deadline_ns_) return;
  if (lost_node_) {
    return begin_ending(ExitCode::node_lost,
                        member_.end_text(*lost_node_, member_.describe_peer(*lost_node_) +
                                                          " is gone; the recording was closed after step " +
                                                          std::to_string(complete_up_to())));
  }
  // after the END the recording is complete, whether or not a signal was received
  const wire::NodeStatus& io = member_.peer(Role::io).status;
  const auto code = static_cast<ExitCode>(io.exit_code);
  finish({code, io.reason}, io.state == NodeState::fault ? code : ExitCode::ok,
         member_.end_text(Role::io, "io ended the session: " + io.reason));
}

void RecorderNode::begin_ending(ExitCode code, const std::string& reason) {
  finish({code, reason}, code, reason);
}

void RecorderNode::finish(const SessionEnd& session, ExitCode own_code, const std::string& own_reason) {
  if (stage_ == Stage::finished) return;
  count_all_losses();
  const std::string missing = std::to_string(lost()) + " messages are missing in the recording";
  const bool has_losses = own_code == ExitCode::ok && lost() > 0;
  close(has_losses && session.code == ExitCode::ok ? SessionEnd{ExitCode::losses, missing} : session);
  const bool is_orderly =
      own_code == ExitCode::ok || own_code == ExitCode::interrupted || own_code == ExitCode::terminated;
  if (!stopped_.is_ok() && is_orderly) {
    member_.fail(stopped_.code, stopped_.text);
  } else if (has_losses) {
    member_.fail(ExitCode::losses, missing);
  } else if (is_orderly) {
    member_.end(own_code);
  } else {
    member_.fail(own_code, own_reason);
  }
  member_.publish_status_if_changed();
  stage_ = Stage::finished;
}

void RecorderNode::count_all_losses() {
  counts_[static_cast<std::size_t>(Topic::state)].lost += missing_states_.size();
  missing_states_.clear();
  count_losses(former_, false);
  count_losses(streams_, true);
}

// Counts once: the streams are empty afterwards.
void RecorderNode::count_losses(EpochStreams& streams, bool is_present) {
  if (is_present) last_step_ = complete_up_to();
  for (auto& [key, stream] : streams.steps) {
    StreamGaps& gaps = stream.gaps;
    gaps.close_at(is_present ? final_step(key.second, gaps.newest()) : gaps.newest());
    counts_[static_cast<std::size_t>(key.first)].lost += gaps.lost();
  }
  for (const auto& [source, stream] : streams.blocks) {
    const StepIndex last = is_present ? last_block(source, stream.newest) : stream.newest;
    const StepIndex step = every(source.topic);
    const StepIndex from = streams.had_begun ? stream.first : streams.begin;
    const StepIndex before = step == 0 ? 0 : (from + step - 1) / step;  // blocks of earlier steps
    const auto expected =
        step == 0 ? stream.arrived : static_cast<std::uint64_t>(std::max<StepIndex>(0, last / step + 1 - before));
    counts_[static_cast<std::size_t>(source.topic)].lost += expected - std::min(expected, stream.arrived);
  }
  streams = {};
}

}  // namespace slew::recorder_node
