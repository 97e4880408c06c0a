// SPDX-License-Identifier: Apache-2.0
// PhysicsNode's part that receives messages.
#include <string>

#include "node/physics_node.h"

namespace slew::node {

using wire::NodeState;
using wire::Phase;
using wire::Role;
using wire::Topic;

void PhysicsNode::receive(const transport::Received& message, std::int64_t now_ns) {
  switch (message.topic) {
    case Topic::session:
      return receive_session(message.bytes, now_ns);
    case Topic::node_status: {
      const Status refusal = member_.on_node_status(message.bytes, now_ns);
      if (!refusal.is_ok()) refuse(refusal);
      return;
    }
    case Topic::health:
      return member_.on_health(message.bytes, now_ns);
    case Topic::tick:
      return receive_tick(message, now_ns);
    case Topic::mechanism:
    case Topic::actuators:
    case Topic::flexible:
    case Topic::elastic:
    case Topic::poses:
      return receive_sample(message, now_ns);
    case Topic::resend:
      return receive_resend(message.bytes);
    case Topic::state:
      return receive_state(message.bytes);
    default:
      return;
  }
}

// Another process holds the role: this one was never part of the session.
void PhysicsNode::refuse(const Status& refusal) {
  member_.step_aside(refusal.code, refusal.text);
  stage_ = Stage::finished;
}

void PhysicsNode::receive_session(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::SessionDescription session;
  if (!member_.decode(bytes, session)) return;
  const SessionChange change = member_.change_of(session);
  if (change == SessionChange::withdrawn) {
    member_.withdraw();
    stage_ = Stage::finished;
  }
  if (change == SessionChange::renewed) return renew(session, now_ns);
  if (change != SessionChange::begins) return;
  if (const Status held = member_.adopt(session, now_ns); !held.is_ok()) return refuse(held);
  const Status protocol = member_.problem_of_protocol();
  if (protocol.is_ok() && !member_.requires_role(member_.role())) {
    const std::string why = "scene '" + session.scene_name + "' needs no " + std::string(to_text(member_.role())) +
                            " node; nothing to do here";
    return refuse(Status::error(ExitCode::bad_input, why));
  }
  if (const Status built = protocol.is_ok() ? build(session) : protocol; !built.is_ok()) {
    member_.fail(built.code, built.text);
    member_.publish_status_if_changed();
    stage_ = Stage::finished;
    return;
  }
  const bool has_deadline = session.pace == Pace::real;
  const bool takes_late = built_.session.mode == scene::ExchangeMode::free_running;
  samples_.configure(member_, built_.exchange, takes_late);
  step_timing_.set_deadline({has_deadline ? session.step_ns * samples_.stride() : 0});
  loop_ = make_step_loop(member_, samples_, built_.session, step_timing_);
  member_.set_state(NodeState::joining);
  stage_ = Stage::joining;
  deadline_ns_ = 0;
}

// Error: this node cannot take part in the session.
Status PhysicsNode::build(const wire::SessionDescription& session) {
  if (Status built = factory_(session, built_); !built.is_ok()) return built;
  if (const std::size_t count = built_.published_variables.size(); count > wire::kMaxVariables) {
    return Status::error(ExitCode::bad_input, "scene '" + session.scene_name + "' publishes " + std::to_string(count) +
                                                  " variables of this node, the limit is " +
                                                  std::to_string(wire::kMaxVariables) +
                                                  "; this node does not take part; name fewer in recording.variables");
  }
  const bool must_save = session.rejoin_ns > 0 || member_.has_state();
  const Status can_save = must_save ? built_.subsystem->can_save() : Status::ok();
  if (can_save.is_ok()) return can_save;
  return Status::error(can_save.code,
                       "the state of this node cannot be taken over by another process: " + can_save.text +
                           "; this node does not take part; run it with session.rejoin=0, from the start");
}

// io has published the processes that it gave up, and the step of the session.
void PhysicsNode::renew(const wire::SessionDescription& session, std::int64_t now_ns) {
  member_.renew(session, now_ns);
  if (!member_.is_given_up()) return;
  member_.yield();
  stage_ = Stage::finished;
}

void PhysicsNode::receive_state(std::span<const std::byte> bytes) {
  wire::Header header;
  if (!member_.decode_header(bytes, header)) return;
  if (stage_ != Stage::loading || !member_.fits(header, Topic::state)) return;
  states_.receive_part(bytes, member_);
}

void PhysicsNode::receive_tick(const transport::Received& message, std::int64_t now_ns) {
  wire::Header header;
  if (!member_.header_of(message, header)) return;
  // a new epoch starts with an INIT tick
  if (member_.begins_next_epoch(header)) return restart(header);
  if (!member_.fits(header, Topic::tick)) return;
  member_.acknowledge(header, Topic::tick, now_ns);
  if (header.phase != Phase::running) return;
  if (loop_->receive_tick(message, header, n_, now_ns)) measure_release(header.step, message.source_ns);
}

void PhysicsNode::receive_sample(const transport::Received& message, std::int64_t now_ns) {
  wire::Header header;
  if (!member_.receive_header(message, header, now_ns)) return;
  samples_.for_each_missing(n_, [&](Role role, Topic missing, StepIndex) {
    if (missing == message.topic) step_timing_.came(role, now_ns);
  });
  samples_.receive(message, header, n_, member_.refusals());
  const bool releases = is_follower() && header.phase == Phase::running && header.step > n_;
  if (releases) measure_release(header.step, message.source_ns);
}

void PhysicsNode::measure_release(StepIndex step, std::int64_t source_ns) noexcept {
  const std::string& host = is_follower() ? member_.peer(Role::mechanics).status.host : member_.session().host;
  const bool is_local = host == member_.identity().host;
  const std::int64_t now_ns = monotonic_ns();
  step_timing_.release(step, sent_ns(source_ns, now_ns, is_local ? WriterClock::same : WriterClock::other), now_ns);
}

void PhysicsNode::receive_resend(std::span<const std::byte> bytes) {
  wire::ResendRequest request;
  if (!member_.decode(bytes, request)) return;
  if (request.role != member_.role() || !member_.fits(request.header, Topic::resend)) return;
  if (request.topic == static_cast<std::uint8_t>(Topic::state)) return;
  if (request.topic == static_cast<std::uint8_t>(Topic::checkpoint)) {
    if (request.header.role != Role::io) return;
    states_.request(request.header.step);
    if (stage_ == Stage::stepping && states_.is_requested(n_)) states_.publish_state(member_, n_, published_);
    return;
  }
  health().resends_answered += samples_.answer(member_, request);
}

}  // namespace slew::node
