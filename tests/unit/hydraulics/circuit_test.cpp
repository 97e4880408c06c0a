// SPDX-License-Identifier: Apache-2.0
// Parts of the circuit, one by one.
#include "hydraulics/circuit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "core/state_bytes.h"
#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/sources.h"
#include "hydraulics/curve.h"
#include "hydraulics/oil.h"
#include "hydraulics/smooth.h"
#include "tests/properties/hydraulics/bench_circuit.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace circuit_test {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

TEST(Smooth, ramp_is_exact_outside_its_width_and_close_inside) {
  EXPECT_EQ(ramp(-1, 0.1).value, 0);
  EXPECT_EQ(ramp(0.2, 0.1).value, 0.2);
  for (double x = 0; x < 0.1; x += 1e-3) {
    EXPECT_LE(ramp(x, 0.1).value, x + 0.1 * 4 / 27);
    EXPECT_LE(std::fabs(ramp(x, 0.1).value - x), 0.1 * 4 / 27 + 1e-15);
    EXPECT_NEAR(ramp(x, 0.1).slope, (ramp(x + 1e-6, 0.1).value - ramp(x - 1e-6, 0.1).value) / 2e-6, 1e-4);
  }
}

TEST(Smooth, root_is_odd_and_a_square_root_far_from_zero) {
  EXPECT_NEAR(root(35e5, 1e4).value, std::sqrt(35e5), 1e-4 * std::sqrt(35e5));
  EXPECT_EQ(root(-7e3, 1e4).value, -root(7e3, 1e4).value);
  EXPECT_NEAR(root(1, 1e4).slope, 1 / std::sqrt(1e4), 1e-6);
}

TEST(Smooth, clip_stays_within_zero_and_one) {
  for (double x = -1; x < 3; x += 1e-3) {
    EXPECT_GE(unit_clip(x, 0.02).value, 0);
    EXPECT_LE(unit_clip(x, 0.02).value, 1 + 0.02 * 4 / 27 + 1e-12);
  }
  EXPECT_DOUBLE_EQ(unit_clip(0.5, 0.02).value, 0.5);
  EXPECT_DOUBLE_EQ(unit_clip(2, 0.02).value, 1);
}

TEST(Oil, table_agrees_with_the_law_and_is_continuous) {
  HydraulicsDef def;
  const OilCompressibility oil(def);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(std::log10(300.0), 8.9);
  for (int i = 0; i < 20000; ++i) {
    const double p = std::pow(10, exponent(random));
    EXPECT_NEAR(oil.at(p).value, oil.exact(p).value, 1e-6 * oil.exact(p).value) << p;
    EXPECT_NEAR(oil.at(p * (1 + 1e-13)).value, oil.at(p).value, 1e-9 * oil.exact(p).value);
    EXPECT_GT(oil.at(p).value, 0);
  }
}

TEST(Oil, bulk_modulus_rises_from_the_airs_to_the_oils) {
  HydraulicsDef def;
  const OilCompressibility oil(def);
  // at 1 bar: (1/B + alpha/(n p)) / (1 + alpha)
  EXPECT_NEAR(oil.at(1e5).value, (1 / 1.5e9 + 0.005 / 1.2 / 1e5) / 1.005, 1e-4 * oil.at(1e5).value);
  EXPECT_NEAR(1 / oil.at(200e5).value, 1.494e9, 0.001e9);
  def.entrained_air = 0;
  EXPECT_NEAR(1 / OilCompressibility(def).at(1e5).value, 1.5e9, 1e3);
}

TEST(Oil, without_air_is_as_stiff_at_the_floor_as_anywhere) {
  HydraulicsDef def;
  def.entrained_air = 0;
  const OilCompressibility oil(def);
  for (double p = 0.9 * def.pressure_floor; p < 1.1 * def.pressure_floor; p += 1e-3 * def.pressure_floor) {
    EXPECT_NEAR(oil.at(p).value * def.oil_bulk_modulus, 1, 1e-9) << p;
  }
}

TEST(Vapour, pressure_leaves_the_floor_with_its_slope_and_stays_above_half_of_it) {
  constexpr double kFloor = 5e3;
  EXPECT_NEAR(vapour_pressure(kFloor * (1 - 1e-9), kFloor).value, kFloor, 1e-5);
  EXPECT_NEAR(vapour_pressure(kFloor * (1 - 1e-9), kFloor).slope, 1, 1e-8);
  double above = kFloor;
  for (double u = kFloor; u > -1e9; u -= 0.01 * kFloor + 0.1 * std::fabs(u - kFloor)) {
    const ValueSlope p = vapour_pressure(u, kFloor);
    EXPECT_LE(p.value, above);
    EXPECT_GE(p.value, vapour_pressure_of(kFloor));
    const double h = 1e-4 * kFloor;
    const double slope = (vapour_pressure(u + h, kFloor).value - vapour_pressure(u - h, kFloor).value) / (2 * h);
    EXPECT_NEAR(p.slope, slope, 1e-6);
    above = p.value;
  }
}

