// SPDX-License-Identifier: Apache-2.0
// Times of requests for a missing step: 3 ms after it was expected, then with doubling pauses up to 100 ms.
#pragma once

#include <algorithm>
#include <cstdint>

#include "node/session_member.h"

namespace slew::node {

class ResendClock {
 public:
  // Progress was made: the next message is expected at this time, now or later.
  void restart(std::int64_t expected_ns) noexcept {
    pause_ns_ = kResendAfter.ns;
    due_ns_ = expected_ns + pause_ns_;
  }
  [[nodiscard]] bool is_due(std::int64_t now_ns) const noexcept { return now_ns >= due_ns_; }
  void requested(std::int64_t now_ns) noexcept {
    pause_ns_ = std::min(2 * pause_ns_, kResendAtMost.ns);
    due_ns_ = now_ns + pause_ns_;
  }
  // A request has been due and the message is still missing.
  [[nodiscard]] bool is_overdue() const noexcept { return pause_ns_ > kResendAfter.ns; }
  [[nodiscard]] std::int64_t due_ns() const noexcept { return due_ns_; }

 private:
  std::int64_t pause_ns_ = kResendAfter.ns;
  std::int64_t due_ns_ = 0;
};

}  // namespace slew::node
