// SPDX-License-Identifier: Apache-2.0
// Waiting for a message or a condition with a deadline.
#pragma once

#include <cstdint>

#include "core/time.h"
#include "transport/transport.h"

namespace slew::testing {

inline constexpr std::int64_t kPatience = 30'000'000'000;  // ns; far longer than any exchange
inline constexpr std::int64_t kPause = 2'000'000;          // ns between two looks at a condition

// Waits for the next message; false when none came in time.
[[nodiscard]] inline bool next(transport::Transport& transport, transport::Received& message,
                               std::int64_t patience = kPatience) {
  const std::int64_t deadline = monotonic_ns() + patience;
  while (!transport.take(message)) {
    if (monotonic_ns() >= deadline) return false;
    transport.wait_until(deadline);
  }
  return true;
}

// Looks again and again until the condition holds; false when it did not in time.
template <typename Condition>
[[nodiscard]] bool eventually(Condition&& condition) {
  const std::int64_t deadline = monotonic_ns() + kPatience;
  while (!condition()) {
    if (monotonic_ns() >= deadline) return false;
    sleep_until_monotonic(monotonic_ns() + kPause);
  }
  return true;
}

}  // namespace slew::testing
