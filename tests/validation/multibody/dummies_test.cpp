// SPDX-License-Identifier: Apache-2.0
// Masses that elements carry: mass, momentum and inertia are those of a body of the same mass held there by a fixed
// joint; tyres against statics, coasting and slip laws by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace dummies_test {

using math::Vec3;
using testing::Mechanism;

constexpr double kMass = 7;
constexpr Triple kInertia = {0.3, 0.4, 0.5}, kTurn = {0.4, -0.3, 0.9}, kPlace = {0.6, -0.2, 0.3};

// two bodies with a hinge between them, flying
MechanicsDef flying_pair() {
  MechanicsDef def;
  def.bodies = {
      {.name = "First", .position = {1, 2, 3}, .orientation = {0.3, 0.5, 0.2}, .mass = 5, .inertia = {1, 2, 2}},
      {.name = "Second", .relative_to = "First", .position = {1, 0, 0}, .mass = 3, .inertia = {1, 1, 1.5}}};
  def.joints = {{.name = "Flight",
                 .type = JointType::floating,
                 .body2 = "First",
                 .initial_translation = {1, -2, 0.5},
                 .initial_rotation = {0.5, 0.7, -1}},
                {.name = "Hinge",
                 .body1 = "First",
                 .point1 = {1, 0, 0},
                 .orientation1 = {0.2, 0.1, 0},
                 .body2 = "Second",
                 .orientation2 = {0.2, 0.1, 0},
                 .initial_velocity = 2}};
  return def;
}

// a body welded to `carrier` that stands in the frame of `frame` at the start
MechanicsDef with_welded_body(const std::string& frame, const std::string& carrier, Triple place, Triple turn) {
  MechanicsDef def = flying_pair();
  def.bodies.push_back({.name = "Extra",
                        .relative_to = frame,
                        .position = place,
                        .orientation = turn,
                        .mass = kMass,
                        .center_of_mass = {0.1, 0.2, 0},
                        .inertia = kInertia});
  // the weld's point and axes are those of the extra body, seen from the carrier; found from the built poses
  const Mechanism probe = [&] {
    MechanicsDef free = def;
    free.joints.push_back({.name = "Loose", .type = JointType::floating, .body2 = "Extra"});
    return Mechanism(free);
  }();
  const BodyPose extra = probe.pose("Extra"), base = probe.pose(carrier);
  const auto rotation = [](const BodyPose& pose) {
    return math::rotation_of({pose.orientation[0], pose.orientation[1], pose.orientation[2], pose.orientation[3]});
  };
  const math::Mat3 R = math::transpose(rotation(base)) * rotation(extra);
  const Vec3 p = math::transpose(rotation(base)) * (Vec3(extra.position) - Vec3(base.position));
  def.joints.push_back(
      {.name = "Weld",
       .type = JointType::fixed,
       .body1 = carrier,
       .point1 = p.array(),
       .orientation1 = {std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)), std::atan2(-R(0, 1), R(0, 0))},
       .body2 = "Extra"});
  return def;
}

void expect_same_motion(const MechanicsDef& with_dummy, const MechanicsDef& with_body) {
  Mechanism a(with_dummy), b(with_body);
  const Momentum p = momentum(a.model, a.ws), q = momentum(b.model, b.ws);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(p.linear[k], q.linear[k], 1e-11);
    EXPECT_NEAR(p.angular[k], q.angular[k], 1e-10);
  }
  EXPECT_NEAR(energy(a.model, a.ws).kinetic, energy(b.model, b.ws).kinetic, 1e-10);
  EXPECT_NEAR(a.total_energy(), b.total_energy(), 1e-9);
  a.run(0.5, 1e-3);
  b.run(0.5, 1e-3);
  for (std::size_t i = 0; i < a.state.u.size(); ++i) EXPECT_NEAR(a.state.u[i], b.state.u[i], 1e-10);
}

TEST(PartDummy, IsABodyOnItsCarrierPlacedInAnotherFrame) {
  for (const auto& [frame, carrier] : {std::pair{"Ground", "Second"}, {"First", "Second"}, {"Second", "First"}}) {
    MechanicsDef def = flying_pair();
    def.part_dummies = {{.name = "Part",
                         .relative_to = frame,
                         .carried_by = carrier,
                         .position = kPlace,
                         .orientation = kTurn,
                         .mass = kMass,
                         .center_of_mass = {0.1, 0.2, 0},
                         .inertia = kInertia}};
    expect_same_motion(def, with_welded_body(frame, carrier, kPlace, kTurn));
  }
}

