// SPDX-License-Identifier: Apache-2.0
// Requests from LCM for live parameters, and the session's replies. A request is repeated towards the session until it
// is answered; one that LCM repeats is done once and answered again.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>

#include "lcm_log/messages.h"
#include "transport/wire.h"

namespace slew::bridge {

class ParameterDoor {
 public:
  struct Reply {
    lcm_log::ParameterRequest request;
    bool is_accepted = false;
    StepIndex step = kJoinStep;
    double value = 0;
    std::string reason{};
  };
  // send: into the session, returns the request's number there; reply: to LCM.
  ParameterDoor(std::function<std::uint64_t(wire::ControlRequest)> send, std::function<void(const Reply&)> reply)
      : send_(std::move(send)), reply_(std::move(reply)) {}

  void take(std::span<const std::byte> bytes, std::int64_t now_ns);
  void take(const wire::ControlReply& reply);
  // Repeats requests, and gives up those without an answer.
  void poll(std::int64_t now_ns);

  // Requests that were damaged, not finite or too many at once.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  struct Entry {
    Reply reply;
    wire::ControlRequest request;
    bool is_answered = false;
    std::int64_t begin_ns = 0, next_ns = 0;
  };
  void answer(Entry& entry);

  std::function<std::uint64_t(wire::ControlRequest)> send_;
  std::function<void(const Reply&)> reply_;
  std::deque<Entry> entries_;  // the last ones
  std::uint64_t refused_ = 0;
};

// As bytes of a reply_t.
void encode(const ParameterDoor::Reply& reply, std::string& bytes);

}  // namespace slew::bridge
