// SPDX-License-Identifier: Apache-2.0
// Semidefinite systems against the definition, with dependent rows at known places.
#include "math/semidefinite.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/reference_algebra.h"

namespace slew::math {
namespace semidefinite_test {

using testing::Index;
using Matrix = testing::Dense<double>;
using Vector = testing::Dense<double>;

// Row-major copy of a symmetric matrix.
std::vector<double> values_of(const Matrix& a) {
  return {a.data(), a.data() + a.size()};
}

Matrix random_matrix(int rows, int columns, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix a(rows, columns);
  for (Index i = 0; i < a.size(); ++i) a[i] = uniform(random);
  return a;
}

TEST(Semidefinite, RegularSystemIsSolved) {
  std::mt19937_64 random(1);
  const Matrix J = random_matrix(7, 12, random), A = J * J.transposed();
  const Vector x = random_matrix(7, 1, random);
  Semidefinite factor(7);
  factor.factorize(values_of(A), {}, 1e-12);
  EXPECT_EQ(factor.rank(), 7);
  Vector b = A * x;
  factor.solve({b.data(), 7});
  EXPECT_LT((b - x).norm(), 1e-10 * x.norm());
}

TEST(Semidefinite, LaterDependentRowsAreNamedAndGetZero) {
  std::mt19937_64 random(2);
  Matrix J = random_matrix(6, 9, random);
  J.put(2, 0, 3 * J.row(0) - J.row(1));
  J.put(5, 0, J.row(4) * 1e-3);
  const Matrix A = J * J.transposed();
  Semidefinite factor(6);
  factor.factorize(values_of(A), {}, 1e-12);
  EXPECT_EQ(factor.rank(), 4);
  for (int row = 0; row < 6; ++row) EXPECT_EQ(factor.is_redundant(row), row == 2 || row == 5) << row;
  const Vector right = A * random_matrix(6, 1, random);
  Vector x = right;
  factor.solve({x.data(), 6});
  EXPECT_EQ(x[2], 0);
  EXPECT_EQ(x[5], 0);
  EXPECT_LT((A * x - right).norm(), 1e-12 * right.norm());
}

TEST(Semidefinite, RowWithoutAnythingIsRedundant) {
  const Matrix A = Matrix::diagonal(Vector::column({2, 0, 3}));
  Semidefinite factor(3);
  factor.factorize(values_of(A), {}, 1e-12);
  EXPECT_TRUE(factor.is_redundant(1));
  std::vector<double> b = {4, 0, 9};
  factor.solve(b);
  EXPECT_EQ(b, (std::vector<double>{2, 0, 3}));
}

TEST(Semidefinite, RowThatIsSmallAgainstItsReferenceIsRedundant) {
  const std::vector<double> A = {1e-9, 0, 0, 4}, reference = {1, 1};
  Semidefinite factor(2);
  factor.factorize(A, {}, 1e-8);
  EXPECT_EQ(factor.rank(), 2);
  EXPECT_EQ(factor.smallest_pivot(), 1);
  factor.factorize(A, reference, 1e-8);
  EXPECT_TRUE(factor.is_redundant(0));
  EXPECT_EQ(factor.smallest_pivot(), 1e-9);
}

// The bits must not depend on earlier factorisations.
TEST(Semidefinite, RedundancyOfOneMatrixIsForgottenWithTheNext) {
  Semidefinite factor(2);
  factor.factorize(std::vector<double>{1, 1, 1, 1}, {}, 1e-12);
  EXPECT_EQ(factor.rank(), 1);
  factor.factorize(std::vector<double>{2, 0, 0, 2}, {}, 1e-12);
  EXPECT_EQ(factor.rank(), 2);
}

// a ladder of blocks of two, a block beside it, and rows that close a ring: what is not stored is zero, fill included
TEST(Semidefinite, SparseHasTheBitsOfTheDense) {
  std::mt19937_64 random(3);
  constexpr int kRows = 14, kColumns = 40;
  Matrix J(kRows, kColumns);
  const auto fill = [&](int row, int first, int count) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int j = first; j < first + count; ++j) J(row, j) = uniform(random);
  };
  for (int row = 0; row < 10; ++row) fill(row, 3 * (row / 2), 6);
  for (int row = 10; row < 12; ++row) fill(row, 30, 4);
  fill(12, 0, 3);
  fill(12, 15, 3);
  J.put(13, 0, J.row(11) * 2);  // depends on one before
  const Matrix A = J * J.transposed();
  std::vector<std::vector<int>> coupled(kRows);
  for (int k = 0; k < kRows; ++k) {
    for (int l = 0; l < k; ++l) {
      if (A(k, l) != 0) coupled[static_cast<std::size_t>(k)].push_back(l);
    }
  }
  Semidefinite dense(kRows), sparse(coupled);
  std::vector<double> entries(static_cast<std::size_t>(sparse.entry_count()));
  for (int k = 0; k < kRows; ++k) {
    for (int l = 0; l <= k; ++l) {
      const int entry = sparse.entry(k, l);
      ASSERT_TRUE(entry >= 0 || A(k, l) == 0);
      if (entry >= 0) entries[static_cast<std::size_t>(entry)] = A(k, l);
    }
  }
  EXPECT_LT(sparse.entry_count(), kRows * (kRows + 1) / 2);
  EXPECT_EQ(sparse.entry(10, 9), -1);
  // the ring's row fills in what lies between
  EXPECT_EQ(A(12, 4), 0);
  EXPECT_GE(sparse.entry(12, 4), 0);
  dense.factorize(values_of(A), {}, 1e-12);
  sparse.factorize(entries, {}, 1e-12);
  EXPECT_EQ(sparse.rank(), kRows - 1);
  EXPECT_TRUE(sparse.is_redundant(13));
  EXPECT_EQ(sparse.smallest_pivot(), dense.smallest_pivot());
  std::vector<double> b(kRows), c;
  for (double& x : b) x = std::uniform_real_distribution<double>(-1, 1)(random);
  c = b;
  dense.solve(b);
  sparse.solve(c);
  EXPECT_EQ(b, c);
}

TEST(Semidefinite, RowsThatNothingCouplesAreSolvedByThemselves) {
  const std::vector<std::vector<int>> coupled = {{}, {}, {0}, {1}};
  Semidefinite factor(coupled);
  ASSERT_EQ(factor.entry_count(), 6);
  std::vector<double> A(6);
  const auto put = [&](int k, int l, double value) { A[static_cast<std::size_t>(factor.entry(k, l))] = value; };
  put(0, 0, 2), put(2, 0, 1), put(2, 2, 3);
  put(1, 1, 4), put(3, 1, 2), put(3, 3, 5);
  factor.factorize(A, {}, 1e-12);
  const std::vector<int> rows = {1, 3};
  std::vector<double> b = {7, 8, 9, 8};
  factor.solve(rows, b);
  EXPECT_EQ(b[0], 7);
  EXPECT_EQ(b[2], 9);
  EXPECT_DOUBLE_EQ(4 * b[1] + 2 * b[3], 8);
  EXPECT_DOUBLE_EQ(2 * b[1] + 5 * b[3], 8);
}

}  // namespace semidefinite_test
}  // namespace slew::math