TEST(ConstraintDummy, IsABodyOnTheJointsFrame) {
  // the hinge's frames are turned about x, then y'; a body's Euler angles of the same turn
  const math::Mat3 R = math::rotation_xyz({0.2, 0.1, 0});
  const Triple euler = {std::atan2(R(0, 2), -R(1, 2)), std::acos(R(2, 2)), std::atan2(R(2, 0), R(2, 1))};
  for (const int index : {1, 2}) {
    MechanicsDef def = flying_pair();
    def.constraint_dummies = {{.name = "Pin",
                               .relative_to = "Hinge",
                               .index = index,
                               .mass = kMass,
                               .center_of_mass = {0.1, 0.2, 0},
                               .inertia = kInertia}};
    const Triple place = index == 1 ? Triple{1, 0, 0} : Triple{0, 0, 0};
    const std::string carrier = index == 1 ? "First" : "Second";
    expect_same_motion(def, with_welded_body(carrier, carrier, place, euler));
  }
}

constexpr double kRadius = 0.5, kStiffness = 2e5, kWeight = 120 * 9.81;

// a block of 100 kg over a wheel of 20 kg; the axle is z, so that the wheel rolls towards -x with a positive speed
MechanicsDef wheel(Triple velocity, TyreRolling rolling) {
  MechanicsDef def;
  def.bodies = {
      {.name = "Block", .position = {0, kRadius - kWeight / kStiffness, 0}, .mass = 100, .inertia = {5, 5, 5}}};
  def.joints = {{.name = "Free",
                 .type = JointType::floating,
                 .point1 = {0, kRadius - kWeight / kStiffness, 0},
                 .body2 = "Block",
                 .initial_translation = velocity}};
  def.tyre_dummies = {{.name = "Wheel",
                       .relative_to = "Block",
                       .mass = 20,
                       .rolling = rolling,
                       .radius = kRadius,
                       .stiffness = kStiffness,
                       .damping = 2e3,
                       .friction = 0.7,
                       .longitudinal_slip_slope = 12,
                       .lateral_slip_slope = 9}};
  return def;
}

TEST(Tyre, CarriesTheWeightOfBodyAndWheel) {
  Mechanism mechanism(wheel({}, TyreRolling::free));
  EXPECT_NEAR(mechanism.value("Wheel.normal_force"), kWeight, 1e-8);
  EXPECT_NEAR(mechanism.value("Wheel.deflection"), kWeight / kStiffness, 1e-12);
  forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
  for (const double rate : mechanism.ws.udot) EXPECT_NEAR(rate, 0, 1e-9);
}

TEST(Tyre, FollowsAGroundAtAnAngle) {
  MechanicsDef def = wheel({}, TyreRolling::free);
  // plane through the contact point, tilted about the axle by 30 degrees: distance of the centre is the same
  def.tyre_dummies[0].ground_normal = {std::sin(M_PI / 6), std::cos(M_PI / 6), 0};
  const double height = kRadius - kWeight / kStiffness;
  def.tyre_dummies[0].ground_height = height * std::cos(M_PI / 6) - kRadius + 0.001;
  Mechanism mechanism(def);
  EXPECT_NEAR(mechanism.value("Wheel.normal_force"), 0.001 * kStiffness, 1e-6);
  forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
  EXPECT_NEAR(mechanism.ws.udot[0], 0.001 * kStiffness / 120 * std::sin(M_PI / 6), 1e-9);
}

TEST(Tyre, NeverPullsAtTheGround) {
  Mechanism mechanism(wheel({0, 50, 0}, TyreRolling::free));
  EXPECT_EQ(mechanism.value("Wheel.normal_force"), 0);
  mechanism.run(0.1, 1e-3);
  EXPECT_EQ(mechanism.value("Wheel.deflection"), 0);
  EXPECT_NEAR(mechanism.state.u[1], 50 - 9.81 * 0.1, 1e-9);
}

