// SPDX-License-Identifier: Apache-2.0
// Leases of a program that moves inputs of a session, for one controller name or several.
//
// A lease is requested when the first value for it comes, and again while values go on. A value that comes before the
// lease is not kept: an old value must not move the machine later. No value is repeated here: a silent source is a
// silent controller, and the session puts its input to neutral after session.controller_timeout.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "transport/wire.h"

namespace slew::observer {

class InputLeases {
 public:
  using Key = std::pair<std::string, std::string>;  // controller, input
  // Sends a message into the session; `session` is filled in there.
  using Send = std::function<void(const wire::ControllerInput&)>;

  explicit InputLeases(Send send);

  // Writes the value if the lease is held, else requests it: every 200 ms, after a refusal every second. based_on: step
  // whose variables the value follows from. Result: whether it was written.
  bool write(const Key& key, double value, StepIndex based_on, std::int64_t now_ns);
  // Requests the lease without a value. take_over: also from its holder, for the channel's supervisor.
  enum class Acquire : std::uint8_t { free, take_over };
  void request(const Key& key, Acquire acquire);
  void take(const wire::ControllerLease& lease);
  // After a reset every input is free.
  void take_epoch(std::uint32_t epoch);
  // Gives all inputs back, or one.
  void release();
  void release(const Key& key);

  [[nodiscard]] bool is_held(const Key& key) const;
  // Sentences for the user since the last call.
  [[nodiscard]] std::vector<std::string> take_notices() { return std::exchange(notices_, {}); }

 private:
  struct Lease {
    bool is_held = false;
    std::uint64_t requested_from = 0;  // number of the first message that requested it; 0: not requested
    std::int64_t next_request_ns = 0;
    std::string refusal{};  // last one that was reported
  };

  void send(const Key& key, wire::ControllerAction action, double value, StepIndex based_on);

  Send send_;
  std::map<Key, Lease> leases_;
  std::uint64_t sequence_;
  std::optional<std::uint32_t> epoch_;
  std::vector<std::string> notices_;
};

}  // namespace slew::observer
