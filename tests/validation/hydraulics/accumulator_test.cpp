// SPDX-License-Identifier: Apache-2.0
// Accumulator against closed forms of the gas: discharge, energy, oscillation, heat exchange.
#include "hydraulics/components/accumulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace accumulator_test {

double variable(Circuit& circuit, const CircuitIntegrator& integrator, const std::string& name) {
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

constexpr double kV0 = 2e-3, kP0 = 100e5;  // m3, Pa

AccumulatorDef& add_accumulator(HydraulicsDef& def, const std::string& volume, double K) {
  AccumulatorDef& accumulator = add<AccumulatorDef>(def, "Accumulator");
  accumulator.port_1 = volume, accumulator.gas_volume = kV0, accumulator.precharge_pressure = kP0;
  accumulator.nominal_flow = K * std::sqrt(5e5);
  return accumulator;
}

TEST(ValidationAccumulator, starts_at_rest_at_the_pressure_of_its_volume) {
  for (const double tau : {0.0, 10.0}) {
    for (const double p : {50e5, 100e5, 250e5}) {
      HydraulicsDef def;
      add_volume(def, "Vessel", p).rigid_volume = 1e-3;
      add_accumulator(def, "Vessel", 1e-6).thermal_time_constant = tau;
      Circuit circuit(def);
      CircuitIntegrator integrator(circuit, def);
      integrator.start({}, {}, {});
      const double n = tau > 0 ? 1 : 1.4;
      const double oil = p > kP0 ? kV0 * (1 - std::pow(kP0 / p, 1 / n)) : 0;
      EXPECT_NEAR(variable(circuit, integrator, "Accumulator.oil_volume"), oil, 1e-12) << p;
      EXPECT_NEAR(variable(circuit, integrator, "Accumulator.gas_pressure"), std::max(p, kP0), 1e-6 * p) << p;
      for (int k = 0; k < 100; ++k) integrator.step(1e-2, HeldSpeed(0));
      EXPECT_NEAR(integrator.state()[0], p, 1e-9 * p);
      EXPECT_NEAR(variable(circuit, integrator, "Accumulator.oil_volume"), oil, 1e-9 * kV0) << p;
    }
  }
}

// nu = p_0/p = 1/120, far below any data sheet's: 2 l hold 1.983 l of oil at most, whatever the pressure
TEST(ValidationAccumulator, never_holds_more_oil_than_its_volume) {
  HydraulicsDef def;
  add_tank(def, "Line", 600e5);
  AccumulatorDef& accumulator = add_accumulator(def, "Line", 1e-6);
  accumulator.precharge_pressure = 5e5, accumulator.polytropic_exponent = 1;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(integrator.step(1e-2, HeldSpeed(0)).has(StepFlag::clamp_active));
  EXPECT_NEAR(variable(circuit, integrator, "Accumulator.oil_volume"), kV0 * (1 - 5.0 / 600), 1e-9 * kV0);
  // beyond its law: the step reports it
  integrator.mutable_state()[static_cast<std::size_t>(circuit.first_component_state())] = 1 - 5e-4;
  EXPECT_NE(circuit.flags(integrator.state().data()) & static_cast<std::uint32_t>(StepFlag::clamp_active), 0u);
}

// Discharge into p ~ 0 through its connection: V_g' = K sqrt(p_g), p_g = p_0 (V_0/V_g)^n,
//   V_g^(1 + n/2) = V_g0^(1 + n/2) + (1 + n/2) K sqrt(p_0) V_0^(n/2) t                                            (1)
// Tolerance 1e-4 of the gas volume: the 1e-4 of p_0 of the outlet, and the solver's.
TEST(ValidationAccumulator, discharges_as_the_closed_form_and_stays_empty) {
  for (const double n : {1.0, 1.4}) {
    constexpr double K = 5e-7, p_s = 300e5;
    HydraulicsDef def;
    def.pressure_floor = 100, def.orifice_transition = 1, def.relative_tolerance = 1e-6;
    add_tank(def, "Outlet", p_s);
    add_accumulator(def, "Outlet", K).polytropic_exponent = n;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    integrator.start({}, {}, {});
    integrator.mutable_state()[0] = 1e3;
    const double m = 1 + n / 2, rate = m * K * std::sqrt(kP0) * std::pow(kV0, n / 2);
    const double V_g0 = kV0 * std::pow(kP0 / p_s, 1 / n);
    const double empty = (std::pow(kV0, m) - std::pow(V_g0, m)) / rate;
    for (int k = 1; k <= 97; ++k) {
      ASSERT_FALSE(integrator.step(empty / 100, HeldSpeed(0)).has_failed());
      const double V_g = std::pow(std::pow(V_g0, m) + rate * k * empty / 100, 1 / m);
      EXPECT_NEAR(kV0 - variable(circuit, integrator, "Accumulator.oil_volume"), V_g, 1e-4 * kV0) << n << " " << k;
    }
    for (int k = 0; k < 1000; ++k) integrator.step(empty / 100, HeldSpeed(0));
    EXPECT_NEAR(variable(circuit, integrator, "Accumulator.oil_volume"), 0, 1e-6 * kV0);
    EXPECT_NEAR(variable(circuit, integrator, "Accumulator.flow"), 0, 1e-9);
  }
}

// A cylinder on an accumulator: omega = sqrt(n p A^2/(V_g m)) with p and V_g at rest, if the connection is wide and the
// oil column (16 times as stiff) is in series: 1/k = 1/k_gas + 1/k_oil. Tolerance 0.5 %, for small swings.
TEST(ValidationAccumulator, a_load_swings_on_the_gas_at_the_frequency_of_its_stiffness) {
  constexpr double D = 0.1, mass = 3000, n = 1.4, p = 150e5, V_oil = 3e-3, B = 1.5e9;
  const double A = std::numbers::pi / 4 * D * D;
  HydraulicsDef def;
  def.oil_bulk_modulus = B, def.entrained_air = 0, def.relative_tolerance = 1e-6;
  add_volume(def, "A").rigid_volume = V_oil - 0.5 * A;
  add_tank(def, "Tank", 1e5);
  add_accumulator(def, "A", 1e-3).polytropic_exponent = n;
  DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
  cylinder.rod_diameter = 0.05, cylinder.rod_length = 1, cylinder.common.force = "Force";
  cylinder.common.port_a = "A", cylinder.common.port_b = "Tank", cylinder.common.bulk_modulus = 1e18;
  cylinder.common.piston_diameter = D, cylinder.common.chamber_length = 1;
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.95;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double F = p * A - 1e5 * circuit.actuators()[0].area_b;
  const double x[] = {0.5}, v[] = {0}, force[] = {F};
  integrator.start(x, v, force);
  MassLoad load({{mass, F + 300, 0}});
  double first = 0, last = 0, before = 0;
  int crossings = 0;
  constexpr double kStep = 1e-3;
  for (int k = 1; k <= 10000; ++k) {
    integrator.step(kStep, load);
    const double now = integrator.actuators()[0].v;
    if (before < 0 && now >= 0) {
      const double t = (k - 1 + before / (before - now)) * kStep;
      if (crossings++ == 0) first = t;
      last = t;
    }
    before = now;
  }
  ASSERT_GT(crossings, 5);
  const double V_g = kV0 * std::pow(kP0 / p, 1 / n);
  const double stiffness = A * A / (V_g / (n * p) + V_oil / B);
  const double omega = std::sqrt(stiffness / mass);
  EXPECT_NEAR(2 * std::numbers::pi * (crossings - 1) / (last - first), omega, 5e-3 * omega);
}

// After a fast charge the gas is hot by nu^(1 - n) and cools at constant volume: p_g falls from the adiabatic to the
// isothermal pressure with the time constant tau.
TEST(ValidationAccumulator, the_gas_of_a_fast_charge_cools_with_its_time_constant) {
  constexpr double tau = 8, p_s = 200e5;
  HydraulicsDef def;
  def.relative_tolerance = 1e-6;
  add_tank(def, "Source", kP0);
  add_accumulator(def, "Source", 1e-5).thermal_time_constant = tau;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  // charged within some milliseconds, then closed
  integrator.mutable_state()[0] = p_s;
  integrator.step(0.05, HeldSpeed(0));
  const double nu = 1 - variable(circuit, integrator, "Accumulator.oil_volume") / kV0;
  EXPECT_NEAR(nu, std::pow(kP0 / p_s, 1 / 1.4), 5e-3);
  EXPECT_NEAR(variable(circuit, integrator, "Accumulator.temperature_ratio"), std::pow(nu, -0.4), 1e-2);
  const int nominal = circuit.find_parameter("Accumulator.nominal_flow");
  ASSERT_EQ(circuit.set_parameter(nominal, 1e-12), ParameterResult::ok);
  const double hot = variable(circuit, integrator, "Accumulator.gas_pressure"), cold = kP0 / nu;
  for (int k = 1; k <= 30; ++k) {
    integrator.step(1, HeldSpeed(0));
    const double expected = cold + (hot - cold) * std::exp(-k / tau);
    EXPECT_NEAR(variable(circuit, integrator, "Accumulator.gas_pressure"), expected, 1e-3 * (hot - cold)) << k;
  }
}

// The work on the oil that enters is the energy in the gas, p_0 V_0 (nu^(1 - n) - 1)/(n - 1), less none: the
// connection's loss is outside of p_g. The integral of p_g Q by the trapezoidal rule; tolerance 1e-3.
TEST(ValidationAccumulator, the_gas_keeps_the_work_done_on_it) {
  HydraulicsDef def;
  def.relative_tolerance = 1e-7;
  add_tank(def, "Source", kP0);
  add_accumulator(def, "Source", 1e-7);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  integrator.mutable_state()[0] = 250e5;
  double work = 0;
  const auto power = [&] {
    return variable(circuit, integrator, "Accumulator.gas_pressure") *
           variable(circuit, integrator, "Accumulator.flow");
  };
  for (int k = 0; k < 2000; ++k) {
    const double before = power();
    integrator.step(1e-3, HeldSpeed(0));
    work += 0.5e-3 * (before + power());
  }
  const double nu = 1 - variable(circuit, integrator, "Accumulator.oil_volume") / kV0;
  ASSERT_LT(nu, 0.8);
  const double energy = kP0 * kV0 * (std::pow(nu, -0.4) - 1) / 0.4;
  EXPECT_NEAR(work, energy, 1e-3 * energy);
}

TEST(ValidationAccumulator, a_piston_moves_only_beyond_the_friction_of_its_seals) {
  HydraulicsDef def;
  add_tank(def, "Source", 150e5);
  add_accumulator(def, "Source", 1e-6).friction_pressure = 2e5;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const double oil = variable(circuit, integrator, "Accumulator.oil_volume");
  const auto after = [&](double p) {
    integrator.mutable_state()[0] = p;
    for (int k = 0; k < 2000; ++k) integrator.step(1e-2, HeldSpeed(0));
    return variable(circuit, integrator, "Accumulator.gas_pressure");
  };
  after(151.9e5);
  EXPECT_EQ(variable(circuit, integrator, "Accumulator.oil_volume"), oil);
  after(148.1e5);
  EXPECT_EQ(variable(circuit, integrator, "Accumulator.oil_volume"), oil);
  // comes to rest 2 bar short of the source from either side
  EXPECT_NEAR(after(160e5), 158e5, 0.02e5);
  EXPECT_NEAR(after(140e5), 142e5, 0.02e5);
}

}  // namespace accumulator_test
}  // namespace slew::hydraulics::test
