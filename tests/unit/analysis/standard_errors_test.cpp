// SPDX-License-Identifier: Apache-2.0
// Standard errors of a fit: one signal as in a straight line by hand, signals of unlike errors by closed forms and by
// the share of many draws whose interval holds the truth.
#include "analysis/fit/standard_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analysis/parameter_sweep/statistics.h"

namespace slew::analysis {
namespace standard_errors_test {

// (J' J)^-1 of one column
double inverse_of(const std::vector<double>& J) {
  double squares = 0;
  for (const double j : J) squares += j * j;
  return 1 / squares;
}

// a + b x at x = -1, 0, 1, 2, 3 with residuals r: the textbook's variances of both
TEST(StandardErrors, OfOneSignalAreThoseOfTheLine) {
  const std::vector<double> x = {-1, 0, 1, 2, 3}, r = {0.1, -0.2, 0.05, 0.15, -0.1};
  std::vector<double> J;
  for (const double one : x) J.insert(J.end(), {1, one});
  // sum 1 = 5, sum x = 5, sum x^2 = 15, determinant 50
  const std::vector<double> N = {15.0 / 50, -5.0 / 50, -5.0 / 50, 5.0 / 50};
  const std::vector<std::size_t> samples = {5};
  const StandardErrors errors = standard_errors(N, J, r, samples);
  const double variance = (0.01 + 0.04 + 0.0025 + 0.0225 + 0.01) / 3;
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(errors.covariance[k], variance * N[k], 1e-15) << k;
  for (const double freedom : errors.freedom) EXPECT_NEAR(freedom, 3, 1e-12);
}

// n values of a constant by a signal with errors, and 4 n of a signal without, which the constant does not change
TEST(StandardErrors, ExactSignalsWithoutEffectChangeNothing) {
  std::vector<double> J(50, 0.0), r(50, 0.0);
  for (std::size_t i = 0; i < 10; ++i) {
    J[i] = 1;
    r[i] = i % 2 == 0 ? 0.3 : -0.3;
  }
  const std::vector<double> N = {inverse_of(J)};
  const std::vector<std::size_t> samples = {10, 40};
  const StandardErrors errors = standard_errors(N, J, r, samples);
  EXPECT_NEAR(errors.covariance[0], 10 * 0.09 / 9 / 10, 1e-15);
  EXPECT_NEAR(errors.freedom[0], 9, 1e-12);
}

// one sample that determines its value alone has no residual: its error is taken as that of the others
TEST(StandardErrors, ASignalWithoutFreedomTakesTheVarianceOfAll) {
  const std::vector<double> J = {1, 0, 0, 1, 0, 1, 0, 1}, N = {1, 0, 0, 1.0 / 3};
  const std::vector<double> r = {0, 0.1, -0.2, 0.1};
  const std::vector<std::size_t> samples = {1, 3};
  const StandardErrors errors = standard_errors(N, J, r, samples);
  EXPECT_NEAR(errors.covariance[0], 0.06 / 2, 1e-15);
  EXPECT_NEAR(errors.freedom[0], 2, 1e-12);
  EXPECT_NEAR(errors.covariance[3], 0.06 / 2 / 3, 1e-15);
}

// One value, signals of errors 1 and 0.05 that it changes by 1 and 0.3: 95 % of 4000 intervals hold it, 0.35 % is the
// deviation of that share. With one variance for both signals 74 % do.
TEST(StandardErrors, NineteenOfTwentyIntervalsHoldTheTruth) {
  constexpr std::size_t kDraws = 4000, kFew = 12, kMany = 30;
  std::mt19937_64 generator(5);
  const auto uniform = [&] { return (static_cast<double>(generator() >> 11) + 0.5) * 0x1p-53; };
  const auto normal = [&] { return std::sqrt(-2 * std::log(uniform())) * std::cos(2 * M_PI * uniform()); };
  std::vector<double> J(kFew, 1.0);
  J.insert(J.end(), kMany, 0.3);
  const double N = inverse_of(J);
  const std::vector<std::size_t> samples = {kFew, kMany};
  int held = 0;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    std::vector<double> r;
    double found = 0;  // truth: 0
    for (std::size_t i = 0; i < J.size(); ++i) {
      r.push_back((i < kFew ? 1 : 0.05) * normal());
      found += N * J[i] * r.back();
    }
    for (std::size_t i = 0; i < J.size(); ++i) r[i] -= J[i] * found;
    const StandardErrors errors = standard_errors(std::vector<double>{N}, J, r, samples);
    const double half = student_quantile(errors.freedom[0]) * std::sqrt(errors.covariance[0]);
    held += std::fabs(found) <= half ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(held) / kDraws, 0.95, 0.015);
}

}  // namespace standard_errors_test
}  // namespace slew::analysis