// two volumes with an orifice between them, one of them drawn empty by a piston
TEST(Vapour, room_without_oil_is_what_the_piston_made_less_what_flowed_in) {
  HydraulicsDef def = bench_circuit();
  Circuit circuit(def);
  std::vector<double> y(static_cast<std::size_t>(circuit.state_count())), f(y);
  circuit.start_at_initial_pressures(y);
  const auto A = static_cast<std::size_t>(circuit.find_volume("Vol_A"));
  y[static_cast<std::size_t>(circuit.position(0))] = 0.3;
  circuit.follow_vapour(y.data());
  const double C = circuit.vapour_capacities()[A];
  // rates in vapour are flows over a capacity that neither pressure nor stroke changes
  for (const double x : {0.3, 0.6}) {
    for (const double u : {-1e5, -1e8}) {
      y[static_cast<std::size_t>(circuit.position(0))] = x, y[A] = u;
      circuit.rates(y.data(), f.data());
      const double still = f[A];
      y[static_cast<std::size_t>(circuit.speed(0))] = 0.2;
      circuit.rates(y.data(), f.data());
      const double area = circuit.actuators()[0].area_a;
      EXPECT_NEAR((still - f[A]) * C, 0.2 * area, 1e-9 * area) << x << " " << u;
      y[static_cast<std::size_t>(circuit.speed(0))] = 0;
    }
  }
}

TEST(Oil, density_parabola_has_the_bulk_moduli_of_the_two_dof_crane) {
  HydraulicsDef def;
  def.oil_law = OilLaw::density_parabola;
  def.oil_compressibility = 6.53e-10;
  def.oil_density_peak = 6.53e-10 / (2 * 1.19e-18);
  const OilCompressibility oil(def);
  // published: (1 + a p + b p^2) / (a + 2 b p)
  EXPECT_NEAR(1 / oil.exact(3.17084615e6).value, 1.552488e9, 1e3);
  EXPECT_NEAR(1 / oil.at(4.52915385e6).value, 1.561664e9, 1e4);
  EXPECT_GT(oil.at(1e9).value, 0);
  EXPECT_EQ(oil.at(1e9).slope, 0);
}

TEST(DoubleRodCylinder, starts_around_the_mean_pressure_and_holds_its_load) {
  HydraulicsDef def = bench_circuit();
  // the motor at one of its volumes would start that volume too
  std::erase_if(def.components, [](const auto& component) { return component->name == "Fan"; });
  Circuit circuit(def);
  const double F = 2e4;
  std::vector<double> y(static_cast<std::size_t>(circuit.state_count())), forces(circuit.actuators().size());
  forces[0] = F;
  circuit.start_in_equilibrium(forces, y);
  const double area = 0.25 * std::numbers::pi * (0.1 * 0.1 - 0.05 * 0.05);
  const auto a = static_cast<std::size_t>(circuit.find_volume("Vol_A"));
  const auto b = static_cast<std::size_t>(circuit.find_volume("Vol_B"));
  EXPECT_NEAR((y[a] - y[b]) * area, F, 1e-6);
  EXPECT_NEAR(0.5 * (y[a] + y[b]), def.start_slew_pressure, 1e-3);
  EXPECT_DOUBLE_EQ(circuit.actuators()[0].area_a, circuit.actuators()[0].area_b);
}

// areas, lengths and ratios by hand
TEST(ActuatorFacts, of_every_type_of_cylinder_are_its_geometry_by_hand) {
  const auto with_common = [](auto def) {
    def.common.force = "Force", def.common.port_a = "Vol_A", def.common.port_b = "Vol_B";
    def.common.piston_diameter = 0.1, def.common.minimum_stroke = 0.02, def.common.maximum_stroke = 0.7;
    def.common.cylinder_coefficient = 0.85, def.common.coupling = PortCoupling::tlm;
    return def;
  };
  const double full = 7.853981633974483e-3, ring = 5.890486225480862e-3;  // m2
  DoubleActingCylinderDef acting = with_common(DoubleActingCylinderDef());
  acting.rod_diameter = 0.05, acting.rod_length = 0.8, acting.attachment_length = 0.1;
  DoubleRodCylinderDef rods = with_common(DoubleRodCylinderDef());
  rods.rod_diameter = 0.05, rods.rod_length = 0.8, rods.attachment_length = 0.1;
  SlewCylinderDef slew = with_common(SlewCylinderDef());
  slew.pinion_radius = 0.15, slew.stroke_offset = 0.3;
  struct Expected {
    const ComponentDef* def;
    double area_a, area_b;
    PortCoordinate coordinate;
    Motion motion;
    StartRule start;
  };
  for (const Expected& expected : {
           Expected{&acting, full, ring, {-0.9, 1}, Motion::linear, StartRule::return_pressure},
           Expected{&rods, ring, ring, {-0.9, 1}, Motion::linear, StartRule::mean_pressure},
           Expected{&slew, full, full, {0.3, 0.15}, Motion::rotary, StartRule::mean_pressure},
       }) {
    const ActuatorDef actuator = expected.def->actuator().value();
    SCOPED_TRACE(expected.def->type_name());
    EXPECT_NEAR(actuator.area_a, expected.area_a, 1e-12);
    EXPECT_NEAR(actuator.area_b, expected.area_b, 1e-12);
    EXPECT_DOUBLE_EQ(actuator.coordinate.offset, expected.coordinate.offset);
    EXPECT_EQ(actuator.coordinate.ratio, expected.coordinate.ratio);
    EXPECT_EQ(actuator.motion, expected.motion);
    EXPECT_EQ(actuator.start, expected.start);
    EXPECT_EQ(actuator.force, "Force");
    EXPECT_EQ(actuator.port_a, "Vol_A");
    EXPECT_EQ(actuator.port_b, "Vol_B");
    EXPECT_EQ(actuator.line_force.minimum_stroke, 0.02);
    EXPECT_EQ(actuator.line_force.maximum_stroke, 0.7);
    EXPECT_EQ(actuator.line_force.cylinder_coefficient, 0.85);
    EXPECT_EQ(actuator.coupling, PortCoupling::tlm);
  }
  EXPECT_FALSE(OrificeDef().actuator());
}

