// Signals that ask the program to end: the first one ends a session in order, a Ctrl-C some time after it at once.
#pragma once

#include "core/time.h"

namespace slew::session {

// A terminal that is closed, and programs like timeout(1), send their signals twice: nobody has changed his mind
// before.
inline constexpr SimDuration kSecondThought = milliseconds(500);

// SIGINT, SIGTERM and SIGHUP are counted; the nodes' stop flag (node/driver.h) is set as well. SIGPIPE is ignored.
void count_interrupts();

[[nodiscard]] int interrupts() noexcept;
// Exit code that the first one asks for: 130 or 143; 0 before.
[[nodiscard]] int interrupt_code() noexcept;
// Those by Ctrl-C (SIGINT) that somebody meant: the first signal of all, and what came kSecondThought after it.
// SIGTERM and SIGHUP are none, however often they come.
[[nodiscard]] int ctrl_cs() noexcept;

}  // namespace slew::session
