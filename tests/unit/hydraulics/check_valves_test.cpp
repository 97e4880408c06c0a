// SPDX-License-Identifier: Apache-2.0
// Laws of the check valves at numbers worked out by hand, and their own rules.
#include "hydraulics/components/check_valves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hydraulics/circuit.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace check_valves_test {

// Pressures of four volumes and the valve between them; K = 1e-3 m3/s at 4 bar.
struct Rig {
  HydraulicsDef def;

  Rig(double p_1, double p_2, double p_3 = 1e5, double p_4 = 1e5) {
    def.orifice_transition = 1;
    add_tank(def, "P1", p_1), add_tank(def, "P2", p_2), add_tank(def, "P3", p_3), add_tank(def, "P4", p_4);
  }
  static void set(CheckParameters& common) {
    common.nominal_flow = 1e-3, common.nominal_pressure_drop = 4 * kBar;
    common.crack_pressure = 0.5 * kBar, common.opening_pressure_rise = 1 * kBar;
  }
  [[nodiscard]] double variable(const std::string& name) const {
    Problems errors, warnings;
    validate(def, errors, warnings);
    for (const Problem& problem : errors) ADD_FAILURE() << problem.path << ": " << problem.what;
    Circuit circuit(def);
    std::vector<double> y(static_cast<std::size_t>(circuit.state_count())), values(circuit.variables().size());
    circuit.start_at_initial_pressures(y);
    circuit.read_variables(y.data(), values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (circuit.variables()[i].name == name) return values[i];
    }
    ADD_FAILURE() << name;
    return 0;
  }
};

double check_flow(double drop_bar, const std::string& quantity = "flow") {
  Rig rig((200 + drop_bar) * kBar, 200 * kBar);
  CheckValveDef& valve = add<CheckValveDef>(rig.def, "Valve");
  valve.port_1 = "P1", valve.port_2 = "P2", Rig::set(valve.common);
  return rig.variable("Valve." + quantity);
}

TEST(CheckValve, passes_oil_one_way_above_its_crack_pressure) {
  EXPECT_EQ(check_flow(-100), 0);
  EXPECT_EQ(check_flow(0.5), 0);
  // half open at 1 bar: 0.5 x 1e-3 sqrt(1/4)
  EXPECT_NEAR(check_flow(1), 2.5e-4, 1e-9);
  EXPECT_NEAR(check_flow(1, "opening"), 0.5, 1e-9);
  // fully open from 1.5 bar on: its nominal flow at 4 bar, twice that at 16 bar
  EXPECT_NEAR(check_flow(4), 1e-3, 1e-9);
  EXPECT_NEAR(check_flow(16), 2e-3, 1e-9);
}

double throttled_flow(double drop_bar, double opening) {
  Rig rig((20 + drop_bar) * kBar, 20 * kBar);
  ThrottleCheckValveDef& valve = add<ThrottleCheckValveDef>(rig.def, "Valve");
  valve.port_1 = "P1", valve.port_2 = "P2", Rig::set(valve.common);
  valve.throttle_flow = 2e-4, valve.throttle_opening = opening;
  return rig.variable("Valve.flow");
}

TEST(ThrottleCheckValve, throttles_one_way_and_adds_its_throttle_the_other_way) {
  EXPECT_NEAR(throttled_flow(-4, 1), -2e-4, 1e-9);
  EXPECT_NEAR(throttled_flow(-16, 0.5), -2e-4, 1e-9);
  EXPECT_EQ(throttled_flow(-16, 0), 0);
  EXPECT_NEAR(throttled_flow(4, 0.5), 1e-3 + 1e-4, 1e-9);
}

// load of 101 bar on port 2 against 1 bar, pilot ratio 4
double piloted_opening(double pilot_bar, const char* drain) {
  Rig rig(1 * kBar, 101 * kBar, pilot_bar * kBar, 11 * kBar);
  PilotCheckValveDef& valve = add<PilotCheckValveDef>(rig.def, "Valve");
  valve.port_1 = "P1", valve.port_2 = "P2", valve.port_3 = "P3", valve.port_4 = drain;
  valve.pilot_ratio = 4, Rig::set(valve.common);
  const double opening = rig.variable("Valve.opening"), flow = rig.variable("Valve.flow");
  EXPECT_NEAR(flow, -opening * 1e-3 * std::sqrt(100 / 4.0), 1e-9);
  return opening;
}

TEST(PilotCheckValve, opens_against_its_load_at_the_pressure_of_the_balance_of_forces) {
  // (p_x - 1) 4 = 100 + 0.5: from 26.125 bar on; half open 0.125 bar above
  EXPECT_EQ(piloted_opening(26.125, ""), 0);
  EXPECT_NEAR(piloted_opening(26.25, ""), 0.5, 1e-9);
  EXPECT_EQ(piloted_opening(26.5, ""), 1);
  // behind the piston the drain's 11 bar in place of 1 bar
  EXPECT_EQ(piloted_opening(36.125, "P4"), 0);
  EXPECT_NEAR(piloted_opening(36.25, "P4"), 0.5, 1e-9);
}