TEST(FourWayValve, meters_by_complementary_edges) {
  HydraulicsDef def;
  def.oil_density = 850, def.orifice_transition = 1;
  add_tank(def, "Vol_P", 80 * kBar), add_tank(def, "Vol_T", 1 * kBar);
  add_volume(def, "Vol_A", 40 * kBar).rigid_volume = 1e-3;
  add_volume(def, "Vol_B", 30 * kBar).rigid_volume = 1e-3;
  FourWayValveDef& valve = add<FourWayValveDef>(def, "Valve");
  valve.port_p = "Vol_P", valve.port_a = "Vol_A", valve.port_b = "Vol_B", valve.port_t = "Vol_T";
  valve.edge_area = 1e-5, valve.neutral_opening = 0.5, valve.opening_gain = 0.5;
  Circuit circuit(def);
  std::vector<double> y(static_cast<std::size_t>(circuit.state_count())), values(circuit.variables().size());
  circuit.start_at_initial_pressures(y);
  const auto value = [&](const std::string& name) {
    circuit.read_variables(y.data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit.variables()[i].name == name) return values[i];
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  const double K = 0.67 * 1e-5 * std::sqrt(2 / 850.0);
  circuit.set_control(0, 0.4);  // u = 0.7
  EXPECT_NEAR(value("Valve.opening"), 0.7, 1e-12);
  EXPECT_NEAR(value("Valve.flow_pa"), 0.7 * K * std::sqrt(40e5), 1e-9);
  EXPECT_NEAR(value("Valve.flow_bt"), 0.7 * K * std::sqrt(29e5), 1e-9);
  EXPECT_NEAR(value("Valve.flow_pb"), 0.3 * K * std::sqrt(50e5), 1e-9);
  EXPECT_NEAR(value("Valve.flow_at"), 0.3 * K * std::sqrt(39e5), 1e-9);
  circuit.set_control(0, 2);
  EXPECT_EQ(value("Valve.opening"), 1);
  EXPECT_EQ(value("Valve.flow_pb"), 0);
}

TEST(Curve, pchip_passes_through_its_points_and_stays_between_them) {
  HydraulicsDef def = crane_circuit();
  CurveDef& curve = def.curves[0];
  EXPECT_EQ(straight_lines(curve), curve.points);
  curve.interpolation = Interpolation::pchip;
  const Table table = straight_lines(curve);
  ASSERT_EQ(table.size(), 16 * (curve.points.size() - 1) + 1);
  for (std::size_t i = 0; i + 1 < curve.points.size(); ++i) {
    const double low = std::min(curve.points[i][1], curve.points[i + 1][1]);
    const double high = std::max(curve.points[i][1], curve.points[i + 1][1]);
    for (std::size_t k = 0; k <= 16; ++k) {
      EXPECT_GE(table[16 * i + k][1], low - 1e-12);
      EXPECT_LE(table[16 * i + k][1], high + 1e-12);
    }
    EXPECT_NEAR(table[16 * i][1], curve.points[i][1], 1e-12);
  }
  EXPECT_EQ(find_curve(def, "Spline_CylinderFriction"), &curve);
  EXPECT_EQ(find_curve(def, "nothing"), nullptr);
}

// the cubic itself, not lines through it: by hand from the slopes of Fritsch and Carlson (1980) at the points
TEST(Curve, pchip_is_the_cubic_with_its_own_slope) {
  CurveDef curve;
  curve.points = {{-1, 0}, {0, 0.2}, {0.3, 3}, {0.5, 3.2}, {1, 10}};
  curve.interpolation = Interpolation::pchip;
  const CurveFunction function(curve);
  // weighted harmonic means: w1 = 2 h1 + h0, w2 = h1 + 2 h0
  const double m_1 = (1.6 + 2.3) / (1.6 / 0.2 + 2.3 / (2.8 / 0.3)), m_2 = (0.7 + 0.8) / (0.7 / (2.8 / 0.3) + 0.8 / 1);
  for (const double x : {0.002, 0.01, 0.1, 0.2, 0.29}) {
    const double h = 0.3, t = x / h, u = 1 - t;
    const double y = u * u * (1 + 2 * t) * 0.2 + t * t * (3 - 2 * t) * 3 + t * u * h * (u * m_1 - t * m_2);
    EXPECT_NEAR(function.at(x).value, y, 1e-12) << x;
  }
  for (double x = -0.995; x < 1; x += 0.01) {
    const double step = 1e-6;
    const double slope = (function.at(x + step).value - function.at(x - step).value) / (2 * step);
    EXPECT_NEAR(function.at(x).slope, slope, 1e-4) << x;
  }
  for (const auto& [end, value] : {std::pair{-2.0, 0.0}, std::pair{2.0, 10.0}}) {
    EXPECT_EQ(function.at(end).value, value);
    EXPECT_EQ(function.at(end).slope, 0);
  }
  curve.interpolation = Interpolation::linear;
  EXPECT_NEAR(CurveFunction(curve).at(0.15).value, 1.6, 1e-12);
}

TEST(Circuit, numbers_its_states_volumes_first_then_pistons_then_components) {
  const Circuit circuit(crane_circuit());
  EXPECT_EQ(circuit.volume_count(), 8);
  EXPECT_EQ(circuit.actuator_count(), 3);
  // three spools, one LS line, relief valve, swash
  EXPECT_EQ(circuit.state_count(), 8 + 6 + 6);
  EXPECT_EQ(circuit.position(1), 9);
  EXPECT_EQ(circuit.speed(1), 12);
  EXPECT_EQ(circuit.actuators()[0].name, "Cyl_Lift");
  EXPECT_EQ(circuit.actuators()[0].force, "ForceT_Lift");
  EXPECT_DOUBLE_EQ(circuit.actuators()[0].coordinate.offset, -1.237);
  EXPECT_DOUBLE_EQ(circuit.actuators()[2].coordinate.ratio, 0.144);
  EXPECT_EQ(circuit.actuators()[2].line_force.friction_curve, "Spline_CylinderFriction");
}

TEST(Circuit, equilibrium_start_holds_the_static_forces) {
  const Circuit circuit(crane_circuit());
  std::vector<double> y(at(circuit.state_count())), F(3);
  // pushing, pulling hard, and to either side
  for (const double lift : {251e3, 627e3, 0.0, -50e3, -400e3}) {
    const double forces[] = {lift, 107e3, 0.2 * lift};
    circuit.start_in_equilibrium(forces, y);
    circuit.pressure_forces(y.data(), F.data());
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(F[j], forces[j], 1e-6 * (1e3 + std::fabs(forces[j])));
    for (int i = 0; i < circuit.volume_count(); ++i) EXPECT_GE(y[at(i)], 1e5 * (1 - 1e-12));
  }
  const double forces[] = {251e3, 107e3, 0};
  circuit.start_in_equilibrium(forces, y);
  EXPECT_DOUBLE_EQ(y[at(circuit.find_volume("Vol_LiftCyl_B"))], 5e5);
  EXPECT_DOUBLE_EQ(y[at(circuit.find_volume("Vol_SlewCyl_A"))], 20e5);
  EXPECT_DOUBLE_EQ(y[at(circuit.find_volume("Vol_MainPump"))], 26e5);
}

TEST(Circuit, table_13_start_is_1_bar_everywhere) {
  HydraulicsDef def = crane_circuit();
  def.start = StartState::table13;
  const Circuit circuit(def);
  std::vector<double> y(at(circuit.state_count()), 7);
  circuit.start(kCraneForces, y);
  for (int i = 0; i < circuit.volume_count(); ++i) EXPECT_EQ(y[at(i)], 1e5);
  EXPECT_EQ(y.back(), 0);
}

TEST(Circuit, moving_a_piston_to_and_fro_gives_the_pressures_back) {
  Circuit circuit(crane_circuit());
  std::vector<double> y(at(circuit.state_count()));
  circuit.start_in_equilibrium(kCraneForces, y);
  for (int j = 0; j < 3; ++j) y[at(circuit.position(j))] = kCraneStrokes[j];
  const std::vector<double> y_0 = y;
  const double there[] = {0.8325, 0.7525, 0.6};
  EXPECT_TRUE(circuit.move_pistons(y.data(), there));
  // lift: K_A of about 43 kN/mm on 314 cm2, so half a millimetre is some 7 bar
  EXPECT_LT(y[at(circuit.find_volume("Vol_LiftCyl_A"))], y_0[at(circuit.find_volume("Vol_LiftCyl_A"))] - 5e5);
  EXPECT_TRUE(circuit.move_pistons(y.data(), kCraneStrokes));
  for (std::size_t i = 0; i < y.size(); ++i) EXPECT_NEAR(y[i], y_0[i], 1e-5 * y_0[i]);
}

TEST(Circuit, moving_a_piston_slightly_follows_the_stiffness) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const ActuatorLinearisation before = integrator.actuators()[0];
  const double x[] = {kCraneStrokes[0] + 1e-6, kCraneStrokes[1], kCraneStrokes[2]};
  integrator.align(x, kAtRest);
  integrator.refresh();
  EXPECT_NEAR(integrator.actuators()[0].F - before.F, -before.K * 1e-6, 1e-3 * before.K * 1e-6);
  EXPECT_EQ(integrator.actuators()[0].x, x[0]);
}

