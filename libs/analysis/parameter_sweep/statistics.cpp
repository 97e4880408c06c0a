// SPDX-License-Identifier: Apache-2.0
#include "analysis/parameter_sweep/statistics.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <functional>

namespace slew::analysis {
namespace {

constexpr double kQuantile = 0.975;               // of two-sided intervals of 95 %
constexpr double kNormalQuantile = 1.9599639845;  // of the normal distribution

double mean_of(std::span<const double> samples) {
  double sum = 0;
  for (const double x : samples) sum += x;
  return sum / static_cast<double>(samples.size());
}

bool are_equal(std::span<const double> samples) {
  return std::adjacent_find(samples.begin(), samples.end(), std::not_equal_to<>()) == samples.end();
}

}  // namespace

double student_quantile(double degrees_of_freedom) {
  // without long double inside: half of the templates
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::quantile(boost::math::students_t_distribution<double, Policy>(degrees_of_freedom), kQuantile);
}

SampleStatistics statistics_of(std::span<const double> samples) {
  if (samples.empty()) return {};
  SampleStatistics result{.count = samples.size(), .mean = mean_of(samples)};
  if (samples.size() < 2) return result;
  double squares = 0;
  for (const double x : samples) squares += (x - result.mean) * (x - result.mean);
  const auto n = static_cast<double>(samples.size());
  result.deviation = std::sqrt(squares / (n - 1));
  const double half = student_quantile(n - 1) * result.deviation / std::sqrt(n);
  result.interval = Interval{result.mean - half, result.mean + half};
  return result;
}

std::optional<Correlation> correlation_of(std::span<const double> x, std::span<const double> y) {
  const std::size_t n = x.size();
  // equal samples may differ from their rounded mean
  if (n < 2 || are_equal(x) || are_equal(y)) return std::nullopt;
  const double mean_x = mean_of(x), mean_y = mean_of(y);
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  Correlation result{.value = std::clamp(xy / std::sqrt(xx) / std::sqrt(yy), -1.0, 1.0)};
  if (n > 3) {
    const double z = std::atanh(result.value), half = kNormalQuantile / std::sqrt(static_cast<double>(n) - 3);
    result.interval = Interval{std::tanh(z - half), std::tanh(z + half)};
  }
  return result;
}

}  // namespace slew::analysis
