// SPDX-License-Identifier: Apache-2.0
// Statistics of samples: mean and deviation with an interval for the mean, correlation with an interval.
//
//   mean m = sum x / n, deviation s = sqrt(sum (x - m)^2 / (n - 1))
//   95 % interval of the mean: m -+ t s / sqrt(n), t: 0.975 quantile of Student's distribution, n - 1 degrees of
//   freedom Pearson's correlation r = sum (x - mx)(y - my) / sqrt(sum (x - mx)^2 sum (y - my)^2) 95 % interval of r by
//   Fisher's transform: tanh(atanh r -+ 1.96 / sqrt(n - 3))
//
// The interval of the mean holds for independent samples and many rows or a normal distribution. Rows of a Latin
// hypercube are spread more evenly than independent ones: where a measure depends on the varied values mainly one by
// one, its mean is known better than the interval states (Stein 1987, Technometrics 29, p. 143). The interval of a
// correlation holds for normal distributions; r measures the linear part of a dependence alone.
#pragma once

#include <optional>
#include <span>

namespace slew::analysis {

struct Interval {
  double low = 0, high = 0;
};

// 0.975 quantile of Student's distribution.
[[nodiscard]] double student_quantile(double degrees_of_freedom);

struct SampleStatistics {
  std::size_t count = 0;
  double mean = 0;
  double deviation = 0;                // 0 for a single sample
  std::optional<Interval> interval{};  // of the mean, 95 %; none for a single sample
};

// Empty samples: count 0.
[[nodiscard]] SampleStatistics statistics_of(std::span<const double> samples);

struct Correlation {
  double value = 0;                    // -1 to 1
  std::optional<Interval> interval{};  // 95 %; none below four samples
};

// None: fewer than two samples, or one of the two does not vary. Pre-condition: as many x as y.
[[nodiscard]] std::optional<Correlation> correlation_of(std::span<const double> x, std::span<const double> y);

}  // namespace slew::analysis
