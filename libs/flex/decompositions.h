// SPDX-License-Identifier: Apache-2.0
// Eigenproblems and linear systems of symmetric matrices; the only place of decompositions.
//
// Small problems are solved dense, large ones by Lanczos steps with (K + sigma M)^-1, both for the largest
// mu = 1/(lambda + sigma), so that the lowest modes are the most accurate ones:
//   M v = mu (K + sigma M) v                                                                                (1)
// Lanczos finds only one mode of a multiple frequency. So the modes below a bound are counted by the signs of the
// pivots of K - bound M (Sylvester), and missing ones are searched orthogonally to those found. All memory is allocated
// by Eigen, and Eigen uses fixed cache sizes, so that the bits depend neither on addresses nor on the processor's
// caches.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace slew::flex {

enum class EigenMethod : int { automatic, dense, lanczos };

// freedoms up to which `automatic` solves dense: about a tenth of a second; Lanczos is faster beyond
inline constexpr int kDenseFreedoms = 500;

// Eigen's products are cut into blocks by these sizes, not by the machine's. Call it before products of large matrices.
void fix_product_blocks() noexcept;

// Ascending lambda [1/s2]; vectors in columns, v^T M v = 1.
struct Modes {
  std::vector<double> lambda;
  Eigen::MatrixXd vectors;
};

// K v = lambda M v: the `count` lowest modes, or all with mass. shift sigma >= 0 [1/s2], > 0 where K is singular: near
// the lowest lambda that is not zero. Throws InputError when K + sigma M is not positive definite, or when the
// iteration does not find the modes.
[[nodiscard]] Modes lowest_modes(const Eigen::SparseMatrix<double>& K, const Eigen::SparseMatrix<double>& M, int count,
                                 double shift, EigenMethod method = EigenMethod::automatic);
// The same, dense: the `count` lowest modes, and all.
[[nodiscard]] Modes dense_modes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M, double shift, int count);
[[nodiscard]] Modes all_modes(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M, double shift);

// A^-1 B. Throws InputError: "what" names the matrix that is not positive definite and the probable cause.
[[nodiscard]] Eigen::MatrixXd solve_positive(const Eigen::SparseMatrix<double>& A, const Eigen::MatrixXd& B,
                                             const std::string& what);

// Number of negative pivots of A and smallest pivot over its diagonal element.
struct Pivots {
  int negative = 0;
  double smallest = 1;
};
[[nodiscard]] Pivots pivots_of(const Eigen::SparseMatrix<double>& A);

// Eigenvalues of a small symmetric matrix, descending, with the vectors in columns.
struct SmallModes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
[[nodiscard]] SmallModes descending_modes(const Eigen::MatrixXd& symmetric);

// A^-1 B of a small regular A; its rank is found at the same time.
struct SmallSolution {
  int rank = 0;
  Eigen::MatrixXd x;
};
[[nodiscard]] SmallSolution solve_small(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

}  // namespace slew::flex
