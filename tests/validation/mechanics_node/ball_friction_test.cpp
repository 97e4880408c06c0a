// SPDX-License-Identifier: Apache-2.0
// Friction of a joint that turns about a point: one law for all directions, in every formulation. A ball about its own
// centre has M = I 1: Coulomb friction slows it down along its own direction by F_c/I, wherever that points.
#include <gtest/gtest.h>

#include <cmath>

#include "monolith/mechanics_reference.h"
#include "multibody/results/observe.h"
#include "support/mechanics_alone.h"

namespace slew::testing {
namespace ball_friction_test {

constexpr const char* kBall = R"(
mechanics: {gravity: [0, 0, 0]}
bodies:
  Rod: {mass: 1 kg, inertia: [1, 1, 1]}
  Ball: {mass: 3 kg, inertia: [0.5, 0.5, 0.5]}
joints:
  Clamp: {type: fixed, body2: Rod}
  Socket:
    type: spherical
    body1: Rod
    orientation1: [0.3, -0.7, 1.1]
    body2: Ball
    initial_angular_velocity: [1 rad/s, 2 rad/s, -2 rad/s]
    coulomb_friction: 0.3 Nm
    friction_speed: 1e-4 rad/s
)";

// 5 N m of weight at 30 degrees from the vertical
constexpr const char* kLamp = R"(
bodies:
  Lamp: {orientation: [0, 30 deg, 0], mass: 2 kg, center_of_mass: [0, -0.5 m, 0], inertia: [0.05, 0.02, 0.06]}
joints:
  Neck: {type: spherical, body2: Lamp, coulomb_friction: 6 Nm, breakaway_ratio: 1.2, friction_speed: 0.01 rad/s,
         bristle_stiffness: 5000 Nm/rad, bristle_damping: 50 Nms/rad}
)";

constexpr const char* kSwing = R"(
bodies:
  Lamp: {orientation: [0, 60 deg, 0], mass: 2 kg, center_of_mass: [0.05 m, -0.5 m, 0], inertia: [0.05, 0.02, 0.06]}
joints:
  Neck: {type: spherical, body2: Lamp, initial_angular_velocity: [0 rad/s, 3 rad/s, 1 rad/s], coulomb_friction: 0.8 Nm,
         viscous_friction: 0.05 Nms/rad, friction_speed: 0.05 rad/s}
)";

class BallFriction : public ::testing::TestWithParam<const char*> {
 protected:
  static MechanicsAlone load(const std::string& text, const std::string& more = "") {
    std::vector<std::string> overrides = {std::string("mechanics.formulation=") + GetParam()};
    if (!more.empty()) overrides.push_back(more);
    return MechanicsAlone(scene::load_text(text, "ball", overrides));
  }
};

math::Vec3 vector_of(const MechanicsAlone& m, const std::string& variable) {
  return {m.value(variable + ".x"), m.value(variable + ".y"), m.value(variable + ".z")};
}

TEST_P(BallFriction, SlowsDownAlongItsOwnDirection) {
  MechanicsAlone m = load(kBall);
  m.run_to(1);
  // 3 rad/s less 0.3 N m / 0.5 kg m2 in a second
  const math::Vec3 w = vector_of(m, "Ball.angular_velocity"), expected = math::Vec3(1, 2, -2) * (2.4 / 3);
  EXPECT_LT(norm(w - expected), 2e-5);
  EXPECT_NEAR(norm(vector_of(m, "Socket.torque")), 0.3, 1e-9);
  m.run_to(4.99);
  // the torque is that for the speed of the stage before, a little less
  EXPECT_NEAR(norm(vector_of(m, "Ball.angular_velocity")), 0.006, 5e-4);
  m.run_to(6);
  EXPECT_LT(norm(vector_of(m, "Ball.angular_velocity")), 1e-6);
  EXPECT_LT(norm(vector_of(m, "Socket.torque")), 1e-3);
}

TEST_P(BallFriction, HoldsByBristlesBelowTheirBreakaway) {
  MechanicsAlone m = load(kLamp);
  m.run_to(1);
  const math::Vec3 held = vector_of(m, "Lamp.center_of_mass");
  const double load = 2 * 9.81 * std::hypot(held.x(), held.z());
  EXPECT_NEAR(norm(vector_of(m, "Neck.torque")), load, 1e-6 * load);
  // bent by the load over the bristles' stiffness, from 30 degrees on, and a little slip on the way there
  EXPECT_NEAR(std::hypot(held.x(), held.z()), 0.5 * std::sin(M_PI / 6 - load / 5000), 2e-3);
  m.run_to(21);
  EXPECT_LT(norm(vector_of(m, "Lamp.center_of_mass") - held), 1e-7);
}

TEST_P(BallFriction, LetsGoAboveTheirBreakaway) {
  MechanicsAlone m = load(kLamp, "Neck.coulomb_friction=3");
  m.run_to(3);
  const math::Vec3 end = vector_of(m, "Lamp.center_of_mass");
  EXPECT_LT(2 * 9.81 * std::hypot(end.x(), end.z()), 1.2 * 3);
  EXPECT_LT(norm(vector_of(m, "Lamp.angular_velocity")), 1e-3);
}

