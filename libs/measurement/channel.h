// SPDX-License-Identifier: Apache-2.0
// One measured quantity: from its true value at the sampling instants to the value that a controller receives.
//
//   t_k = k T                                                   sampling instants, T = sample_time               (1)
//   d_k = d_{k-1} + T drift / drift_time,  d_0 = 0              drift                                            (2)
//   a_k = gain x(t_k) + offset + d_k + noise g(seed, k)                                                          (3)
//   r_k = resolution round(a_k / resolution)                    a_k without a resolution                         (4)
//   y_k = min(max(r_k, lowest), highest)                        range                                            (5)
//   y_k = y_{k-1}  with probability `frozen`, or, as lost, with probability `dropout`                            (6)
//   y(t) = y_k of the last k with t_k + delay <= t;  y_0 before                                                  (7)
// x true value, y measured value, both in the quantity's unit. g is a standard normal number by the method of Box and
// Muller from two uniform ones. All random numbers are functions of (seed, instrument, channel, k) (counter-based, the
// mixing function of SplitMix64): a run that begins at a saved state, is distributed or replayed has the same ones.
//
// Sources: Box and Muller 1958; Steele, Lea and Flood 2014, for the mixing function. Not covered: dynamics of the
// sensing element (a filter of its own), noise that is not white, hysteresis, cross sensitivity.
#pragma once

#include <cstdint>
#include <vector>

#include "core/state_bytes.h"

namespace slew::measurement {

// Properties of a quantity's measurement, in the unit U of the quantity.
struct ChannelParameters {
  double lowest = 0, highest = 0;  // U, range
  double gain = 1;                 // 1
  double offset = 0;               // U
  double noise = 0;                // U, standard deviation
  double drift = 0;                // U in drift_time
  double drift_time = 3600;        // s
  double resolution = 0;           // U, step of the quantisation; 0: none
};

// What all channels of an instrument share.
struct SamplingParameters {
  double sample_time = 0;  // s, T, a whole multiple of the session's step; 0: that step
  double delay = 0;        // s, a whole multiple of the session's step
  std::int64_t seed = 0;
  double frozen = 0;   // probability that a sample repeats the one before, unnoticed
  double dropout = 0;  // probability that a sample is lost
};

// Random numbers of one channel by the number of the sample.
class ChannelNoise {
 public:
  // key: of instrument, channel and seed
  explicit ChannelNoise(std::uint64_t key = 0) noexcept : key_(key) {}
  // Uniform in (0, 1); stream: which of the numbers of a sample.
  [[nodiscard]] double uniform(std::int64_t k, int stream) const noexcept;
  // Standard normal.
  [[nodiscard]] double normal(std::int64_t k) const noexcept;

 private:
  std::uint64_t key_;
};

// One uniform number a sample decides about each fault, the same for all channels of an instrument.
enum class SampleFate : std::uint8_t { measured, frozen, lost };
[[nodiscard]] SampleFate fate_of(const SamplingParameters& sampling, const ChannelNoise& noise,
                                 std::int64_t k) noexcept;

// Samples of a channel that are on their way or shown. Sized once; observe() does not allocate.
class Channel {
 public:
  // samples: of the delay, delay / T rounded up
  Channel(std::uint64_t key, std::size_t samples) : noise_(key), kept_(samples + 1) {}

  // Takes sample k, k = 0, 1, 2, ...; T: sample_time [s]
  void observe(std::int64_t k, double x, SampleFate fate, const ChannelParameters& parameters, double T) noexcept;
  // Sample k of (7), one of the last `samples`; the first one for k < 0.
  [[nodiscard]] double value(std::int64_t k) const noexcept { return kept_[slot(k < 0 ? 0 : k)].value; }
  [[nodiscard]] bool is_valid(std::int64_t k) const noexcept { return kept_[slot(k < 0 ? 0 : k)].is_valid != 0; }

  void reset() noexcept;
  template <typename Bytes, typename Self>
  static void visit(Bytes& bytes, Self& self) {
    bytes.number(self.drift_);
    bytes.number(self.last_);
    for (auto& sample : self.kept_) {
      bytes.number(sample.value);
      bytes.flag(sample.is_valid);
    }
  }

 private:
  struct Sample {
    double value = 0;
    std::uint8_t is_valid = 1;
  };
  [[nodiscard]] std::size_t slot(std::int64_t k) const noexcept { return static_cast<std::size_t>(k) % kept_.size(); }

  ChannelNoise noise_;
  std::vector<Sample> kept_;
  double drift_ = 0;  // d_k
  double last_ = 0;   // y_k
};

}  // namespace slew::measurement
