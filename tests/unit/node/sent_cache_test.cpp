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

}  // namespace sent_cache_test
}  // namespace slew::node
