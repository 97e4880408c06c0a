// SPDX-License-Identifier: Apache-2.0
#include "measurement/channel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace slew::measurement {
namespace {

// output of SplitMix64 at a state; increments of the state by an odd number give its sequence
std::uint64_t mixed(std::uint64_t z) noexcept {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

constexpr std::uint64_t kIncrement = 0x9e3779b97f4a7c15ULL;  // 2^64 over the golden ratio, of SplitMix64
constexpr int kStreams = 4;                                  // uniform numbers of a sample
constexpr int kFrozen = 2, kDropout = 3;                     // streams; 0 and 1 are those of normal()

}  // namespace

double ChannelNoise::uniform(std::int64_t k, int stream) const noexcept {
  const std::uint64_t counter = static_cast<std::uint64_t>(k) * kStreams + static_cast<std::uint64_t>(stream) + 1;
  // the middle of one of 2^53 intervals: neither 0 nor 1
  return (static_cast<double>(mixed(mixed(key_) + counter * kIncrement) >> 11) + 0.5) * 0x1p-53;
}

double ChannelNoise::normal(std::int64_t k) const noexcept {
  return std::sqrt(-2 * std::log(uniform(k, 0))) * std::cos(2 * std::numbers::pi * uniform(k, 1));
}

SampleFate fate_of(const SamplingParameters& sampling, const ChannelNoise& noise, std::int64_t k) noexcept {
  if (sampling.dropout > 0 && noise.uniform(k, kDropout) < sampling.dropout) return SampleFate::lost;
  if (sampling.frozen > 0 && noise.uniform(k, kFrozen) < sampling.frozen) return SampleFate::frozen;
  return SampleFate::measured;
}

void Channel::observe(std::int64_t k, double x, SampleFate fate, const ChannelParameters& parameters,
                      double T) noexcept {
  // the drift goes on while samples are lost
  if (k > 0) drift_ += T * parameters.drift / parameters.drift_time;
  if (fate == SampleFate::measured) {
    double y = parameters.gain * x + parameters.offset + drift_;
    if (parameters.noise > 0) y += parameters.noise * noise_.normal(k);
    if (parameters.resolution > 0) y = parameters.resolution * std::round(y / parameters.resolution);
    // by these bounds a value that is not a number stays one
    last_ = std::min(std::max(y, parameters.lowest), parameters.highest);
  }
  kept_[slot(k)] = {last_, static_cast<std::uint8_t>(fate != SampleFate::lost)};
}

void Channel::reset() noexcept {
  std::fill(kept_.begin(), kept_.end(), Sample{});
  drift_ = last_ = 0;
}

}  // namespace slew::measurement
