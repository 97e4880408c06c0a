// SPDX-License-Identifier: Apache-2.0
// Signals that request the program to end: the first one ends a session in order, a Ctrl-C some time after it at once.
#pragma once

#include "core/time.h"

namespace slew::session {

// A closing terminal and programs like timeout(1) send their signals twice: a second signal within this time is not a
// second request of the user.
inline constexpr SimDuration kSecondThought = milliseconds(500);

// SIGINT, SIGTERM and SIGHUP are counted; the nodes' stop flag (node/driver.h) is set as well. SIGPIPE is ignored.
void count_interrupts();

[[nodiscard]] int interrupts() noexcept;
// Exit code that the first signal requests: 130 or 143; 0 before.
[[nodiscard]] int interrupt_code() noexcept;
// Number of Ctrl-Cs (SIGINT) that count as requests: the first signal of all, and those more than kSecondThought after
// it. SIGTERM and SIGHUP never count.
[[nodiscard]] int ctrl_cs() noexcept;

}  // namespace slew::session
