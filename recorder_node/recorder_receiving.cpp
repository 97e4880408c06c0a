// SPDX-License-Identifier: Apache-2.0
// What the recorder receives, and under which epoch and step it is recorded.
#include <algorithm>
#include <numeric>
#include <utility>

#include "recorder_node/recorder_node.h"
#include "transport/roles.h"
#include "transport/topics.h"

namespace slew::recorder_node {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

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
  if (!member_.decode(message.bytes, session)) return;
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
  if (!member_.decode_header(message.bytes, header)) return;
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
  for (const Role role : transport::state_roles()) {
    if (!member_.requires_role(role) || transport::traits(role).is_follower) continue;
    streams_.steps.try_emplace({transport::traits(role).sample, role}, make_stream(streams_.begin));
  }
}

// Blocks of variables and the samples from and to flexible bodies and sensors are published every k-th step from step 0
// on. Missing ones are counted, not requested.
void RecorderNode::record_variables(const transport::Received& message, const wire::Header& header,
                                    EpochStreams& streams) {
  wire::VariableBlock block;
  if (!member_.decode(message.bytes, block)) return;
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
  if (writer_ != nullptr) writer_->begin_epoch(init.epoch, streams_.begin);
  member_.set_epoch(init.epoch);
  reported_step_ = kJoinStep;
  member_.set_recorded_step(kJoinStep);
  member_.mark_status_changed();
}

}  // namespace slew::recorder_node
