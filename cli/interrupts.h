// Signals that ask the program to end, counted: the first one ends a session in order, the second one at once.
#pragma once

namespace slew::cli {

// SIGINT, SIGTERM and SIGHUP are counted; the nodes' stop flag (node/driver.h) is set as well. SIGPIPE is ignored.
void count_interrupts();

[[nodiscard]] int interrupts() noexcept;
// Exit code that the first one asks for: 130 or 143; 0 before.
[[nodiscard]] int interrupt_code() noexcept;

}  // namespace slew::cli
