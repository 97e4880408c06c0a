// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "flex/decompositions.h"
#include "flex/input_error.h"

namespace slew::flex {

using Eigen::MatrixXd;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

namespace {

// a pivot below this share of its diagonal element is zero but for rounding: a chain of 1000 elements leaves 1e-10
constexpr double kZeroPivot = 1e-14;
constexpr double kLanczosTolerance = 1e-13;
constexpr int kLanczosRestarts = 1000;
// searches across the modes found: each finds at least one of every frequency
constexpr int kSearches = 12;

using Factor = Eigen::SimplicialLDLT<SparseMatrix<double>>;

// y = (K + sigma M)^-1 x orthogonal to the modes found already
class DeflatedInverse {
 public:
  using Scalar = double;

  DeflatedInverse(const Factor& factor, const SparseMatrix<double>& M, const MatrixXd& found)
      : factor_(factor), found_(found), mass_of_found_(M * found) {}

  [[nodiscard]] Eigen::Index rows() const { return factor_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return factor_.cols(); }
  void set_shift(double) {}  // the factor contains the shift
  void perform_op(const double* x, double* y) const {
    VectorXd right(rows());
    std::copy_n(x, rows(), right.data());
    VectorXd out = factor_.solve(right);
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd shares = mass_of_found_.transpose() * out;
      out -= found_ * shares;
    }
    std::copy_n(out.data(), rows(), y);
  }

 private:
  const Factor& factor_;
  const MatrixXd& found_;
  MatrixXd mass_of_found_;
};

// Spectra's operator takes raw pointers; the product is made in memory of Eigen's
class MassProduct {
 public:
  using Scalar = double;
  explicit MassProduct(const SparseMatrix<double>& M) : M_(M) {}
  [[nodiscard]] Eigen::Index rows() const { return M_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return M_.cols(); }
  void perform_op(const double* x, double* y) const {
    VectorXd right(rows());
    std::copy_n(x, rows(), right.data());
    const VectorXd out = M_ * right;
    std::copy_n(out.data(), rows(), y);
  }

 private:
  const SparseMatrix<double>& M_;
};

Modes sorted(const Modes& modes, int count) {
  std::vector<int> order(modes.lambda.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return modes.lambda[static_cast<std::size_t>(a)] < modes.lambda[static_cast<std::size_t>(b)];
  });
  order.resize(std::min(order.size(), static_cast<std::size_t>(count)));
  Modes out;
  out.vectors.resize(modes.vectors.rows(), static_cast<Eigen::Index>(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    out.lambda.push_back(modes.lambda[static_cast<std::size_t>(order[i])]);
    out.vectors.col(static_cast<Eigen::Index>(i)) = modes.vectors.col(order[i]);
  }
  return out;
}

void append(Modes& modes, const Modes& more) {
  const Eigen::Index old = modes.vectors.cols();
  modes.vectors.conservativeResize(more.vectors.rows(), old + more.vectors.cols());
  modes.vectors.rightCols(more.vectors.cols()) = more.vectors;
  modes.lambda.insert(modes.lambda.end(), more.lambda.begin(), more.lambda.end());
}

void normalise(Modes& modes, const SparseMatrix<double>& M) {
  for (Eigen::Index i = 0; i < modes.vectors.cols(); ++i) {
    const VectorXd v = modes.vectors.col(i), Mv = M * v;
    modes.vectors.col(i) /= std::sqrt(v.dot(Mv));
  }
}

Modes search(const Factor& factor, const SparseMatrix<double>& M, const Modes& found, int count, double shift) {
  const int n = static_cast<int>(M.rows());
  const int wanted = std::min(count, n - 2);
  const int steps = std::min(n, std::max(2 * wanted + 1, wanted + 20));
  DeflatedInverse inverse(factor, M, found.vectors);
  MassProduct mass(M);
  Spectra::SymGEigsShiftSolver<DeflatedInverse, MassProduct, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, wanted, steps, -shift);
  solver.init();
  const auto converged = solver.compute(Spectra::SortRule::LargestMagn, kLanczosRestarts, kLanczosTolerance,
                                        Spectra::SortRule::SmallestMagn);
  Modes modes;
  modes.vectors = solver.eigenvectors();
  const VectorXd values = solver.eigenvalues();
  for (Eigen::Index i = 0; i < converged; ++i) modes.lambda.push_back(values[i]);
  normalise(modes, M);
  return modes;
}

int count_below(const SparseMatrix<double>& K, const SparseMatrix<double>& M, double bound) {
  const SparseMatrix<double> shifted = K - bound * M;
  return pivots_of(shifted).negative;
}

Modes lanczos_modes(const SparseMatrix<double>& K, const SparseMatrix<double>& M, int count, double shift) {
  const SparseMatrix<double> A = K + shift * M;
  const Factor factor(A);
  Modes found;
  found.vectors.resize(M.rows(), 0);
  for (int i = 0; i < kSearches; ++i) {
    try {
      append(found, search(factor, M, found, count, shift));
    } catch (const std::exception& error) {
      throw InputError(
          fmt::format("the iteration for {} modes of {} freedoms failed: {}; expected a well-conditioned "
                      "model; request fewer modes or solve dense",
                      count, M.rows(), error.what()));
    }
    found = sorted(found, static_cast<int>(found.lambda.size()));
    if (static_cast<int>(found.lambda.size()) < count) continue;
    // complete if the number of modes below the last requested one equals the number found
    const double bound = found.lambda[static_cast<std::size_t>(count) - 1] * (1 - 1e-6) - 1e-6 * shift;
    const auto below = std::count_if(found.lambda.begin(), found.lambda.end(), [&](double x) { return x < bound; });
    if (count_below(K, M, bound) <= below) return sorted(found, count);
  }
  throw InputError(
      fmt::format("the {} lowest modes of {} freedoms were not all found in {} searches; expected a "
                  "well-conditioned model; request fewer modes or solve dense",
                  count, M.rows(), kSearches));
}

}  // namespace

Modes lowest_modes(const SparseMatrix<double>& K, const SparseMatrix<double>& M, int count, double shift,
                   EigenMethod method) {
  fix_product_blocks();
  const int n = static_cast<int>(K.rows());
  const int wanted = std::min(count, n);
  if (wanted == 0) return {{}, MatrixXd(n, 0)};
  const bool is_large = method == EigenMethod::automatic ? n > kDenseFreedoms : method == EigenMethod::lanczos;
  // Lanczos needs room for its steps
  if (is_large && wanted > 0 && wanted + 3 < n) return lanczos_modes(K, M, wanted, shift);
  return dense_modes(MatrixXd(K), MatrixXd(M), shift, wanted);
}

Pivots pivots_of(const SparseMatrix<double>& A) {
  const Factor factor(A);
  Pivots out;
  if (factor.info() != Eigen::Success) return {0, 0};  // a pivot of exactly zero
  const VectorXd pivot = factor.vectorD(), diagonal = factor.permutationP() * VectorXd(A.diagonal());
  for (Eigen::Index i = 0; i < pivot.size(); ++i) {
    if (pivot[i] < 0) ++out.negative;
    out.smallest = std::min(out.smallest, diagonal[i] > 0 ? pivot[i] / diagonal[i] : -1.0);
  }
  return out;
}

MatrixXd solve_positive(const SparseMatrix<double>& A, const MatrixXd& B, const std::string& what) {
  if (A.rows() == 0 || B.cols() == 0) return MatrixXd::Zero(A.rows(), B.cols());
  if (!(pivots_of(A).smallest > kZeroPivot)) throw InputError(what);
  const Factor factor(A);
  return factor.solve(B);
}

}  // namespace slew::flex
