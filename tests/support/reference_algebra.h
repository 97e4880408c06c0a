// SPDX-License-Identifier: Apache-2.0
// Dense algebra of the references: vectors and matrices of any size, by value. Operations and decompositions are
// compiled once, in reference_algebra*.cpp; Eigen's expressions would be compiled again by every test that writes them.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace slew::testing {

using Index = std::ptrdiff_t;

// One column after the other, zeros at first; a vector is a matrix with one column.
template <typename Real>
class Dense {
 public:
  Dense() = default;
  explicit Dense(Index rows, Index columns = 1)
      : rows_(rows), columns_(columns), values_(static_cast<std::size_t>(rows * columns)) {}
  [[nodiscard]] static Dense column(std::vector<Real> values);
  [[nodiscard]] static Dense identity(Index n);
  [[nodiscard]] static Dense unit(Index n, Index k);
  [[nodiscard]] static Dense diagonal(const Dense& values);

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index cols() const { return columns_; }
  [[nodiscard]] Index size() const { return rows_ * columns_; }
  [[nodiscard]] Real& operator()(Index row, Index column) {
    return values_[static_cast<std::size_t>(column * rows_ + row)];
  }
  [[nodiscard]] Real operator()(Index row, Index column) const {
    return values_[static_cast<std::size_t>(column * rows_ + row)];
  }
  [[nodiscard]] Real& operator[](Index i) { return values_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Real operator[](Index i) const { return values_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Real* data() { return values_.data(); }
  [[nodiscard]] const Real* data() const { return values_.data(); }

  // copies of parts; `put` writes one
  [[nodiscard]] Dense block(Index row, Index column, Index rows, Index columns) const;
  [[nodiscard]] Dense col(Index k) const { return block(0, k, rows_, 1); }
  [[nodiscard]] Dense row(Index k) const { return block(k, 0, 1, columns_); }
  [[nodiscard]] Dense chosen(std::span<const Index> rows, std::span<const Index> columns) const;
  void put(Index row, Index column, const Dense& part);
  void append_rows(const Dense& below);
  void append_columns(const Dense& right);

  Dense& operator+=(const Dense& b);
  Dense& operator-=(const Dense& b);
  [[nodiscard]] Dense operator+(const Dense& b) const;
  [[nodiscard]] Dense operator-(const Dense& b) const;
  [[nodiscard]] Dense operator-() const;
  [[nodiscard]] Dense operator*(const Dense& b) const;
  [[nodiscard]] Dense operator*(Real factor) const;
  [[nodiscard]] Dense operator/(Real divisor) const;
  [[nodiscard]] friend Dense operator*(Real factor, const Dense& a) { return a * factor; }

  [[nodiscard]] bool operator==(const Dense& b) const;

  [[nodiscard]] Dense transposed() const;
  [[nodiscard]] Dense flat() const { return column(values_); }  // one column below the other
  [[nodiscard]] Real dot(const Dense& b) const;
  [[nodiscard]] Real norm() const;
  // largest absolute value; 0 without any
  [[nodiscard]] Real largest() const;

 private:
  Index rows_ = 0, columns_ = 0;
  std::vector<Real> values_;
};
extern template class Dense<double>;
extern template class Dense<long double>;

// Every decomposition is done in long double, so that Eigen's templates are compiled for one type alone.
[[nodiscard]] Dense<double> rounded(const Dense<long double>& A);
[[nodiscard]] Dense<long double> widened(const Dense<double>& A);

// A^-1 B and A^-1 of a regular A
[[nodiscard]] Dense<long double> solve(const Dense<long double>& A, const Dense<long double>& B);
[[nodiscard]] Dense<double> solve(const Dense<double>& A, const Dense<double>& B);
[[nodiscard]] Dense<long double> inverse(const Dense<long double>& A);
[[nodiscard]] Dense<double> inverse(const Dense<double>& A);

// Orthonormal basis of the columns of A. Smaller than threshold times the largest pivot is zero.
[[nodiscard]] Dense<long double> column_basis(const Dense<long double>& A, long double threshold);
[[nodiscard]] Index column_rank(const Dense<long double>& A, long double threshold);

// The smallest x that leaves the least of A x - b.
struct SmallestSolution {
  Dense<long double> x;
  Index rank = 0;
};
[[nodiscard]] SmallestSolution smallest_solution(const Dense<long double>& A, const Dense<long double>& b,
                                                 long double threshold);

// Eigenvalues of any square matrix, in no order.
[[nodiscard]] std::vector<std::complex<double>> eigenvalues(const Dense<double>& A);
// Largest absolute eigenvalue.
[[nodiscard]] double spectral_radius(const Dense<double>& A);
// Ascending lambda of K v = lambda M v; vectors in columns, v^T M v = 1.
struct SymmetricModes {
  std::vector<double> lambda;
  Dense<double> vectors;
};
[[nodiscard]] SymmetricModes symmetric_modes(const Dense<double>& K, const Dense<double>& M);
// e^A
[[nodiscard]] Dense<double> exponential(const Dense<double>& A);

[[nodiscard]] Dense<long double> to_vector(std::span<const double> values);
// Largest difference, over 1 + the largest of b.
[[nodiscard]] long double difference(const Dense<long double>& a, const Dense<long double>& b);

}  // namespace slew::testing
