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

// Duration of a survey. With keys, processes agree on them before the first message: 0.4 s on an idle machine, seconds
// on a busy one.
struct SurveyTime {
  SimDuration quiet = milliseconds(1000);    // after the last session or node that was found
  SimDuration longest = milliseconds(3000);  // while there is none

  [[nodiscard]] static SurveyTime usual(const node::SessionOptions& options) noexcept;
};

// All sessions that publish within the time, by name. Time in which this process was not run does not count, up to ten
// times the longest. Those that are over are left out.
[[nodiscard]] std::vector<FoundSession> find_sessions(const node::SessionOptions& options, const SurveyTime& time);

// An observer with `look` can send no requests; one with `control` has the rights of a controller.
enum class Access : std::uint8_t { look, control, steer };

// Opens an observer of the named session, or of the only one that runs on the domain, and waits until it receives from
// it. Throws Failure when there is none, or more than one and no name. receiver: may be null.
[[nodiscard]] std::unique_ptr<observer::Observer> find_session(node::SessionOptions options, Access access,
                                                               observer::Receiver* receiver = nullptr);

}  // namespace slew::session
