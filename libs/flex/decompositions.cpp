// SPDX-License-Identifier: Apache-2.0
#include "flex/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "flex/input_error.h"

namespace slew::flex {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// mu below this share of the largest one: a vector without mass
constexpr double kNoMass = 1e-15;

Modes kept_modes(const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>& solver, double shift, int count) {
  // ascending mu: from the last one backwards, (1)
  const VectorXd& mu = solver.eigenvalues();
  const Eigen::Index n = mu.size();
  Modes modes;
  modes.vectors.resize(n, std::min<Eigen::Index>(n, count));
  Eigen::Index kept = 0;
  for (Eigen::Index i = n - 1; i >= 0 && kept < modes.vectors.cols(); --i) {
    if (!(mu[i] > kNoMass * mu[n - 1])) break;
    modes.lambda.push_back(1 / mu[i] - shift);
    modes.vectors.col(kept++) = solver.eigenvectors().col(i) / std::sqrt(mu[i]);
  }
  modes.vectors.conservativeResize(n, kept);
  return modes;
}

}  // namespace

void fix_product_blocks() noexcept {
  Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20);
}

Modes dense_modes(const MatrixXd& K, const MatrixXd& M, double shift, int count) {
  if (K.rows() == 0 || count == 0) return {{}, MatrixXd(K.rows(), 0)};
  const MatrixXd A = K + shift * M;
  const Eigen::LLT<MatrixXd> probe(A);
  if (probe.info() != Eigen::Success) {
    throw InputError(
        "the stiffness matrix is not positive definite; expected one without mechanisms; check supports and joints");
  }
  return kept_modes(Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(M, A), shift, count);
}

Modes all_modes(const MatrixXd& K, const MatrixXd& M, double shift) {
  fix_product_blocks();
  return dense_modes(K, M, shift, static_cast<int>(K.rows()));
}

SmallModes descending_modes(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  return {solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse()};
}

SmallSolution solve_small(const MatrixXd& A, const MatrixXd& B) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  return {static_cast<int>(qr.rank()), qr.solve(B)};
}

}  // namespace slew::flex
