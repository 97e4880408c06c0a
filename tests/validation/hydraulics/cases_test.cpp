// SPDX-License-Identifier: Apache-2.0
// Cases C01 to C04: closed forms of textbook hydraulics. Source, numbers and tolerances in each card comment.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/bench_circuit.h"

namespace slew::hydraulics::test {
namespace cases_test {

// Oil without air, of constant bulk modulus, so that the closed forms hold.
HydraulicsDef plain_oil(double bulk_modulus, double density) {
  HydraulicsDef def;
  def.oil_bulk_modulus = bulk_modulus;
  def.oil_density = density;
  def.entrained_air = 0;
  return def;
}

void expect_valid(const HydraulicsDef& def) {
  Problems errors, warnings;
  validate(def, errors, warnings);
  for (const Problem& problem : errors) ADD_FAILURE() << problem.path << ": " << problem.what;
}

double variable(Circuit& circuit, const CircuitIntegrator& integrator, const std::string& name) {
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << "no variable " << name;
  return 0;
}

// C01: dp/dt = (B/V) Cd A sqrt(2 (ps - p)/rho), p(t) = ps - (sqrt(ps - p0) - K t/2)^2, full at T = 2 sqrt(ps - p0)/K.
// Tolerance 1e-4 of ps away from T; near T the laminar transition of the orifice (0.1 bar) shows: twice that pressure.
TEST(ValidationC01, orifice_charges_a_volume_as_the_closed_form) {
  constexpr double V = 1e-3, B = 1.5e9, Cd = 0.67, d = 1e-3, rho = 850, ps = 1e7, p0 = 1e5;
  constexpr double K = 38287.89392685961, T = 0.16435620880694005, Q_0 = 8.031336385658114e-05;
  HydraulicsDef def = plain_oil(B, rho);
  add_tank(def, "Supply", ps);
  add_volume(def, "Vessel", p0).rigid_volume = V;
  OrificeDef& orifice = add<OrificeDef>(def, "Orifice");
  orifice.port_1 = "Supply", orifice.port_2 = "Vessel", orifice.diameter = d, orifice.discharge_coefficient = Cd;
  expect_valid(def);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  EXPECT_NEAR(variable(circuit, integrator, "Orifice.flow"), Q_0, 1e-5 * Q_0);

  const HeldSpeed still(0);
  constexpr int kSteps = 400;  // to 2 T
  double last = p0;
  for (int k = 1; k <= kSteps; ++k) {
    const StepReport report = integrator.step(2 * T / kSteps, still);
    EXPECT_EQ(report.flags, 0u);
    const double t = 2 * T * k / kSteps, p = integrator.state()[1];
    const double root = std::max(0.0, std::sqrt(ps - p0) - K * t / 2), exact = ps - root * root;
    const bool is_laminar = ps - exact < 20 * def.orifice_transition;
    EXPECT_NEAR(p, exact, is_laminar ? 2 * def.orifice_transition : 1e-4 * ps) << "t/T " << t / T;
    EXPECT_LE(p, ps);  // no overshoot
    EXPECT_GE(p, last - 1e-3);
    last = p;
    if (k == kSteps / 8) {
      EXPECT_NEAR(p, 4.43125e6, 1e-4 * ps);
    }
    if (k == kSteps / 4) {
      EXPECT_NEAR(p, 7.525e6, 1e-4 * ps);
    }
  }
}

// C02: omega = sqrt(Be (A1^2/V1 + A2^2/V2)/m), closed ports; small step of load, frequency by zero crossings.
// Tolerance 0.1 %.
double oil_column_frequency(double x_0) {
  HydraulicsDef def = plain_oil(1.2e9, 850);
  add_volume(def, "A", 50e5);
  add_volume(def, "B", 50e5);
  DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
  cylinder.rod_diameter = 0.056, cylinder.rod_length = 1;
  CylinderParameters& common = cylinder.common;
  common.force = "Force", common.port_a = "A", common.port_b = "B";
  common.piston_diameter = 0.1, common.piston_length = 0, common.chamber_length = 0.535;
  common.minimum_stroke = 0, common.maximum_stroke = 0.535;
  common.dead_volume = 1.9e-4, common.bulk_modulus = 1e18, common.end_stiffness = 0;
  def.start = StartState::table13;
  def.relative_tolerance = 1e-6;
  expect_valid(def);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double A_1 = circuit.actuators()[0].area_a, A_2 = circuit.actuators()[0].area_b;
  const double x[] = {x_0}, v[] = {0}, F[] = {0};
  integrator.start(x, v, F);
  const double F_0 = 50e5 * (A_1 - A_2);
  MassLoad load({{1500, F_0 + 100, 0}});

  // times at which the speed changes from falling to rising load side, by linear interpolation
  constexpr double H = 1e-4;
  double previous = 0, first = 0, last = 0;
  int crossings = 0;
  for (int k = 1; k <= 10000; ++k) {
    integrator.step(H, load);
    const double now = integrator.actuators()[0].v;
    if (previous < 0 && now >= 0) {
      const double t = (k - 1 + previous / (previous - now)) * H;
      if (crossings++ == 0) first = t;
      last = t;
    }
    previous = now;
  }
  return 2 * std::numbers::pi * (crossings - 1) / (last - first);
}

TEST(ValidationC02, oil_column_rings_at_190_741901_rad_per_second) {
  EXPECT_NEAR(oil_column_frequency(0.25), 190.741901, 1e-3 * 190.741901);
}

TEST(ValidationC02, oil_column_is_softest_at_188_rad_per_second) {
  EXPECT_NEAR(oil_column_frequency(0.300904), 187.988256, 1e-3 * 187.988256);
}

// C03: p Ap = F0 + ks x (+ 2 Cd w x p cos 45 deg with flow force), Q = Cd w x sqrt(2 p/rho), w = pi d sin 45 deg.
// Tolerance 1e-4 of the pressure at a given flow.
double pressure_at_flow(FlowForce flow_force, double Q) {
  HydraulicsDef def = plain_oil(1.5e9, 850);
  add_volume(def, "Inlet", 200e5).rigid_volume = 1e-3;
  add_tank(def, "Outlet", 1e5);
  add_tank(def, "Source", 1000e5);
  DirectReliefValveDef& valve = add<DirectReliefValveDef>(def, "Valve");
  valve.port_1 = "Inlet", valve.port_2 = "Outlet", valve.seat_diameter = 0.01, valve.crack_pressure = 200e5;
  valve.spring_constant = 4e4, valve.discharge_coefficient = 0.62, valve.flow_force = flow_force;
  // a long capillary from a high pressure feeds about the wanted flow; its diameter is adjusted to it below
  LaminarRestrictionDef& feed = add<LaminarRestrictionDef>(def, "Feed");
  feed.port_1 = "Source", feed.port_2 = "Inlet", feed.length = 10;
  double p = 200e5;
  for (int iteration = 0; iteration < 30; ++iteration) {
    const double G = Q / (1000e5 - 1e5 - p);
    feed.diameter = std::pow(G * 128 * 850 * def.oil_viscosity * feed.length / std::numbers::pi, 0.25);
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    integrator.start({}, {}, {});
    const HeldSpeed still(0);
    for (int k = 0; k < 400; ++k) integrator.step(5e-3, still);
    const double reached = integrator.state()[0] - 1e5;
    if (std::fabs(reached - p) < 1) break;
    p = reached;
  }
  return p;
}

TEST(ValidationC03, steady_curve_without_flow_force) {
  const std::pair<double, double> points[] = {
      {1e-4, 2.001704e7}, {5e-4, 2.008505e7}, {1e-3, 2.016974e7}, {1.6667e-3, 2.028212e7}};
  for (const auto& [Q, p] : points) EXPECT_NEAR(pressure_at_flow(FlowForce::neglected, Q), p, 1e-4 * p) << Q;
}

TEST(ValidationC03, steady_curve_with_flow_force) {
  const std::pair<double, double> points[] = {
      {1e-4, 2.018374e7}, {5e-4, 2.093249e7}, {1e-3, 2.190007e7}, {1.6667e-3, 2.324654e7}};
  for (const auto& [Q, p] : points) EXPECT_NEAR(pressure_at_flow(FlowForce::included, Q), p, 1e-4 * p) << Q;
}

TEST(ValidationC03, nothing_flows_below_the_crack_pressure) {
  HydraulicsDef def = plain_oil(1.5e9, 850);
  add_volume(def, "Inlet", 199.9e5).rigid_volume = 1e-3;
  add_tank(def, "Outlet", 1e5);
  DirectReliefValveDef& valve = add<DirectReliefValveDef>(def, "Valve");
  valve.port_1 = "Inlet", valve.port_2 = "Outlet", valve.seat_diameter = 0.01, valve.crack_pressure = 200e5;
  valve.spring_constant = 4e4;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  EXPECT_EQ(variable(circuit, integrator, "Valve.flow"), 0);
}

// C04: Q = Cd A sqrt(2 dp_c/rho), independent of the load; p_pump = highest load + margin less the controller's droop
// alpha/K. dp_c 8 bar, margin 20 bar, A 5e-6 m2: 1.453434067e-4 m3/s. Tolerances 0.5 % of flow, 1 % of pump pressure.
struct TwoFunctions {
  double flow_1, flow_2, pump_pressure, droop;  // pressure above tank
};

TwoFunctions two_functions(double load_1, double load_2) {
  HydraulicsDef def;
  def.oil_density = 850;
  add_volume(def, "Pump_Line", 25e5).rigid_volume = 1e-3;
  add_tank(def, "Tank", 1e5);
  add_tank(def, "Load_1", load_1 + 1e5);
  add_tank(def, "Load_2", load_2 + 1e5);
  for (const char* n : {"1", "2"}) {
    CompensatedOrificeDef& function = add<CompensatedOrificeDef>(def, std::string("Function_") + n);
    function.port_p = "Pump_Line", function.port_a = std::string("Load_") + n, function.port_t = "Tank";
    function.area = 5e-6;
  }
  LsShuttleDef& shuttle = add<LsShuttleDef>(def, "Shuttle");
  shuttle.port_1 = "Function_1", shuttle.port_2 = "Function_2", shuttle.line_time_constant = 0.01;
  LsPumpDef& pump = add<LsPumpDef>(def, "Pump");
  pump.port_a = "Pump_Line", pump.port_b = "Tank", pump.ls_port = "Shuttle";
  pump.speed = 1500 * 2 * std::numbers::pi / 60, pump.displacement = 28e-6 / (2 * std::numbers::pi);
  pump.set_pressure = 20e5, pump.standby_pressure = 20e5, pump.maximum_ls_pressure = 230e5;
  expect_valid(def);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const HeldSpeed still(0);
  for (int k = 0; k < 2000; ++k) EXPECT_FALSE(integrator.step(1e-3, still).has_failed());
  return {variable(circuit, integrator, "Function_1.flow"), variable(circuit, integrator, "Function_2.flow"),
          integrator.state()[0] - 1e5, variable(circuit, integrator, "Pump.swash") / pump.controller_gain};
}

constexpr double kCompensatedFlow = 1.453434067e-4;

TEST(ValidationC04, flow_does_not_depend_on_the_load_and_the_pump_follows_it) {
  for (const double load : {20e5, 60e5, 100e5, 140e5, 180e5}) {
    const TwoFunctions result = two_functions(load, 1e5);
    EXPECT_NEAR(result.flow_1, kCompensatedFlow, 5e-3 * kCompensatedFlow) << load;
    const double expected = load + 20e5 - result.droop;
    EXPECT_NEAR(result.pump_pressure, expected, 1e-2 * expected) << load;
    EXPECT_NEAR(result.droop, 2 * kCompensatedFlow / (28e-6 * 25) / 3.5e-7, 0.01 * result.droop);
  }
}

TEST(ValidationC04, the_lighter_of_two_functions_keeps_its_flow) {
  const TwoFunctions result = two_functions(40e5, 160e5);
  EXPECT_NEAR(result.flow_1, kCompensatedFlow, 5e-3 * kCompensatedFlow);
  EXPECT_NEAR(result.flow_2, kCompensatedFlow, 5e-3 * kCompensatedFlow);
  EXPECT_NEAR(result.pump_pressure, 180e5 - result.droop, 1e-2 * 180e5);
}

TEST(ValidationC04, the_pump_stops_following_at_its_largest_ls_pressure) {
  const TwoFunctions result = two_functions(240e5, 20e5);
  EXPECT_NEAR(result.pump_pressure, 250e5 - result.droop, 1e-2 * 250e5);
}

}  // namespace cases_test
}  // namespace slew::hydraulics::test
