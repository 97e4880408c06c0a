// SPDX-License-Identifier: Apache-2.0
// Friction and limits along the coordinates of universal and cylindrical joints, and of joints that close a loop, in
// every formulation. A ball about the centre of a universal joint has M = I 1: its two axes are independent.
#include <gtest/gtest.h>

#include <cmath>

#include "support/mechanics_alone.h"

namespace slew::testing {
namespace joint_axes_test {

constexpr const char* kBall = R"(
mechanics: {gravity: [0, 0, 0]}
bodies:
  Ball: {mass: 3 kg, inertia: [0.5, 0.5, 0.5]}
joints:
  Cross:
    type: universal
    body2: Ball
    orientation2: [-90 deg, 0, -180 deg]
    initial_velocity_1: 3 rad/s
    initial_velocity_2: 2 rad/s
    viscous_friction_1: 0.4 Nms/rad
    limit_max_2: 1 rad
    limit_stiffness_2: 2000 Nm/rad
)";

constexpr const char* kNut = R"(
bodies:
  Nut: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Pin:
    type: cylindrical
    orientation1: [-90 deg, 0, 0]
    body2: Nut
    orientation2: [-90 deg, 0, 0]
    initial_angular_velocity: 5 rad/s
    coulomb_friction_angle: 0.05 Nm
    friction_speed_angle: 1e-4 rad/s
    coulomb_friction: 30 N
    friction_speed: 1 mm/s
    bristle_stiffness: 1e6 N/m
    bristle_damping: 2000 Ns/m
)";

// the joint listed last closes the loop: all have friction
std::string crank_scene(const std::string& joints) {
  return R"(
bodies:
  Crank: {orientation: [60 deg, 0, 0], mass: 1 kg, center_of_mass: [0.05 m, 0, 0], inertia: [0.001, 0.01, 0.01]}
  Rod: {position: [0.05 m, 0.08660254037844387 m, 0], orientation: [-16.778654881 deg, 0, 0], mass: 1 kg, center_of_mass: [0.15 m, 0, 0],
        inertia: [0.001, 0.01, 0.01]}
  Slider: {position: [0.337228132327 m, 0, 0], mass: 2 kg, inertia: [0.01, 0.01, 0.01]}
joints:
)" + joints;
}
constexpr const char* kMain =
    "  Main: {type: revolute, body2: Crank, viscous_friction: 0.02 Nms/rad, initial_velocity: 4 rad/s}\n";
constexpr const char* kPin =
    "  Pin: {type: revolute, body1: Crank, point1: [0.1 m, 0, 0], body2: Rod, viscous_friction: 0.02 Nms/rad}\n";
constexpr const char* kWrist =
    "  Wrist: {type: revolute, body1: Rod, point1: [0.3 m, 0, 0], body2: Slider, viscous_friction: 0.02 Nms/rad}\n";
constexpr const char* kSlot =
    "  Slot: {type: prismatic, body2: Slider, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0], "
    "viscous_friction: 5 Ns/m, limit_max: 0.38 m, limit_stiffness: 1e5 N/m, limit_damping: 100 Ns/m}\n";

class JointAxes : public ::testing::TestWithParam<const char*> {
 protected:
  static MechanicsAlone load(const std::string& text) {
    return MechanicsAlone(scene::load_text(text, "axes", {std::string("mechanics.formulation=") + GetParam()}));
  }
};

