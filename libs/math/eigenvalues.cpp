// SPDX-License-Identifier: Apache-2.0
#include "math/eigenvalues.h"

#include <Eigen/Eigenvalues>

namespace slew::math {

std::vector<std::complex<double>> eigenvalues(std::span<const double> A, std::size_t n) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = static_cast<Eigen::Index>(n);
  const Eigen::MatrixXd matrix = Eigen::Map<const RowMajor>(A.data(), size, size);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, false);
  const Eigen::VectorXcd values = solver.eigenvalues();
  return {values.data(), values.data() + values.size()};
}

}  // namespace slew::math