// the law enters as forces that are linear over a sub-step, and with the speed of the stage before
TEST_P(BallFriction, SwingsAsTheReferencesDo) {
  const scene::Scene scene = scene::load_text(kSwing, "ball");
  const double times[] = {0.25, 0.5, 1};
  monolith::MechanicsReference reference;
  for (const auto equations :
       {monolith::ReferenceEquations::joint_coordinates, monolith::ReferenceEquations::body_coordinates}) {
    const Status status = monolith::integrate_mechanics(
        scene.mechanics, times, {.equations = equations, .relative_tolerance = 1e-9, .absolute_tolerance = 1e-10},
        reference);
    ASSERT_TRUE(status.is_ok()) << status.text;
    double error = 0;
    MechanicsAlone m = load(kSwing);
    for (std::size_t i = 0; i < 3; ++i) {
      m.run_to(times[i]);
      multibody::Workspace ws(reference.model);
      multibody::observe(reference.model, reference.states[i], ws);
      const multibody::BodyPose pose = multibody::body_pose(reference.model, ws, 1);
      error = std::max(error, norm(vector_of(m, "Lamp.angular_velocity") - math::Vec3(pose.angular_velocity)));
    }
    RecordProperty("error_1e_6", std::to_string(1e6 * error));
    EXPECT_LT(error, 5e-4);
  }
}

// a slider-crank whose rod ends in a ball, which closes the loop or does not
TEST_P(BallFriction, BrakesALoopAlikeWhicheverJointClosesIt) {
  const auto crank = [](const std::string& joints) {
    return R"(
bodies:
  Crank: {orientation: [60 deg, 0, 0], mass: 1 kg, center_of_mass: [0.05 m, 0, 0], inertia: [0.001, 0.01, 0.01]}
  Rod: {position: [0.05 m, 0.08660254037844387 m, 0], orientation: [-16.778654881 deg, 0, 0], mass: 1 kg,
        center_of_mass: [0.15 m, 0, 0], inertia: [0.001, 0.01, 0.01]}
  Slider: {position: [0.337228132327 m, 0, 0], mass: 2 kg, inertia: [0.01, 0.01, 0.01]}
joints:
  Main: {type: revolute, body2: Crank, initial_velocity: 4 rad/s, viscous_friction: 0.02 Nms/rad}
  Pin: {type: revolute, body1: Crank, point1: [0.1 m, 0, 0], body2: Rod, viscous_friction: 0.02 Nms/rad}
)" + joints;
  };
  const std::string wrist =
      "  Wrist: {type: spherical, body1: Rod, point1: [0.3 m, 0, 0], body2: Slider, coulomb_friction: 0.05 Nm, "
      "viscous_friction: 0.02 Nms/rad, friction_speed: 0.01 rad/s}\n";
  const std::string slot =
      "  Slot: {type: prismatic, body2: Slider, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0], "
      "viscous_friction: 5 Ns/m}\n";
  MechanicsAlone closed_by_slot = load(crank(wrist + slot)), closed_by_wrist = load(crank(slot + wrist));
  ASSERT_EQ(closed_by_slot.subsystem.model().joints[3].cut, 0);
  ASSERT_EQ(closed_by_wrist.subsystem.model().joints[3].cut, 0);
  for (const double time : {0.05, 0.1, 0.2, 0.4}) {
    closed_by_slot.run_to(time);
    closed_by_wrist.run_to(time);
    EXPECT_NEAR(closed_by_slot.value("Slot.position"), closed_by_wrist.value("Slot.position"), 1e-5) << time;
    EXPECT_NEAR(closed_by_slot.value("Slot.velocity"), closed_by_wrist.value("Slot.velocity"), 1e-3) << time;
    // the reaction includes the joint's own friction
    for (const char* part : {".x", ".y", ".z"}) {
      EXPECT_NEAR(closed_by_slot.value(std::string("Wrist.reaction_moment") + part),
                  closed_by_wrist.value(std::string("Wrist.reaction_moment") + part), 1e-3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, BallFriction, ::testing::Values("recursive", "lagrange", "augmented", "penalty"),
                         [](const auto& test) { return std::string(test.param); });

TEST(BallFrictionParameters, ChangeWhileRunning) {
  MechanicsAlone m(scene::load_text(kBall, "ball"));
  m.run_to(0.1);
  ASSERT_TRUE(m.subsystem.change_parameter(m.n, {"Socket.coulomb_friction", 0, milliseconds(0)}));
  m.run_to(0.101);
  const double speed = norm(vector_of(m, "Ball.angular_velocity"));
  m.run_to(0.5);
  EXPECT_NEAR(norm(vector_of(m, "Ball.angular_velocity")), speed, 1e-9);
  EXPECT_FALSE(m.subsystem.change_parameter(m.n, {"Socket.limit_stiffness", 1, milliseconds(0)}));
}

TEST(BallFrictionParameters, ThatAreBadAreNamed) {
  const auto text_of = [](const std::string& assignment) {
    try {
      static_cast<void>(scene::load_text(kBall, "ball", {assignment}));
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(text_of("Socket.limit_max=1").find("limit_max"), std::string::npos);
  EXPECT_NE(text_of("Socket.bristle_damping=1").find("without bristles"), std::string::npos);
}

}  // namespace ball_friction_test
}  // namespace slew::testing