TEST(Circuit, published_force_rate_predicts_the_force_of_a_small_step) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double v[] = {0.01, -0.02, 0.05};
  integrator.start(kCraneStrokes, v, kCraneForces);
  const HeldSpeed motion(3);
  for (int k = 0; k < 50; ++k) integrator.step(1e-3, motion);
  std::vector<ActuatorLinearisation> before(integrator.actuators().begin(), integrator.actuators().end());
  integrator.step(1e-5, motion);
  for (std::size_t j = 0; j < 3; ++j) {
    const double dF = integrator.actuators()[j].F - before[j].F;
    EXPECT_NEAR(dF, before[j].F_dot * 1e-5, 1e-2 * std::fabs(dF)) << j;
  }
}

TEST(Circuit, lambda_is_the_decay_that_open_edges_give_a_compressed_cylinder) {
  // lift and slew commanded, so that oil leaves and enters through open edges; a small push on all pistons
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  circuit.set_control(circuit.find_control("L90Lift"), -500);
  circuit.set_control(circuit.find_control("L90Jib"), 500);
  circuit.set_control(circuit.find_control("L90Slew"), -500);
  for (int k = 0; k < 100; ++k) integrator.step(1e-3, HeldSpeed(3));
  const std::vector<ActuatorLinearisation> before(integrator.actuators().begin(), integrator.actuators().end());
  std::vector<double> C(at(circuit.volume_count()));
  circuit.capacities(integrator.state().data(), C.data());
  std::vector<double> x;
  for (const ActuatorLinearisation& actuator : before) x.push_back(actuator.x + 1e-7);
  integrator.align(x, kAtRest);
  integrator.refresh();
  for (std::size_t j = 0; j < 3; ++j) {
    const ActuatorLinearisation& after = integrator.actuators()[j];
    const Actuator& actuator = circuit.actuators()[j];
    // F' = A_A Q_A/C_A - A_B Q_B/C_B at rest; its change is -lambda times that of F
    const double rate = actuator.area_a * (after.Q_a - before[j].Q_a) / C[at(actuator.port_a)] -
                        actuator.area_b * (after.Q_b - before[j].Q_b) / C[at(actuator.port_b)];
    const double lambda = -rate / (after.F - before[j].F);
    EXPECT_NEAR(before[j].lambda, lambda, 2e-3 * lambda) << j;
    EXPECT_GT(lambda, 0.1) << j;
  }
}

