// SPDX-License-Identifier: Apache-2.0
#include "core/hdr_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace slew {
namespace hdr_histogram_test {

constexpr double kShares[] = {0, 0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1};

// durations of 100 ns to 20 s, as many in each decade
std::vector<std::int64_t> durations(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<std::int64_t> values(n);
  for (std::int64_t& value : values) {
    const double u = static_cast<double>(random() >> 11) * 0x1p-53;
    value = static_cast<std::int64_t>(100 * std::pow(10, 8.3 * u));
  }
  return values;
}

std::int64_t of_sorted(const std::vector<std::int64_t>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(1, rank) - 1];
}

void expect_percentiles_of(const HdrHistogram& histogram, std::vector<std::int64_t> values) {
  std::sort(values.begin(), values.end());
  ASSERT_EQ(histogram.count(), values.size());
  EXPECT_EQ(histogram.min(), values.front());
  EXPECT_EQ(histogram.max(), values.back());
  std::array<std::int64_t, std::size(kShares)> together{};
  histogram.percentiles(kShares, together);
  for (std::size_t i = 0; i < together.size(); ++i) EXPECT_EQ(together[i], histogram.percentile(kShares[i]));
  for (const double share : kShares) {
    const std::int64_t exact = of_sorted(values, share);
    EXPECT_GE(histogram.percentile(share), exact) << share;
    EXPECT_LE(histogram.percentile(share), exact + exact / 128 + 64) << share;
  }
}

TEST(HdrHistogram, PercentilesAreThoseOfTheSortedValuesToOnePart128) {
  for (const std::size_t n : {1u, 2u, 10u, 997u, 20'000u}) {
    const auto histogram = std::make_unique<HdrHistogram>();
    const std::vector<std::int64_t> values = durations(n, static_cast<unsigned>(n));
    for (const std::int64_t value : values) histogram->record(value);
    expect_percentiles_of(*histogram, values);
  }
}

TEST(HdrHistogram, FallingValuesAreAsThoseRecordedOneByOne) {
  struct {
    std::int64_t largest_ns, apart_ns;
    std::uint64_t count;
  } const kFalls[] = {{0, 1, 1},
                      {8191, 1, 8192},  // down to 0 through all of the linear part
                      {799'500'000, 1'000'000, 799},
                      {51'234'567, 10'000, 5123},
                      {3'600'000'000'000, 1'000'000, 3'600'000}};  // beyond the largest bucket
  for (const auto& fall : kFalls) {
    const auto one_by_one = std::make_unique<HdrHistogram>(), together = std::make_unique<HdrHistogram>();
    for (std::uint64_t i = 0; i < fall.count; ++i) {
      one_by_one->record(fall.largest_ns - static_cast<std::int64_t>(i) * fall.apart_ns);
    }
    together->record_falling(fall.largest_ns, fall.apart_ns, fall.count);
    EXPECT_EQ(together->count(), one_by_one->count());
    EXPECT_EQ(together->min(), one_by_one->min());
    EXPECT_EQ(together->max(), one_by_one->max());
    for (int i = 0; i <= 1000; ++i) {
      ASSERT_EQ(together->percentile(i * 0.001), one_by_one->percentile(i * 0.001)) << fall.largest_ns << ": " << i;
    }
  }
}

TEST(HdrHistogram, HoursOfTinyStepsAreTheWorkOfAFewBuckets) {
  const auto histogram = std::make_unique<HdrHistogram>();
  constexpr std::int64_t kDay = 86'400'000'000'000;
  constexpr std::int64_t kStep = 64;
  histogram->record_falling(kDay, kStep, kDay / kStep);  // 1.35e12 values: never, one by one
  EXPECT_EQ(histogram->count(), static_cast<std::uint64_t>(kDay / kStep));
  EXPECT_EQ(histogram->min(), kStep);
  EXPECT_EQ(histogram->max(), kDay);
}

TEST(HdrHistogram, EveryBucketEndsWhereTheNextOneBegins) {
  for (std::size_t i = 0; i + 1 < HdrHistogram::kBuckets; ++i) {
    ASSERT_EQ(HdrHistogram::bucket_of(HdrHistogram::upper_bound(i)), i);
    ASSERT_EQ(HdrHistogram::bucket_of(HdrHistogram::upper_bound(i) + 1), i + 1);
  }
  EXPECT_GT(HdrHistogram::upper_bound(HdrHistogram::kBuckets - 1), 60'000'000'000);
}

TEST(HdrHistogram, WhatIsOutOfRangeIsCountedAtItsEnds) {
  const auto histogram = std::make_unique<HdrHistogram>();
  EXPECT_EQ(histogram->percentile(0.5), 0);
  EXPECT_EQ(histogram->min(), 0);
  histogram->record(-5);
  histogram->record(3'600'000'000'000);
  EXPECT_EQ(histogram->count(), 2u);
  EXPECT_EQ(histogram->min(), 0);
  EXPECT_EQ(histogram->max(), 3'600'000'000'000);
  EXPECT_LE(histogram->percentile(0.5), 64);
}

}  // namespace hdr_histogram_test
}  // namespace slew
