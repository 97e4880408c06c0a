// SPDX-License-Identifier: Apache-2.0
// Counts of ticks that a recorder updates while it writes.
#include "node/tick_counter.h"

#include <gtest/gtest.h>

namespace slew::node {
namespace tick_counter_test {

constexpr std::int64_t kMs = 1'000'000;

void take(TickCounter& counter, std::uint32_t epoch, StepIndex step, std::int64_t sent_ns, std::uint32_t flags = 0) {
  wire::Header header;
  header.phase = wire::Phase::running;
  header.epoch = epoch;
  header.step = step;
  counter.take(header, flags);
  counter.take_time(sent_ns);
}

void io_reports(TickCounter& counter, wire::NodeState state, std::int64_t sent_ns, const char* reason = "") {
  wire::NodeStatus io;
  io.header.role = wire::Role::io;
  io.state = state;
  io.reason = reason;
  counter.take_status(io, sent_ns);
}

TEST(TickCounter, CountsStepsOfAllEpochsAndWallTimeWithoutPauses) {
  TickCounter counter(milliseconds(1));
  io_reports(counter, wire::NodeState::running, 1);
  for (StepIndex step = 0; step < 10; ++step) take(counter, 0, step, (100 + step) * kMs);
  io_reports(counter, wire::NodeState::holding, 110 * kMs);
  io_reports(counter, wire::NodeState::running, 500 * kMs);
  take(counter, 0, 10, 509 * kMs);
  // holding for a node is not a pause
  io_reports(counter, wire::NodeState::holding, 510 * kMs, "waits for mechanics");
  take(counter, 0, 13, 609 * kMs);
  for (StepIndex step = 0; step < 5; ++step) take(counter, 1, step, (700 + step) * kMs);
  EXPECT_TRUE(counter.is_in_order());
  const TickSpan span = counter.span();
  EXPECT_EQ(span.steps, 14 + 5) << "lost ticks between others count";
  EXPECT_EQ(span.epoch, 1u);
  EXPECT_EQ(span.next, 5);
  EXPECT_NEAR(span.paused_time, 0.399, 1e-9);
  EXPECT_NEAR(span.wall_time, 0.604 - 0.399, 1e-9);
  EXPECT_EQ(span.behind_end, 0u);
  const std::optional<TickSpan> read = tick_span_of(text_of(span));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->wall_time, span.wall_time);
  EXPECT_EQ(read->paused_time, span.paused_time);
  EXPECT_EQ(read->steps, span.steps);
  EXPECT_EQ(read->next, span.next);
  EXPECT_FALSE(tick_span_of("1 2 x"));
}

TEST(TickCounter, CountsTicksAfterAnEndAndDetectsALateOne) {
  TickCounter counter(milliseconds(1));
  for (const StepIndex step : {0, 1, 2, 3}) take(counter, 0, step, (1 + step) * kMs);
  take(counter, 0, 2, 5 * kMs, static_cast<std::uint32_t>(wire::TickFlag::end));
  EXPECT_EQ(counter.span().behind_end, 2u);
  EXPECT_TRUE(counter.is_in_order());
  take(counter, 0, 4, 3 * kMs);
  EXPECT_FALSE(counter.is_in_order());
}

}  // namespace tick_counter_test
}  // namespace slew::node