TEST(Circuit, lambda_takes_the_steeper_side_of_an_anti_cavitation_valve) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const double closed = integrator.actuators()[0].lambda;
  const auto B = at(circuit.find_volume("Vol_LiftCyl_B"));
  integrator.mutable_state()[B] = 1e5 - 0.15e5;  // shortly before it opens at 0.2 bar
  integrator.refresh();
  EXPECT_GT(integrator.actuators()[0].lambda, 1 + closed);
}

TEST(Circuit, lambda_before_an_anti_cavitation_valve_opens_is_what_it_is_just_behind) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const auto B = at(circuit.find_volume("Vol_LiftCyl_B"));
  const auto lambda_at = [&](double below) {
    integrator.mutable_state()[B] = 1e5 - below;
    integrator.refresh();
    return integrator.actuators()[0].lambda;
  };
  // opens at 0.2 bar; the published slope is that of the side to which it would switch, on both sides of the switch
  const double before = lambda_at(0.1999e5), behind = lambda_at(0.2001e5);
  EXPECT_GT(before, 0.99 * behind);
  EXPECT_GT(behind, 10 * lambda_at(-1e5));
}

TEST(Circuit, live_parameters_act_at_once_and_others_are_refused) {
  Circuit circuit(crane_circuit());
  std::vector<double> y(at(circuit.state_count())), f(y), g(y);
  circuit.start_in_equilibrium(kCraneForces, y);
  for (int j = 0; j < 3; ++j) y[at(circuit.position(j))] = kCraneStrokes[j];
  const auto B = at(circuit.find_volume("Vol_LiftCyl_B"));
  circuit.rates(y.data(), f.data());
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("L90Lift.leak_flow"), 10 * kLeak), ParameterResult::ok);
  circuit.rates(y.data(), g.data());
  EXPECT_LT(f[B] - g[B], 0);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("L90Lift.leak_flow"), -1), ParameterResult::out_of_range);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("L90Lift.overlap"), 2), ParameterResult::out_of_range);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("L90Lift.step_response"), 1), ParameterResult::unknown);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("Nothing.overlap"), 0.1), ParameterResult::unknown);
  EXPECT_EQ(circuit.set_parameter(-1, 0.1), ParameterResult::unknown);
  const int index = circuit.find_parameter("PRV_MainPump.setting_pressure");
  ASSERT_GE(index, 0);
  EXPECT_EQ(*circuit.parameters()[at(index)].value, 270e5);
  EXPECT_EQ(circuit.parameter_values()[at(index)], 270e5);
}

