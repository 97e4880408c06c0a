// SPDX-License-Identifier: Apache-2.0
// Holding brake of a motor: rest without creep, sliding by closed forms, release by pressure. Torques in Nm at the
// shaft.
#include "tests/validation/hydraulics/motor_rig.h"

namespace slew::hydraulics::test {
namespace motor_brake_test {

constexpr double kTorque = 300, kTwist = 0.0175, kSlip = 2e-4;  // Nm, rad, s/rad of shaft_brake.h

// Ports at `pressure`, the brake's port at `release`.
MotorRig rig_on_tanks(double pressure, double release) {
  MotorRig rig;
  add_tank(rig.def, "A", pressure), add_tank(rig.def, "B", pressure), add_tank(rig.def, "Pilot", release);
  HydraulicMotorDef& motor = rig.add_motor();
  motor.brake_port = "Pilot", motor.brake.torque = kTorque, motor.brake.twist = kTwist;
  return rig;
}

// The oil leaks from port to port; a motor without a brake would sink by 3 rad/s.
TEST(ValidationMotorBrake, a_load_below_the_torque_stays_where_it_is) {
  MotorRig rig;
  add_volume(rig.def, "A").rigid_volume = 1e-3;
  add_volume(rig.def, "B").rigid_volume = 1e-3;
  add_tank(rig.def, "Pilot", 1e5);
  HydraulicMotorDef& motor = rig.add_motor();
  motor.leak_flow = 1e-5, motor.brake_port = "Pilot", motor.brake.torque = kTorque;
  rig.start(0, 200);
  EXPECT_NEAR(rig.variable("Motor.brake_torque"), 200, 1e-9);
  rig.run(10, MassLoad({{4, 200, 0}}));
  EXPECT_NEAR(rig.shaft().x, 0, 1e-9);
  EXPECT_NEAR(rig.variable("Motor.brake_torque"), 200, 1e-3);
}

// After 20 swings of the load between 290 and -290 Nm the shaft is back: no ratchet, no drift of bristles.
TEST(ValidationMotorBrake, a_swinging_load_does_not_make_it_creep) {
  MotorRig rig = rig_on_tanks(20e5, 1e5);
  rig.start(0, 0);
  MassLoad load({{0.04, 0, 20}});  // far above the swing's frequency
  for (int k = 1; k <= 2000; ++k) {
    load.loads()[0].force = 290 * std::sin(2 * std::numbers::pi * k / 100);
    rig.run(1e-3, load);
  }
  load.loads()[0].force = 150;
  rig.run(1, load);
  EXPECT_NEAR(rig.shaft().x, -kTwist * 150 / kTorque, 1e-6);
}

// J v' = load - T (1 + kSlip v): v = v_e (1 - exp(-T kSlip t/J)), v_e = (load - T)/(T kSlip)
TEST(ValidationMotorBrake, a_load_above_the_torque_slides_as_the_closed_form) {
  MotorRig rig = rig_on_tanks(20e5, 1e5);
  rig.start(0, 400);
  const MassLoad load({{4, 400, 0}});
  const double v_end = 100 / (kTorque * kSlip);
  for (int k = 1; k <= 20; ++k) {
    rig.run(0.1, load);
    const double v = v_end * (1 - std::exp(-kTorque * kSlip * 0.1 * k / 4));
    ASSERT_NEAR(rig.shaft().v, -v, 3e-3 * v) << k;
  }
  EXPECT_LT(rig.shaft().K, 1e-4 * kTorque / kTwist);  // discs that slip are no spring
}

// J v' = -T (1 + kSlip v) until rest; then the discs hold the shaft there, twisted by what is left of its energy.
TEST(ValidationMotorBrake, it_stops_a_turning_shaft_and_holds_it) {
  MotorRig rig = rig_on_tanks(20e5, 1e5);
  constexpr double v_0 = 100, J = 4, c = kTorque * kSlip;
  rig.start(v_0, 0);
  const MassLoad load({{J, 0, 0}});
  rig.run(1, load);
  EXPECT_NEAR(rig.shaft().v, (v_0 + 1 / kSlip) * std::exp(-c / J) - 1 / kSlip, 0.02);
  rig.run(0.5, load);
  const double x = rig.shaft().x;
  for (int k = 0; k < 50; ++k) {
    rig.run(0.01, load);
    ASSERT_NEAR(rig.shaft().x, x, 2 * kTwist);
    ASSERT_LE(std::fabs(rig.variable("Motor.brake_torque")), kTorque * 1.02);
  }
  EXPECT_NEAR(rig.shaft().K, kTorque / kTwist, 1e-9 * kTorque / kTwist);
}

TEST(ValidationMotorBrake, pressure_releases_it_in_proportion) {
  for (const auto& [bar, share] : {std::pair{1.0, 1.0}, {6.0, 0.75}, {11.0, 0.5}, {21.5, 0.0}}) {
    MotorRig rig = rig_on_tanks(20e5, bar * 1e5);
    rig.start(0, 0);
    EXPECT_NEAR(rig.variable("Motor.brake_capacity"), share * kTorque, 1e-9) << bar;
    rig.set("Motor.brake_share", 0.4);
    EXPECT_NEAR(rig.variable("Motor.brake_capacity"), 0.4 * share * kTorque, 1e-9) << bar;
  }
}

TEST(ValidationMotorBrake, open_discs_do_not_drag) {
  MotorRig rig = rig_on_tanks(20e5, 30e5);
  rig.start(100, 0);
  rig.run(1, MassLoad({{4, 0, 0}}));
  EXPECT_NEAR(rig.shaft().v, 100, 1e-6);
}

// The springs stand in the case: its pressure works against the release.
TEST(ValidationMotorBrake, the_case_drain_counts) {
  MotorRig rig = rig_on_tanks(20e5, 11e5);
  add_tank(rig.def, "Case", 6e5);
  dynamic_cast<HydraulicMotorDef&>(*rig.def.components.front()).port_c = "Case";
  rig.start(0, 0);
  EXPECT_NEAR(rig.variable("Motor.brake_capacity"), 0.75 * kTorque, 1e-9);
}

TEST(ValidationMotorBrake, an_exchange_twists_what_holds) {
  MotorRig rig = rig_on_tanks(20e5, 1e5);
  rig.start(0, 0);
  rig.align(1e-3, 0);
  EXPECT_NEAR(rig.shaft().F, -kTorque * 1e-3 / kTwist, 1e-9);
}

TEST(ValidationMotorBrake, without_torque_or_with_rk4_it_is_refused) {
  MotorRig rig = rig_on_tanks(20e5, 1e5);
  dynamic_cast<HydraulicMotorDef&>(*rig.def.components.front()).brake.torque = 0;
  rig.def.solver = Solver::rk4;
  Problems errors, warnings;
  validate(rig.def, errors, warnings);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].path, "Motor.brake_torque");
  EXPECT_EQ(errors[0].what, "the brake has no torque");
  EXPECT_EQ(errors[1].path, "Motor.brake_port");
  EXPECT_EQ(errors[1].what, "the discs of a brake slip faster than the sub-steps of rk4");
}

}  // namespace motor_brake_test
}  // namespace slew::hydraulics::test