TEST_P(JointAxes, OfAUniversalJointBrakeAndStopEachOnItsOwn) {
  MechanicsAlone m = load(kBall);
  m.run_to(0.4);
  EXPECT_NEAR(m.value("Cross.velocity_1"), 3 * std::exp(-0.4 / 0.5 * 0.4), 1e-6);
  EXPECT_NEAR(m.value("Cross.torque_1"), -0.4 * m.value("Cross.velocity_1"), 1e-9);
  EXPECT_NEAR(m.value("Cross.position_2"), 0.8, 1e-6);
  EXPECT_EQ(m.value("Cross.torque_2"), 0);
  // the stop turns the second axis round after half a period of its spring
  const double stopped = M_PI * std::sqrt(0.5 / 2000);
  m.run_to(0.5 + 0.5 * stopped);
  EXPECT_LT(m.value("Cross.torque_2"), -50);
  m.run_to(0.9);
  EXPECT_NEAR(m.value("Cross.velocity_2"), -2, 0.02);
  EXPECT_NEAR(m.value("Cross.position_2"), 1 - 2 * (0.9 - 0.5 - stopped), 0.01);
  EXPECT_NEAR(m.value("Cross.velocity_1"), 3 * std::exp(-0.4 / 0.5 * 0.9), 1e-6);
}

TEST_P(JointAxes, OfACylindricalJointHoldAndBrake) {
  MechanicsAlone m = load(kNut);
  m.run_to(1);
  const double held = m.value("Pin.position");
  EXPECT_NEAR(held, 0, 1e-4);
  // 0.05 N m on 0.1 kg m2
  EXPECT_NEAR(m.value("Pin.velocity_angle"), 5 - 0.5, 1e-6);
  EXPECT_NEAR(m.value("Pin.force"), 2 * 9.81, 1e-3);
  EXPECT_NEAR(m.value("Pin.torque"), -0.05, 1e-9);
  m.run_to(11);
  EXPECT_NEAR(m.value("Pin.position"), held, 1e-9) << "bristles hold the weight of 19.6 N below 30 N";
  EXPECT_NEAR(m.value("Pin.velocity_angle"), 0, 1e-3);
  EXPECT_NEAR(m.value("Pin.position_angle"), 25, 1e-2) << "w^2 I / 2 F";
}

TEST_P(JointAxes, BrakeALoopAlikeWhicheverJointClosesIt) {
  MechanicsAlone closed_by_slot = load(crank_scene(std::string(kMain) + kPin + kWrist + kSlot));
  MechanicsAlone closed_by_main = load(crank_scene(std::string(kSlot) + kWrist + kPin + kMain));
  ASSERT_EQ(closed_by_slot.subsystem.model().joints[3].cut, 0);
  ASSERT_EQ(closed_by_main.subsystem.model().joints[3].cut, 0);
  EXPECT_NEAR(closed_by_slot.value("Main.velocity"), 4, 1e-9);
  EXPECT_NEAR(closed_by_main.value("Main.velocity"), 4, 1e-9) << "the joint that closes the loop keeps its start speed";
  for (const double time : {0.05, 0.1, 0.2, 0.4, 0.8}) {
    closed_by_slot.run_to(time);
    closed_by_main.run_to(time);
    EXPECT_NEAR(closed_by_slot.value("Slot.position"), closed_by_main.value("Slot.position"), 1e-5) << time;
    EXPECT_NEAR(closed_by_slot.value("Slot.velocity"), closed_by_main.value("Slot.velocity"), 1e-3) << time;
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, JointAxes, ::testing::Values("recursive", "lagrange", "augmented", "penalty"),
                         [](const auto& test) { return std::string(test.param); });

TEST(JointAxisParameters, OfBothCoordinatesChangeWhileRunning) {
  MechanicsAlone m(scene::load_text(kBall, "axes"));
  m.run_to(0.1);
  ASSERT_TRUE(m.subsystem.change_parameter(m.n, {"Cross.viscous_friction_1", 0, milliseconds(0)}));
  m.run_to(0.101);
  const double speed = m.value("Cross.velocity_1");
  m.run_to(0.3);
  EXPECT_NEAR(m.value("Cross.velocity_1"), speed, 1e-9);
  EXPECT_TRUE(m.subsystem.change_parameter(m.n, {"Cross.limit_damping_2", 10, milliseconds(0)}));
  EXPECT_FALSE(m.subsystem.change_parameter(m.n, {"Cross.limit_damping", 10, milliseconds(0)}));
}

}  // namespace joint_axes_test
}  // namespace slew::testing