TEST(Circuit, every_live_parameter_can_be_set_to_its_own_value_without_effect) {
  Circuit circuit(crane_circuit());
  std::vector<double> y(at(circuit.state_count())), f(y), g(y);
  circuit.start_in_equilibrium(kCraneForces, y);
  for (int j = 0; j < 3; ++j) y[at(circuit.position(j))] = kCraneStrokes[j];
  circuit.rates(y.data(), f.data());
  for (std::size_t i = 0; i < circuit.parameters().size(); ++i) {
    EXPECT_EQ(circuit.set_parameter(static_cast<int>(i), *circuit.parameters()[i].value), ParameterResult::ok);
  }
  circuit.rates(y.data(), g.data());
  EXPECT_EQ(f, g);
}

TEST(Circuit, variables_have_names_of_their_own_and_finite_values) {
  Circuit circuit(crane_circuit());
  std::vector<double> y(at(circuit.state_count())), values(circuit.variables().size(), NAN);
  circuit.start_in_equilibrium(kCraneForces, y);
  for (int j = 0; j < 3; ++j) y[at(circuit.position(j))] = kCraneStrokes[j];
  circuit.set_line_force(0, 123);
  circuit.read_variables(y.data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_TRUE(std::isfinite(values[i])) << circuit.variables()[i].name;
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(circuit.variables()[i].name, circuit.variables()[k].name);
    if (circuit.variables()[i].name == "Cyl_Lift.force") {
      EXPECT_EQ(values[i], 123);
    }
    if (circuit.variables()[i].name == "Vol_LiftCyl_A.effective_bulk_modulus") {
      EXPECT_NEAR(values[i], 1.15e9, 0.2e9);
    }
  }
}

TEST(Circuit, flags_pistons_in_their_stops_and_chambers_pressed_shut) {
  Circuit circuit(crane_circuit());
  std::vector<double> y(at(circuit.state_count()));
  circuit.start_in_equilibrium(kCraneForces, y);
  for (int j = 0; j < 3; ++j) y[at(circuit.position(j))] = kCraneStrokes[j];
  EXPECT_EQ(circuit.flags(y.data()), 0u);
  y[at(circuit.position(0))] = 1.051;
  EXPECT_EQ(circuit.flags(y.data()), static_cast<std::uint32_t>(StepFlag::limit_hit));
  y[at(circuit.position(0))] = 1.2;
  EXPECT_TRUE(circuit.flags(y.data()) & static_cast<std::uint32_t>(StepFlag::clamp_active));
}

TEST(CircuitIntegrator, hash_changes_when_any_state_changes_by_one_ulp) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const HeldSpeed motion(3);
  integrator.step(1e-3, motion);
  const auto digest = [&] {
    StateHash hash;
    integrator.add_to(hash);
    return hash.digest();
  };
  const std::uint64_t before = digest();
  for (double& value : integrator.mutable_state()) {
    const double good = value;
    value = std::nextafter(good, 1e300);
    EXPECT_NE(digest(), before);
    value = good;
  }
  const double h = integrator.step_size();
  integrator.set_step_size(std::nextafter(h, 1.0));
  EXPECT_NE(digest(), before);
  integrator.set_step_size(h);
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(circuit.set_parameter(circuit.find_parameter("L90Lift.overlap"), std::nextafter(0.32, 1.0)),
            ParameterResult::ok);
  EXPECT_NE(digest(), before);
}

// Found by a fuzzer: a state with the flag of inconsistent volumes without compressibility, where there are none.
TEST(CircuitIntegrator, a_saved_state_whose_flags_cannot_be_is_refused) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  integrator.step(1e-3, HeldSpeed(3));
  std::vector<std::byte> saved;
  StateWriter writer(saved, {});
  integrator.save(writer);
  writer.finish();
  constexpr std::size_t kHeader = 32, kCheck = 24;  // offsets in the layout of core/state_bytes.h
  int refused = 0;
  for (std::size_t i = kHeader; i < saved.size(); ++i) {
    if (saved[i] != std::byte{1}) continue;
    std::vector<std::byte> changed = saved;
    changed[i] = {};
    StateHash check;
    check.add_bytes(changed.data() + kHeader, changed.size() - kHeader);
    const std::uint64_t digest = check.digest();
    std::memcpy(changed.data() + kCheck, &digest, sizeof digest);
    StateReader reader(changed, {});
    integrator.load(reader);
    if (reader.finish("hydraulics").is_ok()) {
      EXPECT_FALSE(integrator.step(1e-3, HeldSpeed(3)).has(StepFlag::not_converged)) << i;
    } else {
      ++refused;
    }
  }
  EXPECT_GE(refused, 1);
  StateReader reader(saved, {});
  integrator.load(reader);
  EXPECT_TRUE(reader.finish("hydraulics").is_ok());
}

