// SPDX-License-Identifier: Apache-2.0
// Pressure-reducing valve by hand: 20 l/min at 10 bar fully open, 2 bar from closed to open.
#include "hydraulics/components/reducing_valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "hydraulics/components/sources.h"
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

// An outlet that holds its setting runs back into a supply that is gone: within 9 to 27 ms, of 1 l 0.35 s, by the same
// equations apart (scipy, LSODA at rtol 1e-10), whatever the solver.
TEST(ReducingValve, gives_its_outlet_back_to_a_supply_that_is_gone) {
  for (const Solver solver : {Solver::rodas3, Solver::implicit_euler, Solver::cvode}) {
    for (const double setting_bar : {3.0, 24.0, 59.0}) {
      for (const double outlet : {1e-5, 6e-5, 1e-3}) {
        CircuitRig rig;
        rig.def.solver = solver, rig.def.start = StartState::table13;
        rig.def.relative_tolerance = 1e-6, rig.def.max_substep = 1e-5;
        add_tank(rig.def, "Drain", 1 * kBar);
        add_volume(rig.def, "Supply", 1 * kBar).rigid_volume = 5e-5;
        add_volume(rig.def, "Outlet", 1 * kBar).rigid_volume = outlet;
        PressureSourceDef& source = add<PressureSourceDef>(rig.def, "Source");
        source.port_1 = "Supply", source.set_pressure = 60 * kBar, source.nominal_flow = 10 * kLitrePerMinute;
        ReducingValveDef& valve = add<ReducingValveDef>(rig.def, "Valve");
        valve.port_1 = "Supply", valve.port_2 = "Outlet", valve.port_3 = "Drain";
        valve.setting_pressure = setting_bar * kBar, valve.nominal_flow = 10 * kLitrePerMinute;
        rig.run(2);
        EXPECT_NEAR(rig.variable("Outlet.pressure") / kBar, setting_bar + 1, 0.01) << setting_bar << " " << outlet;
        rig.set("Source.set_pressure", 1 * kBar);
        rig.run(0.01);
        if (setting_bar == 24 && outlet == 6e-5) {
          const double bound = solver == Solver::implicit_euler ? 0.02 : 0.005;
          EXPECT_NEAR(rig.variable("Outlet.pressure") / kBar, 2.3373, bound);
        }
        rig.run(0.09 + 1e3 * outlet);
        EXPECT_NEAR(rig.variable("Outlet.pressure") / kBar, 1, 0.01) << setting_bar << " " << outlet;
      }
    }
  }
}

// The closed outlet at its setting costs 4 ml/min of 10 l/min at 60 bar: the leak of its lands.
TEST(ReducingValve, leaks_little_in_its_middle) {
  Rig rig(31 * kBar, true);
  rig.run(0, 2);
  const double root = 20 * std::sqrt(170.0 / 10), drain = 20 * std::sqrt(30.0 / 10);  // l/min, open edges
  const double leak = rig.variable("Valve.flow") / kLitrePerMinute;
  EXPECT_NEAR(leak, rig.variable("Valve.drain_flow") / kLitrePerMinute, 1e-6);
  // (w + y)^2 root = (w - y)^2 drain, over 4 w, with w = 1e-3
  const double ratio = std::sqrt(drain / root), open = 2e-3 * ratio / (1 + ratio);
  EXPECT_NEAR(leak, open * open / 4e-3 * root, 1e-3 * leak);
  EXPECT_LT(leak, 0.02);
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