TEST(PilotCheckValve, its_pilot_piston_never_pulls) {
  // free flow from port 1 at 4 bar, whatever the pilot pressure below p_1
  for (const double pilot : {1.0, 50.0, 100.0}) {
    Rig rig(104 * kBar, 100 * kBar, pilot * kBar);
    PilotCheckValveDef& valve = add<PilotCheckValveDef>(rig.def, "Valve");
    valve.port_1 = "P1", valve.port_2 = "P2", valve.port_3 = "P3", Rig::set(valve.common);
    EXPECT_NEAR(rig.variable("Valve.flow"), 1e-3, 1e-9) << pilot;
  }
}

TEST(DoublePilotCheckValve, pressure_in_one_line_opens_the_other) {
  // line A at 41 bar feeds its load at 37 bar; the other load has 101 bar behind a return line of 1 bar
  Rig rig(41 * kBar, 37 * kBar, 1 * kBar, 101 * kBar);
  DoublePilotCheckValveDef& lock = add<DoublePilotCheckValveDef>(rig.def, "Lock");
  lock.port_a1 = "P1", lock.port_a2 = "P2", lock.port_b1 = "P3", lock.port_b2 = "P4";
  lock.pilot_ratio = 4, Rig::set(lock.common);
  EXPECT_NEAR(rig.variable("Lock.flow_a"), 1e-3, 1e-9);
  // 40 x 4 > 100.5
  EXPECT_EQ(rig.variable("Lock.opening_b"), 1);
  EXPECT_NEAR(rig.variable("Lock.flow_b"), -5e-3, 1e-9);
  // 40 x 2 < 100.5
  lock.pilot_ratio = 2;
  EXPECT_EQ(rig.variable("Lock.flow_b"), 0);
}

std::string first_error(const HydraulicsDef& def) {
  Problems errors, warnings;
  validate(def, errors, warnings);
  return errors.empty() ? "" : errors.front().path + ": " + errors.front().what;
}

TEST(CheckValve, a_nominal_drop_below_the_full_opening_is_refused) {
  Rig rig(1e5, 1e5);
  CheckValveDef& valve = add<CheckValveDef>(rig.def, "Valve");
  valve.port_1 = "P1", valve.port_2 = "P2", Rig::set(valve.common);
  valve.common.nominal_pressure_drop = 1.5 * kBar;
  EXPECT_EQ(first_error(rig.def), "");
  valve.common.nominal_pressure_drop = 1.4 * kBar;
  EXPECT_EQ(first_error(rig.def),
            "Valve.nominal_pressure_drop: at this drop the valve is not fully open: it is from 1.5 bar on");
}

TEST(CheckValve, one_volume_on_two_ports_is_refused) {
  Rig rig(1e5, 1e5);
  CheckValveDef& valve = add<CheckValveDef>(rig.def, "Valve");
  valve.port_1 = valve.port_2 = "P1", Rig::set(valve.common);
  EXPECT_EQ(first_error(rig.def), "Valve.port_2: it is connected to 'P1' as the port before it");
  DoublePilotCheckValveDef& lock = add<DoublePilotCheckValveDef>(rig.def, "Lock");
  valve.port_2 = "P2";
  lock.port_a1 = lock.port_b1 = "P1", lock.port_a2 = "P2", lock.port_b2 = "P3", Rig::set(lock.common);
  EXPECT_EQ(first_error(rig.def), "Lock.port_b1: it is connected to 'P1' as the port before it");
}

// flow of the pump's line reaches a relief valve through a check valve, not against it
TEST(CheckValve, connects_a_pumps_line_in_its_free_direction_only) {
  for (const bool is_reversed : {false, true}) {
    HydraulicsDef def = crane_circuit();
    add_volume(def, "Vol_Behind").rigid_volume = 1e-3;
    CheckValveDef& check = add<CheckValveDef>(def, "Check");
    check.port_1 = "Vol_MainPump", check.port_2 = "Vol_Behind";
    if (is_reversed) std::swap(check.port_1, check.port_2);
    check.common.nominal_flow = 5e-3;
    for (auto& component : def.components) {
      if (component->name == "PRV_MainPump") {
        auto& relief = dynamic_cast<ReliefValveDef&>(*component);
        relief.port_1 = relief.port_3 = "Vol_Behind";
      }
    }
    Problems errors, warnings;
    validate(def, errors, warnings);
    ASSERT_TRUE(errors.empty());
    const bool is_warned = std::any_of(warnings.begin(), warnings.end(),
                                       [](const Problem& problem) { return problem.path == "MainPump.port_a"; });
    EXPECT_EQ(is_warned, is_reversed);
  }
}

}  // namespace check_valves_test
}  // namespace slew::hydraulics::test
