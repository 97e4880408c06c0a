// SPDX-License-Identifier: Apache-2.0
// Case P02: the same mechanisms in MuJoCo 2.2.2 (mujoco_peer.h), which assembles the mass matrix from composite bodies
// and factorises it: the states of case P01 with dummies on forces taken away from both.
//
// Both are exact, the difference is rounding: 6e-14 at most, 1e-12 allowed.
#include "tests/peers/multibody/agreement.h"
#include "tests/peers/multibody/mujoco_peer.h"

namespace slew::multibody::testing {
namespace mujoco_test {

constexpr double kTolerance = 1e-12;

class Mechanisms : public ::testing::TestWithParam<Case> {
 protected:
  const Sample sample{GetParam(), ForceDummies::without};
};

TEST_P(Mechanisms, AccelerateLikeMujoco) {
  const double difference = accelerations_differ_by<MujocoPeer>(sample, sample.def);
  record("difference", difference);
  EXPECT_LT(difference, kTolerance);
}

TEST_P(Mechanisms, ShowTheRowsThatMujocoSees) {
  if (sample.rows.empty()) GTEST_SKIP() << "nothing to act on";
  expect_same_rows(rows_differ_by<MujocoPeer>(sample), kTolerance);
}

INSTANTIATE_TEST_SUITE_P(OfOurs, Mechanisms, ::testing::ValuesIn(cases()), case_name);

TEST(ComparisonWithMujoco, SeesAMassThatIsAMillionthOff) {
  const Sample sample({Case::Kind::truck_crane, 1}, ForceDummies::without);
  MechanicsDef other = sample.def;
  other.bodies.back().mass *= 1 + 1e-6;
  EXPECT_GT(accelerations_differ_by<MujocoPeer>(sample, other), 1e4 * kTolerance);
}

}  // namespace mujoco_test
}  // namespace slew::multibody::testing
