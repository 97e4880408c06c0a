// SPDX-License-Identifier: Apache-2.0
// What the owner of a session receives: other sessions of its name, samples, requests to resend and to control it.
#include <algorithm>

#include "io_node/io_node.h"
#include "transport/cdr/codec.h"

namespace slew::io_node {

using wire::Phase;
using wire::Role;
using wire::Topic;

void IoNode::receive(const transport::Received& message, std::int64_t now_ns) {
  switch (message.topic) {
    case Topic::session:
      return receive_session(message.bytes);
    case Topic::node_status: {
      const Status refusal = member_.on_node_status(message.bytes, now_ns);
      if (refusal.is_ok()) return;
      member_.step_aside(refusal.code, refusal.text);
      stage_ = Stage::finished;
      return;
    }
    case Topic::health:
      variables_.receive_health(message.bytes);
      return member_.on_health(message.bytes, now_ns);
    case Topic::mechanism:
    case Topic::actuators:
    case Topic::elastic:
    case Topic::sensors:
      return receive_sample(message, now_ns);
    case Topic::controller_input:
      return requests_.receive_controller(message, n_, now_ns, times_);
    case Topic::control_request:
      return receive_control(message.bytes, now_ns);
    case Topic::resend:
      return receive_resend(message.bytes, now_ns);
    case Topic::checkpoint:
      if (const auto answer = keeper_.receive_checkpoint(message.bytes, n_)) requests_.answer(*answer);
      return;
    case Topic::state:
      return keeper_.receive_upload(message.bytes);
    default:
      return;
  }
}

// Two sessions of one name: a description in phase JOIN claims the name, one in phase RUNNING holds it. The holder
// stays; of two that claim or hold together, because both started at one instant, the lower id stays.
void IoNode::receive_session(std::span<const std::byte> bytes) {
  wire::SessionDescription other;
  if (!transport::decode(bytes, other) || other.name != config_.session_name) return;
  const wire::SessionId& own = member_.session().header.session;
  if (other.header.session == own) return;
  if (stage_ != Stage::checking_name && stage_ != Stage::joining) return;
  const bool other_holds = other.header.phase == Phase::running;
  const bool this_holds = stage_ == Stage::joining;
  if (this_holds && !other_holds) return;
  if (this_holds == other_holds && own < other.header.session) return;
  // nodes that have followed this description look for another one
  if (this_holds) publish_session(Phase::ended);
  member_.step_aside(ExitCode::bad_input,
                     "session '" + config_.session_name + "' is held by process " + std::to_string(other.pid) + " on " +
                         node::machine_of(other.host) + ", started " + node::time_text(other.started_ns) +
                         "; this second one ends; stop the first, or choose another --session name");
  stage_ = Stage::finished;
}

void IoNode::receive_sample(const transport::Received& message, std::int64_t now_ns) {
  wire::Header header;
  if (!member_.receive_header(message, header, now_ns)) return;
  if (header.phase != Phase::running) return;
  const SampleProgress::Receipt receipt = samples_.receive(header.role, header.step, n_);
  if (receipt == SampleProgress::Receipt::too_far_ahead) {
    ++member_.refusals().too_far_ahead;
    return;
  }
  if (receipt == SampleProgress::Receipt::repeated) ++member_.refusals().duplicate;
  if (receipt == SampleProgress::Receipt::next) samples_.expect(std::max(now_ns, due_ns()));
  if (keeper_.catches_up(header.role, header.step) && !keeper_.is_replacing()) clock_.begin_grace(n_);
}

void IoNode::receive_resend(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::ResendRequest request;
  if (!member_.decode(bytes, request)) return;
  if (request.topic == static_cast<std::uint8_t>(Topic::state)) return receive_state_request(request, now_ns);
  if (request.role != Role::io || !member_.is_of_session(request.header, Topic::resend)) return;
  if (request.topic != static_cast<std::uint8_t>(Topic::tick)) return;
  // a node that missed a reset requests with the old epoch: it receives the tick that started the new one
  const bool is_late_epoch = request.header.epoch < member_.epoch();
  const StepIndex first = is_late_epoch ? kJoinStep : request.header.step;
  const StepIndex last = is_late_epoch ? kJoinStep : std::min(request.last_step, first + node::kMostAnswers - 1);
  health().resends_answered += ticks_.resend(first, last);
}

void IoNode::receive_state_request(const wire::ResendRequest& request, std::int64_t now_ns) {
  if (!member_.fits(request.header, Topic::resend) || static_cast<std::size_t>(request.role) >= wire::kRoles) return;
  // a recorder that joined late names no step: it receives the states of the next one
  if (request.header.role == Role::recorder && request.header.step < 0) {
    if (stage_ == Stage::ticking && !keeper_.is_saving()) begin_saving({}, now_ns);
    return;
  }
  if (keeper_.publish_state(request)) ++health().resends_answered;
}

void IoNode::receive_control(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::ControlRequest request;
  if (!member_.decode(bytes, request)) return;
  if (request.session != config_.session_name) return;
  if (request.action == wire::ControlAction::get_parameter) {
    return requests_.answer(requests_.get_parameter(request, n_));
  }
  const bool is_numbered = request.request != 0;
  if (is_numbered && (keeper_.is_under_way(request) || requests_.repeat_answer(request))) return;
  if (stage_ != Stage::ticking) return requests_.answer({request, false, "the session is not running yet", n_});
  apply_control(request, now_ns);
}

void IoNode::apply_control(const wire::ControlRequest& request, std::int64_t now_ns) {
  const auto accept = [&](StepIndex step) { requests_.answer({request, true, "", step}); };
  const auto refuse = [&](const std::string& why) { requests_.answer({request, false, why, n_}); };
  switch (request.action) {
    case wire::ControlAction::get_parameter:
      return;  // answered in every stage
    case wire::ControlAction::set_parameter:
      return requests_.answer(requests_.set_parameter(request, n_));
    case wire::ControlAction::pause:
      pause_.begin();
      show_running();
      return accept(n_);
    case wire::ControlAction::resume:
      // a pause is no slip
      if (pause_.is_paused()) clock_.excuse(n_, now_ns);
      pause_.end();
      show_running();
      return accept(n_);
    case wire::ControlAction::step:
      if (!pause_.is_paused()) return refuse("pause the session first");
      if (!(request.value >= 1 && request.value <= 1e9)) return refuse("the number of steps must be 1 to 1e9");
      pause_.add_steps(static_cast<StepIndex>(request.value));
      show_running();
      return accept(n_);
    case wire::ControlAction::reset:
      if (keeper_.is_holding()) return refuse(keeper_.held_text() + kRepeatLater);
      accept(0);
      return start_epoch(now_ns, kJoinStep);
    case wire::ControlAction::stop:
      accept(n_);
      return begin_ending(ExitCode::ok, "", now_ns);
    case wire::ControlAction::save:
      return begin_saving(request, now_ns);
    case wire::ControlAction::load:
      if (const std::string why = keeper_.begin_loading(request, now_ns); !why.empty()) return refuse(why);
      return advance_loading(now_ns);
  }
}

}  // namespace slew::io_node
