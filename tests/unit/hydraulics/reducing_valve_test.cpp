// SPDX-License-Identifier: Apache-2.0
// Pressure-reducing valve by hand: 20 l/min at 10 bar fully open, 2 bar from closed to open.
#include "hydraulics/components/reducing_valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace reducing_valve_test {

constexpr double kSet = 30 * kBar;

class Rig : public CircuitRig {
 public:
  // The outlet is held at `outlet`, or closed at that pressure.
  Rig(double outlet, bool is_closed) {
    def.orifice_transition = 10, def.start = StartState::table13;
    add_tank(def, "Supply", 201 * kBar), add_tank(def, "Drain", 1 * kBar);
    if (is_closed) {
      add_volume(def, "Outlet", outlet).rigid_volume = 1e-4;
    } else {
      add_tank(def, "Outlet", outlet);
    }
    ReducingValveDef& valve = add<ReducingValveDef>(def, "Valve");
    valve.port_1 = "Supply", valve.port_2 = "Outlet", valve.port_3 = "Drain";
    valve.setting_pressure = kSet, valve.pressure_per_signal = 10 * kBar;
    valve.nominal_flow = 20 * kLitrePerMinute;
  }
  void run(double signal, double seconds) {
    set_signal("Valve", signal);
    CircuitRig::run(seconds);
  }
};

// Half a bar per quarter of the travel, on either side.
TEST(ReducingValve, opens_to_the_supply_below_its_setting_and_to_the_drain_above) {
  for (const auto& [below_bar, position] : {std::pair{1.0, 0.5}, {0.5, 0.25}, {-1.0, -0.5}}) {
    Rig rig(1 * kBar + kSet - below_bar * kBar, false);
    rig.run(0, 0.3);
    EXPECT_NEAR(rig.variable("Valve.spool_position"), position, 1e-4) << below_bar;
    const double supply = position > 0 ? position * 20 * std::sqrt((170 + below_bar) / 10) : 0;
    const double drain = position < 0 ? -position * 20 * std::sqrt((30 - below_bar) / 10) : 0;
    EXPECT_NEAR(rig.variable("Valve.flow") / kLitrePerMinute, supply, 1e-3 * (supply + 1)) << below_bar;
    EXPECT_NEAR(rig.variable("Valve.drain_flow") / kLitrePerMinute, drain, 1e-3 * (drain + 1)) << below_bar;
  }
}

TEST(ReducingValve, fills_and_relieves_a_closed_line_to_its_setting) {
  for (const double start_bar : {2.0, 80.0}) {
    Rig rig(start_bar * kBar, true);
    rig.run(0, 1);
    EXPECT_NEAR(rig.variable("Outlet.pressure") - 1 * kBar, kSet, 0.05 * kBar) << start_bar;
    EXPECT_NEAR(rig.variable("Valve.flow"), 0, 0.02 * kLitrePerMinute) << start_bar;
  }
}

TEST(ReducingValve, follows_its_signal_and_never_below_the_drain) {
  Rig rig(31 * kBar, true);
  rig.run(2, 1);
  EXPECT_EQ(rig.variable("Valve.set_pressure"), 50 * kBar);
  EXPECT_NEAR(rig.variable("Outlet.pressure"), 51 * kBar, 0.05 * kBar);
  rig.run(-5, 2);
  EXPECT_EQ(rig.variable("Valve.set_pressure"), 0);
  EXPECT_NEAR(rig.variable("Outlet.pressure"), 1 * kBar, 0.1 * kBar);
}

TEST(ReducingValve, of_one_volume_at_two_ports_is_refused) {
  HydraulicsDef def;
  add_tank(def, "A"), add_tank(def, "B");
  ReducingValveDef& valve = add<ReducingValveDef>(def, "Valve");
  valve.port_1 = "A", valve.port_2 = "A", valve.port_3 = "A", valve.nominal_flow = 1e-4;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].path, "Valve.port_2");
  EXPECT_EQ(errors[1].path, "Valve.port_3");
}

}  // namespace reducing_valve_test
}  // namespace slew::hydraulics::test
