#include "recorder_node/stream_gaps.h"

#include <gtest/gtest.h>

namespace slew::recorder {
namespace {

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

}  // namespace
}  // namespace slew::recorder
