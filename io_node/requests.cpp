// io_node's part that answers: controllers, commands, parameters, messages that are asked for again.
#include <algorithm>
#include <utility>

#include "core/printable.h"
#include "io_node/io_node.h"

namespace slew::io_node {
namespace {

constexpr std::size_t kKeptAnswers = 64;  // that a request which is sent again may need

}  // namespace

using wire::Phase;
using wire::Role;
using wire::Topic;

void IoNode::receive_controller(std::span<const std::byte> bytes, std::int64_t now_ns) {
  if (!transport::decode(bytes, input_)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (input_.session != config_.session_name) {
    ++member_.refusals().other_session;
    return;
  }
  const int found = gate_.find(input_.channel);
  const auto channel = static_cast<std::size_t>(found);
  const bool has_name = !input_.controller.empty() && is_printable(input_.controller);
  const bool is_known = found >= 0 && has_name;
  // in every step: no memory is taken for it
  if (is_known && input_.action == wire::ControllerAction::write) {
    if (gate_.write(channel, input_.controller, input_.value, n_, now_ns, input_.based_on_step, writer_)) {
      input_ns_[channel] = config_.controllers_clock == node::WriterClock::same
                               ? node::sent_ns(source_ns_, node::WriterClock::same)
                               : now_ns;
    } else if (std::optional<LeaseAnswer> told = gate_.answer_to_write(channel, input_.controller, now_ns, writer_)) {
      tell_lease(std::move(*told));
    }
    return;
  }
  if (!is_known) {
    return tell_lease({false, "",
                       found < 0 ? "the scene has no input '" + printable(input_.channel) + "'"
                                 : "a controller needs a name, without control characters"});
  }
  LeaseAnswer answer = input_.action == wire::ControllerAction::release
                           ? gate_.release(channel, input_.controller, input_.based_on_step, writer_)
                       : input_.value == wire::kTakeOver ? gate_.take_over(channel, input_.controller, now_ns, writer_)
                                                         : gate_.acquire(channel, input_.controller, now_ns, writer_);
  tell_notices();
  tell_lease(std::move(answer));
}

// to the controller whose message was received
void IoNode::tell_lease(LeaseAnswer answer) {
  wire::ControllerLease lease;
  lease.header = member_.header(Phase::running, n_);
  lease.controller = input_.controller;
  lease.channel = input_.channel;
  lease.is_granted = answer.is_granted;
  lease.holder = std::move(answer.holder);
  lease.reason = answer.reason.substr(0, wire::kMaxReasonLength);
  lease.answers = input_.sequence;
  member_.publish(Topic::controller_lease, lease);
}

void IoNode::receive_control(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::ControlRequest request;
  if (!transport::decode(bytes, request)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (request.session != config_.session_name) return;
  if (request.action == wire::ControlAction::get_parameter) return tell_parameter(request);
  if (is_asked_again(request)) return;
  if (stage_ != Stage::ticking) return answer(request, false, "the session is not running yet", n_);
  switch (request.action) {
    case wire::ControlAction::get_parameter:
      return;  // answered above, in every stage
    case wire::ControlAction::set_parameter:
      return set_parameter(request);
    case wire::ControlAction::pause:
      is_paused_ = true;
      single_steps_ = 0;
      show_running();
      return answer(request, true, "", n_);
    case wire::ControlAction::resume:
      // a pause is no slip
      if (is_paused_) clock_.excuse(n_, now_ns);
      is_paused_ = false;
      show_running();
      return answer(request, true, "", n_);
    case wire::ControlAction::step:
      if (!is_paused_) return answer(request, false, "pause the session first", n_);
      if (!(request.value >= 1 && request.value <= 1e9)) {
        return answer(request, false, "the number of steps must be 1 to 1e9", n_);
      }
      single_steps_ += static_cast<StepIndex>(request.value);
      show_running();
      return answer(request, true, "", n_);
    case wire::ControlAction::reset:
      if (!vacancies_.empty()) {
        return answer(request, false, vacancy_text(vacancies_.front()) + "; ask again when it has come", n_);
      }
      answer(request, true, "", 0);
      return start_epoch(now_ns);
    case wire::ControlAction::stop:
      answer(request, true, "", n_);
      return begin_ending(ExitCode::ok, "", now_ns);
    case wire::ControlAction::save:
      return begin_saving(request, now_ns);
    case wire::ControlAction::load:
      return begin_loading(request, now_ns);
  }
}

// Who asks sends its request until it is answered: the first may go before this node hears its writer, and the answer
// before it hears this one. A copy has the same answer and no further effect.
bool IoNode::is_asked_again(const wire::ControlRequest& request) {
  if (request.request == 0) return false;
  if (saving_ && saving_->request == request) return true;
  if (upload_.asked == request) return true;
  const auto found = std::find_if(answered_.begin(), answered_.end(),
                                  [&](const Answered& answered) { return answered.request == request; });
  if (found == answered_.end()) return false;
  member_.publish(Topic::control_reply, found->reply);
  return true;
}

void IoNode::set_parameter(const wire::ControlRequest& request) {
  const ParameterVerdict verdict = config_.judge_parameter
                                       ? config_.judge_parameter(request.path, request.value, request.over_ns)
                                       : ParameterVerdict{false, "this session has no live parameters", 0};
  if (!verdict.is_accepted) return answer(request, false, verdict.reason, n_);
  if (waiting_commands_.size() >= wire::kMaxCommandsPerTick) {
    return answer(request, false,
                  std::to_string(wire::kMaxCommandsPerTick) +
                      " changes already wait for the next step; send it again after that step",
                  n_);
  }
  wire::Command command;
  command.request = request.request;
  command.path = request.path;
  command.value = request.value;
  command.over_ns = verdict.over_ns;
  waiting_commands_.push_back(command);
  answer(request, true, "", n_);
}

void IoNode::tell_parameter(const wire::ControlRequest& request) {
  const int parameter = parameters_.find(request.path);
  if (parameter < 0) return answer(request, false, "no live parameter '" + request.path + "' in this session", n_);
  const bool is_waiting = std::any_of(waiting_commands_.begin(), waiting_commands_.end(),
                                      [&](const wire::Command& command) { return command.path == request.path; });
  const char* const remark = is_waiting                           ? "a change waits for the next step"
                             : parameters_.is_changing(parameter) ? "on its way to a new value"
                                                                  : "";
  answer(request, true, remark, n_, parameters_.value(parameter));
}

void IoNode::answer(const wire::ControlRequest& request, bool accepted, const std::string& reason, StepIndex step,
                    double value) {
  wire::ControlReply reply;
  reply.header = member_.header(Phase::running, step);
  reply.request = request.request;
  reply.is_accepted = accepted;
  reply.value = value;
  reply.reason = reason.substr(0, wire::kMaxReasonLength);
  // the recorder may not know yet who asks
  if (request.request != 0) reply.asked = node::to_text(request).substr(0, wire::kMaxReasonLength);
  member_.publish(Topic::control_reply, reply);
  if (request.request == 0 || request.action == wire::ControlAction::get_parameter) return;
  if (answered_.size() == kKeptAnswers) answered_.pop_front();
  answered_.push_back({request, std::move(reply)});
}

void IoNode::receive_resend(std::span<const std::byte> bytes, std::int64_t now_ns) {
  wire::ResendRequest request;
  if (!transport::decode(bytes, request)) {
    ++member_.refusals().undecodable;
    return;
  }
  if (request.topic == static_cast<std::uint8_t>(Topic::state)) return answer_state(request, now_ns);
  if (request.role != Role::io || !member_.is_of_session(request.header, Topic::resend)) return;
  if (request.topic != static_cast<std::uint8_t>(Topic::tick)) return;
  // a node that missed a reset asks with the old epoch: it gets the tick that started the new one
  const bool is_late_epoch = request.header.epoch < member_.epoch();
  const StepIndex first = is_late_epoch ? kJoinStep : request.header.step;
  const StepIndex last = is_late_epoch ? kJoinStep : std::min(request.last_step, first + node::kMostAnswers - 1);
  for (StepIndex step = first; step <= last; ++step) {
    const std::span<const std::byte> sent = sent_.find(step);
    if (sent.empty()) continue;
    member_.send(Topic::tick, sent);
    ++health().resends_answered;
  }
}

void IoNode::tell_notices() {
  for (Notice& notice : gate_.take_notices()) {
    if (notice.controller.empty()) {
      tell_event(notice.reason);
    } else {
      wire::ControllerLease lease;
      lease.header = member_.header(Phase::running, n_);
      lease.controller = std::move(notice.controller);
      lease.channel = gate_.config(notice.channel).name;
      lease.is_granted = notice.has_channel;
      if (notice.has_channel) lease.holder = lease.controller;
      lease.reason = notice.reason.substr(0, wire::kMaxReasonLength);
      member_.publish(Topic::controller_lease, lease);
    }
    if (warnings_left_ == 0) continue;
    member_.warn(notice.reason + (--warnings_left_ > 0 ? "" : "; what follows of this kind is in the recording alone"));
  }
}

}  // namespace slew::io_node
