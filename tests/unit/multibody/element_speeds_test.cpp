// SPDX-License-Identifier: Apache-2.0
// Limits of the explicit rules on springs and dampers, against their stability regions (Hairer and Wanner, IV.2).
#include "multibody/formulations/element_speeds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

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

// a stretch of 1 m along the x axis between Ground and a mass of 1 kg on a slide
MechanicsDef slider() {
  MechanicsDef def;
  def.bodies = {{.name = "Block", .position = {1, 0, 0}, .mass = 1, .inertia = {0.1, 0.1, 0.1}}};
  JointDef slide{.name = "Slide", .body1 = "Ground", .body2 = "Block"};
  slide.type = JointType::prismatic;
  slide.orientation1 = slide.orientation2 = {0, M_PI / 2, 0};
  def.joints = {slide};
  return def;
}

TranslationalForceDef spring_to_block() {
  TranslationalForceDef force{.name = "Spring", .body1 = "Ground", .body2 = "Block"};
  force.free_length = 1;
  return force;
}

// not even by a thousandth: 1.187 times in each of two thousand steps is 1e149
TEST(ElementSpeeds, DamperIsFollowedUpToTheRealAxis) {
  const double damping = 4000, limit = kRk4OnReal * kInertia / damping;
  EXPECT_FALSE(found(arm(0, damping), 0.999 * limit));
  const auto beyond = found(arm(0, damping), 1.002 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->element, "Spring");
  EXPECT_NEAR(beyond->rate, damping / kInertia, 1e-4 * damping / kInertia);
  EXPECT_NEAR(beyond->longest_step, limit, 1e-3 * limit);
  // R(-2.9) = 1 - 2.9 + 2.9^2/2 - 2.9^3/6 + 2.9^4/24
  const auto known = found(arm(0, 2900 * kInertia), 1e-3);
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->growth, 1.1871708, 1e-5);
  EXPECT_FALSE(known->swings);
}

