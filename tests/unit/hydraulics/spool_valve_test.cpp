// SPDX-License-Identifier: Apache-2.0
// Laws of the spool valve and the sources at numbers worked out by hand, and their own rules.
#include "hydraulics/components/spool_valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/bench_circuit.h"

namespace slew::hydraulics::test {
namespace spool_valve_test {

// Four ports and the two of a bypass at fixed pressures [bar above zero]: P 104, A 100, B 64, T 0 (set to 1e-9), C 16,
// D 7. An edge of 1 mm2 passes k = 0.67e-6 sqrt(2/870) m3/s at 1 Pa.
struct Rig {
  HydraulicsDef def;
  SpoolValveDef* valve;

  Rig() {
    def.orifice_transition = 1;
    def.pressure_floor = 1e-5;  // below that of the tank
    add_tank(def, "P", 104 * kBar), add_tank(def, "A", 100 * kBar), add_tank(def, "B", 64 * kBar);
    add_tank(def, "T", 1e-4), add_tank(def, "C", 16 * kBar), add_tank(def, "D", 7 * kBar);
    valve = &add<SpoolValveDef>(def, "Valve");
    valve->port_p = "P", valve->port_a = "A", valve->port_b = "B", valve->port_t = "T";
    valve->port_c = "C", valve->port_d = "D", valve->step_response = 0.03;
    valve->pa.area = 1e-6, valve->bt.area = 2e-6, valve->pb.area = 3e-6, valve->at.area = 4e-6;
  }
  // values at the position s
  [[nodiscard]] std::vector<double> at(double s) const {
    Problems errors, warnings;
    validate(def, errors, warnings);
    for (const Problem& problem : errors) ADD_FAILURE() << problem.path << ": " << problem.what;
    Circuit circuit(def);
    std::vector<double> y(static_cast<std::size_t>(circuit.state_count())), values(circuit.variables().size());
    circuit.start_at_initial_pressures(y);
    y.back() = s;
    circuit.read_variables(y.data(), values);
    // flow_pa, flow_bt, flow_pb, flow_at, bypass_flow in units of an edge of 1 mm2 at 1 bar
    std::vector<double> flows;
    for (std::size_t i = values.size() - 5; i < values.size(); ++i) {
      flows.push_back(values[i] / (0.67e-6 * std::sqrt(2 * kBar / 870)));
    }
    return flows;
  }
};

void expect_flows(const std::vector<double>& flows, const std::vector<double>& expected) {
  ASSERT_EQ(flows.size(), expected.size());
  for (std::size_t i = 0; i < flows.size(); ++i) EXPECT_NEAR(flows[i], expected[i], 1e-6) << i;
}

TEST(SpoolValve, each_edge_has_its_own_area_and_opens_in_its_direction) {
  const Rig rig;
  // sqrt of the drops: P-A 2, B-T 8, P-B sqrt(40), A-T 10
  expect_flows(rig.at(1), {2, 16, 0, 0, 0});
  expect_flows(rig.at(-1), {0, 0, 3 * std::sqrt(40), 40, 0});
  expect_flows(rig.at(0.25), {0.5, 4, 0, 0, 0});
  expect_flows(rig.at(0), {0, 0, 0, 0, 0});
}

TEST(SpoolValve, overlap_delays_an_edge_and_underlap_opens_it_at_rest) {
  Rig rig;
  rig.valve->pa.overlap = 0.2, rig.valve->bt.overlap = -0.25;
  // (0.6 - 0.2)/0.8 = 0.5; (0.6 + 0.25)/1.25 = 0.68
  expect_flows(rig.at(0.6), {1, 16 * 0.68, 0, 0, 0});
  expect_flows(rig.at(0.1), {0, 16 * 0.28, 0, 0, 0});
  expect_flows(rig.at(0), {0, 16 * 0.2, 0, 0, 0});
  expect_flows(rig.at(-0.25), {0, 0, 0.75 * std::sqrt(40), 10, 0});
}

TEST(SpoolValve, a_curve_states_the_opening_over_the_position) {
  Rig rig;
  rig.def.curves.push_back({.name = "Edge", .points = {{-0.5, 0.1}, {0, 0.2}, {0.5, 0.6}}});
  rig.valve->pa.curve = "Edge";
  for (const auto& [s, x] : {std::pair{-1.0, 0.1}, {-0.25, 0.15}, {0.25, 0.4}, {0.5, 0.6}, {1.0, 0.6}}) {
    EXPECT_NEAR(rig.at(s)[0], 2 * x, 1e-6) << s;
  }
}

TEST(SpoolValve, the_bypass_closes_over_the_travel_to_either_side) {
  Rig rig;
  rig.valve->bypass_area = 10e-6, rig.valve->bypass_closing = 0.1, rig.valve->bypass_closed = 0.5;
  // drop 9 bar: 30 units open
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_NEAR(rig.at(0)[4], 30, 1e-6);
    EXPECT_NEAR(rig.at(0.08 * sign)[4], 30, 1e-6);
    EXPECT_NEAR(rig.at(0.3 * sign)[4], 15, 1e-6);
    EXPECT_NEAR(rig.at(0.5 * sign)[4], 0, 1e-6);
    EXPECT_NEAR(rig.at(sign)[4], 0, 1e-6);
  }
}

TEST(SpoolValve, every_edge_leaks_both_ways) {
  Rig rig;
  rig.valve->leak_flow = 0.67e-6 * std::sqrt(2 * kBar / 870), rig.valve->leak_pressure = 1 * kBar;
  expect_flows(rig.at(0), {4, 64, 40, 100, 0});
}

TEST(SpoolValve, the_spool_follows_its_limited_signal_with_a_lag) {
  Rig rig;
  rig.valve->maximum_control_signal = 500;
  Circuit circuit(rig.def);
  CircuitIntegrator integrator(circuit, rig.def);
  integrator.start({}, {}, {});
  circuit.set_control(0, 700);
  // tau = 10 ms
  for (int k = 1; k <= 30; ++k) {
    integrator.step(1e-3, HeldSpeed(0));
    EXPECT_NEAR(integrator.state().back(), 1 - std::exp(-k / 10.0), 1e-4);
  }
  circuit.set_control(0, -250);
  for (int k = 0; k < 200; ++k) integrator.step(1e-3, HeldSpeed(0));
  EXPECT_NEAR(integrator.state().back(), -0.5, 1e-6);
}

TEST(SpoolValve, openings_below_zero_and_a_bypass_without_travel_are_refused) {
  Rig rig;
  rig.def.curves.push_back({.name = "Edge", .points = {{-1, -0.1}, {1, 1}}});
  rig.def.curves.push_back({.name = "Odd", .points = {{0, 0}, {1, 1}}, .odd = true});
  rig.valve->pa.curve = "Edge", rig.valve->at.curve = "Odd", rig.valve->bypass_closed = 0.1;
  rig.valve->port_b = "A";
  Problems errors, warnings;
  validate(rig.def, errors, warnings);
  ASSERT_EQ(errors.size(), 4u);
  EXPECT_EQ(errors[0].path, "Valve.port_b");
  EXPECT_EQ(errors[1].path, "Valve.curve_pa");
  EXPECT_EQ(errors[1].what, "the curve 'Edge' has negative openings");
  EXPECT_EQ(errors[2].path, "Valve.curve_at");
  EXPECT_EQ(errors[3].path, "Valve.bypass_closed");
}

// per cent or millimetres of the stroke, which the position of -1 to 1 never reaches
TEST(SpoolValve, curves_in_other_units_than_shares_of_the_travel_are_refused) {
  for (const Table& points : {Table{{0, 0}, {100, 20}}, Table{{-7, 1}, {0, 0}}}) {
    Rig rig;
    rig.def.curves.push_back({.name = "Edge", .points = points});
    rig.valve->pa.curve = "Edge";
    Problems errors, warnings;
    validate(rig.def, errors, warnings);
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_EQ(errors[0].path, "Valve.curve_pa");
    EXPECT_NE(errors[0].what.find("the curve 'Edge' goes from"), std::string::npos) << errors[0].what;
  }
}

// a block of 6/3 valves whose bypass is forgotten starves those behind it
TEST(SpoolValve, curves_and_bypass_ports_without_an_area_are_warnings) {
  Rig rig;
  rig.def.curves.push_back({.name = "Edge", .points = {{-1, 0}, {1, 20}}});
  const auto paths = [&] {
    Problems errors, warnings;
    validate(rig.def, errors, warnings);
    EXPECT_TRUE(errors.empty());
    std::string found;
    for (const Problem& warning : warnings) found += warning.path + " ";
    return found;
  };
  rig.valve->pb.curve = "Edge", rig.valve->bypass_area = 1e-6;
  EXPECT_EQ(paths(), "");
  rig.valve->pb.area = 0, rig.valve->bypass_area = 0;
  EXPECT_EQ(paths(), "Valve.curve_pb Valve.port_c Valve.port_d ");
}

// A flow source that fills 1 l of oil without air at B = 1.5e9 Pa: p' = Q B/V.
TEST(FlowSource, fills_a_volume_at_its_flow_whatever_the_pressure) {
  HydraulicsDef def;
  def.entrained_air = 0, def.oil_bulk_modulus = 1.5e9;
  add_tank(def, "Tank", 1e5), add_volume(def, "Vessel", 1e5).rigid_volume = 1e-3;
  FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
  source.port_1 = "Tank", source.port_2 = "Vessel", source.flow = 1e-6, source.flow_per_signal = 2e-6;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const double start = integrator.state()[1];
  for (int k = 0; k < 100; ++k) integrator.step(1e-2, HeldSpeed(0));
  EXPECT_NEAR(integrator.state()[1] - start, 1e-6 * 1.5e12, 1);
  circuit.set_control(0, 1.5);
  for (int k = 0; k < 100; ++k) integrator.step(1e-2, HeldSpeed(0));
  EXPECT_NEAR(integrator.state()[1] - start, 5e-6 * 1.5e12, 1);
}

TEST(FlowSource, without_a_relief_on_its_line_is_warned_about) {
  HydraulicsDef def;
  add_tank(def, "Tank", 1e5), add_volume(def, "Vessel", 1e5).rigid_volume = 1e-3;
  FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
  source.port_1 = "Tank", source.port_2 = "Vessel", source.flow = 1e-4;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].path, "Source.flow");
  EXPECT_EQ(
      warnings[0].what,
      "no relief valve leads from the pump's line to a tank: where 'Vessel' is closed off, its pressure rises without "
      "limit");
}

// C p' = G (p_s - p): the volume follows with the time constant C/G.
TEST(PressureSource, charges_a_volume_through_its_resistance) {
  HydraulicsDef def;
  def.entrained_air = 0, def.oil_bulk_modulus = 1.5e9, def.start = StartState::table13;
  add_volume(def, "Vessel", 10e5).rigid_volume = 3e-3;
  PressureSourceDef& source = add<PressureSourceDef>(def, "Source");
  source.port_1 = "Vessel", source.set_pressure = 60e5, source.pressure_per_signal = 1e5, source.nominal_flow = 1e-5;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const double tau = 3e-3 / 1.5e9 / 1e-10;
  circuit.set_control(0, 50);
  for (int k = 1; k <= 100; ++k) {
    integrator.step(1e-3, HeldSpeed(0));
    EXPECT_NEAR(integrator.state()[0], 110e5 - 100e5 * std::exp(-k * 1e-3 / tau), 2e3) << k;
  }
  // an absolute pressure is not negative
  circuit.set_control(0, -100);
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  EXPECT_EQ(values[values.size() - 2], 0);
}

}  // namespace spool_valve_test
}  // namespace slew::hydraulics::test
