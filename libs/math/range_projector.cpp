// SPDX-License-Identifier: Apache-2.0
#include "math/range_projector.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace slew::math {

namespace {

// share of the earlier pivots below which a row's remaining pivot counts as zero
constexpr double kRankTolerance = 1e-10;

}  // namespace

std::size_t pivoted_cholesky(std::span<const double> W, std::span<double> L, std::span<double> left) noexcept {
  const std::size_t m = left.size();
  SLEW_CHECK(W.size() == m * m && L.size() == m * m);
  std::fill(L.begin(), L.end(), 0.0);
  for (std::size_t i = 0; i < m; ++i) left[i] = W[i * m + i];
  for (std::size_t r = 0; r < m; ++r) {
    std::size_t pivot = m;
    double largest = kRankTolerance;
    for (std::size_t i = 0; i < m; ++i) {
      const double share = W[i * m + i] > 0 ? left[i] / W[i * m + i] : 0;
      if (share > largest) {
        largest = share;
        pivot = i;
      }
    }
    if (pivot == m) return r;
    const double root = std::sqrt(left[pivot]);
    for (std::size_t i = 0; i < m; ++i) {
      double sum = W[i * m + pivot];
      for (std::size_t k = 0; k < r; ++k) sum -= L[i * m + k] * L[pivot * m + k];
      L[i * m + r] = sum / root;
    }
    for (std::size_t i = 0; i < m; ++i) left[i] -= L[i * m + r] * L[i * m + r];
    left[pivot] = 0;
  }
  return m;
}

std::vector<double> range_projector(std::span<const double> W, std::size_t m) {
  std::vector<double> L(m * m), left(m), P(m * m, 0.0);
  const std::size_t rank = pivoted_cholesky(W, L, left);
  if (rank == m) {
    for (std::size_t i = 0; i < m; ++i) P[i * m + i] = 1;
    return P;
  }
  // orthonormal columns by the modified method of Gram and Schmidt, twice against rounding
  for (std::size_t r = 0; r < rank; ++r) {
    for (int times = 0; times < 2; ++times) {
      for (std::size_t s = 0; s < r; ++s) {
        double along = 0;
        for (std::size_t i = 0; i < m; ++i) along += L[i * m + r] * L[i * m + s];
        for (std::size_t i = 0; i < m; ++i) L[i * m + r] -= along * L[i * m + s];
      }
      double square = 0;
      for (std::size_t i = 0; i < m; ++i) square += L[i * m + r] * L[i * m + r];
      for (std::size_t i = 0; i < m; ++i) L[i * m + r] /= std::sqrt(square);
    }
  }
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      for (std::size_t r = 0; r < rank; ++r) P[i * m + j] += L[i * m + r] * L[j * m + r];
    }
  }
  return P;
}

}  // namespace slew::math
