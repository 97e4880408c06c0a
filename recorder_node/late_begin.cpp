// recorder_node's part that begins in mid-session, with the states that a recording can be computed again from.
#include <utility>

#include "recorder_node/recorder_node.h"

namespace slew::recorder {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

// io's probe comes before the first tick, and the first tick before every sample but INIT and the first. A recorder
// that hears a later message first is a second one: it records nothing and waits for the first one's status, which
// names it.
bool RecorderNode::has_come_in_time(const wire::Header& header, Topic topic, std::int64_t now_ns) {
  if (header.phase == Phase::join && topic == Topic::tick) has_heard_probe_ = true;
  if (header.phase == Phase::join || has_heard_probe_) return true;
  if (topic != Topic::tick && header.step <= streams_.begin) return true;
  ++member_.refusals().early;
  if (late_deadline_ns_ == 0) late_deadline_ns_ = now_ns + node::kJoinTimeout.ns;
  return false;
}

// io's probe was heard, and io has chosen this recorder: nobody takes its role from it.
void RecorderNode::become_ready() noexcept {
  if (member_.state() != NodeState::joining || !has_heard_probe_ || !member_.holds_role()) return;
  member_.set_state(NodeState::ready);
}

// What the others can say again from the first step on is no reason to begin later. Blocks of variables are not said
// again: of a session that had begun they are recorded from then on.
bool RecorderNode::is_from_the_begin(const transport::Received& message, const wire::Header& header,
                                     std::int64_t now_ns) {
  if (header.phase == Phase::join) return true;
  // a block's step says nothing about the session's
  if (message.topic == Topic::variables) {
    keep_until_begin(message);
    return false;
  }
  const bool is_near = header.step - streams_.begin < static_cast<StepIndex>(node::kSentDepth / 2);
  if (begin_ == Begin::open && is_near) {
    begin_ = Begin::known;
    streams_.had_begun = true;
    file_what_came_before(now_ns);
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
  file_what_came_before(now_ns);
}

void RecorderNode::keep_until_begin(const transport::Received& message) {
  if (before_.size() >= kMaxEarly) return;
  before_.push_back({message.topic, message.source_ns, {message.bytes.begin(), message.bytes.end()}});
}

void RecorderNode::file_what_came_before(std::int64_t now_ns) {
  for (const Early& before : std::exchange(before_, {})) {
    const transport::Received message{before.topic, before.bytes, before.source_ns};
    before.topic == Topic::variables ? receive_stepped(message, now_ns) : file(message);
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
                                                "' had begun before this recorder came, and its own recorder was not "
                                                "heard; nothing was recorded here; start the recorder with the "
                                                "session"));
}

void RecorderNode::expect_states(StepIndex step) {
  states_step_ = step;
  wants_states_ = false;
  counts_[static_cast<std::size_t>(Topic::state)].lost += missing_states_.size();
  missing_states_.clear();
  for (const Role role : {Role::io, Role::mechanics, Role::hydraulics, Role::flex}) {
    if (member_.requires_role(role)) missing_states_[role];
  }
}

// The states that an epoch begins with, or that follow a gap, so that it can be computed again from there. Those that
// io gives to others later are not recorded.
void RecorderNode::receive_state(const transport::Received& message, std::int64_t now_ns) {
  wire::Header header;
  const bool is_wanted = !missing_states_.empty() || begin_ == Begin::late || wants_states_;
  if (!is_wanted || writer_ == nullptr || !transport::decode_header(message.bytes, header)) return;
  if (header.role != Role::io || !member_.fits(header, Topic::state)) return;
  if (!transport::decode(message.bytes, part_)) {
    ++member_.refusals().undecodable;
    return;
  }
  // io gives its own state with those of all others alone
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

void RecorderNode::ask_for_states(std::int64_t now_ns) {
  const bool knows_io = member_.peer(Role::io).is_known && member_.state() != NodeState::joining;
  const bool is_late = begin_ == Begin::late;
  // a session that cannot be saved gives none
  if (now_ns > states_deadline_ns_) wants_states_ = false;
  if ((missing_states_.empty() && !is_late && !wants_states_) || !knows_io || !states_resend_.is_due(now_ns)) return;
  states_resend_.asked(now_ns);
  const auto ask = [&](Role role, StepIndex step) {
    wire::ResendRequest request;
    request.header = member_.header(Phase::running, step);
    request.role = role;
    request.topic = static_cast<std::uint8_t>(Topic::state);
    request.last_step = step;
    member_.publish(Topic::resend, request);
    ++health().resends_asked;
  };
  if (is_late || wants_states_) return ask(Role::io, kJoinStep);
  for (const auto& [role, parts] : missing_states_) ask(role, states_step_);
}

}  // namespace slew::recorder
