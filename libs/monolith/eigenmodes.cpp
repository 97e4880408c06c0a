// SPDX-License-Identifier: Apache-2.0
#include "monolith/eigenmodes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/check.h"
#include "math/eigenvalues.h"

namespace slew::monolith {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// relative difference below which eigenvalues are equal: differences of the equations are accurate to 1e-8
constexpr double kEqual = 1e-6;
constexpr int kBalancingPasses = 20;
// growth below which rounding is the cause
constexpr double kNoGrowth = 1e-9;

// rows and columns of like size by powers of two (Osborne 1960)
void balance(RowMajor& A) {
  for (int pass = 0; pass < kBalancingPasses; ++pass) {
    bool has_changed = false;
    for (Index i = 0; i < A.rows(); ++i) {
      double row = 0, column = 0;
      for (Index j = 0; j < A.rows(); ++j) {
        if (i == j) continue;
        row += std::fabs(A(i, j));
        column += std::fabs(A(j, i));
      }
      if (row == 0 || column == 0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (factor == 1) continue;
      A.col(i) *= factor;
      A.row(i) /= factor;
      has_changed = true;
    }
    if (!has_changed) return;
  }
}

bool are_equal(std::complex<double> a, std::complex<double> b) {
  return std::abs(a - b) <= kEqual * std::max(std::abs(a), std::abs(b));
}

// columns of the vectors with the values nearest to one value
MatrixXcd nearest(const math::Eigenpairs& pairs, std::complex<double> value, std::size_t count) {
  const auto n = static_cast<Index>(pairs.values.size());
  std::vector<std::size_t> order(pairs.values.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(pairs.values[a] - value) < std::abs(pairs.values[b] - value);
  });
  const Eigen::Map<const MatrixXcd> vectors(pairs.vectors.data(), n, n);
  MatrixXcd chosen(n, static_cast<Index>(count));
  for (std::size_t k = 0; k < count; ++k) chosen.col(static_cast<Index>(k)) = vectors.col(static_cast<Index>(order[k]));
  return chosen;
}

// (2)
std::vector<double> participation(const MatrixXcd& R, const MatrixXcd& L) {
  const MatrixXcd product = L.transpose() * R;
  const MatrixXcd weights = product.fullPivLu().solve(MatrixXcd(L.transpose()));
  std::vector<double> share(static_cast<std::size_t>(R.rows()));
  double sum = 0;
  for (Index k = 0; k < R.rows(); ++k) {
    std::complex<double> p = 0;
    for (Index j = 0; j < R.cols(); ++j) p += R(k, j) * weights(j, k);
    share[static_cast<std::size_t>(k)] = std::abs(p);
    sum += std::abs(p);
  }
  for (double& s : share) s /= sum;
  return share;
}

}  // namespace

Eigenmodes eigenmodes(std::span<const double> A, std::size_t n) {
  SLEW_CHECK(A.size() == n * n);
  Eigenmodes result;
  if (n == 0) return result;
  RowMajor matrix = Eigen::Map<const RowMajor>(A.data(), static_cast<Index>(n), static_cast<Index>(n));
  balance(matrix);
  const std::span<const double> rows(matrix.data(), n * n);
  const math::Eigenpairs right = math::eigenpairs(rows, n);
  matrix.transposeInPlace();
  const math::Eigenpairs left = math::eigenpairs(rows, n);
  if (right.values.empty() || left.values.empty()) return result;
  std::vector<std::complex<double>> sorted;
  for (const std::complex<double> value : right.values) {
    if (std::abs(value) < kSlowestRate) {
      ++result.at_rest;
    } else if (value.imag() >= 0) {
      sorted.push_back(value);
    }
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
  std::vector<char> is_taken(sorted.size(), 0);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (is_taken[i] != 0) continue;
    std::size_t count = 0;
    for (std::size_t j = i; j < sorted.size(); ++j) {
      if (is_taken[j] != 0 || !are_equal(sorted[i], sorted[j])) continue;
      is_taken[j] = 1;
      ++count;
    }
    result.modes.push_back({sorted[i], static_cast<int>(count),
                            participation(nearest(right, sorted[i], count), nearest(left, sorted[i], count))});
  }
  return result;
}

double longest_runge_kutta_step(std::complex<double> lambda) noexcept {
  const double size = std::abs(lambda);
  if (size == 0 || lambda.real() > kNoGrowth * size) return std::numeric_limits<double>::infinity();
  // along the ray of lambda to where |1 + z + z2/2 + z3/6 + z4/24| passes 1; it does so before |z| = 4
  const std::complex<double> direction = lambda / size;
  const auto grows = [&](double length) {
    const std::complex<double> z = length * direction;
    return std::abs(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) > 1 + kNoGrowth;
  };
  double stable = 0, step = 0.5;
  for (int halving = 0; halving < 30; ++halving) {
    while (!grows(stable + step)) stable += step;
    step /= 2;
  }
  return stable / size;
}

}  // namespace slew::monolith
