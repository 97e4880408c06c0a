// SPDX-License-Identifier: Apache-2.0
// What the messages of a session state about it: processes that have lost their place, and pauses.
#pragma once

#include <algorithm>

#include "transport/wire.h"

namespace slew::transport {

// The place of the process was given to another one: its later messages are ignored.
[[nodiscard]] inline bool is_given_up(const wire::SessionDescription& session, wire::Role role,
                                      std::uint32_t incarnation) noexcept {
  const wire::GivenUp process{role, incarnation};
  return std::find(session.given_up.begin(), session.given_up.end(), process) != session.given_up.end();
}

[[nodiscard]] inline bool is_given_up(const wire::SessionDescription& session, const wire::Header& writer) noexcept {
  return is_given_up(session, writer.role, writer.incarnation);
}

// Status of io_node in a pause that was requested; when it waits for a node, the status has a reason.
[[nodiscard]] inline bool is_pause(const wire::NodeStatus& io) noexcept {
  return io.state == wire::NodeState::holding && io.reason.empty();
}

}  // namespace slew::transport
