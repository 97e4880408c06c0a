// SPDX-License-Identifier: Apache-2.0
#include "core/time.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <ctime>

namespace slew {
namespace {

std::int64_t read_clock(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

SimDuration duration_of_seconds(double seconds) noexcept {
  return {std::llround(seconds * 1e9)};
}

std::string seconds_text(SimDuration duration) {
  const double seconds = duration.seconds();
  return seconds < 999.5 ? fmt::format("{:.3g} s", seconds) : fmt::format("{:.0f} s", seconds);
}

std::int64_t monotonic_ns() noexcept {
  return read_clock(CLOCK_MONOTONIC);
}

std::int64_t wall_clock_ns() noexcept {
  return read_clock(CLOCK_REALTIME);
}

void sleep_until_monotonic(std::int64_t deadline_ns) noexcept {
  const timespec deadline{deadline_ns / 1'000'000'000, deadline_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

}  // namespace slew