TEST(ElementSpeeds, SpringIsFollowedUpToTheImaginaryAxis) {
  const double spring = 2e6, omega = std::sqrt(spring / kInertia), limit = kRk4OnImaginary / omega;
  EXPECT_FALSE(found(arm(spring, 0), 0.999 * limit));
  const auto beyond = found(arm(spring, 0), 1.002 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_TRUE(beyond->swings);
  EXPECT_NEAR(beyond->rate, omega, 1e-4 * omega);
  EXPECT_NEAR(beyond->longest_step, limit, 2e-3 * limit);
  EXPECT_FALSE(found(arm(spring, 0), 0.999 * 2 / omega, Integrator::semi_implicit_euler));
  EXPECT_TRUE(found(arm(spring, 0), 1.001 * 2 / omega, Integrator::semi_implicit_euler));
}

TEST(ElementSpeeds, SpringAndDamperTogetherHaveTheirOwnRoots) {
  // a double root at -omega: d / I = 2 omega, which a limit by d alone would halve
  const double omega = 1000, spring = kInertia * omega * omega, damping = 2 * kInertia * omega;
  EXPECT_FALSE(found(arm(spring, damping), 0.99 * kRk4OnReal / omega));
  EXPECT_TRUE(found(arm(spring, damping), 1.01 * kRk4OnReal / omega));
  // semi-implicit: a root of its map is -1 where 4 = 2 h d / I + h^2 k / I, at h omega = sqrt(8) - 2
  const double limit = (std::sqrt(8.0) - 2) / omega;
  EXPECT_FALSE(found(arm(spring, damping), 0.99 * limit, Integrator::semi_implicit_euler));
  EXPECT_TRUE(found(arm(spring, damping), 1.01 * limit, Integrator::semi_implicit_euler));
}

TEST(ElementSpeeds, ExtremeRatesAreNamedWithAStepThatSuits) {
  const double damping = 5e9;
  const auto beyond = found(arm(0, damping), 1e-3);
  ASSERT_TRUE(beyond);
  const double limit = kRk4OnReal * kInertia / damping;
  EXPECT_NEAR(beyond->longest_step, limit, 1e-3 * limit);
  EXPECT_FALSE(found(arm(0, damping), 0.95 * beyond->longest_step));
}

// an inverted pendulum on springs falls by itself, slowly: that is the motion, not the rule
TEST(ElementSpeeds, WhatFallsByItselfIsNoFault) {
  MechanicsDef def = slider();
  TranslationalForceDef pushed = spring_to_block();
  pushed.body1 = "Block", pushed.body2 = "Rod", pushed.free_length = 1.2, pushed.spring_constant = 1e5;
  def.bodies.push_back({.name = "Rod", .position = {2, 0, 0}, .mass = 1, .inertia = {1, 1, 1}});
  JointDef hinge{.name = "Hinge", .body1 = "Ground", .point1 = {2, 0, 0.5}, .body2 = "Rod", .point2 = {0, 0, 0.5}};
  def.joints.push_back(hinge);
  def.translational_forces = {pushed};
  EXPECT_FALSE(found(def, 1e-3));
}

TEST(ElementSpeeds, TablesCountAtTheirSteepest) {
  // 9e6 N/m on 1 kg, soft about the start: 3000 1/s
  const double limit = kRk4OnImaginary / 3000;
  MechanicsDef def = slider();
  TranslationalForceDef spring = spring_to_block();
  spring.spring_table = {{-0.2, -9e5 - 10}, {-0.1, -10}, {0, 0}, {0.1, 10}, {0.2, 9e5 + 10}};
  def.translational_forces = {spring};
  EXPECT_TRUE(found(def, 1.01 * limit));
  def.translational_forces[0].spring_table = {{-0.1, -9e5}, {0.1, 9e5}};
  EXPECT_FALSE(found(def, 0.999 * limit));
  EXPECT_TRUE(found(def, 1.002 * limit));
  def.translational_forces[0].spring_table.clear();
  def.translational_forces[0].damper_table = {{-1, -3000}, {1, 3000}};
  EXPECT_FALSE(found(def, 0.999 * kRk4OnReal / 3000));
  EXPECT_TRUE(found(def, 1.002 * kRk4OnReal / 3000));

  def.translational_forces.clear();
  BushingDef bushing;
  bushing.name = "Mount", bushing.frames.body1 = "Ground", bushing.frames.body2 = "Block";
  bushing.frames.point1 = {1, 0, 0};
  bushing.spring_tables.x = {{-0.1, -9e5}, {0.1, 9e5}};
  def.bushings = {bushing};
  EXPECT_FALSE(found(def, 0.999 * limit));
  EXPECT_TRUE(found(def, 1.002 * limit));
}

TEST(ElementSpeeds, EndDampersCountWhereTheyCanBeTouched) {
  const double omega = std::sqrt(1e7), limit = kRk4OnImaginary / omega;
  MechanicsDef def = slider();
  TranslationalForceDef spring = spring_to_block();
  spring.end_spring_constant = 1e7;
  def.translational_forces = {spring};
  EXPECT_FALSE(found(def, 2 * limit));
  def.translational_forces[0].max_length = 1.05;
  EXPECT_FALSE(found(def, 0.999 * limit));
  const auto beyond = found(def, 1.002 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_TRUE(beyond->is_at_end);
  EXPECT_NE(problem_of(*beyond, Integrator::rk4, 1e-3).what.find("end dampers touched"), std::string::npos);
}

TEST(ElementSpeeds, RopesCountAsTaut) {
  const double limit = kRk4OnImaginary / 3000;
  MechanicsDef def = slider();
  RopeDef rope;
  rope.name = "Rope", rope.bodies = {"Ground", "Block"}, rope.points = {{0, 0, 0}, {0, 0, 0}};
  rope.free_length = 2, rope.stiffness = 9e6;
  def.ropes = {rope};
  EXPECT_FALSE(found(def, 0.995 * limit));
  const auto beyond = found(def, 1.005 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->element, "Rope");
  // the stiffness of a rope by its section goes with its length, which may change in a run
  def.ropes[0].stiffness = 0, def.ropes[0].axial_rigidity = 18e6;
  EXPECT_FALSE(found(def, 0.995 * limit));
  def.ropes[0].free_length = 1;
  EXPECT_TRUE(found(def, 0.995 * limit));
}

// N C R^2/(v_0 I) of a wheel that stands: 49 kN, 10, 0.5 m, 0.1 m/s, 20 kg m2
TEST(ElementSpeeds, TheSlipOfAStandingWheelIsADamper) {
  MechanicsDef def;
  def.bodies = {{.name = "Wheel", .position = {0, 0.45, 0}, .mass = 5000, .inertia = {12, 12, 20}}};
  def.joints = {{.name = "Hub", .body1 = "Ground", .point1 = {0, 0.45, 0}, .body2 = "Wheel"}};
  TyreDummyDef tyre{.name = "Tyre", .relative_to = "Wheel"};
  tyre.rolling = TyreRolling::with_body, tyre.radius = 0.5, tyre.stiffness = 9.8e5;
  def.tyre_dummies = {tyre};
  const double rate = 0.05 * 9.8e5 * 10 * 0.5 * 0.5 / (0.1 * 20), limit = kRk4OnReal / rate;
  EXPECT_FALSE(found(def, 0.99 * limit));
  const auto beyond = found(def, 1.01 * limit);
  ASSERT_TRUE(beyond);
  EXPECT_EQ(beyond->element, "Tyre");
  EXPECT_NEAR(beyond->rate, rate, 1e-2 * rate);
}

// two hundred masses: the rates are those of a part of the space
TEST(ElementSpeeds, FindsTheFastestOfAChain) {
  MechanicsDef def;
  for (int i = 0; i < 100; ++i) {
    const std::string name = "Block" + std::to_string(i), before = i == 0 ? "Ground" : "Block" + std::to_string(i - 1);
    def.bodies.push_back({.name = name, .position = {1.0 + i, 0, 0}, .mass = 1, .inertia = {1, 1, 1}});
    JointDef slide{.name = "Slide" + std::to_string(i), .body1 = "Ground", .body2 = name};
    slide.type = JointType::prismatic;
    slide.orientation1 = slide.orientation2 = {0, M_PI / 2, 0};
    slide.point1 = {1.0 + i, 0, 0};
    def.joints.push_back(slide);
    TranslationalForceDef spring{.name = "Spring" + std::to_string(i), .body1 = before, .body2 = name};
    spring.free_length = 1, spring.spring_constant = 1e6;
    def.translational_forces.push_back(spring);
  }
  // omega = 2 sqrt(k/m) cos(pi/(2 (2 n + 1))), of a chain with one free end
  const double omega = 2e3 * std::cos(M_PI / 402), limit = kRk4OnImaginary / omega;
  EXPECT_FALSE(found(def, 0.999 * limit));
  EXPECT_TRUE(found(def, 1.01 * limit));
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

TEST(ElementSpeeds, LeavesImplicitRulesAlone) {
  EXPECT_FALSE(found(arm(0, 1e9), 1e-3, Integrator::trapezoidal));
  // friction by a table: beyond the limit a sub-step jumps from bound to bound, at rest as well
  MechanicsDef def = arm(0, 0);
  def.rotational_forces[0].damper_table = {{-1, -100}, {-1e-4, -90}, {0, 0}, {1e-4, 90}, {1, 100}};
  EXPECT_FALSE(found(def, 1e-3, Integrator::sdirk2));
  EXPECT_TRUE(found(def, 1e-3));
}

// a mass of 1 kg on an end damper: beyond k h^2/m of 0.25 it would leave with up to 2.9 times its speed
TEST(ElementSpeeds, TouchIsTakenWholeByEulerUpToAQuarterOfItsLimit) {
  MechanicsDef def = slider();
  TranslationalForceDef stop = spring_to_block();
  stop.min_length = 0.5;
  const double h = 1e-3;
  for (const double share : {0.24, 0.26, 3.9}) {
    stop.end_spring_constant = share / (h * h);
    def.translational_forces = {stop};
    const auto euler = found(def, h, Integrator::semi_implicit_euler);
    ASSERT_EQ(euler.has_value(), share > 0.25) << share;
    EXPECT_FALSE(found(def, h)) << "rk4 divides touches";
    if (!euler) continue;
    EXPECT_EQ(euler->element, "Spring");
    EXPECT_TRUE(euler->is_touch);
    EXPECT_NEAR(euler->longest_step, h * std::sqrt(0.25 / share), 1e-2 * h);
    const Problem problem = problem_of(*euler, Integrator::semi_implicit_euler, h);
    EXPECT_NE(problem.what.find("a touch of it is too short for semi_implicit_euler"), std::string::npos);
  }
  // a spring on both sides keeps the limit of the rule
  stop.end_spring_constant = 0;
  stop.spring_constant = 3.9 / (h * h);
  def.translational_forces = {stop};
  EXPECT_FALSE(found(def, h, Integrator::semi_implicit_euler));
}

}  // namespace element_speeds_test
}  // namespace slew::multibody