TEST(Tyre, CoastsAgainstItsRollingResistance) {
  MechanicsDef def = wheel({10, 0, 0}, TyreRolling::free);
  Mechanism free(def);
  EXPECT_EQ(free.value("Wheel.longitudinal_force"), 0);
  def.tyre_dummies[0].rolling_resistance = 0.02;
  Mechanism coasting(def);
  EXPECT_NEAR(coasting.value("Wheel.longitudinal_force"), 0.02 * kWeight, 1e-4 * kWeight);
  forward_dynamics(coasting.model, coasting.state.q, coasting.state.u, {}, coasting.ws);
  // at the hub: no moment on the body
  EXPECT_NEAR(coasting.ws.udot[0], -0.02 * 9.81, 1e-4);
  EXPECT_NEAR(coasting.ws.udot[5], 0, 1e-12);
}

TEST(Tyre, HoldsSidewaysByItsSlipAngleUpToFriction) {
  for (const double sideways : {0.01, 0.1, 1.0, 5.0}) {
    Mechanism mechanism(wheel({10, 0, sideways}, TyreRolling::free));
    const double tangent = sideways / std::sqrt(100 + 0.01);
    EXPECT_NEAR(mechanism.value("Wheel.lateral_force"), -kWeight * 0.7 * std::tanh(9 * tangent / 0.7), 1e-8 * kWeight);
    EXPECT_NEAR(mechanism.value("Wheel.slip_angle"), -std::atan(tangent), 1e-12);
  }
}

TEST(Tyre, BrakesALockedWheelByItsFriction) {
  Mechanism mechanism(wheel({10, 0, 0}, TyreRolling::with_body));
  // slip of the whole speed: 12/0.7 of the way up tanh
  EXPECT_NEAR(mechanism.value("Wheel.slip"), 1, 1e-4);
  EXPECT_NEAR(mechanism.value("Wheel.longitudinal_force"), 0.7 * kWeight, 1e-6 * kWeight);
}

TEST(Tyre, LimitsBothSlipsTogether) {
  MechanicsDef def = wheel({10, 0, 3}, TyreRolling::with_body);
  Mechanism mechanism(def);
  const double x = mechanism.value("Wheel.longitudinal_force"), z = mechanism.value("Wheel.lateral_force");
  EXPECT_NEAR(std::hypot(x, z), 0.7 * kWeight, 1e-6 * kWeight);
  EXPECT_NEAR(-z / x, 9.0 * 3 / (12.0 * 10), 1e-9);
}

TEST(Tyre, HasNoSlipWhereItRolls) {
  MechanicsDef def = wheel({10, 0, 0}, TyreRolling::with_body);
  // forwards along x the wheel turns about -z
  def.joints[0].initial_rotation = {0, 0, -10 / kRadius};
  Mechanism mechanism(def);
  EXPECT_NEAR(mechanism.value("Wheel.slip"), 0, 1e-14);
  EXPECT_NEAR(mechanism.value("Wheel.longitudinal_force"), 0, 1e-9);
  // a bit slower it is driven by the ground
  mechanism.state.u[5] *= 0.999;
  mechanism.see();
  EXPECT_NEAR(mechanism.value("Wheel.longitudinal_force"), kWeight * 12 * 1e-3, 1e-4 * kWeight);
}

// thrown at an angle with a leaning wheel: spring and gravity exchange energy, nothing is lost without damper and slip
TEST(Tyre, KeepsTheEnergyOfALeaningWheel) {
  MechanicsDef def = wheel({1, -2, 0.5}, TyreRolling::free);
  def.bodies[0].orientation = {0, 0.3, 0};
  def.bodies[0].position[1] += 0.1;
  def.joints[0].point1[1] += 0.1;
  def.joints[0].initial_rotation = {0.8, 0.3, 0.2};
  TyreDummyDef& tyre = def.tyre_dummies[0];
  tyre.damping = tyre.longitudinal_slip_slope = tyre.lateral_slip_slope = 0;
  Mechanism mechanism(def);
  const double before = mechanism.total_energy();
  double deepest = 0, drift = 0;
  for (int i = 0; i < 1000; ++i) {
    mechanism.run(2e-4, 2e-4);
    deepest = std::max(deepest, mechanism.value("Wheel.deflection"));
    drift = std::max(drift, std::abs(mechanism.total_energy() - before));
  }
  EXPECT_GT(deepest, 0.02);
  EXPECT_LT(drift, 1e-5 * before);
}

}  // namespace dummies_test
}  // namespace slew::multibody
