// SPDX-License-Identifier: Apache-2.0
// A channel by hand: every equation of channel.h, and the statistics of its random numbers.
#include "measurement/channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace slew::measurement {
namespace channel_test {

constexpr ChannelParameters kWide{.lowest = -1e6, .highest = 1e6};

double measured(const ChannelParameters& parameters, double x) {
  Channel channel(1, 0);
  channel.observe(0, x, SampleFate::measured, parameters, 1e-3);
  return channel.value(0);
}

TEST(Channel, adds_gain_offset_resolution_and_range_in_this_order) {
  ChannelParameters parameters = kWide;
  EXPECT_EQ(measured(parameters, 12.3), 12.3);
  parameters.gain = 1.1, parameters.offset = -2;
  EXPECT_DOUBLE_EQ(measured(parameters, 10), 9);
  parameters.resolution = 4;
  EXPECT_EQ(measured(parameters, 10), 8);
  EXPECT_EQ(measured(parameters, 11), 12);  // 10.1: nearer to 12
  parameters.highest = 10.5, parameters.lowest = -3;
  EXPECT_EQ(measured(parameters, 11), 10.5);
  EXPECT_EQ(measured(parameters, -20), -3);
}

TEST(Channel, drifts_by_its_drift_in_its_drift_time) {
  ChannelParameters parameters = kWide;
  parameters.drift = 3, parameters.drift_time = 2;
  Channel channel(1, 0);
  for (int k = 0; k <= 4000; ++k) channel.observe(k, 7, SampleFate::measured, parameters, 1e-3);
  EXPECT_NEAR(channel.value(4000), 7 + 6, 1e-9);
  // without drift it stays where it is
  parameters.drift = 0;
  channel.observe(4001, 7, SampleFate::measured, parameters, 1e-3);
  EXPECT_NEAR(channel.value(4001), 13, 1e-9);
}

TEST(Channel, repeats_a_sample_that_is_frozen_or_lost_and_marks_the_lost_one) {
  Channel channel(1, 2);
  channel.observe(0, 5, SampleFate::measured, kWide, 1e-3);
  channel.observe(1, 6, SampleFate::frozen, kWide, 1e-3);
  channel.observe(2, 7, SampleFate::lost, kWide, 1e-3);
  EXPECT_EQ(channel.value(1), 5);
  EXPECT_EQ(channel.value(2), 5);
  EXPECT_TRUE(channel.is_valid(1));
  EXPECT_FALSE(channel.is_valid(2));
  channel.observe(3, 8, SampleFate::measured, kWide, 1e-3);
  EXPECT_EQ(channel.value(3), 8);
  EXPECT_TRUE(channel.is_valid(3));
}

// Moments and quantiles of the standard normal distribution, correlation of neighbours 0; the bounds are five standard
// deviations of each estimate.
TEST(ChannelNoise, is_standard_normal_and_white) {
  constexpr int kSamples = 100000;
  const ChannelNoise noise(42);
  double sum = 0, squares = 0, fourth = 0, products = 0, last = 0;
  int beyond_one = 0;
  for (int k = 0; k < kSamples; ++k) {
    const double g = noise.normal(k);
    sum += g, squares += g * g, fourth += g * g * g * g, products += g * last;
    beyond_one += std::fabs(g) > 1 ? 1 : 0;
    last = g;
  }
  const double n = kSamples, sigma = 1 / std::sqrt(n);
  EXPECT_NEAR(sum / n, 0, 5 * sigma);
  EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2.0) * sigma);
  EXPECT_NEAR(fourth / n, 3, 5 * std::sqrt(96.0) * sigma);
  EXPECT_NEAR(products / n, 0, 5 * sigma);
  const double p = std::erfc(std::sqrt(0.5));
  EXPECT_NEAR(beyond_one / n, p, 5 * std::sqrt(p * (1 - p)) * sigma);
}

TEST(ChannelNoise, of_neighbouring_keys_is_unrelated) {
  constexpr int kSamples = 20000;
  const ChannelNoise one(7), other(8);
  double products = 0;
  for (int k = 0; k < kSamples; ++k) products += one.normal(k) * other.normal(k);
  EXPECT_NEAR(products / kSamples, 0, 5 / std::sqrt(double{kSamples}));
}

// A sample's number alone decides: read backwards the numbers are the same.
TEST(ChannelNoise, depends_on_the_sample_and_not_on_the_ones_before) {
  const ChannelNoise noise(3), same(3);
  std::vector<double> forwards;
  for (int k = 0; k < 100; ++k) forwards.push_back(noise.normal(k));
  for (int k = 99; k >= 0; --k) EXPECT_EQ(same.normal(k), forwards[static_cast<std::size_t>(k)]);
}

TEST(SampleFates, come_at_their_probabilities) {
  constexpr int kSamples = 50000;
  const SamplingParameters sampling{.frozen = 0.25, .dropout = 0.1};
  int frozen = 0, lost = 0;
  for (int k = 0; k < kSamples; ++k) {
    const SampleFate fate = fate_of(sampling, ChannelNoise(5), k);
    frozen += fate == SampleFate::frozen ? 1 : 0;
    lost += fate == SampleFate::lost ? 1 : 0;
  }
  const auto expect_share = [](int count, double p) {
    EXPECT_NEAR(count / double{kSamples}, p, 5 * std::sqrt(p * (1 - p) / kSamples));
  };
  expect_share(lost, 0.1);
  expect_share(frozen, 0.9 * 0.25);
  EXPECT_EQ(fate_of({.frozen = 1}, ChannelNoise(5), 1), SampleFate::frozen);
  EXPECT_EQ(fate_of({.frozen = 1, .dropout = 1}, ChannelNoise(5), 1), SampleFate::lost);
  EXPECT_EQ(fate_of({}, ChannelNoise(5), 1), SampleFate::measured);
}

}  // namespace channel_test
}  // namespace slew::measurement
