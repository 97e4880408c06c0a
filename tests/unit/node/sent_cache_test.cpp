// SPDX-License-Identifier: Apache-2.0
#include "node/sent_cache.h"

#include <gtest/gtest.h>

#include "core/allocation_guard.h"

namespace slew::node {
namespace sent_cache_test {

TEST(SentCache, ALargeMessageTakesMemoryForItselfAlone) {
  SentCache sent(64);
  const std::vector<std::byte> usual(100), large(300);
  sent.keep(0, usual);
  const AllocationGuard guard;
  for (StepIndex step = 1; step < 100; ++step) sent.keep(step, usual);
  if (AllocationGuard::kCounts) {
    EXPECT_EQ(guard.allocations(), 0u);
  }
  sent.keep(100, large);
  for (StepIndex step = 101; step < 300; ++step) sent.keep(step, usual);
  if (AllocationGuard::kCounts) {
    EXPECT_EQ(guard.allocations(), 1u);
  }
}

TEST(SentCache, FindsWhatItKeptAtItsFullLength) {
  SentCache sent(4);
  for (StepIndex step = 0; step < 6; ++step) {
    sent.keep(step, std::vector<std::byte>(static_cast<std::size_t>(10 + step), std::byte{7}));
  }
  EXPECT_TRUE(sent.find(1).empty()) << "overwritten";
  for (StepIndex step = 2; step < 6; ++step) EXPECT_EQ(sent.find(step).size(), static_cast<std::size_t>(10 + step));
}

TEST(SentCache, GoesAsFarBackAsATimeWithin64MiB) {
  EXPECT_EQ(sent_depth(milliseconds(2000), milliseconds(1)), 2500u);
  EXPECT_EQ(sent_depth(milliseconds(10'000), milliseconds(1)), 10'500u);
  EXPECT_EQ(sent_depth(milliseconds(2000), {200'000}), 12'500u);
  EXPECT_EQ(sent_depth(milliseconds(2000), {300'001}), 8334u);
  EXPECT_EQ(sent_depth(milliseconds(500), milliseconds(1)), kSentDepth);
  EXPECT_EQ(sent_depth(milliseconds(60'000), {10'000}), kSentBytes / kLeastMessage);
  SentCache sent;
  sent.set_depth(sent_depth(milliseconds(2000), {10'000}));
  EXPECT_EQ(sent.depth(), 250'000u);
  const std::vector<std::byte> long_ones(4096);
  sent.keep(0, long_ones);
  EXPECT_EQ(sent.depth(), kSentBytes / long_ones.size());
  EXPECT_EQ(sent.find(0).size(), long_ones.size());
}

}  // namespace sent_cache_test
}  // namespace slew::node
