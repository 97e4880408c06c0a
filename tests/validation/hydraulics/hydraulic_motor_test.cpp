// SPDX-License-Identifier: Apache-2.0
// Hydraulic motor against closed forms: run-up through its edges, efficiencies, the swing of an inertia on both oil
// columns, and the balance of its oil. Inertia in the coordinate of the shaft.
#include "hydraulics/components/hydraulic_motor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace hydraulic_motor_test {

constexpr double kDisplacement = 10e-6, kInertia = 0.5;  // m3/rad, kg m2

double variable(Circuit& circuit, const CircuitIntegrator& integrator, const std::string& name) {
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

HydraulicMotorDef& add_motor(HydraulicsDef& def) {
  HydraulicMotorDef& motor = add<HydraulicMotorDef>(def, "Motor");
  motor.force = "Force", motor.port_a = "A", motor.port_b = "B", motor.displacement = kDisplacement;
  return motor;
}

void add_orifice(HydraulicsDef& def, const std::string& name, const std::string& from, const std::string& to) {
  BleedDef& bleed = add<BleedDef>(def, name);
  bleed.port_1 = from, bleed.port_2 = to, bleed.nominal_flow = 1e-3, bleed.nominal_pressure_drop = 100e5;
}

// One orifice on either side, K each, oil that is nearly rigid:
//   J v' = D (p_S - p_T) - 2 D^3/K^2 v^2,   v = sqrt(a/b) tanh(sqrt(a b) t/J)                                    (1)
TEST(ValidationHydraulicMotor, runs_up_through_two_orifices_as_the_closed_form) {
  constexpr double supply = 200e5, tank = 1e5, K = 1e-3 / 3162.27766;
  for (const double direction : {1.0, -1.0}) {
    HydraulicsDef def;
    def.orifice_transition = 10, def.relative_tolerance = 1e-6, def.entrained_air = 0;
    def.start = StartState::table13;
    add_volume(def, "A", direction > 0 ? supply : tank);
    add_volume(def, "B", direction > 0 ? tank : supply);
    add_tank(def, "Supply", supply), add_tank(def, "Tank", tank);
    add_motor(def).dead_volume = 1e-5;
    add_orifice(def, "In", "Supply", direction > 0 ? "A" : "B");
    add_orifice(def, "Out", direction > 0 ? "B" : "A", "Tank");
    Problems errors, warnings;
    validate(def, errors, warnings);
    ASSERT_TRUE(errors.empty()) << errors.front().path << errors.front().what;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const double zero[] = {0};
    integrator.start(zero, zero, zero);
    const MassLoad shaft({{kInertia, 0, 0}});
    const double a = kDisplacement * (supply - tank), b = 2 * std::pow(kDisplacement, 3) / (K * K);
    for (int k = 1; k <= 500; ++k) {
      ASSERT_FALSE(integrator.step(2e-3, shaft).has_failed());
      const double v = std::sqrt(a / b) * std::tanh(std::sqrt(a * b) * k * 2e-3 / kInertia);
      ASSERT_NEAR(direction * integrator.actuators()[0].v, v, 1e-3 * std::sqrt(a / b)) << k;
    }
    // x is the integral of (1), J/b ln cosh
    const double x = kInertia / b * std::log(std::cosh(std::sqrt(a * b) / kInertia));
    EXPECT_NEAR(direction * integrator.actuators()[0].x, x, 1e-3 * x);
  }
}

// At 150 rad/s and 180 bar, by hand in l/min: D v = 90; 2 from port to port and 1 to the case at 100 bar.
TEST(ValidationHydraulicMotor, takes_the_flow_of_its_displacement_and_its_leaks) {
  HydraulicsDef def;
  add_tank(def, "A", 200e5), add_tank(def, "B", 20e5), add_tank(def, "Case", 5e5);
  HydraulicMotorDef& motor = add_motor(def);
  motor.port_c = "Case", motor.leak_flow = 2 * kLitrePerMinute, motor.case_leak_flow = 1 * kLitrePerMinute;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0}, v[] = {150}, F[] = {0};
  integrator.start(x, v, F);
  const auto flow = [&](const char* name) { return variable(circuit, integrator, name) / kLitrePerMinute; };
  EXPECT_NEAR(flow("Motor.flow_a"), 90 + 2 * 1.8 + 1.95, 1e-9);
  EXPECT_NEAR(flow("Motor.flow_b"), -90 - 2 * 1.8 + 0.15, 1e-9);
  EXPECT_NEAR(flow("Motor.case_flow"), 1.95 + 0.15, 1e-9);
  EXPECT_NEAR(variable(circuit, integrator, "Motor.pressure_torque"), 180e5 * 10e-6, 1e-9);
  circuit.set_line_force(0, 170);
  EXPECT_NEAR(variable(circuit, integrator, "Motor.power"), 170 * 150, 1e-9);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("Motor.case_leak_flow"), 0), ParameterResult::ok);
  EXPECT_NEAR(flow("Motor.case_flow"), 0, 1e-12);
}

