// SPDX-License-Identifier: Apache-2.0
#include "recording/state_hashes.h"

#include <gtest/gtest.h>

#include <limits>

namespace slew::recording {
namespace state_hashes_test {

StateHashes of(std::initializer_list<StepIndex> steps) {
  StateHashes hashes;
  hashes.role = 1;
  hashes.epoch = 3;
  for (const StepIndex step : steps) hashes.add(step, 1000 + static_cast<std::uint64_t>(step));
  return hashes;
}

TEST(StateHashes, AreTheSameInAnyOrderAndInParts) {
  const StateHashes straight = of({40, 41, 42, 43}), mixed = of({42, 40, 43, 41});
  EXPECT_EQ(straight.digest, mixed.digest);
  EXPECT_EQ(mixed.first_step, 40);
  EXPECT_EQ(mixed.last_step, 43);
  StateHashes sum;
  sum.add(of({41, 43}));
  sum.add(of({40, 42}));
  EXPECT_EQ(sum.role, 1u);
  EXPECT_EQ(sum.epoch, 3u);
  EXPECT_EQ(sum.digest, straight.digest);
  EXPECT_EQ(sum.count, 4u);
  EXPECT_EQ(sum.first_step, 40);
  EXPECT_EQ(sum.last_step, 43);
}

TEST(StateHashes, DifferWhenOneBitOfAHashOrTwoStepsAreExchanged) {
  StateHashes other = of({40, 41});
  other.add(42, 1042 ^ 1);
  EXPECT_NE(other.digest, of({40, 41, 42}).digest);
  StateHashes exchanged;
  exchanged.add(40, 1041);
  exchanged.add(41, 1040);
  EXPECT_NE(exchanged.digest, of({40, 41}).digest);
}

TEST(StateHashes, GoThroughTheFile) {
  const StateHashes written = of({40, 47, 59});
  Bytes bytes;
  encode_state_hashes(written, bytes);
  EXPECT_EQ(bytes.size(), 40u);
  StateHashes read;
  ASSERT_TRUE(decode_state_hashes(bytes, read));
  EXPECT_EQ(read.first_step, 40);
  EXPECT_EQ(read.last_step, 59);
  EXPECT_EQ(read.role, 1u);
  EXPECT_EQ(read.epoch, 3u);
  EXPECT_EQ(read.count, 3u);
  EXPECT_EQ(read.digest, written.digest);
  bytes.pop_back();
  EXPECT_FALSE(decode_state_hashes(bytes, read)) << "cut";
}

// a reader counts from the first to the last step
TEST(StateHashes, OfAStepThatHasNoNextOneAreRefused) {
  StateHashes last = of({std::numeric_limits<StepIndex>::max()});
  Bytes bytes;
  encode_state_hashes(last, bytes);
  StateHashes read;
  EXPECT_FALSE(decode_state_hashes(bytes, read));
}

TEST(StateHashes, OfStepsOfTwoBlocksOrNoneAreRefused) {
  Bytes bytes;
  StateHashes read;
  encode_state_hashes(of({59, 60}), bytes);
  EXPECT_FALSE(decode_state_hashes(bytes, read));
  encode_state_hashes(of({}), bytes);
  EXPECT_FALSE(decode_state_hashes(bytes, read));
}

}  // namespace state_hashes_test
}  // namespace slew::recording
