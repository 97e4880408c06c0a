// SPDX-License-Identifier: Apache-2.0
// Inputs from LCM on their way into a session: a lease for each controller and channel, in the name lcm:<controller>.
//
// Accepted values are forwarded one by one and never repeated (observer/input_leases.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lcm_log/input_filter.h"
#include "observer/input_leases.h"
#include "transport/wire.h"

namespace slew::bridge {

inline constexpr const char* kLeasePrefix = "lcm:";

class Incoming {
 public:
  Incoming(std::vector<lcm_log::InputChannel> channels, std::vector<std::string> controllers,
           observer::InputLeases::Send send)
      : filter_(std::move(channels), std::move(controllers)), leases_(std::move(send)) {}

  void take(std::span<const std::byte> bytes, std::int64_t now_ns, StepIndex newest_step);
  void take(const wire::ControllerLease& lease) { leases_.take(lease); }
  // After a reset every channel is free.
  void take_epoch(std::uint32_t epoch) { leases_.take_epoch(epoch); }
  // Gives all channels back.
  void release() { leases_.release(); }

  [[nodiscard]] const lcm_log::InputCounts& counts() const noexcept { return filter_.counts(); }
  // Sentences for the user since the last call.
  [[nodiscard]] std::vector<std::string> take_notices();

 private:
  lcm_log::InputFilter filter_;
  observer::InputLeases leases_;
};

}  // namespace slew::bridge