TEST(CircuitIntegrator, a_non_finite_state_is_latched_and_the_last_good_one_stays) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const std::vector<double> good(integrator.state().begin(), integrator.state().end());
  // a partner that loses its numbers
  class Broken final : public PistonMotion {
   public:
    void accelerations(const double*, const double*, const double*, double* a) const noexcept override {
      a[0] = a[1] = a[2] = NAN;
    }
    void slopes(const double*, const double*, const double*, double* dF, double* dx,
                double* dv) const noexcept override {
      for (int i = 0; i < 9; ++i) dF[i] = dx[i] = dv[i] = NAN;
    }
  };
  const StepReport report = integrator.step(1e-3, Broken());
  EXPECT_TRUE(report.has(StepFlag::non_finite));
  EXPECT_EQ(report.offender, circuit.speed(0));
  EXPECT_TRUE(std::equal(good.begin(), good.end(), integrator.state().begin()));
  EXPECT_TRUE(integrator.step(1e-3, HeldSpeed(3)).has(StepFlag::non_finite));
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  EXPECT_FALSE(integrator.step(1e-3, HeldSpeed(3)).has(StepFlag::non_finite));
}

TEST(CircuitIntegrator, names_the_state_that_was_not_finite_before_the_step) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  integrator.step(1e-3, HeldSpeed(3));
  const double lost[] = {kCraneStrokes[0], kCraneStrokes[1], NAN};
  integrator.align(lost, kAtRest);
  const StepReport report = integrator.step(1e-3, HeldSpeed(3));
  EXPECT_TRUE(report.has(StepFlag::non_finite));
  EXPECT_EQ(report.offender, circuit.position(2));
  EXPECT_EQ(integrator.step(1e-3, HeldSpeed(3)).offender, report.offender);
}

TEST(CircuitIntegrator, a_pressure_beyond_the_oils_law_is_flagged_with_the_volume_where_it_is_highest) {
  const HydraulicsDef def = crane_circuit();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  EXPECT_FALSE(integrator.step(1e-6, HeldSpeed(3)).has(StepFlag::beyond_oil_law));
  const int lift = circuit.find_volume("Vol_LiftCyl_A"), jib = circuit.find_volume("Vol_JibCyl_A");
  integrator.mutable_state()[at(lift)] = 1100e5;
  integrator.mutable_state()[at(jib)] = 1300e5;
  const StepReport report = integrator.step(1e-6, HeldSpeed(3));
  EXPECT_TRUE(report.has(StepFlag::beyond_oil_law));
  EXPECT_EQ(report.offender, jib);
}

TEST(CircuitIntegrator, a_saved_state_in_vapour_goes_on_with_the_same_bits) {
  HydraulicsDef def = crane_circuit();
  for (auto& c : def.components) {
    if (c->type_name() == "l90ls_valve") static_cast<L90lsValveDef&>(*c).anti_cavitation_flow = 0;
  }
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  const auto move = [](CircuitIntegrator& one, double speed, int steps) {
    const double v[] = {0, 0, speed};
    for (int k = 0; k < steps; ++k) {
      std::vector<double> x;
      for (const ActuatorLinearisation& a : one.actuators()) x.push_back(a.x);
      one.align(x, v);
      one.step(1e-3, HeldSpeed(3));
    }
    StateHash hash;
    one.add_to(hash);
    return hash.digest();
  };
  move(integrator, 0.6, 100);
  ASSERT_GE(circuit.first_cavitating(integrator.state().data()), 0);
  std::vector<std::byte> saved;
  StateWriter writer(saved, {});
  integrator.save(writer);
  writer.finish();
  Circuit other(def);
  CircuitIntegrator restored(other, def);
  StateReader reader(saved, {});
  restored.load(reader);
  ASSERT_TRUE(reader.finish("hydraulics").is_ok());
  EXPECT_EQ(move(integrator, -0.6, 150), move(restored, -0.6, 150));
}

// a rate in vapour is a flow over the capacity that the volume had at the floor
TEST(CircuitIntegrator, the_capacity_of_a_volume_in_vapour_is_part_of_the_hash) {
  HydraulicsDef def;
  def.start = StartState::table13;
  def.volumes = {{.name = "Suction", .initial_pressure = 5e5, .rigid_volume = 1e-4},
                 {.name = "T", .initial_pressure = 1e5, .fixed = true}};
  auto pump = std::make_unique<FlowSourceDef>();
  pump->name = "Pump", pump->port_1 = "Suction", pump->port_2 = "T", pump->flow = 1e-3;
  def.components.push_back(std::move(pump));
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const auto hash_of = [](const CircuitIntegrator& one) {
    StateHash hash;
    one.add_to(hash);
    return hash.digest();
  };
  const auto with_another_capacity = [&] {
    const std::span<const double> capacities = circuit.vapour_capacities();
    std::vector<double> C(capacities.begin(), capacities.end());
    const std::vector<double> kept = C;
    C[0] = std::nextafter(C[0], 1.0);
    circuit.set_vapour_capacities(C);
    const std::uint64_t hash = hash_of(integrator);
    circuit.set_vapour_capacities(kept);
    return hash;
  };
  EXPECT_EQ(with_another_capacity(), hash_of(integrator)) << "above the floor it has no effect";
  for (int k = 0; k < 20; ++k) integrator.step(1e-3, HeldSpeed(0));
  ASSERT_EQ(circuit.first_cavitating(integrator.state().data()), 0);
  EXPECT_NE(with_another_capacity(), hash_of(integrator));
}

