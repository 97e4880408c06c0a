// SPDX-License-Identifier: Apache-2.0
#include "tests/support/reference_algebra.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slew::testing {
namespace {

// in every build: these are tests
void require(bool is_met) {
  if (!is_met) throw std::logic_error("sizes of vectors or matrices do not fit");
}

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

Matrix to_eigen(const Dense<long double>& A) {
  return Eigen::Map<const Matrix>(A.data(), A.rows(), A.cols());
}

Dense<long double> from_eigen(const Matrix& A) {
  Dense<long double> result(A.rows(), A.cols());
  std::copy(A.data(), A.data() + A.size(), result.data());
  return result;
}

Eigen::ColPivHouseholderQR<Matrix> pivoted(const Dense<long double>& A, long double threshold) {
  Eigen::ColPivHouseholderQR<Matrix> qr;
  qr.setThreshold(threshold);
  qr.compute(to_eigen(A));
  return qr;
}

}  // namespace

template <typename Real>
Dense<Real> Dense<Real>::column(std::vector<Real> values) {
  Dense result;
  result.rows_ = static_cast<Index>(values.size());
  result.columns_ = 1;
  result.values_ = std::move(values);
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::identity(Index n) {
  Dense result(n, n);
  for (Index k = 0; k < n; ++k) result(k, k) = 1;
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::unit(Index n, Index k) {
  Dense result(n);
  result[k] = 1;
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::diagonal(const Dense& values) {
  Dense result(values.size(), values.size());
  for (Index k = 0; k < values.size(); ++k) result(k, k) = values[k];
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::block(Index row, Index column, Index rows, Index columns) const {
  require(row >= 0 && column >= 0 && row + rows <= rows_ && column + columns <= columns_);
  Dense result(rows, columns);
  for (Index k = 0; k < columns; ++k) {
    for (Index i = 0; i < rows; ++i) result(i, k) = (*this)(row + i, column + k);
  }
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::chosen(std::span<const Index> rows, std::span<const Index> columns) const {
  Dense result(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  Index at = 0;
  for (const Index column : columns) {
    for (const Index row : rows) result[at++] = (*this)(row, column);
  }
  return result;
}

template <typename Real>
void Dense<Real>::put(Index row, Index column, const Dense& part) {
  require(row >= 0 && column >= 0 && row + part.rows_ <= rows_ && column + part.columns_ <= columns_);
  for (Index k = 0; k < part.columns_; ++k) {
    for (Index i = 0; i < part.rows_; ++i) (*this)(row + i, column + k) = part(i, k);
  }
}

template <typename Real>
void Dense<Real>::append_rows(const Dense& below) {
  require(size() == 0 || columns_ == below.columns_);
  Dense result(rows_ + below.rows_, below.columns_);
  if (size() > 0) result.put(0, 0, *this);
  result.put(rows_, 0, below);
  *this = std::move(result);
}

template <typename Real>
void Dense<Real>::append_columns(const Dense& right) {
  require(rows_ == right.rows_);
  values_.insert(values_.end(), right.values_.begin(), right.values_.end());
  columns_ += right.columns_;
}

template <typename Real>
Dense<Real>& Dense<Real>::operator+=(const Dense& b) {
  require(rows_ == b.rows_ && columns_ == b.columns_);
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] += b.values_[i];
  return *this;
}

template <typename Real>
Dense<Real>& Dense<Real>::operator-=(const Dense& b) {
  require(rows_ == b.rows_ && columns_ == b.columns_);
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] -= b.values_[i];
  return *this;
}

template <typename Real>
Dense<Real> Dense<Real>::operator+(const Dense& b) const {
  Dense result = *this;
  result += b;
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::operator-(const Dense& b) const {
  Dense result = *this;
  result -= b;
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::operator-() const {
  Dense result = *this;
  for (Real& value : result.values_) value = -value;
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::operator*(const Dense& b) const {
  require(columns_ == b.rows_);
  Dense result(rows_, b.columns_);
  for (Index k = 0; k < b.columns_; ++k) {
    Real* const sum = result.data() + k * rows_;
    for (Index j = 0; j < columns_; ++j) {
      const Real* const own = data() + j * rows_;
      const Real factor = b(j, k);
      for (Index i = 0; i < rows_; ++i) sum[i] += own[i] * factor;
    }
  }
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::operator*(Real factor) const {
  Dense result = *this;
  for (Real& value : result.values_) value *= factor;
  return result;
}

template <typename Real>
Dense<Real> Dense<Real>::operator/(Real divisor) const {
  Dense result = *this;
  for (Real& value : result.values_) value /= divisor;
  return result;
}

template <typename Real>
bool Dense<Real>::operator==(const Dense& b) const {
  return rows_ == b.rows_ && columns_ == b.columns_ && values_ == b.values_;
}

template <typename Real>
Dense<Real> Dense<Real>::transposed() const {
  Dense result(columns_, rows_);
  for (Index k = 0; k < columns_; ++k) {
    for (Index i = 0; i < rows_; ++i) result(k, i) = (*this)(i, k);
  }
  return result;
}

template <typename Real>
Real Dense<Real>::dot(const Dense& b) const {
  require(size() == b.size());
  Real sum = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) sum += values_[i] * b.values_[i];
  return sum;
}

template <typename Real>
Real Dense<Real>::norm() const {
  return std::sqrt(dot(*this));
}

template <typename Real>
Real Dense<Real>::largest() const {
  Real most = 0;
  for (const Real value : values_) {
    if (std::isnan(value)) return value;  // so that no claim holds
    most = std::max(most, std::abs(value));
  }
  return most;
}

template class Dense<double>;
template class Dense<long double>;

Dense<double> rounded(const Dense<long double>& A) {
  Dense<double> result(A.rows(), A.cols());
  for (Index i = 0; i < A.size(); ++i) result[i] = static_cast<double>(A[i]);
  return result;
}

Dense<long double> widened(const Dense<double>& A) {
  Dense<long double> result(A.rows(), A.cols());
  for (Index i = 0; i < A.size(); ++i) result[i] = A[i];
  return result;
}

// Gauss elimination by columns, the largest pivot of each
Dense<long double> solve(const Dense<long double>& A, const Dense<long double>& B) {
  require(A.rows() == A.cols() && A.rows() == B.rows());
  const Index n = A.rows();
  Dense<long double> left = A, x = B;
  const auto swap_rows = [](Dense<long double>& M, Index i, Index j) {
    for (Index k = 0; k < M.cols(); ++k) std::swap(M(i, k), M(j, k));
  };
  const auto subtract = [](Dense<long double>& M, Index row, Index other, long double factor, Index first) {
    for (Index k = first; k < M.cols(); ++k) M(row, k) -= factor * M(other, k);
  };
  for (Index k = 0; k < n; ++k) {
    Index pivot = k;
    for (Index i = k + 1; i < n; ++i) pivot = std::abs(left(i, k)) > std::abs(left(pivot, k)) ? i : pivot;
    swap_rows(left, k, pivot);
    swap_rows(x, k, pivot);
    for (Index i = k + 1; i < n; ++i) {
      const long double factor = left(i, k) / left(k, k);
      subtract(left, i, k, factor, k);
      subtract(x, i, k, factor, 0);
    }
  }
  for (Index k = n - 1; k >= 0; --k) {
    for (Index j = 0; j < x.cols(); ++j) x(k, j) /= left(k, k);
    for (Index i = 0; i < k; ++i) subtract(x, i, k, left(i, k), 0);
  }
  return x;
}

Dense<double> solve(const Dense<double>& A, const Dense<double>& B) {
  return rounded(solve(widened(A), widened(B)));
}

Dense<long double> inverse(const Dense<long double>& A) {
  return solve(A, Dense<long double>::identity(A.rows()));
}

Dense<double> inverse(const Dense<double>& A) {
  return rounded(inverse(widened(A)));
}

Dense<long double> column_basis(const Dense<long double>& A, long double threshold) {
  const Eigen::ColPivHouseholderQR<Matrix> qr = pivoted(A, threshold);
  return from_eigen(qr.householderQ()).block(0, 0, A.rows(), qr.rank());
}

Index column_rank(const Dense<long double>& A, long double threshold) {
  return pivoted(A, threshold).rank();
}

SmallestSolution smallest_solution(const Dense<long double>& A, const Dense<long double>& b, long double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Matrix> inverse;
  inverse.setThreshold(threshold);
  inverse.compute(to_eigen(A));
  return {from_eigen(inverse.solve(to_eigen(b))), inverse.rank()};
}

Dense<double> exponential(const Dense<double>& A) {
  double largest = 0;
  for (Index i = 0; i < A.rows(); ++i) {
    double sum = 0;
    for (Index j = 0; j < A.cols(); ++j) sum += std::abs(A(i, j));
    largest = std::max(largest, sum);
  }
  // halved until the series of 20 terms is exact
  constexpr int kTerms = 20;
  const int halvings = largest > 0 ? std::max(0, static_cast<int>(std::ceil(std::log2(largest))) + 2) : 0;
  const Dense<double> small = A / std::pow(2.0, halvings);
  Dense<double> sum = Dense<double>::identity(A.rows()), term = sum;
  for (int k = 1; k <= kTerms; ++k) {
    term = term * small / k;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

Dense<long double> to_vector(std::span<const double> values) {
  return Dense<long double>::column({values.begin(), values.end()});
}

long double difference(const Dense<long double>& a, const Dense<long double>& b) {
  return (a - b).largest() / (1 + b.largest());
}

}  // namespace slew::testing
