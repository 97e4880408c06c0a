// SPDX-License-Identifier: Apache-2.0
#include "io_node/requests.h"

#include <algorithm>
#include <utility>

#include "core/printable.h"

namespace slew::io_node {
namespace {

constexpr std::size_t kKeptAnswers = 64;  // for repeated requests

}  // namespace

using wire::Phase;
using wire::Topic;

void Requests::receive_controller(const transport::Received& message, StepIndex n, std::int64_t now_ns,
                                  TickTimes& times) {
  if (!member_.decode(message.bytes, input_)) return;
  if (input_.session != config_.session_name) {
    ++member_.refusals().other_session;
    return;
  }
  InputGate& gate = inputs_.gate();
  const int found = gate.find(input_.channel);
  const auto channel = static_cast<std::size_t>(found);
  const bool has_name = !input_.controller.empty() && is_printable(input_.controller);
  const bool is_known = found >= 0 && has_name;
  // writes come in every step and do not allocate
  if (is_known && input_.action == wire::ControllerAction::write) {
    if (gate.write(channel, input_.controller, input_.value, n, now_ns, input_.based_on_step, message.writer)) {
      const bool has_stamp = config_.controllers_clock == node::WriterClock::same;
      times.receive_value(
          channel, has_stamp ? node::sent_ns(message.source_ns, monotonic_ns(), node::WriterClock::same) : now_ns);
    } else if (auto refusal = gate.answer_to_write(channel, input_.controller, now_ns, message.writer)) {
      publish_lease(std::move(*refusal), n);
    }
    return;
  }
  if (!is_known) {
    return publish_lease({false, "",
                          found < 0 ? "the scene has no input '" + printable(input_.channel) + "'"
                                    : "a controller needs a name, without control characters"},
                         n);
  }
  LeaseAnswer answer = input_.action == wire::ControllerAction::release
                           ? gate.release(channel, input_.controller, input_.based_on_step, message.writer)
                       : input_.value == wire::kTakeOver
                           ? gate.take_over(channel, input_.controller, now_ns, message.writer)
                           : gate.acquire(channel, input_.controller, now_ns, message.writer);
  publish_notices(n);
  publish_lease(std::move(answer), n);
}

void Requests::publish_lease(LeaseAnswer answer, StepIndex n) {
  wire::ControllerLease lease;
  lease.header = member_.header(Phase::running, n);
  lease.controller = input_.controller;
  lease.channel = input_.channel;
  lease.is_granted = answer.is_granted;
  lease.holder = std::move(answer.holder);
  lease.reason = answer.reason.substr(0, wire::kMaxReasonLength);
  lease.answers = input_.sequence;
  member_.publish(Topic::controller_lease, lease);
}

void Requests::publish_notices(StepIndex n) {
  for (Notice& notice : inputs_.gate().take_notices()) {
    if (notice.controller.empty()) {
      publish_event(notice.reason, n);
    } else {
      wire::ControllerLease lease;
      lease.header = member_.header(Phase::running, n);
      lease.controller = std::move(notice.controller);
      lease.channel = inputs_.gate().config(notice.channel).name;
      lease.is_granted = notice.has_channel;
      if (notice.has_channel) lease.holder = lease.controller;
      lease.reason = notice.reason.substr(0, wire::kMaxReasonLength);
      member_.publish(Topic::controller_lease, lease);
    }
    if (warnings_left_ == 0) continue;
    member_.warn(notice.reason + (--warnings_left_ > 0 ? "" : "; what follows of this kind is in the recording alone"));
  }
}

// A client repeats its request until it receives an answer: the first request may precede the match with this node, the
// answer the match with the client.
bool Requests::repeat_answer(const wire::ControlRequest& request) {
  if (request.request == 0) return false;
  const auto found = std::ranges::find(answered_, request, &Answered::request);
  if (found == answered_.end()) return false;
  member_.publish(Topic::control_reply, found->reply);
  return true;
}

ControlAnswer Requests::set_parameter(const wire::ControlRequest& request, StepIndex n) {
  const ParameterCheck check = config_.check_parameter
                                   ? config_.check_parameter(request.path, request.value, request.over_ns)
                                   : ParameterCheck{false, "this session has no live parameters", 0};
  if (!check.is_accepted) return {request, false, check.reason, n};
  if (inputs_.waiting().size() >= wire::kMaxCommandsPerTick) {
    return {request, false,
            std::to_string(wire::kMaxCommandsPerTick) +
                " changes already wait for the next step; send it again after that step",
            n};
  }
  wire::Command change{request.request, request.path, request.value, check.over_ns};
  if (config_.check_course) {
    std::string refusal = config_.check_course(change, inputs_.course_with(change, n));
    if (!refusal.empty()) return {request, false, std::move(refusal), n};
  }
  inputs_.add_change(std::move(change));
  return {request, true, "", n};
}

ControlAnswer Requests::get_parameter(const wire::ControlRequest& request, StepIndex n) const {
  const LiveParameters& parameters = inputs_.parameters();
  const int parameter = parameters.find(request.path);
  if (parameter < 0) return {request, false, "no live parameter '" + request.path + "' in this session", n};
  const bool is_waiting =
      std::ranges::find(inputs_.waiting(), request.path, &wire::Command::path) != inputs_.waiting().end();
  const char* const remark = is_waiting                          ? "a change waits for the next step"
                             : parameters.is_changing(parameter) ? "on its way to a new value"
                                                                 : "";
  return {request, true, remark, n, parameters.value(parameter)};
}

void Requests::answer(const ControlAnswer& answer) {
  const wire::ControlRequest& request = answer.request;
  wire::ControlReply reply;
  reply.header = member_.header(Phase::running, answer.step);
  reply.request = request.request;
  reply.is_accepted = answer.is_accepted;
  reply.value = answer.value;
  reply.reason = answer.reason.substr(0, wire::kMaxReasonLength);
  // the request itself, for a recorder that has not received it
  if (request.request != 0) reply.asked = node::to_text(request).substr(0, wire::kMaxReasonLength);
  member_.publish(Topic::control_reply, reply);
  if (request.request == 0 || request.action == wire::ControlAction::get_parameter) return;
  if (answered_.size() == kKeptAnswers) answered_.pop_front();
  answered_.push_back({request, std::move(reply)});
}

}  // namespace slew::io_node
