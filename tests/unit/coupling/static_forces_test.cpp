#include "coupling/static_forces.h"

#include <gtest/gtest.h>

namespace slew::coupling {
namespace {

TEST(StaticForces, CancelTheFreeAccelerations) {
  const double W[] = {3e-5, -2e-5, -2e-5, 4e-5}, a_free[] = {-5, 3};
  double F[2] = {};
  ASSERT_TRUE(static_forces(W, a_free, F));
  EXPECT_NEAR(W[0] * F[0] + W[1] * F[1], 5, 1e-12);
  EXPECT_NEAR(W[2] * F[0] + W[3] * F[1], -3, 1e-12);
}

TEST(StaticForces, AreNotThereForTwoCylindersOnOneCoordinate) {
  const double W[] = {1, 2, 2, 4}, a_free[] = {1, 2};
  double F[2] = {};
  EXPECT_FALSE(static_forces(W, a_free, F));
}

}  // namespace
}  // namespace slew::coupling
