// SPDX-License-Identifier: Apache-2.0
#include "recording/sort_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

namespace slew::recording {
namespace sort_window_test {

using Key = std::tuple<std::uint32_t, StepIndex, std::uint16_t, std::uint32_t>;

Key key_of(const WindowEntry& entry) {
  return {entry.stamp.epoch, entry.stamp.step, entry.channel, entry.stamp.sequence};
}

TEST(SortWindow, GivesRandomArrivalsInOrderWithTheirPayloads) {
  std::mt19937 random(7);
  SortWindow window(1'000'000, 6'000, 100);
  std::vector<Key> waiting;
  for (int round = 0; round < 20'000; ++round) {
    const Key key = {random() % 2, static_cast<StepIndex>(random() % 50), static_cast<std::uint16_t>(random() % 4),
                     static_cast<std::uint32_t>(round)};
    // the payload repeats a byte that the key determines
    const Bytes payload(random() % 200, static_cast<std::byte>(std::get<3>(key)));
    const MessageStamp stamp = {std::get<0>(key), std::get<1>(key), std::get<3>(key), 0};
    while (window.push(stamp, std::get<2>(key), payload) != SortWindow::PushResult::taken) {
      ASSERT_FALSE(window.is_empty());
      const auto expected = std::min_element(waiting.begin(), waiting.end());
      const WindowEntry& first = window.first();
      ASSERT_EQ(key_of(first), *expected);
      const ByteSpan held = window.payload_of(first);
      ASSERT_EQ(held.size(), first.size);
      ASSERT_TRUE(std::all_of(held.begin(), held.end(),
                              [&](std::byte b) { return b == static_cast<std::byte>(first.stamp.sequence); }));
      waiting.erase(expected);
      window.pop_first();
    }
    waiting.push_back(key);
  }
  EXPECT_EQ(waiting.empty(), window.is_empty());
}

TEST(SortWindow, TiesAreDecidedByContentNotByArrival) {
  for (const bool is_swapped : {false, true}) {
    SortWindow window(4, 1'000, 10);
    const std::string_view texts[] = {is_swapped ? "b" : "a", is_swapped ? "a" : "b"};
    for (const std::string_view text : texts) {
      ASSERT_EQ(window.push({0, 1, 1, 0}, 0, as_byte_span(text)), SortWindow::PushResult::taken);
    }
    EXPECT_EQ(as_text(window.payload_of(window.first())), "a");
  }
}

TEST(SortWindow, HoldsBackTheSpanOfSteps) {
  SortWindow window(3, 1'000, 10);
  for (StepIndex step = 0; step < 3; ++step) {
    ASSERT_EQ(window.push({0, step, 0, 0}, 0, {}), SortWindow::PushResult::taken);
    EXPECT_FALSE(window.is_first_due());
  }
  ASSERT_EQ(window.push({0, 3, 0, 0}, 0, {}), SortWindow::PushResult::taken);
  EXPECT_TRUE(window.is_first_due());
  window.pop_first();
  EXPECT_FALSE(window.is_first_due());
}

TEST(SortWindow, RefusesWhatItCanNeverHold) {
  SortWindow window(3, 64, 10);
  EXPECT_EQ(window.push({}, 0, Bytes(57)), SortWindow::PushResult::too_large);
  EXPECT_EQ(window.push({}, 0, Bytes(56)), SortWindow::PushResult::taken);
  EXPECT_EQ(window.push({}, 0, Bytes(1)), SortWindow::PushResult::full);
  window.pop_first();
  EXPECT_EQ(window.push({}, 0, Bytes(1)), SortWindow::PushResult::taken);
}

}  // namespace sort_window_test
}  // namespace slew::recording
