// SPDX-License-Identifier: Apache-2.0
// Answers of io_node to controllers and to control requests, and the events that it publishes.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "io_node/session_inputs.h"
#include "io_node/tick_times.h"
#include "node/session_member.h"
#include "transport/transport.h"

namespace slew::io_node {

inline constexpr int kControllerWarnings = 20;  // on standard error, per session

struct ControlAnswer {
  wire::ControlRequest request;
  bool is_accepted = false;
  std::string reason;
  StepIndex step = 0;
  double value = 0;
};

class Requests {
 public:
  Requests(const IoConfig& config, node::SessionMember& member, SessionInputs& inputs)
      : config_(config), member_(member), inputs_(inputs) {}

  // ---- controllers; n: the next tick
  void receive_controller(const transport::Received& message, StepIndex n, std::int64_t now_ns, TickTimes& times);
  // Publishes the notices of the input gate.
  void publish_notices(StepIndex n);

  // ---- control requests
  // Publishes an answer, and keeps it for a repeated request.
  void answer(const ControlAnswer& answer);
  // Answers a request that was answered before, which has no further effect. False: it is a new one.
  bool repeat_answer(const wire::ControlRequest& request);
  [[nodiscard]] ControlAnswer set_parameter(const wire::ControlRequest& request, StepIndex n);
  [[nodiscard]] ControlAnswer get_parameter(const wire::ControlRequest& request, StepIndex n) const;

  // Publishes an event of the session: an answer without a request, for the recording.
  void publish_event(const std::string& text, StepIndex n) { answer({{}, true, text, n}); }

 private:
  struct Answered {
    wire::ControlRequest request;
    wire::ControlReply reply;
  };

  // To the controller of input_.
  void publish_lease(LeaseAnswer answer, StepIndex n);

  const IoConfig& config_;
  node::SessionMember& member_;
  SessionInputs& inputs_;
  std::deque<Answered> answered_;  // the newest ones
  wire::ControllerInput input_;    // the message that is being received; its texts keep their memory
  int warnings_left_ = kControllerWarnings;
};

}  // namespace slew::io_node
