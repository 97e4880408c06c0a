// SPDX-License-Identifier: Apache-2.0
#include "recorder_node/stream_gaps.h"

#include <gtest/gtest.h>

namespace slew::recorder_node {
namespace stream_gaps_test {

using Arrival = StreamGaps::Arrival;

TEST(StreamGaps, ContiguousStreamHasNoGap) {
  StreamGaps stream;
  for (StepIndex step = 0; step < 10'000; ++step) {
    EXPECT_EQ(stream.arrived(step), Arrival::new_step);
    EXPECT_FALSE(stream.has_gap());
  }
  EXPECT_EQ(stream.next(), 10'000);
  EXPECT_EQ(stream.lost(), 0u);
}

TEST(StreamGaps, GapIsNamedUntilItIsFilled) {
  StreamGaps stream;
  stream.arrived(0);
  stream.arrived(4);
  stream.arrived(6);
  EXPECT_TRUE(stream.has_gap());
  EXPECT_EQ(stream.next(), 1);
  EXPECT_EQ(stream.gap_end(), 3);
  for (const StepIndex step : {2, 1, 3}) EXPECT_EQ(stream.arrived(step), Arrival::new_step);
  EXPECT_EQ(stream.next(), 5);
  EXPECT_EQ(stream.gap_end(), 5);
  stream.arrived(5);
  EXPECT_FALSE(stream.has_gap());
  EXPECT_EQ(stream.lost(), 0u);
}

TEST(StreamGaps, DuplicatesAreSeenBeforeAndAfterAGap) {
  StreamGaps stream;
  stream.arrived(0);
  stream.arrived(2);
  EXPECT_EQ(stream.arrived(0), Arrival::duplicate);
  EXPECT_EQ(stream.arrived(2), Arrival::duplicate);
}

TEST(StreamGaps, WhatNeverComesIsCountedAsLost) {
  StreamGaps stream(8);
  stream.arrived(0);
  for (StepIndex step = 3; step < 20; ++step) stream.arrived(step);
  EXPECT_EQ(stream.lost(), 2u);
  EXPECT_EQ(stream.next(), 20);
  stream.close_at(22);
  EXPECT_EQ(stream.lost(), 5u);
}

TEST(StreamGaps, ReportsOnceWhatItHasGivenUp) {
  StreamGaps stream(64);
  for (const StepIndex step : {0, 1, 4, 7, 8}) stream.arrived(step);
  stream.give_up_before(6);
  EXPECT_EQ(stream.next(), 6);
  const StreamGaps::Lost first = stream.take_lost();
  EXPECT_EQ(first.first, 2);
  EXPECT_EQ(first.last, 5);
  EXPECT_EQ(first.steps, 3u);
  EXPECT_EQ(stream.take_lost().steps, 0u);
  stream.give_up_before(7);
  EXPECT_EQ(stream.next(), 9) << "7 and 8 have come";
  EXPECT_EQ(stream.take_lost().steps, 1u);
  stream.give_up_before(5);
  EXPECT_EQ(stream.lost(), 4u);
}

TEST(StreamGaps, OneOddStepGivesUpNothing) {
  StreamGaps stream(8);
  stream.arrived(0);
  for (const StepIndex odd : {StepIndex{17}, StepIndex{1} << 53, StepIndex{100}}) {
    EXPECT_EQ(stream.arrived(odd), Arrival::too_far) << odd;
  }
  EXPECT_EQ(stream.arrived(1), Arrival::new_step);
  EXPECT_EQ(stream.next(), 2);
  EXPECT_EQ(stream.newest(), 1);
  EXPECT_EQ(stream.lost(), 0u);
}

TEST(StreamGaps, StreamThatWentOnFarAheadIsFoundAgain) {
  StreamGaps stream(8);
  stream.arrived(0);
  EXPECT_EQ(stream.arrived(1000), Arrival::too_far);
  EXPECT_EQ(stream.arrived(1001), Arrival::new_step);
  // steps within a depth can still be requested
  EXPECT_EQ(stream.next(), 994);
  EXPECT_EQ(stream.lost(), 993u);
  for (StepIndex step = 994; step <= 1000; ++step) EXPECT_EQ(stream.arrived(step), Arrival::new_step);
  EXPECT_FALSE(stream.has_gap());
}

TEST(StreamGaps, ClosingFarAheadCountsWithoutCountingOneByOne) {
  StreamGaps stream(8);
  stream.arrived(0);
  stream.arrived(2);
  stream.close_at(StepIndex{1} << 53);
  EXPECT_EQ(stream.next(), (StepIndex{1} << 53) + 1);
  EXPECT_EQ(stream.lost(), (std::uint64_t{1} << 53) - 1);
}

}  // namespace stream_gaps_test
}  // namespace slew::recorder_node
