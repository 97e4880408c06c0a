// SPDX-License-Identifier: Apache-2.0
// Check valves in circuits with closed forms, in oil of constant bulk modulus.
#include "hydraulics/components/check_valves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace check_valves_test {

constexpr double kV = 1e-3, kB = 1.5e9;  // m3, Pa

HydraulicsDef plain_oil() {
  HydraulicsDef def;
  def.oil_bulk_modulus = kB, def.oil_density = 850, def.entrained_air = 0;
  return def;
}

// Charging through a check valve is the orifice's p(t) = p_s - (sqrt(p_s - p_0) - K B t/(2 V))^2 while the valve is
// fully open; it ends at p_s - crack_pressure. Tolerance 1e-4 of p_s; at the end, after 0.25 s in all, 1 % of the rise.
TEST(ValidationCheckValve, charges_a_volume_as_the_closed_form_and_holds_it) {
  constexpr double p_s = 100e5, p_0 = 1e5, K = 5e-8, crack = 2e5, rise = 1e5;
  HydraulicsDef def = plain_oil();
  add_tank(def, "Supply", p_s);
  add_volume(def, "Vessel", p_0).rigid_volume = kV;
  CheckValveDef& valve = add<CheckValveDef>(def, "Valve");
  valve.port_1 = "Supply", valve.port_2 = "Vessel";
  valve.common = {K * std::sqrt(4e5), 4e5, crack, rise};
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const HeldSpeed still(0);
  double t = 0;
  for (; integrator.state()[1] < p_s - crack - rise; t += 1e-4) {
    const double root = std::sqrt(p_s - p_0) - K * kB * t / (2 * kV);
    ASSERT_NEAR(integrator.state()[1], p_s - root * root, 1e-4 * p_s) << t;
    ASSERT_FALSE(integrator.step(1e-4, still).has_failed());
  }
  EXPECT_GT(t, 0.03);
  for (int k = 0; k < 2500; ++k) integrator.step(1e-4, still);
  const double charged = integrator.state()[1];
  EXPECT_NEAR(charged, p_s - crack, 1e-2 * rise);
  // a supply that falls to 1 bar takes nothing back
  integrator.mutable_state()[0] = 1e5;
  for (int k = 0; k < 1000; ++k) integrator.step(1e-3, still);
  EXPECT_EQ(integrator.state()[1], charged);
}

// Through the throttle it empties as (sqrt(p_0 - p_t) - K_t B t/(2 V))^2 above the outlet.
TEST(ValidationCheckValve, a_throttle_check_valve_empties_as_its_throttle_alone) {
  constexpr double p_0 = 100e5, p_t = 1e5, K_t = 1e-8;
  HydraulicsDef def = plain_oil();
  add_tank(def, "Outlet", p_t);
  add_volume(def, "Vessel", p_0).rigid_volume = kV;
  ThrottleCheckValveDef& valve = add<ThrottleCheckValveDef>(def, "Valve");
  valve.port_1 = "Outlet", valve.port_2 = "Vessel";
  valve.common.nominal_flow = 1e-3, valve.common.nominal_pressure_drop = 5e5;
  valve.throttle_flow = 2 * K_t * std::sqrt(5e5), valve.throttle_opening = 0.5;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const HeldSpeed still(0);
  const double full = 2 * kV * std::sqrt(p_0 - p_t) / (K_t * kB);
  for (int k = 1; k <= 90; ++k) {
    ASSERT_FALSE(integrator.step(full / 100, still).has_failed());
    const double root = std::sqrt(p_0 - p_t) * (1 - k / 100.0);
    EXPECT_NEAR(integrator.state()[1], p_t + root * root, 1e-4 * p_0) << k;
  }
}

// A cylinder with 50 kN on it behind a double pilot check valve: with both valve-side lines at tank it holds; with line
// B at pressure it comes down when p_b exceeds the balance of forces at the poppet,
//   r (p_b - p_t) = p_A - p_t + crack,  p_A A_A = F + p_B A_B,  p_B = p_b - crack                                (1)
TEST(ValidationCheckValve, a_locked_cylinder_holds_until_the_pilot_pressure_of_the_balance) {
  constexpr double D = 0.1, d = 0.06, F = 50e3, r = 3, crack = 0.2e5, p_t = 1e5;
  const double A_A = std::numbers::pi / 4 * D * D, A_B = std::numbers::pi / 4 * (D * D - d * d);
  // (1) solved for p_b
  const double balance = ((F - crack * A_B) / A_A + r * p_t - p_t + crack) / (r - A_B / A_A);
  const auto lowered = [&](double p_b) {
    HydraulicsDef def = plain_oil();
    add_tank(def, "Line_A", p_t), add_tank(def, "Line_B", p_b);
    add_volume(def, "A"), add_volume(def, "B");
    DoublePilotCheckValveDef& lock = add<DoublePilotCheckValveDef>(def, "Lock");
    lock.port_a1 = "Line_A", lock.port_a2 = "A", lock.port_b1 = "Line_B", lock.port_b2 = "B";
    lock.pilot_ratio = r, lock.common.nominal_flow = 1e-4, lock.common.crack_pressure = crack;
    DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
    cylinder.rod_diameter = d, cylinder.rod_length = 1, cylinder.common.force = "Force";
    cylinder.common.port_a = "A", cylinder.common.port_b = "B";
    cylinder.common.piston_diameter = D, cylinder.common.chamber_length = 1;
    cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.95;
    // line B has charged its side already
    def.start_return_pressure = std::max(p_t, p_b - crack);
    Problems errors, warnings;
    validate(def, errors, warnings);
    EXPECT_TRUE(errors.empty());
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const double x[] = {0.5}, v[] = {0}, load[] = {F};
    integrator.start(x, v, load);
    MassLoad mass({{2000, F, 2e5}});
    for (int k = 0; k < 2000; ++k) EXPECT_FALSE(integrator.step(1e-3, mass).has_failed());
    return 0.5 - integrator.actuators()[0].x;
  };
  // the oil columns give way by less than 1 mm
  EXPECT_LT(lowered(p_t), 1e-3);
  EXPECT_LT(lowered(balance - 0.5e5), 1e-3);
  EXPECT_GT(lowered(balance + 1e5), 0.01);
}

}  // namespace check_valves_test
}  // namespace slew::hydraulics::test
