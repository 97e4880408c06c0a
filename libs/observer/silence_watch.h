// SPDX-License-Identifier: Apache-2.0
// Whether the nodes of a session publish: processes that were killed publish no end.
#pragma once

#include <cstdint>
#include <utility>

#include "core/time.h"
#include "observer/session_view.h"
#include "transport/roles.h"

namespace slew::observer {

inline constexpr SimDuration kSilentSession = milliseconds(5000);  // nodes publish their health ten times a second

class SilenceWatch {
 public:
  // True: the session has fallen silent since the last call, or publishes again. now_ns: monotonic.
  [[nodiscard]] bool has_changed(const SessionView& view, std::int64_t now_ns) noexcept {
    std::uint64_t healths = 0;
    for (const wire::Role role : transport::node_roles()) healths += view.node(role).healths;
    if (healths != healths_ || received_ns_ == 0) received_ns_ = now_ns;
    healths_ = healths;
    const bool is_silent = now_ns - received_ns_ > kSilentSession.ns;
    return is_silent != std::exchange(is_silent_, is_silent);
  }
  [[nodiscard]] bool is_silent() const noexcept { return is_silent_; }

 private:
  std::uint64_t healths_ = 0;     // messages of all nodes
  std::int64_t received_ns_ = 0;  // time of the last call that had a new one; 0: none
  bool is_silent_ = false;
};

}  // namespace slew::observer
