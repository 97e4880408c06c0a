// Processes whose place in a session was given to others (SessionDescription.given_up): their later messages are
// ignored.
#pragma once

#include <algorithm>

#include "transport/wire.h"

namespace slew::transport {

[[nodiscard]] inline bool is_given_up(const wire::SessionDescription& session, wire::Role role,
                                      std::uint32_t incarnation) noexcept {
  const wire::GivenUp process{role, incarnation};
  return std::find(session.given_up.begin(), session.given_up.end(), process) != session.given_up.end();
}

[[nodiscard]] inline bool is_given_up(const wire::SessionDescription& session, const wire::Header& writer) noexcept {
  return is_given_up(session, writer.role, writer.incarnation);
}

}  // namespace slew::transport
