// SPDX-License-Identifier: Apache-2.0
// Simulation time: integer nanoseconds and step numbers. Double seconds exist only inside an integrator.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace slew {

// Span of simulation or wall time in nanoseconds.
struct SimDuration {
  std::int64_t ns = 0;
  [[nodiscard]] constexpr double seconds() const noexcept { return static_cast<double>(ns) * 1e-9; }
  constexpr auto operator<=>(const SimDuration&) const noexcept = default;
};

// Instant of a session's logical clock; 0 is the start of step 0.
struct SimTime {
  std::int64_t ns = 0;
  [[nodiscard]] constexpr double seconds() const noexcept { return static_cast<double>(ns) * 1e-9; }
  constexpr auto operator<=>(const SimTime&) const noexcept = default;
};

// Number of a communication step; step n covers [n H, (n+1) H]. -1 is the join probe.
using StepIndex = std::int64_t;

inline constexpr StepIndex kJoinStep = -1;

[[nodiscard]] constexpr SimDuration milliseconds(std::int64_t ms) noexcept {
  return {ms * 1'000'000};
}
[[nodiscard]] constexpr SimDuration microseconds(std::int64_t us) noexcept {
  return {us * 1'000};
}

// Nearest whole nanosecond: 1.001 s is 1,001,000,000 ns, of which truncation makes one less. |seconds| below 9e9.
[[nodiscard]] SimDuration duration_of_seconds(double seconds) noexcept;

// "0.35 s", "12.3 s", "3600 s": three digits, all of them from 1000 s on.
[[nodiscard]] std::string seconds_text(SimDuration duration);

[[nodiscard]] constexpr SimTime start_of(StepIndex step, SimDuration communication_step) noexcept {
  return {step * communication_step.ns};
}

[[nodiscard]] constexpr SimTime operator+(SimTime t, SimDuration d) noexcept {
  return {t.ns + d.ns};
}
[[nodiscard]] constexpr SimDuration operator-(SimTime a, SimTime b) noexcept {
  return {a.ns - b.ns};
}
[[nodiscard]] constexpr SimDuration operator+(SimDuration a, SimDuration b) noexcept {
  return {a.ns + b.ns};
}
[[nodiscard]] constexpr SimDuration operator-(SimDuration a, SimDuration b) noexcept {
  return {a.ns - b.ns};
}

// Monotonic wall clock (CLOCK_MONOTONIC) in nanoseconds. Never enters physics.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;

// Wall-clock time since 1970 (CLOCK_REALTIME) in nanoseconds. For names and log entries only.
[[nodiscard]] std::int64_t wall_clock_ns() noexcept;

// Sleeps until the monotonic clock reaches the given instant.
void sleep_until_monotonic(std::int64_t deadline_ns) noexcept;

}  // namespace slew
