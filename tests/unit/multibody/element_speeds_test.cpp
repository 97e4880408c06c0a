// SPDX-License-Identifier: Apache-2.0
// Limits of the explicit rules on springs and dampers, against their stability regions (Hairer and Wanner, IV.2).
#include "multibody/forces/element_speeds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::multibody {
namespace element_speeds_test {

constexpr double kInertia = 2;        // kg m2, about the hinge
constexpr double kRk4OnReal = 2.785;  // h |lambda|
constexpr double kRk4OnImaginary = 2.828;

// an arm on a hinge with a rotational spring and damper towards Ground
MechanicsDef arm(double spring, double damping) {
  MechanicsDef def;
  def.bodies = {{.name = "Arm", .mass = 1, .inertia = {kInertia, kInertia, kInertia}}};
  def.joints = {{.name = "Hinge", .body1 = "Ground", .body2 = "Arm"}};
  RotationalForceDef force{.name = "Spring", .body1 = "Ground", .f1 = {1, 0, 0}, .g1 = {0, 1, 0}, .body2 = "Arm"};
  force.f2 = {1, 0, 0};
  force.spring_constant = spring;
  force.damping_constant = damping;
  def.rotational_forces = {force};
  return def;
}

std::optional<TooFast> found(const MechanicsDef& def, double h, Integrator rule = Integrator::rk4) {
  return find_too_fast_element(build_model(def), rule, h);
}

TEST(ElementSpeeds, DamperIsFollowedUpToTheRealAxis) {
  const double damping = 4000, limit = kRk4OnReal * kInertia / damping;
  EXPECT_FALSE(found(arm(0, damping), 0.99 * limit));
  const auto beyond = found(arm(0, damping), 1.1 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->element, "Spring");
  EXPECT_GT(beyond->growth, 1.25);
  EXPECT_NEAR(beyond->longest_step, limit, 0.07 * limit);
}

TEST(ElementSpeeds, SpringIsFollowedUpToTheImaginaryAxis) {
  const double spring = 2e6, omega = std::sqrt(spring / kInertia), limit = kRk4OnImaginary / omega;
  EXPECT_FALSE(found(arm(spring, 0), 0.99 * limit));
  const auto beyond = found(arm(spring, 0), 1.1 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_NEAR(beyond->longest_step, limit, 0.04 * limit);
  EXPECT_FALSE(found(arm(spring, 0), 0.99 * 2 / omega, Integrator::semi_implicit_euler));
  EXPECT_TRUE(found(arm(spring, 0), 1.1 * 2 / omega, Integrator::semi_implicit_euler));
}

TEST(ElementSpeeds, SpringAndDamperTogetherHaveTheirOwnRoots) {
  // a double root at -omega: d / I = 2 omega, which a limit by d alone would halve
  const double omega = 1000, spring = kInertia * omega * omega, damping = 2 * kInertia * omega;
  EXPECT_FALSE(found(arm(spring, damping), 0.95 * kRk4OnReal / omega));
  EXPECT_TRUE(found(arm(spring, damping), 1.15 * kRk4OnReal / omega));
}

TEST(ElementSpeeds, ExtremeRatesAreNamedWithAStepThatSuits) {
  const double damping = 5e9;
  const auto beyond = found(arm(0, damping), 1e-3);
  ASSERT_TRUE(beyond);
  const double limit = kRk4OnReal * kInertia / damping;
  EXPECT_NEAR(beyond->longest_step, limit, 0.07 * limit);
  EXPECT_FALSE(found(arm(0, damping), 0.95 * beyond->longest_step));
}

// A load on a rope over a pulley, slack or taut at the start: omega^2 = k/m, k = EA/L_0 or the stiffness.
TEST(ElementSpeeds, RopeIsFollowedAsTheSpringThatItIsWhileTaut) {
  constexpr double kMass = 3, kRigidity = 3e6;
  for (const double free_length : {5.5, 4.9}) {
    MechanicsDef def;
    def.bodies = {{.name = "Load", .position = {2, -1, 0}, .mass = kMass, .inertia = {1, 1, 1}}};
    def.joints = {{.name = "Guide",
                   .type = JointType::prismatic,
                   .point1 = {2, -1, 0},
                   .orientation1 = {-M_PI / 2, 0, 0},
                   .body2 = "Load",
                   .orientation2 = {-M_PI / 2, 0, 0}}};
    RopeDef rope{.name = "Hoist", .bodies = {"Ground", "Ground", "Load"}, .points = {{0, 2, 0}, {2, 2, 0}, {0, 0, 0}}};
    rope.free_length = free_length;
    rope.damping_constant = 1e9;  // as much as the spring at most
    for (const bool is_by_rigidity : {true, false}) {
      rope.axial_rigidity = is_by_rigidity ? kRigidity : 0;
      rope.stiffness = is_by_rigidity ? 0 : kRigidity / free_length;
      def.ropes = {rope};
      const double limit = kRk4OnImaginary * std::sqrt(kMass * free_length / kRigidity);
      EXPECT_FALSE(found(def, 0.99 * limit)) << free_length;
      const auto beyond = found(def, 1.1 * limit);
      ASSERT_TRUE(beyond) << free_length;
      EXPECT_EQ(beyond->element, "Hoist");
      EXPECT_NEAR(beyond->longest_step, limit, 0.05 * limit);
      EXPECT_FALSE(found(def, 1.1 * limit, Integrator::trapezoidal));
    }
    def.ropes[0].stiffness = 0;
    def.ropes[0].spring_table = {{0, 0}, {1, 1e12}};
    EXPECT_FALSE(found(def, 1e-2));
  }
}

TEST(ElementSpeeds, NamesTheElementThatIsTooFast) {
  MechanicsDef def = arm(10, 1);
  RotationalForceDef brake = def.rotational_forces[0];
  brake.name = "Brake";
  brake.damping_constant = 1e6;
  def.rotational_forces.push_back(brake);
  Problems problems;
  check_element_speeds(def, 1e-3, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].path, "Brake");
  EXPECT_NE(problems[0].what.find("rk4 in sub-steps of 0.001 s"), std::string::npos) << problems[0].what;
  EXPECT_NE(problems[0].expected.find("mechanics.max_substep of at most 5."), std::string::npos)
      << problems[0].expected;
}

TEST(ElementSpeeds, LeavesImplicitRulesAndSaturatingTablesAlone) {
  EXPECT_FALSE(found(arm(0, 1e9), 1e-3, Integrator::trapezoidal));
  MechanicsDef def = arm(0, 0);
  def.rotational_forces[0].damper_table = {{-1, -100}, {-1e-4, -90}, {0, 0}, {1e-4, 90}, {1, 100}};
  EXPECT_FALSE(found(def, 1e-3));
}

}  // namespace element_speeds_test
}  // namespace slew::multibody
