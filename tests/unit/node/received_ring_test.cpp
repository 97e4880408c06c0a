// SPDX-License-Identifier: Apache-2.0
#include "node/received_ring.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/allocation_guard.h"

namespace slew::node {
namespace received_ring_test {

using transport::Received;
using wire::Topic;

Received received_as_bytes(StepIndex step, std::vector<std::byte>& bytes) {
  wire::Tick tick;
  tick.header.step = step;
  EXPECT_TRUE(transport::encode(tick, bytes));
  Received received;
  received.topic = Topic::tick;
  received.bytes = bytes;
  return received;
}

TEST(ReceivedRing, HoldsBytesAndObjectsUntilTheirStepIsDone) {
  ReceivedRing<wire::Tick> ring(8);
  std::vector<std::byte> bytes;
  ASSERT_TRUE(ring.put(received_as_bytes(3, bytes), 3));
  const auto tick = std::make_shared<wire::Tick>();
  tick->header.step = 4;
  Received object;
  object.topic = Topic::tick;
  object.object = tick;
  object.header = &tick->header;
  ASSERT_TRUE(ring.put(object, 4));
  object.object.reset();
  ASSERT_NE(ring.find(3), nullptr);
  EXPECT_EQ(ring.find(3)->header.step, 3);
  EXPECT_EQ(ring.find(4), tick.get()) << "not a copy";
  EXPECT_EQ(ring.find(5), nullptr);
  ring.drop_before(4);
  EXPECT_EQ(ring.find(3), nullptr);
  EXPECT_EQ(ring.find(4), tick.get());
  ring.drop_before(1000);
  EXPECT_EQ(ring.find(4), nullptr);
  EXPECT_EQ(tick.use_count(), 1) << "given back";
}

TEST(ReceivedRing, RefusesBytesThatCannotBeDecodedAndKeepsWhatItHas) {
  ReceivedRing<wire::Tick> ring(2);
  std::vector<std::byte> bytes;
  ASSERT_TRUE(ring.put(received_as_bytes(1, bytes), 1));
  const std::vector<std::byte> damaged(bytes.begin(), bytes.begin() + 10);
  Received received;
  received.topic = Topic::tick;
  received.bytes = damaged;
  EXPECT_FALSE(ring.put(received, 3));  // the place of step 1
  ASSERT_NE(ring.find(1), nullptr);
  EXPECT_EQ(ring.find(1)->header.step, 1);
  EXPECT_EQ(ring.find(3), nullptr);
}

TEST(ReceivedRing, TakesEarlierStepsAgainAfterItWasCleared) {
  ReceivedRing<wire::Tick> ring(4);
  std::vector<std::byte> bytes;
  ASSERT_TRUE(ring.put(received_as_bytes(90, bytes), 90));
  ring.drop_before(90);
  ring.clear();
  EXPECT_EQ(ring.find(90), nullptr);
  ASSERT_TRUE(ring.put(received_as_bytes(0, bytes), 0));
  ring.drop_before(0);
  EXPECT_NE(ring.find(0), nullptr);
  ring.drop_before(1);
  EXPECT_EQ(ring.find(0), nullptr);
}

TEST(ReceivedRing, HoldsAsManyStepsAsItIsDeepWithoutAllocating) {
  ReceivedRing<wire::Tick> ring(16);
  std::vector<std::byte> bytes;
  const Received received = received_as_bytes(0, bytes);
  const AllocationGuard guard;
  for (StepIndex step = 0; step < 100; ++step) {
    static_cast<void>(ring.put(received, step));
    if (step % 40 == 39) ring.drop_before(step - 3);
  }
  EXPECT_EQ(guard.allocations(), 0u);
}

}  // namespace received_ring_test
}  // namespace slew::node
