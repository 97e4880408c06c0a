// SPDX-License-Identifier: Apache-2.0
#include "math/spectral_radius.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::math {
namespace spectral_radius_test {

TEST(SpectralRadius, finds_a_real_eigenvalue_and_its_owner) {
  const double scale[] = {1, 1, 1};
  SpectralRadius radius(scale, 3);
  const double A[] = {-1, 2, 0, 0, -50, 1, 0, 0, -3};
  EXPECT_NEAR(radius.update(A, 40), 50, 1e-6);
  EXPECT_EQ(radius.owner(), 1);
}

TEST(SpectralRadius, finds_the_size_of_a_complex_pair_in_any_units) {
  // a spring of 100 rad/s with its position in um and its speed in km/s would not be seen without scales
  const double scale[] = {1e-6, 1e-4};
  SpectralRadius radius(scale, 2);
  const double A[] = {0, 1, -1e4, -20};
  EXPECT_NEAR(radius.update(A, 200), 100, 3);
}

TEST(SpectralRadius, follows_a_matrix_that_changes_within_a_few_iterations) {
  const double scale[] = {1, 1};
  SpectralRadius radius(scale, 4);
  double A[] = {-10, 1, 9, 9, 0, -2, 9, 9};  // stride 4
  EXPECT_NEAR(radius.update(A, 60), 10, 1e-6);
  A[5] = -1000;
  static_cast<void>(radius.update(A, 4));
  EXPECT_NEAR(radius.update(A, 4), 1000, 1);
  EXPECT_EQ(radius.owner(), 1);
}

TEST(SpectralRadius, of_nothing_is_zero) {
  const double scale[] = {1, 1}, A[] = {0, 0, 0, 0};
  SpectralRadius radius(scale, 2);
  EXPECT_EQ(radius.update(A, 4), 0);
}

}  // namespace spectral_radius_test
}  // namespace slew::math
