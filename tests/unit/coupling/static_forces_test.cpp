// SPDX-License-Identifier: Apache-2.0
#include "coupling/static_forces.h"

#include <gtest/gtest.h>

namespace slew::coupling {
namespace static_forces_test {

TEST(StaticForces, CancelTheFreeAccelerations) {
  const double W[] = {3e-5, -2e-5, -2e-5, 4e-5}, a_free[] = {-5, 3};
  double F[2] = {};
  ASSERT_TRUE(static_forces(W, a_free, F));
  EXPECT_NEAR(W[0] * F[0] + W[1] * F[1], 5, 1e-12);
  EXPECT_NEAR(W[2] * F[0] + W[3] * F[1], -3, 1e-12);
}

TEST(StaticForces, AreSharedByCylindersThatMoveTheSameCoordinate) {
  // W = g g^T, g = (1, 2): the shortest F of W F = -a_free lies along g
  const double W[] = {1, 2, 2, 4}, a_free[] = {1, 2};
  double F[2] = {};
  ASSERT_TRUE(static_forces(W, a_free, F));
  EXPECT_NEAR(F[0], -0.2, 1e-15);
  EXPECT_NEAR(F[1], -0.4, 1e-15);
}

TEST(StaticForces, AreEqualForTwinsBesideAThirdCylinder) {
  // two equal ports with the rounding of a real mechanism between them, one that also moves another coordinate
  const double W[] = {3e-5, 3e-5 * (1 + 1e-15), -2e-5, 3e-5 * (1 + 1e-15), 3e-5, -2e-5, -2e-5, -2e-5, 4e-5};
  const double a_free[] = {-9, -9, 5};
  double F[3] = {};
  ASSERT_TRUE(static_forces(W, a_free, F));
  EXPECT_NEAR(F[0], F[1], 1e-8 * F[0]);
  EXPECT_NEAR(3e-5 * (F[0] + F[1]) - 2e-5 * F[2], 9, 1e-7);
  EXPECT_NEAR(-2e-5 * (F[0] + F[1]) + 4e-5 * F[2], -5, 1e-7);
}

TEST(StaticForces, AreNotThereWhenOnePortWouldMoveOtherwise) {
  const double W[] = {1, 2, 2, 4}, a_free[] = {1, 3};
  double F[2] = {};
  EXPECT_FALSE(static_forces(W, a_free, F));
}

}  // namespace static_forces_test
}  // namespace slew::coupling
