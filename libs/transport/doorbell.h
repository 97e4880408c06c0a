// SPDX-License-Identifier: Apache-2.0
// A word of bits that other threads set and one thread sleeps on: the shortest way from a receiving thread to the loop.
//
// A futex of Linux on an atomic word; no lock, no allocation, and no system call while no thread sleeps.
#pragma once

#include <atomic>
#include <cstdint>

namespace slew::transport {

class Doorbell {
 public:
  // Sets bits and wakes the sleeper. Any thread.
  void ring(std::uint32_t bits) noexcept;

  // The bits set since the last call; the sleeper's thread.
  [[nodiscard]] std::uint32_t collect() noexcept { return bits_.exchange(0); }

  // Returns when a bit is set or the monotonic clock reaches the deadline; the sleeper's thread.
  void wait_until(std::int64_t monotonic_deadline_ns) noexcept;

 private:
  std::atomic<std::uint32_t> bits_{0};
  std::atomic<bool> is_asleep_{false};
};

}  // namespace slew::transport
