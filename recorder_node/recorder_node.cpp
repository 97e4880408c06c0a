// SPDX-License-Identifier: Apache-2.0
#include "recorder_node/recorder_node.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "transport/roles.h"
#include "transport/topics.h"

namespace slew::recorder_node {
namespace {

using node::to_text;
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

// ---- receiving ------------------------------------------------------------------------------------------------

void RecorderNode::receive(const transport::Received& message, std::int64_t now_ns) {
  switch (message.topic) {
    case Topic::session:
      return receive_session(message, now_ns);
    case Topic::tick:
    case Topic::mechanism:
    case Topic::actuators:
    case Topic::flexible:
    case Topic::elastic:
    case Topic::poses:
    case Topic::sensors:
    case Topic::variables:
      return receive_stepped(message, now_ns);
    case Topic::node_status: {
      const Status refusal = member_.on_node_status(message.bytes, now_ns);
      if (!refusal.is_ok()) return refuse(refusal);
      break;
    }
    case Topic::health:
      member_.on_health(message.bytes, now_ns);
      break;
    case Topic::state:
      return receive_state(message, now_ns);
    default:
      break;
  }
  file(message);
}

// Files a message without a step of its own under the step that is being recorded.
void RecorderNode::file(const transport::Received& message) {
  if (writer_ == nullptr || is_of_another_session(message)) return;
  if (begin_ != Begin::known) return keep_until_begin(message);
  write(message, member_.epoch(), std::max(streams_.begin, complete_up_to()), static_cast<std::uint32_t>(++unstepped_));
}

// A process of an earlier session of the name may still exist after it stood still.
bool RecorderNode::is_of_another_session(const transport::Received& message) const {
  if (message.topic == Topic::controller_input || message.topic == Topic::control_request) return false;
  wire::Header header;
  return transport::decode_header(message.bytes, header) && header.session != member_.session().header.session;
}

// Removes the recording unless it holds a step of the session.
void RecorderNode::discard(const Status& why) {
  if (writer_ == nullptr) return;
  count_all_losses();
  close({why.code, why.text});
  if (has_step_) return;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  std::filesystem::remove(path_.parent_path(), ignored);
  path_.clear();
}

// Another process records this session.
void RecorderNode::refuse(const Status& refusal) {
  discard(refusal);
  member_.step_aside(refusal.code, refusal.text);
  stage_ = Stage::finished;
}

void RecorderNode::withdraw() {
  discard(Status::error(ExitCode::bad_input, "the session was withdrawn: another one holds its name"));
  member_.withdraw();
  stage_ = Stage::finished;
}

void RecorderNode::receive_session(const transport::Received& message, std::int64_t now_ns) {
  wire::SessionDescription session;
  if (!transport::decode(message.bytes, session)) {
    ++member_.refusals().undecodable;
    return;
  }
  const node::SessionChange change = member_.change_of(session);
  if (change == node::SessionChange::withdrawn) return withdraw();
  if (change == node::SessionChange::renewed) {
    member_.renew(session, now_ns);
    return file(message);
  }
  if (change != node::SessionChange::begins) return;
  if (const Status held = member_.adopt(session, now_ns); !held.is_ok()) return refuse(held);
  Status status = member_.problem_of_protocol();
  if (status.is_ok()) status = create(session);
  if (!status.is_ok()) {
    discard(status);
    member_.fail(status.code, status.text);
    member_.publish_status_if_changed();
    stage_ = Stage::finished;
    return;
  }
  begin_streams(session.header.step);
  write(message, session.header.epoch, kJoinStep, 0);
  // a session that needs a recorder begins with io's probe; one that has begun has its recorder
  member_.set_state(member_.requires_role(Role::recorder) ? NodeState::joining : NodeState::ready);
  if (!member_.requires_role(Role::recorder)) {
    // a session that has given a process up, or was reset, has begun long ago
    const bool is_late = !session.given_up.empty() || session.header.epoch > 0;
    begin_ = is_late ? Begin::late : Begin::open;
    late_deadline_ns_ = is_late ? now_ns + node::kJoinTimeout.ns : 0;
  }
  stage_ = Stage::recording;
  deadline_ns_ = 0;
}

void RecorderNode::receive_stepped(const transport::Received& message, std::int64_t now_ns) {
  wire::Header header;
  if (!transport::decode_header(message.bytes, header)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (message.topic == Topic::tick && member_.begins_next_epoch(header)) {
    start_epoch(header);
    receive_stepped(message, now_ns);
    for (const PendingMessage& pending : std::exchange(next_epoch_, {})) {
      receive_stepped({pending.topic, pending.bytes, pending.source_ns}, now_ns);
    }
    return;
  }
  if (header.epoch == member_.epoch() + 1) {
    if (member_.is_of_session(header, message.topic)) keep_for_next_epoch(message);
    return;
  }
  // a message of the epoch that a reset has just ended
  if (header.epoch + 1 == member_.epoch() && header.phase == Phase::running) {
    if (member_.is_of_session(header, message.topic)) record_step(message, header, former_, now_ns);
    return;
  }
  if (!member_.fits(header, message.topic)) return;
  if (begin_ != Begin::known && !is_from_the_begin(message, header, now_ns)) return;
  if (member_.state() == NodeState::joining && !has_come_in_time(header, message.topic, now_ns)) return;
  member_.acknowledge(header, message.topic, now_ns);
  if (header.phase == Phase::join || writer_ == nullptr) return;
  if (header.phase == Phase::init) {
    return write(message, header.epoch, kJoinStep, static_cast<std::uint32_t>(header.role));
  }
  record_step(message, header, streams_, now_ns);
}

void RecorderNode::record_step(const transport::Received& message, const wire::Header& header, EpochStreams& streams,
                               std::int64_t now_ns) {
  if (writer_ == nullptr) return;
  if (message.topic == Topic::variables) return record_variables(message, header, streams);
  const bool is_every_kth = message.topic == Topic::flexible || message.topic == Topic::elastic ||
                            message.topic == Topic::poses || message.topic == Topic::sensors;
  if (is_every_kth) return record_block(message, header, {message.topic, header.role, 0}, streams);
  TopicCounts& counts = counts_[static_cast<std::size_t>(message.topic)];
  StepStream& stream =
      streams.steps.try_emplace({message.topic, header.role}, make_stream(streams.begin)).first->second;
  const StepIndex expected = stream.gaps.next();
  switch (stream.gaps.arrived(header.step)) {
    case StreamGaps::Arrival::duplicate:
      ++counts.duplicates;
      return;
    case StreamGaps::Arrival::too_far:
      ++member_.refusals().too_far_ahead;
      return;
    case StreamGaps::Arrival::new_step:
      break;
  }
  if (stream.gaps.next() > expected) stream.resend.restart(now_ns);
  write(message, header.epoch, header.step, static_cast<std::uint32_t>(header.role));
}

StepStream RecorderNode::make_stream(StepIndex begin) const {
  return {StreamGaps(stream_depth(member_.give_up_after(), {member_.session().step_ns}), begin), {}};
}

// Streams that must be complete: the ticks and the samples of every role that takes part, and the states they begin
// with. from: step of these states; -1: the epoch begins with INIT.
void RecorderNode::begin_streams(StepIndex from) {
  streams_.begin = std::max<StepIndex>(0, from);
  wants_states_ = false;
  missing_states_.clear();
  states_step_ = streams_.begin;
  if (from >= 0) expect_states(from);
  for (const Role role : wire::kStateRoles) {
    if (!member_.requires_role(role) || transport::traits(role).is_follower) continue;
    streams_.steps.try_emplace({transport::traits(role).sample, role}, make_stream(streams_.begin));
  }
}

// Blocks of variables and the samples from and to flexible bodies and sensors are published every k-th step from step 0
// on. Missing ones are counted, not requested.
void RecorderNode::record_variables(const transport::Received& message, const wire::Header& header,
                                    EpochStreams& streams) {
  wire::VariableBlock block;
  if (!transport::decode(message.bytes, block)) {
    ++member_.refusals().undecodable;
    return;
  }
  record_block(message, header, {message.topic, header.role, block.first}, streams);
}

void RecorderNode::record_block(const transport::Received& message, const wire::Header& header,
                                const BlockSource& source, EpochStreams& streams) {
  BlockStream& stream = streams.blocks[source];
  if (header.step <= stream.newest || header.step < streams.begin) {
    ++counts_[static_cast<std::size_t>(message.topic)].duplicates;
    return;
  }
  if (stream.arrived == 0) stream.first = header.step;
  stream.newest = header.step;
  ++stream.arrived;
  every(message.topic) = std::gcd(every(message.topic), header.step);
  write(message, header.epoch, header.step, (static_cast<std::uint32_t>(header.role) << 16) | source.first);
}

// After a reset the first messages of a fast node may overtake io's tick that begins the epoch.
void RecorderNode::keep_for_next_epoch(const transport::Received& message) {
  if (next_epoch_.size() >= kMaxPending) {
    ++member_.refusals().other_epoch;
    return;
  }
  next_epoch_.push_back({message.topic, message.source_ns, {message.bytes.begin(), message.bytes.end()}});
}

void RecorderNode::start_epoch(const wire::Header& init) {
  if (writer_ != nullptr && stopped_.is_ok()) {
    end_lost_steps();
    for (const recording::StateHashes& hashes : selection_.take_rest()) write_hashes(hashes);
  }
  count_losses(former_, false);
  former_ = std::exchange(streams_, {});
  begin_streams(init.step);
  member_.set_epoch(init.epoch);
  reported_step_ = kJoinStep;
  member_.set_recorded_step(kJoinStep);
  member_.mark_status_changed();
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
