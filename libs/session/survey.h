// The sessions that run on a domain.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "node/session_options.h"
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

// Name of the one session of the domain. Throws Failure when there is none or more than one.
[[nodiscard]] std::string only_session(const node::SessionOptions& options);

}  // namespace slew::session
