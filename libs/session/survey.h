// SPDX-License-Identifier: Apache-2.0
// The sessions that run on a domain, and an observer of one of them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "node/session_options.h"
#include "observer/observer.h"
#include "transport/wire.h"

namespace slew::session {

struct FoundSession {
  wire::SessionDescription description;
  std::array<wire::NodeStatus, wire::kRoles> nodes{};
  std::array<bool, wire::kRoles> has_status{};
  StepIndex step = kJoinStep;
};

// All sessions that publish within the time, by name; while there are none, waits on up to the longest time. Those that
// are over are left out.
[[nodiscard]] std::vector<FoundSession> find_sessions(const node::SessionOptions& options, SimDuration time,
                                                      SimDuration longest);

// An observer with `look` can send no requests; one with `control` has the rights of a controller.
enum class Access : std::uint8_t { look, control, steer };

// Opens an observer of the named session, or of the only one that runs on the domain, and waits until it receives from
// it. Throws Failure when there is none, or more than one and no name. receiver: may be null.
[[nodiscard]] std::unique_ptr<observer::Observer> find_session(node::SessionOptions options, Access access,
                                                               observer::Receiver* receiver = nullptr);

}  // namespace slew::session
