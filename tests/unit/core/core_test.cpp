// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

#include "core/allocation_guard.h"
#include "core/arithmetic_self_test.h"
#include "core/reductions.h"
#include "core/state_hash.h"
#include "core/static_vector.h"
#include "core/time.h"

namespace slew {
namespace core_test {

// values whose sum depends on the order of addition
std::vector<double> awkward_values(std::size_t n) {
  std::vector<double> values(n);
  double x = 0.37;
  for (double& value : values) {
    x = 3.9 * x * (1 - x);
    value = std::ldexp(x - 0.5, static_cast<int>(40 * x) - 20);
  }
  return values;
}

TEST(SimDuration, HasThreeDigits) {
  EXPECT_EQ(seconds_text(milliseconds(10'000)), "10 s");
  EXPECT_EQ(seconds_text(milliseconds(350)), "0.35 s");
  EXPECT_EQ(seconds_text(milliseconds(1'003)), "1 s");
  EXPECT_EQ(seconds_text(milliseconds(3'600'000)), "3600 s");
  EXPECT_EQ(seconds_text(milliseconds(999'600)), "1000 s");
  EXPECT_EQ(seconds_text({0}), "0 s");
}

TEST(Time, EveryWholeMillisecondIsItsNanoseconds) {
  for (std::int64_t ms = 0; ms <= 60'000; ++ms) {
    ASSERT_EQ(duration_of_seconds(static_cast<double>(ms) * 1e-3).ns, ms * 1'000'000);
    ASSERT_EQ(duration_of_seconds(static_cast<double>(ms) / 1000).ns, ms * 1'000'000);
  }
  EXPECT_EQ(duration_of_seconds(-1.001).ns, -1'001'000'000);
}

TEST(Reductions, DoNotDependOnTheAddress) {
  const std::vector<double> a = awkward_values(61);
  const std::vector<double> b = awkward_values(61);
  std::vector<double> storage(4 * 61 + 8);
  double expected = 0;
  for (std::size_t shift = 0; shift < 4; ++shift) {
    double* moved = storage.data() + shift;
    std::copy(a.begin(), a.end(), moved);
    const double dot = fixed_dot({moved, a.size()}, b);
    if (shift == 0) expected = dot;
    EXPECT_EQ(dot, expected) << "shifted by " << 8 * shift << " bytes";
  }
}

TEST(Reductions, ProductIsRight) {
  const std::vector<double> a = {1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(fixed_dot(a, a), 140);
}

TEST(Reductions, LargestAbsoluteValueReportsNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(fixed_max_abs(std::vector<double>{1, nan, 2})));
  EXPECT_EQ(fixed_max_abs(std::vector<double>{1, -3, 2}), 3);
  EXPECT_FALSE(all_finite(std::vector<double>{1, nan}));
}

TEST(StateHash, ChangesWithOneUlpOrderAndSignOfZero) {
  const auto hash = [](std::vector<double> values) {
    StateHash h;
    h.add(values);
    return h.digest();
  };
  EXPECT_EQ(hash({1, 2}), hash({1, 2}));
  EXPECT_NE(hash({1, 2}), hash({1, std::nextafter(2.0, 3.0)}));
  EXPECT_NE(hash({1, 2}), hash({2, 1}));
  EXPECT_NE(hash({0.0}), hash({-0.0}));
}

TEST(AllocationGuard, SeesEveryHeapCallOfThisThread) {
  if (!AllocationGuard::kCounts) GTEST_SKIP() << "a sanitizer is in front of malloc";
  const AllocationGuard guard;
  EXPECT_EQ(guard.allocations(), 0u);
  auto owned = std::make_unique<int>(3);
  void* volatile block = std::malloc(10);
  EXPECT_EQ(guard.allocations(), 2u);
  std::free(block);
  EXPECT_EQ(guard.frees(), 1u);
  EXPECT_EQ(*owned, 3);
}

TEST(ArithmeticSelfTest, IsRepeatable) {
  EXPECT_EQ(arithmetic_self_test(), arithmetic_self_test());
}

TEST(Time, StepsAreExactInNanoseconds) {
  EXPECT_EQ(start_of(3'000'000'000, milliseconds(1)).ns, 3'000'000'000'000'000);
  EXPECT_EQ((start_of(7, microseconds(10)) - start_of(5, microseconds(10))).ns, 20'000);
}

TEST(StaticVector, ComparesByContent) {
  StaticVector<double, 4> a{1, 2};
  StaticVector<double, 4> b{1};
  EXPECT_FALSE(a == b);
  b.push_back(2);
  EXPECT_TRUE(a == b);
}

}  // namespace core_test
}  // namespace slew
