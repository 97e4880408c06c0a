// SPDX-License-Identifier: Apache-2.0
// What waits for a client: every event in its order, of a state the newest value.
#include "gateway/outbox.h"

#include <gtest/gtest.h>

namespace outbox_test {

using namespace slew::gateway;

std::string event_of(Outbox::Next next) {
  const auto* const frame = std::get_if<Frame>(&next);
  return frame != nullptr ? frame->head : "no event";
}
int state_of(Outbox::Next next) {
  const auto* const state = std::get_if<std::size_t>(&next);
  return state != nullptr ? static_cast<int>(*state) : -1;
}

TEST(Outbox, GivesEventsInTheirOrderAndBeforeStates) {
  Outbox outbox(100);
  outbox.mark(0);
  ASSERT_TRUE(outbox.push(text_frame("a")));
  ASSERT_TRUE(outbox.push(text_frame("b")));
  EXPECT_EQ(event_of(outbox.next()), "a");
  EXPECT_EQ(event_of(outbox.next()), "b");
  EXPECT_EQ(state_of(outbox.next()), 0);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(outbox.next()));
}

TEST(Outbox, CountsTheValuesOfAStateThatNewerOnesReplaced) {
  Outbox outbox(100);
  for (int i = 0; i < 5; ++i) outbox.mark(3);
  EXPECT_EQ(state_of(outbox.next()), 3);
  EXPECT_EQ(state_of(outbox.next()), -1);
  EXPECT_EQ(outbox.take_left_out(), 4u);
  EXPECT_EQ(outbox.take_left_out(), 0u);
}

TEST(Outbox, TakesEachStateInTurnSoThatNoneStarves) {
  Outbox outbox(100);
  std::vector<int> taken;
  for (int i = 0; i < 6; ++i) {
    for (std::size_t state = 0; state < 3; ++state) outbox.mark(state);
    taken.push_back(state_of(outbox.next()));
  }
  EXPECT_EQ(taken, (std::vector{0, 1, 2, 0, 1, 2}));
}

TEST(Outbox, AnEventBeyondTheLimitIsRefusedFromThenOnAndStatesNeedNoRoom) {
  Outbox outbox(10);
  EXPECT_TRUE(outbox.push(text_frame("12345")));
  EXPECT_FALSE(outbox.push(text_frame("123456")));
  EXPECT_TRUE(outbox.is_full());
  EXPECT_FALSE(outbox.push(text_frame("1")));
  EXPECT_EQ(outbox.waiting_bytes(), 5u);
  for (std::size_t state = 0; state < 1000; ++state) outbox.mark(state);
  EXPECT_EQ(outbox.waiting_bytes(), 5u);
}

TEST(Outbox, AStateThatIsNotWantedAnyMoreDoesNotCome) {
  Outbox outbox(10);
  outbox.mark(1);
  outbox.mark(2);
  outbox.unmark(1);
  EXPECT_EQ(state_of(outbox.next()), 2);
  EXPECT_EQ(state_of(outbox.next()), -1);
}

}  // namespace outbox_test
