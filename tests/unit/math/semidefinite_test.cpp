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

// The bits must not depend on what was factorized before.
TEST(Semidefinite, RedundancyOfOneMatrixIsForgottenWithTheNext) {
  Semidefinite factor(2);
  factor.factorize(std::vector<double>{1, 1, 1, 1}, {}, 1e-12);
  EXPECT_EQ(factor.rank(), 1);
  factor.factorize(std::vector<double>{2, 0, 0, 2}, {}, 1e-12);
  EXPECT_EQ(factor.rank(), 2);
}

}  // namespace semidefinite_test
}  // namespace slew::math
