// SPDX-License-Identifier: Apache-2.0
// Motor of variable displacement: its servo, torque, flow and oil spring at a setting, by hand.
#include "tests/validation/hydraulics/motor_rig.h"

namespace slew::hydraulics::test {
namespace variable_motor_test {

constexpr double kBulkModulus = 1.5e9, kOil = 1e-3;  // Pa, m3 on either side

MotorRig closed_rig(double setting) {
  MotorRig rig;
  rig.def.oil_bulk_modulus = kBulkModulus, rig.def.entrained_air = 0, rig.def.relative_tolerance = 1e-7;
  rig.def.start_slew_pressure = 100e5;
  add_volume(rig.def, "A").rigid_volume = kOil - 1e-4;
  add_volume(rig.def, "B").rigid_volume = kOil - 1e-4;
  HydraulicMotorDef& motor = rig.add_motor();
  motor.is_variable = true, motor.setting = setting, motor.setting_per_signal = -0.1, motor.time_constant = 0.05;
  return rig;
}

TEST(ValidationVariableMotor, follows_its_signal_with_a_lag_between_its_limits) {
  MotorRig rig = closed_rig(1);
  rig.start(0, 0);
  const MassLoad load({{4, 0, 0}});
  rig.set_signal(4);
  rig.run(0.05, load);
  EXPECT_NEAR(rig.variable("Motor.setting"), 0.6 + 0.4 * std::exp(-1), 1e-5);
  rig.set_signal(100);
  rig.run(1, load);
  EXPECT_NEAR(rig.variable("Motor.setting"), 0.2, 1e-5);
  rig.set("Motor.minimum_setting", 0.35);
  rig.set_signal(-100);
  rig.run(1, load);
  EXPECT_NEAR(rig.variable("Motor.setting"), 1, 1e-5);
}

TEST(ValidationVariableMotor, its_setting_changes_no_faster_than_its_limit) {
  MotorRig rig = closed_rig(1);
  dynamic_cast<HydraulicMotorDef&>(*rig.def.components.front()).setting_rate_limit = 2;
  rig.start(0, 0);
  rig.set_signal(8);
  rig.run(0.2, MassLoad({{4, 0, 0}}));
  EXPECT_NEAR(rig.variable("Motor.setting"), 0.6, 1e-4);
}

// At a setting of 0.6, 150 rad/s and 180 bar: 0.6 x 90 l/min, 0.6 x 180 Nm.
TEST(ValidationVariableMotor, torque_and_flow_follow_the_setting) {
  MotorRig rig;
  add_tank(rig.def, "A", 200e5), add_tank(rig.def, "B", 20e5);
  HydraulicMotorDef& motor = rig.add_motor();
  motor.is_variable = true, motor.setting = 0.6;
  rig.start(150, 0);
  EXPECT_NEAR(rig.variable("Motor.pressure_torque"), 108, 1e-9);
  EXPECT_NEAR(rig.shaft().F, 108, 1e-9);
  EXPECT_NEAR(rig.variable("Motor.flow_a"), 54 * kLitrePerMinute, 1e-12);
}

// The start holds 60 Nm by 60/(0.5 D) = 120 bar around the mean of 100 bar.
TEST(ValidationVariableMotor, an_equilibrium_start_counts_the_setting) {
  MotorRig rig = closed_rig(0.5);
  rig.start(0, 60);
  EXPECT_NEAR(rig.variable("A.pressure") - rig.variable("B.pressure"), 120e5, 1);
  EXPECT_NEAR(rig.shaft().F, 60, 1e-6);
  rig.run(1, MassLoad({{4, 60, 0}}));
  EXPECT_NEAR(rig.shaft().x, 0, 1e-6);
}

// omega^2 = (e D)^2 (2 B/V)/J; no loss of the swing.
TEST(ValidationVariableMotor, an_inertia_swings_on_the_oil_of_its_setting) {
  MotorRig rig = closed_rig(0.5);
  rig.start(1, 0);
  const double K = std::pow(0.5 * 10e-6, 2) * 2 * kBulkModulus / kOil, omega = std::sqrt(K / 20);
  EXPECT_NEAR(rig.shaft().K, K, 1e-6 * K);
  const MassLoad load({{20, 0, 0}});
  const double H = 2 * std::numbers::pi / omega / 100;
  for (int k = 1; k <= 1000; ++k) {
    rig.run(H, load, H);
    ASSERT_NEAR(rig.shaft().v, std::cos(omega * k * H), 1e-3) << k;
  }
}

// While the setting falls the work of the oil is that of its pressures, and a smaller one makes the shaft faster: the
// kinetic energy and the energy of both oil columns, V/(2 B) p^2, keep their sum.
TEST(ValidationVariableMotor, a_change_of_its_setting_keeps_the_energy) {
  MotorRig rig = closed_rig(1);
  rig.start(0, 0);
  const MassLoad load({{0.5, 0, 0}});
  rig.align(0.5, 0);
  const auto energy = [&] {
    const double a = rig.variable("A.pressure") - 100e5, b = rig.variable("B.pressure") - 100e5, v = rig.shaft().v;
    return 0.25 * v * v + kOil / (2 * kBulkModulus) * (a * a + b * b);
  };
  const double before = energy();
  rig.set_signal(5);
  rig.run(0.2, load, 1e-4);
  ASSERT_LT(rig.variable("Motor.setting"), 0.51);
  EXPECT_NEAR(energy(), before, 1e-3 * before);
}

TEST(ValidationVariableMotor, an_exchange_moves_the_oil_of_its_setting) {
  MotorRig rig = closed_rig(0.5);
  rig.start(0, 0);
  rig.align(0.05, 0);
  const double rise = kBulkModulus / kOil * 0.5 * 10e-6 * 0.05;
  EXPECT_NEAR(rig.variable("A.pressure"), 100e5 - rise, 1e-6 * rise);
  EXPECT_NEAR(rig.variable("B.pressure"), 100e5 + rise, 1e-6 * rise);
}

}  // namespace variable_motor_test
}  // namespace slew::hydraulics::test