// Both sides closed, V on each: omega^2 = D^2 (B/V_A + B/V_B)/J. No leak: the swing keeps its size.
TEST(ValidationHydraulicMotor, an_inertia_swings_on_both_oil_columns) {
  constexpr double V_A = 1e-3, V_B = 2e-3, B = 1.5e9, inertia = 20, v_0 = 1;
  HydraulicsDef def;
  def.oil_bulk_modulus = B, def.entrained_air = 0, def.relative_tolerance = 1e-7, def.start_slew_pressure = 100e5;
  add_volume(def, "A").rigid_volume = V_A - 1e-4;
  add_volume(def, "B").rigid_volume = V_B - 1e-4;
  add_motor(def).dead_volume = 1e-4;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {3}, v[] = {v_0}, F[] = {0};
  integrator.start(x, v, F);
  const double omega = kDisplacement * std::sqrt(B / V_A + B / V_B) / std::sqrt(inertia);
  const MassLoad shaft({{inertia, 0, 0}});
  const double H = 2 * std::numbers::pi / omega / 100;
  for (int k = 1; k <= 2000; ++k) {
    integrator.step(H, shaft);
    ASSERT_NEAR(integrator.actuators()[0].v, v_0 * std::cos(omega * k * H), 1e-3 * v_0) << k;
  }
  EXPECT_NEAR(integrator.actuators()[0].K, kDisplacement * kDisplacement * (B / V_A + B / V_B),
              1e-6 * integrator.actuators()[0].K);
}

// With constant compressibility: C_A dp_A + C_B dp_B + int Q_C dt = 0 whatever the shaft does.
TEST(ValidationHydraulicMotor, its_oil_is_in_its_volumes_or_has_gone_to_the_case) {
  constexpr double B = 1.5e9, V_A = 1e-3, V_B = 3e-3;
  HydraulicsDef def;
  def.oil_bulk_modulus = B, def.entrained_air = 0, def.relative_tolerance = 1e-7, def.start_slew_pressure = 150e5;
  add_volume(def, "A").rigid_volume = V_A - 1e-4;
  add_volume(def, "B").rigid_volume = V_B - 1e-4;
  add_tank(def, "Case", 2e5);
  HydraulicMotorDef& motor = add_motor(def);
  motor.port_c = "Case", motor.leak_flow = 1e-5, motor.case_leak_flow = 2e-5;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0}, v[] = {2}, F[] = {0};
  integrator.start(x, v, F);
  const double p_A = integrator.actuators()[0].p_a, p_B = integrator.actuators()[0].p_b;
  const MassLoad shaft({{20, 10, 0.5}});
  double drained = 0;
  for (int k = 0; k < 2000; ++k) {
    const double before = variable(circuit, integrator, "Motor.case_flow");
    integrator.step(1e-4, shaft);
    drained += 0.5e-4 * (before + variable(circuit, integrator, "Motor.case_flow"));
  }
  ASSERT_GT(drained, 1e-6);
  const double lost = V_A / B * (p_A - integrator.actuators()[0].p_a) + V_B / B * (p_B - integrator.actuators()[0].p_b);
  EXPECT_NEAR(lost, drained, 1e-4 * drained);
}

// An exchange that moves the shaft by dx moves D dx of oil from one side to the other.
TEST(ValidationHydraulicMotor, an_exchange_keeps_the_oil_of_both_sides) {
  constexpr double B = 1.5e9, V = 1e-3;
  HydraulicsDef def;
  def.oil_bulk_modulus = B, def.entrained_air = 0, def.start_slew_pressure = 150e5;
  add_volume(def, "A").rigid_volume = V - 1e-4;
  add_volume(def, "B").rigid_volume = V - 1e-4;
  add_motor(def);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {628}, v[] = {0}, F[] = {0}, moved[] = {628.05};
  integrator.start(x, v, F);
  integrator.align(moved, v);
  integrator.refresh();
  const double rise = B / V * kDisplacement * 0.05;
  EXPECT_NEAR(integrator.actuators()[0].p_a, 150e5 - rise, 1e-6 * rise);
  EXPECT_NEAR(integrator.actuators()[0].p_b, 150e5 + rise, 1e-6 * rise);
}

}  // namespace hydraulic_motor_test
}  // namespace slew::hydraulics::test
