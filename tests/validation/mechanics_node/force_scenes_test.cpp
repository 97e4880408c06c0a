// SPDX-License-Identifier: Apache-2.0
// The scenes of scenes/forces move as their comments predict, in both formulations: figures by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "support/mechanics_alone.h"

namespace slew::testing {
namespace force_scenes_test {

class ForceScene : public ::testing::TestWithParam<const char*> {
 protected:
  static MechanicsAlone load(const std::string& name) {
    return MechanicsAlone("scenes/forces/" + name + ".yaml", {std::string("mechanics.formulation=") + GetParam()});
  }
};

TEST_P(ForceScene, PointForceMovesCartAndDisc) {
  MechanicsAlone m = load("point_force");
  m.run_to(3);
  // a = 2 t up to 1 s, then 2: way 1/3 + 1 * 2 + 4 = 19/3; torque 4 on 0.8 kg m2 over 3 s
  EXPECT_NEAR(m.value("Rail.position"), 19.0 / 3, 1e-9);
  EXPECT_NEAR(m.value("Pin.velocity"), 15, 1e-9);
}

TEST_P(ForceScene, BushingSettlesByWeightOverStiffness) {
  MechanicsAlone m = load("bushing");
  m.run_to(3);
  EXPECT_NEAR(m.value("Mount.deflection.y"), -0.04, 1e-6);
}

TEST_P(ForceScene, BeamBendsByItsFormula) {
  MechanicsAlone m = load("beam");
  m.run_to(2);
  const double EI = 210e9 * 833.3333333e-8, kGA = 0.8333333333 * 210e9 / 2.6 * 1e-2;
  EXPECT_NEAR(m.value("Cantilever.deflection.y"), -981 * (8 / (3 * EI) + 2 / kGA), 2e-8);
}

TEST_P(ForceScene, RopeHaulsItsLoad) {
  MechanicsAlone m = load("rope");
  m.run_to(0.99);
  const double before = m.value("Load.position.y");
  ASSERT_TRUE(m.subsystem.change_parameter(m.n, {"Hoist.free_length", 8.99, milliseconds(2000)}));
  m.run_to(6);
  EXPECT_NEAR(m.value("Hoist.tension"), 300 * 9.81, 1);
  // the stretch shrinks with the rope
  EXPECT_NEAR(m.value("Load.position.y") - before, 0.5 * (1 + 300 * 9.81 / 3e6), 1e-4);
}

TEST_P(ForceScene, TabledSpringCarriesTheSeat) {
  MechanicsAlone m = load("tables");
  m.run_to(10);
  EXPECT_NEAR(m.value("Suspension.force"), 80 * 9.81, 0.1);
  EXPECT_LT(m.value("Suspension.length"), 0.45);
}

TEST_P(ForceScene, TyresCarryAndRoll) {
  MechanicsAlone m = load("tyres");
  m.run_to(0.99);
  const char* wheels[] = {"Wheel_FL", "Wheel_FR", "Wheel_RL", "Wheel_RR"};
  double load = 0, resistance = 0;
  for (const char* wheel : wheels) load += m.value(std::string(wheel) + ".normal_force");
  // chassis, four wheels, ballast, coupling
  EXPECT_NEAR(load, 550 * 9.81, 0.01 * load);
  m.run_to(5);
  for (const char* wheel : wheels) resistance -= std::fabs(m.value(std::string(wheel) + ".longitudinal_force"));
  EXPECT_NEAR(resistance, -0.015 * 550 * 9.81, 1);
  const double speed = m.value("Chassis.velocity.x");
  m.run_to(6);
  EXPECT_NEAR(m.value("Chassis.velocity.x") - speed, (500 + resistance) / 550, 2e-3);
}

// The protractor has no law and no row: a step does not move it. Four sub-steps, whose times are rounded otherwise than
// the step's, with and without a motion by time.
TEST_P(ForceScene, ElementsWithoutForceShowThePresentMotion) {
  for (const char* motion :
       {"", "motions: {Drive: {type: rotation_harmonic, joint: Pin, amplitude: 1 rad, frequency: 1 Hz}}"}) {
    MechanicsAlone m(scene::load_text(std::string(R"(
session: {step: 4 ms}
mechanics: {max_substep: 1 ms}
bodies: {Arm: {mass: 2 kg, center_of_mass: [1, 0, 0], inertia: [0.1, 0.2, 0.2]}}
joints: {Pin: {type: revolute, body2: Arm}}
forces:
  Protractor: {type: rotational, body1: Ground, f1: [1, 0, 0], g1: [0, 1, 0], body2: Arm, f2: [1, 0, 0]}
  Tape: {type: translational, body1: Ground, point1: [0, 3, 0], body2: Arm, point2: [1, 0, 0]}
)") + motion,
                                      "protractor", {std::string("mechanics.formulation=") + GetParam()}));
    for (int step = 0; step < 60; ++step) {
      m.step();
      const double angle = m.value("Pin.position");
      ASSERT_NEAR(m.value("Protractor.angle"), angle, 1e-9) << step << motion;
      ASSERT_NEAR(m.value("Tape.length"), std::hypot(std::cos(angle), 3 - std::sin(angle)), 1e-9) << step << motion;
      ASSERT_NEAR(m.value("Protractor.rate"), m.value("Pin.velocity"), 1e-9) << step << motion;
    }
    EXPECT_GT(std::fabs(m.value("Pin.position")), 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, ForceScene, ::testing::Values("recursive", "lagrange"));

TEST(ForceSceneReset, StartsTheClockAgain) {
  MechanicsAlone m("scenes/forces/point_force.yaml");
  m.run_to(0.5);
  const std::uint64_t first = m.subsystem.state_hash();
  m.run_to(0.8);
  m.subsystem.reset();
  m.start();
  m.run_to(0.5);
  EXPECT_EQ(m.subsystem.state_hash(), first);
}

TEST(OperatedLoad, IsMultipliedByItsInputAndNeutralWithoutOne) {
  for (const char* formulation : {"recursive", "lagrange", "augmented", "penalty"}) {
    MechanicsAlone m("scenes/forces/operated.yaml", {std::string("mechanics.formulation=") + formulation});
    EXPECT_EQ(m.value("Motor.torque"), 0);
    m.run_to(0.5);
    EXPECT_EQ(m.value("Axle.velocity"), 0);
    const std::vector<double> half = {0.5}, none = {0.0};
    const std::uint64_t before = m.subsystem.state_hash();
    while (m.n < 1500) m.report = m.subsystem.step(m.n++, {}, half, m.sample);
    EXPECT_EQ(m.value("Motor.torque"), 10);
    EXPECT_NE(m.subsystem.state_hash(), before);
    m.report = m.subsystem.step(m.n++, {}, none, m.sample);
    EXPECT_NEAR(m.value("Axle.velocity"), 12.5, 1e-9) << formulation;
    EXPECT_EQ(m.value("Motor.torque"), 0);
    m.subsystem.reset();
    m.start();
    EXPECT_EQ(m.value("Motor.torque"), 0);
  }
}

}  // namespace force_scenes_test
}  // namespace slew::testing
