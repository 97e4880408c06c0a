// SPDX-License-Identifier: Apache-2.0
// Requests to a live session that wait for their replies. A request is repeated until it is answered: io_node
// recognises a copy and answers it again. Each client has a share of them, so that none can use up all.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/time.h"
#include "transport/wire.h"

namespace slew::gateway {

class Requests {
 public:
  struct Answer {
    bool is_accepted = false;
    StepIndex step = kJoinStep;  // the first one with the change
    double value = 0;            // SI: of get_parameter
    std::string reason{};        // of a refusal
  };
  using Done = std::function<void(const Answer&)>;
  // Sends a request into the session and returns its number.
  using Send = std::function<std::uint64_t(wire::ControlRequest)>;

  // Sender of a request: a client, or the gateway itself.
  using Owner = std::uint32_t;
  static constexpr Owner kGateway = 0;
  static constexpr std::size_t kMostOfOwner = 16, kMostWaiting = 128;

  explicit Requests(Send send) : send_(std::move(send)) {}

  // done is called once: with the session's answer, or with a refusal when it has not come within 3 s, or when as many
  // others of this owner, or of all, wait already.
  void send(wire::ControlRequest request, Owner owner, Done done, std::int64_t now_ns);
  // Returns whether the reply was to one of these.
  bool take(const wire::ControlReply& reply);
  void poll(std::int64_t now_ns);
  [[nodiscard]] std::size_t waiting_of(Owner owner) const noexcept;

 private:
  struct Entry {
    wire::ControlRequest request;
    Owner owner = kGateway;
    Done done;
    std::int64_t begin_ns = 0, next_ns = 0;
  };
  Send send_;
  std::vector<Entry> entries_;
};

}  // namespace slew::gateway
