// SPDX-License-Identifier: Apache-2.0
// The doorbell without the middleware: the thread sanitizer cannot see behind libddsc.
#include "transport/doorbell.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

#include "core/time.h"

namespace slew::transport {
namespace doorbell_test {

constexpr std::size_t kRingers = 4;
constexpr int kRounds = 2000;
constexpr std::int64_t kPatience = 30'000'000'000;  // ns

TEST(DoorbellThreads, WhatIsWrittenBeforeARingIsReadAfterItAndNoRingIsLost) {
  Doorbell doorbell;
  std::array<int, kRingers> written{};  // no atomics: the bell orders them
  std::array<Doorbell, kRingers> answers;
  std::vector<std::thread> ringers;
  for (std::size_t i = 0; i < kRingers; ++i) {
    ringers.emplace_back([&, i] {
      for (int round = 1; round <= kRounds; ++round) {
        written[i] = round;
        doorbell.ring(1u << i);
        const std::int64_t deadline = monotonic_ns() + kPatience;
        while (answers[i].collect() == 0 && monotonic_ns() < deadline) answers[i].wait_until(deadline);
      }
    });
  }
  std::array<int, kRingers> read{};
  const std::int64_t deadline = monotonic_ns() + kPatience;
  const auto all_read = [&] {
    for (const int count : read) {
      if (count < kRounds) return false;
    }
    return true;
  };
  while (!all_read() && monotonic_ns() < deadline) {
    doorbell.wait_until(deadline);
    const std::uint32_t bits = doorbell.collect();
    for (std::size_t i = 0; i < kRingers; ++i) {
      if ((bits & 1u << i) == 0) continue;
      EXPECT_EQ(written[i], ++read[i]);
      answers[i].ring(1);
    }
  }
  for (std::thread& ringer : ringers) ringer.join();
  EXPECT_TRUE(all_read());
}

}  // namespace doorbell_test
}  // namespace slew::transport
