// Inputs from LCM on their way into a session: a lease for each controller and channel, in the name lcm:<controller>.
//
// A lease is requested when the first accepted input for it arrives, and again while inputs go on. The value of an
// input that comes before the lease is not kept: an old value must not move the machine later. Values are forwarded
// one by one and never repeated, so that a silent sender is a silent controller: the session puts the channel to
// neutral after session.controller_timeout.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lcm_log/input_filter.h"
#include "transport/wire.h"

namespace slew::bridge {

inline constexpr const char* kLeasePrefix = "lcm:";

class Incoming {
 public:
  // Sends a message into the session; `session` is filled in there.
  using Send = std::function<void(const wire::ControllerInput&)>;

  Incoming(std::vector<lcm_log::InputChannel> channels, std::vector<std::string> controllers, Send send);

  void take(std::span<const std::byte> bytes, std::int64_t now_ns, StepIndex newest_step);
  void take(const wire::ControllerLease& lease);
  // After a reset every channel is free.
  void take_epoch(std::uint32_t epoch);
  // Gives all channels back.
  void release();

  [[nodiscard]] const lcm_log::InputCounts& counts() const noexcept { return filter_.counts(); }
  // Sentences for the user since the last call.
  [[nodiscard]] std::vector<std::string> take_notices();

 private:
  struct Lease {
    bool is_held = false;
    std::uint64_t requested_from = 0;  // number of the first message that requested it; 0: not requested
    std::int64_t next_request_ns = 0;
    std::string refusal{};  // last one that was reported
  };
  using Key = std::pair<std::string, std::string>;  // lease name, channel

  void send(const Key& key, wire::ControllerAction action, double value, StepIndex based_on);

  lcm_log::InputFilter filter_;
  Send send_;
  std::map<Key, Lease> leases_;
  std::uint64_t sequence_;
  std::optional<std::uint32_t> epoch_;
  std::vector<std::string> notices_;
};

}  // namespace slew::bridge