TEST(CircuitIntegrator, an_exhausted_budget_is_flagged_and_the_step_is_finished) {
  HydraulicsDef def = crane_circuit();
  def.substep_budget = 2;
  def.relative_tolerance = 1e-9;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  MassLoad load = crane_load();
  integrator.start(kCraneStrokes, kAtRest, kCraneForces);
  circuit.set_control(circuit.find_control("L90Lift"), 500);
  StepReport all;
  for (int k = 0; k < 100; ++k) all.flags |= integrator.step(1e-3, load).flags;
  EXPECT_TRUE(all.has(StepFlag::step_budget));
  EXPECT_FALSE(all.has(StepFlag::non_finite));
}

TEST(Circuit, equilibrium_beyond_its_shock_valves_names_volume_and_valve) {
  const HydraulicsDef def = crane_circuit();
  const Circuit circuit(def);
  EXPECT_FALSE(circuit.demand_beyond_limits(kCraneForces));
  const auto* valve = dynamic_cast<const L90lsValveDef*>(def.components[0].get());
  for (const auto& component : def.components) {
    if (component->name == "L90Lift") valve = dynamic_cast<const L90lsValveDef*>(component.get());
  }
  ASSERT_NE(valve, nullptr);
  const double limit = 1e5 + valve->shock_pressure_a + valve->shock_pressure_rise;
  const Actuator& lift = circuit.actuators()[0];
  // F of the lift cylinder that requires exactly this pressure, and a little more
  const double holds = limit * lift.area_a - def.start_return_pressure * lift.area_b;
  double F[] = {0.999 * holds, kCraneForces[1], kCraneForces[2]};
  EXPECT_FALSE(circuit.demand_beyond_limits(F));
  F[0] = 1.001 * holds;
  const auto demand = circuit.demand_beyond_limits(F);
  ASSERT_TRUE(demand);
  EXPECT_EQ(circuit.volume_name(demand->volume), "Vol_LiftCyl_A");
  EXPECT_EQ(demand->actuator, 0);
  EXPECT_EQ(demand->valve, "L90Lift");
  EXPECT_DOUBLE_EQ(demand->limit, limit);
  EXPECT_NEAR(demand->pressure, 1.001 * limit, 1e-3 * limit);
}

// Content of a volume at the start state of the crane.
double content_of(const HydraulicsDef& def, const std::string& volume) {
  Circuit circuit(def);
  std::vector<double> y(at(circuit.state_count()));
  circuit.start_at_initial_pressures(y);
  for (int j = 0; j < circuit.actuator_count(); ++j) y[at(circuit.position(j))] = kCraneStrokes[j];
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(y.data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == volume + ".content") return values[i];
  }
  ADD_FAILURE() << volume;
  return 0;
}

TEST(Circuit, each_chamber_has_a_dead_volume_of_its_own) {
  HydraulicsDef def = crane_circuit();
  const double a = content_of(def, "Vol_LiftCyl_A"), b = content_of(def, "Vol_LiftCyl_B");
  for (const auto& component : def.components) {
    if (component->name != "Cyl_Lift") continue;
    CylinderParameters& common = static_cast<DoubleActingCylinderDef&>(*component).common;
    common.dead_volume_a = 3e-4, common.dead_volume_b = 7e-4;
  }
  EXPECT_NEAR(content_of(def, "Vol_LiftCyl_A") - a, 3e-4, 1e-12);
  EXPECT_NEAR(content_of(def, "Vol_LiftCyl_B") - b, 7e-4, 1e-12);
}

// 100 bar above its 50 bar and the 10 bar that open it: as far open as at rest, not shut.
TEST(Circuit, a_relief_valve_begins_at_the_opening_of_its_start_pressures) {
  for (const auto& [above_bar, opening] : {std::pair{-5.0, 0.0}, {5.0, 0.5}, {100.0, 1.0}}) {
    CircuitRig rig;
    rig.def.start = StartState::table13;
    add_tank(rig.def, "Line", (51 + above_bar) * kBar), add_tank(rig.def, "Tank", 1 * kBar);
    ReliefValveDef& valve = add<ReliefValveDef>(rig.def, "Relief");
    valve.port_1 = "Line", valve.port_2 = "Tank", valve.nominal_flow = 100 * kLitrePerMinute;
    valve.setting_pressure = 50 * kBar, valve.opening_pressure_rise = 10 * kBar;
    EXPECT_NEAR(rig.variable("Relief.opening"), opening, 1e-12) << above_bar;
    rig.run(0.1);
    EXPECT_NEAR(rig.variable("Relief.opening"), opening, 1e-12) << above_bar;
  }
}

}  // namespace circuit_test
}  // namespace slew::hydraulics::test
