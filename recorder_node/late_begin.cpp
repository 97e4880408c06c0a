// SPDX-License-Identifier: Apache-2.0
// RecorderNode's part that begins in mid-session, with the states from which a recording can be computed again.
#include <utility>

#include "recorder_node/recorder_node.h"
#include "transport/roles.h"

namespace slew::recorder_node {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// io's probe precedes the first tick, and the first tick precedes every sample except INIT and the first. A recorder
// that receives a later message first is a second one: it records nothing and waits for the status of the first
// recorder, to name it.
bool RecorderNode::has_come_in_time(const wire::Header& header, Topic topic, std::int64_t now_ns) {
  if (header.phase == Phase::join && topic == Topic::tick) has_received_probe_ = true;
  if (header.phase == Phase::join || has_received_probe_) return true;
  if (topic != Topic::tick && header.step <= streams_.begin) return true;
  ++member_.refusals().early;
  if (late_deadline_ns_ == 0) late_deadline_ns_ = now_ns + node::kJoinTimeout.ns;
  return false;
}

// Ready once io's probe has arrived and io has chosen this recorder: no later process takes its role.
void RecorderNode::become_ready() noexcept {
  if (member_.state() != NodeState::joining || !has_received_probe_ || !member_.holds_role()) return;
  member_.set_state(NodeState::ready);
}

// Begins at the first step if the other nodes can resend all messages since then. Blocks of variables are not resent:
// those of a session that had begun are recorded from now on.
bool RecorderNode::is_from_the_begin(const transport::Received& message, const wire::Header& header,
                                     std::int64_t now_ns) {
  if (header.phase == Phase::join) return true;
  // the step of a block does not bound the step of the session
  if (message.topic == Topic::variables) {
    keep_until_begin(message);
    return false;
  }
  const bool is_near = header.step - streams_.begin < static_cast<StepIndex>(node::kSentDepth / 2);
  if (begin_ == Begin::open && is_near) {
    begin_ = Begin::known;
    streams_.had_begun = true;
    file_pending(now_ns);
    return true;
  }
  if (begin_ == Begin::open) late_deadline_ns_ = now_ns + node::kJoinTimeout.ns;
  begin_ = Begin::late;
  return false;
}

void RecorderNode::begin_late(StepIndex step, std::int64_t now_ns) {
  streams_ = {};
  begin_streams(step);
  streams_.had_begun = true;
  begin_ = Begin::known;
  late_deadline_ns_ = 0;
  file_pending(now_ns);
}

void RecorderNode::keep_until_begin(const transport::Received& message) {
  if (before_begin_.size() >= kMaxPending) return;
  before_begin_.push_back({message.topic, message.source_ns, {message.bytes.begin(), message.bytes.end()}});
}

void RecorderNode::file_pending(std::int64_t now_ns) {
  for (const PendingMessage& pending : std::exchange(before_begin_, {})) {
    const transport::Received message{pending.topic, pending.bytes, pending.source_ns};
    pending.topic == Topic::variables ? receive_stepped(message, now_ns) : file(message);
  }
}

void RecorderNode::refuse_late() {
  if (begin_ == Begin::late) {
    return refuse(Status::error(
        ExitCode::bad_input, "session '" + member_.session().name +
                                 "' runs and has given no state from which a recording could be computed again: it "
                                 "cannot be saved, or it is paused between two exchanges; nothing was recorded here; "
                                 "start the recorder with the session"));
  }
  refuse(Status::error(ExitCode::bad_input, "session '" + member_.session().name +
                                                "' had begun before this recorder came, and no status from its own "
                                                "recorder arrived; nothing was recorded here; start the recorder with "
                                                "the session"));
}

void RecorderNode::expect_states(StepIndex step) {
  states_step_ = step;
  wants_states_ = false;
  counts_[static_cast<std::size_t>(Topic::state)].lost += missing_states_.size();
  missing_states_.clear();
  for (const Role role : transport::state_roles()) {
    if (member_.requires_role(role)) missing_states_[role];
  }
}

// Records the states that an epoch begins with, or that follow a gap, so that it can be computed again from there.
// States that io sends to other nodes later are not recorded.
void RecorderNode::receive_state(const transport::Received& message, std::int64_t now_ns) {
  wire::Header header;
  const bool is_wanted = !missing_states_.empty() || begin_ == Begin::late || wants_states_;
  if (!is_wanted || writer_ == nullptr || !transport::decode_header(message.bytes, header)) return;
  if (header.role != Role::io || !member_.fits(header, Topic::state)) return;
  if (!member_.decode(message.bytes, part_)) return;
  // io sends its own state only together with those of all other nodes
  if (begin_ == Begin::late && part_.role == Role::io) begin_late(header.step, now_ns);
  if (wants_states_ && part_.role == Role::io && header.step > gap_end_) expect_states(header.step);
  if (header.step != states_step_) return;
  const auto missing = missing_states_.find(part_.role);
  if (missing == missing_states_.end() || missing->second.has(part_)) return;
  const bool is_whole = missing->second.take(part_);
  if (!missing->second.has(part_)) return;  // it has no place in its state
  const auto place = static_cast<std::uint32_t>(part_.first / wire::kMaxStatePart);
  write(message, header.epoch, header.step, (static_cast<std::uint32_t>(part_.role) << 16) | place);
  if (is_whole) missing_states_.erase(missing);
}

void RecorderNode::request_states(std::int64_t now_ns) {
  const bool has_joined = member_.peer(Role::io).is_known && member_.state() != NodeState::joining;
  const bool is_late = begin_ == Begin::late;
  // a session that cannot be saved sends none
  if (now_ns > states_deadline_ns_) wants_states_ = false;
  if ((missing_states_.empty() && !is_late && !wants_states_) || !has_joined || !states_resend_.is_due(now_ns)) return;
  states_resend_.requested(now_ns);
  const auto request_state = [&](Role role, StepIndex step) {
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, step);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(Topic::state);
    request.last_step = step;
    member_.publish(Topic::resend, request);
    ++health().resends_asked;
  };
  if (is_late || wants_states_) return request_state(Role::io, kJoinStep);
  for (const auto& [role, parts] : missing_states_) request_state(role, states_step_);
}

}  // namespace slew::recorder_node
