// SPDX-License-Identifier: Apache-2.0
// What this host offers a session: its network interfaces, and the names that may stand for its endpoints.
#pragma once

#include <string>

#include "core/status.h"
#include "transport/network.h"

namespace slew::transport {

inline constexpr std::uint32_t kFirstPort = 7400, kPortsOfDomain = 250;  // RTPS 2.5, 9.6.2

// Reports a domain's number or a peer that no middleware takes.
[[nodiscard]] Status check(const Network& network);
// Reports a session's name that is none.
[[nodiscard]] Status check(const Endpoint& endpoint);

// Fills `address` with the IPv4 address of the interface, or reports which ones exist.
[[nodiscard]] Status find_address(const std::string& interface, std::string& address);

}  // namespace slew::transport
