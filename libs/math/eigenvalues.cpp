// SPDX-License-Identifier: Apache-2.0
#include "math/eigenvalues.h"

#include <Eigen/Eigenvalues>

namespace slew::math {
namespace {

Eigen::EigenSolver<Eigen::MatrixXd> solved(std::span<const double> A, std::size_t n, bool has_vectors) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = static_cast<Eigen::Index>(n);
  return Eigen::EigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(Eigen::Map<const RowMajor>(A.data(), size, size)),
                                             has_vectors);
}

}  // namespace

std::vector<std::complex<double>> eigenvalues(std::span<const double> A, std::size_t n) {
  const Eigen::VectorXcd values = solved(A, n, false).eigenvalues();
  return {values.data(), values.data() + values.size()};
}

Eigenpairs eigenpairs(std::span<const double> A, std::size_t n) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver = solved(A, n, true);
  if (solver.info() != Eigen::Success) return {};
  const Eigen::VectorXcd values = solver.eigenvalues();
  const Eigen::MatrixXcd vectors = solver.eigenvectors();
  return {{values.data(), values.data() + values.size()}, {vectors.data(), vectors.data() + vectors.size()}};
}

}  // namespace slew::math
