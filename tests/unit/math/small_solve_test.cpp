// SPDX-License-Identifier: Apache-2.0
#include "math/small_solve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace slew::math {
namespace small_solve_test {

TEST(SolveInPlace, SolvesSystemsThatNeedRowExchanges) {
  double A[] = {0, 2, 1, 1, 0, 0, 3, 1, 4};
  // two right-hand sides, side by side: solutions (1, 2, 3) and (0, 1, -1)
  double B[] = {7, 1, 1, 0, 17, -3};
  ASSERT_TRUE(solve_in_place(A, B, 3, 2));
  const double expected[] = {1, 0, 2, 1, 3, -1};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(B[i], expected[i], 1e-15) << i;
}

TEST(SolveInPlace, TakesTheLargestPivot) {
  // elimination by 1e-20 would lose the ones
  double A[] = {1e-20, 1, 1, 1}, B[] = {1, 2};
  ASSERT_TRUE(solve_in_place(A, B, 2, 1));
  EXPECT_NEAR(B[0], 1, 1e-15);
  EXPECT_NEAR(B[1], 1, 1e-15);
}

TEST(SolveInPlace, LeavesASmallResidualOnRandomSystems) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 16u}) {
    for (int trial = 0; trial < 50; ++trial) {
      std::vector<double> A(n * n), b(n);
      for (double& value : A) value = unit(random);
      for (double& value : b) value = unit(random);
      std::vector<double> factors = A, x = b;
      ASSERT_TRUE(solve_in_place(factors.data(), x.data(), n, 1));
      double size = 1;
      for (const double value : x) size = std::max(size, std::fabs(value));
      for (std::size_t i = 0; i < n; ++i) {
        double residual = -b[i];
        for (std::size_t j = 0; j < n; ++j) residual += A[i * n + j] * x[j];
        EXPECT_LT(std::fabs(residual), 1e-13 * size);
      }
    }
  }
}

// one right-hand side has code of its own for small sizes, two have not
TEST(SolveInPlace, HasTheSameBitsForAnyNumberOfColumns) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (std::size_t n = 1; n <= 8; ++n) {
    for (int trial = 0; trial < 50; ++trial) {
      std::vector<double> A(n * n), b(n), twice(2 * n);
      for (double& value : A) value = unit(random);
      for (std::size_t i = 0; i < n; ++i) b[i] = twice[2 * i] = twice[2 * i + 1] = unit(random);
      std::vector<double> again = A;
      ASSERT_TRUE(solve_in_place(A.data(), b.data(), n, 1));
      ASSERT_TRUE(solve_in_place(again.data(), twice.data(), n, 2));
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(b[i], twice[2 * i]) << n;
        EXPECT_EQ(b[i], twice[2 * i + 1]) << n;
      }
    }
  }
}

TEST(SolveInPlace, RefusesSingularAndLostMatrices) {
  double singular[] = {1, 2, 2, 4}, lost[] = {std::numeric_limits<double>::quiet_NaN(), 1, 1, 1}, B[] = {1, 1};
  EXPECT_FALSE(solve_in_place(singular, B, 2, 1));
  EXPECT_FALSE(solve_in_place(lost, B, 2, 1));
}

}  // namespace small_solve_test
}  // namespace slew::math
