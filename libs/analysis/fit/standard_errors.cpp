// SPDX-License-Identifier: Apache-2.0
#include "analysis/fit/standard_errors.h"

namespace slew::analysis {
namespace {

// below it the residuals of a signal have no variance of their own
constexpr double kLeastFreedom = 1;

struct SignalSums {
  double squares = 0, trace = 0;  // r_k' r_k, trace(J_k N J_k')
  std::vector<double> spread;     // n x n, N J_k' J_k N
};

}  // namespace

StandardErrors standard_errors(std::span<const double> normal_inverse, std::span<const double> jacobian,
                               std::span<const double> residuals, std::span<const std::size_t> samples) {
  const std::size_t m = residuals.size(), n = jacobian.size() / m;
  std::vector<SignalSums> signals;
  std::vector<double> b(n);  // N j of a row j
  double all_squares = 0;
  std::size_t row = 0;
  for (const std::size_t count : samples) {
    SignalSums& signal = signals.emplace_back();
    signal.spread.assign(n * n, 0.0);
    for (const std::size_t end = row + count; row < end; ++row) {
      const std::span<const double> j = jacobian.subspan(row * n, n);
      signal.squares += residuals[row] * residuals[row];
      for (std::size_t k = 0; k < n; ++k) {
        b[k] = 0;
        for (std::size_t l = 0; l < n; ++l) b[k] += normal_inverse[k * n + l] * j[l];
        signal.trace += b[k] * j[k];
      }
      for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t l = 0; l < n; ++l) signal.spread[k * n + l] += b[k] * b[l];
      }
    }
    all_squares += signal.squares;
  }

  const auto freedom_of_all = static_cast<double>(m - n);
  StandardErrors errors{.covariance = std::vector<double>(n * n, 0.0), .freedom = std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const SignalSums& signal = signals[i];
    double freedom = static_cast<double>(samples[i]) - signal.trace, squares = signal.squares;
    if (freedom < kLeastFreedom) {
      freedom = freedom_of_all;
      squares = all_squares;
    }
    const double variance = squares / freedom;
    for (std::size_t k = 0; k < n * n; ++k) errors.covariance[k] += variance * signal.spread[k];
    for (std::size_t k = 0; k < n; ++k) {
      const double share = variance * signal.spread[k * n + k];
      errors.freedom[k] += share * share / freedom;
    }
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double variance = errors.covariance[k * n + k];
    errors.freedom[k] = errors.freedom[k] > 0 ? variance * variance / errors.freedom[k] : freedom_of_all;
  }
  return errors;
}

}  // namespace slew::analysis
