// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tests/support/reference_algebra.h"

namespace slew::testing {
namespace {

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Matrix to_eigen(const Dense<double>& A) {
  Matrix result(A.rows(), A.cols());
  std::copy(A.data(), A.data() + A.size(), result.data());
  return result;
}

}  // namespace

std::vector<std::complex<double>> eigenvalues(const Dense<double>& A) {
  const Eigen::EigenSolver<Matrix> solver(to_eigen(A), false);
  std::vector<std::complex<double>> values;
  for (const std::complex<long double>& value : solver.eigenvalues()) values.emplace_back(value);
  return values;
}

double spectral_radius(const Dense<double>& A) {
  double radius = 0;
  for (const std::complex<double> value : eigenvalues(A)) radius = std::max(radius, std::abs(value));
  return radius;
}

// with M = L L^T: (L^-1 K L^-T) y = lambda y, v = L^-T y
SymmetricModes symmetric_modes(const Dense<double>& K, const Dense<double>& M) {
  const Index n = M.rows();
  Dense<long double> L(n, n);
  for (Index j = 0; j < n; ++j) {
    for (Index i = j; i < n; ++i) {
      long double rest = M(i, j);
      for (Index k = 0; k < j; ++k) rest -= L(i, k) * L(j, k);
      L(i, j) = i == j ? std::sqrt(rest) : rest / L(j, j);
    }
  }
  const Dense<long double> to_y = inverse(L), reduced = to_y * widened(K) * to_y.transposed();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(Eigen::Map<const Matrix>(reduced.data(), n, n));
  SymmetricModes modes;
  for (const long double lambda : solver.eigenvalues()) modes.lambda.push_back(static_cast<double>(lambda));
  Dense<long double> y(n, n);
  std::copy_n(solver.eigenvectors().data(), n * n, y.data());
  modes.vectors = rounded(to_y.transposed() * y);
  return modes;
}

}  // namespace slew::testing
