// SPDX-License-Identifier: Apache-2.0
// The wall clock of a program under test: hours off, and it may jump while the program runs.
//
// shifted_clock.cpp is loaded into the program in front of its libraries and replaces the kernel's clock. Both read one
// page of a file. A wait until an instant of the wall clock ends when the shifted clock shows that instant.
#pragma once

#include <atomic>
#include <cstdint>

namespace slew::testing {

struct ClockShift {
  std::atomic<std::int64_t> ns{0};      // added to CLOCK_REALTIME
  std::atomic<std::uint64_t> reads{0};  // number of reads of the shifted clock by the program
};

inline constexpr const char* kClockShiftVariable = "SLEWRING_TEST_CLOCK_SHIFT";

}  // namespace slew::testing
