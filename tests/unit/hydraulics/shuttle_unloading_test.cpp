// SPDX-License-Identifier: Apache-2.0
// Shuttle valve, flushing valve and unloading valve by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "hydraulics/components/accumulator.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/components/flushing_valve.h"
#include "hydraulics/components/restrictions.h"
#include "hydraulics/components/shuttle_valve.h"
#include "hydraulics/components/sources.h"
#include "hydraulics/components/unloading_valve.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace shuttle_unloading_test {

// 20 l/min at 5 bar, 0.2 bar to switch; a load at 60 bar.
CircuitRig shuttle_between(double inlet_1, double inlet_2, double load) {
  CircuitRig rig;
  rig.def.orifice_transition = 10, rig.def.start = StartState::table13;
  add_tank(rig.def, "One", inlet_1), add_tank(rig.def, "Two", inlet_2), add_tank(rig.def, "Load", load);
  ShuttleValveDef& valve = add<ShuttleValveDef>(rig.def, "Shuttle");
  valve.port_1 = "One", valve.port_2 = "Two", valve.port_3 = "Load", valve.nominal_flow = 20 * kLitrePerMinute;
  return rig;
}

TEST(ShuttleValve, connects_its_outlet_to_the_higher_inlet_alone) {
  for (const auto& [one, two, load, flow_1, flow_2] : {std::tuple{80.0, 65.0, 60.0, 40.0, 0.0},
                                                       {65.0, 80.0, 60.0, 0.0, 40.0},
                                                       {80.0, 20.0, 100.0, -40.0, 0.0}}) {  // back to the higher inlet
    CircuitRig rig = shuttle_between(one * kBar, two * kBar, load * kBar);
    EXPECT_NEAR(rig.variable("Shuttle.flow_1"), flow_1 * kLitrePerMinute, 1e-5 * kLitrePerMinute);
    EXPECT_NEAR(rig.variable("Shuttle.flow_2"), flow_2 * kLitrePerMinute, 1e-5 * kLitrePerMinute);
    EXPECT_EQ(rig.variable("Shuttle.position"), one > two ? 1 : 0);
  }
}

TEST(ShuttleValve, of_equal_inlets_stands_in_the_middle) {
  CircuitRig rig = shuttle_between(65 * kBar, 65 * kBar, 60 * kBar);
  EXPECT_EQ(rig.variable("Shuttle.position"), 0.5);
  EXPECT_NEAR(rig.variable("Shuttle.flow_1"), 10 * kLitrePerMinute, 1e-5 * kLitrePerMinute);
  EXPECT_NEAR(rig.variable("Shuttle.flow_2"), 10 * kLitrePerMinute, 1e-5 * kLitrePerMinute);
}

// Both lines rest at one pressure when the first one rises. Oil that flowed through the outlet into the second line,
// which is closed, would take that along and keep the ball between the seats.
TEST(ShuttleValve, leaves_a_closed_line_alone_while_the_other_line_rises) {
  CircuitRig rig;
  rig.def.start = StartState::table13;
  add_tank(rig.def, "Tank", kBar);
  for (const char* name : {"One", "Two", "Out"}) add_volume(rig.def, name, 20 * kBar).rigid_volume = 0.5e-3;
  FlowSourceDef& source = add<FlowSourceDef>(rig.def, "Source");
  source.port_1 = "Tank", source.port_2 = "One", source.flow = 0.5 * kLitrePerMinute;
  OrificeDef& consumer = add<OrificeDef>(rig.def, "Consumer");
  consumer.port_1 = "Out", consumer.port_2 = "Tank", consumer.diameter = 2e-4;
  ShuttleValveDef& valve = add<ShuttleValveDef>(rig.def, "Shuttle");
  valve.port_1 = "One", valve.port_2 = "Two", valve.port_3 = "Out", valve.nominal_flow = 20 * kLitrePerMinute;
  rig.run(1);
  EXPECT_GT(rig.variable("One.pressure"), 40 * kBar);
  EXPECT_NEAR(rig.variable("Out.pressure"), rig.variable("One.pressure"), kBar);
  EXPECT_NEAR(rig.variable("Two.pressure"), 20 * kBar, 0.2 * kBar);
  EXPECT_EQ(rig.variable("Shuttle.position"), 1);
}

// 20 l/min at 5 bar; edges open from 5 to 10 bar between the sides.
TEST(FlushingValve, takes_oil_of_the_lower_side_alone) {
  for (const auto& [one, two, flow_1, flow_2] : {std::tuple{25.0, 220.0, 20.0, 0.0},  // 5 bar to the outlet
                                                 {220.0, 25.0, 0.0, 20.0},
                                                 {25.0, 29.0, 0.0, 0.0},       // shut in the middle
                                                 {25.0, 32.5, 10.0, 0.0},      // half open
                                                 {40.0, 400.0, 40.0, 0.0}}) {  // 20 bar
    CircuitRig rig;
    rig.def.orifice_transition = 10, rig.def.start = StartState::table13;
    add_tank(rig.def, "One", one * kBar), add_tank(rig.def, "Two", two * kBar), add_tank(rig.def, "Out", 20 * kBar);
    FlushingValveDef& valve = add<FlushingValveDef>(rig.def, "Flushing");
    valve.port_1 = "One", valve.port_2 = "Two", valve.port_3 = "Out", valve.nominal_flow = 20 * kLitrePerMinute;
    EXPECT_NEAR(rig.variable("Flushing.flow_1"), flow_1 * kLitrePerMinute, 1e-4 * kLitrePerMinute) << one << two;
    EXPECT_NEAR(rig.variable("Flushing.flow_2"), flow_2 * kLitrePerMinute, 1e-4 * kLitrePerMinute) << one << two;
  }
}

// A pump of 20 l/min charges an accumulator over a check valve, a consumer empties it.
class Charging : public CircuitRig {
 public:
  Charging() {
    def.start = StartState::table13;
    add_tank(def, "Tank");
    add_volume(def, "Pump", 61 * kBar).rigid_volume = 2e-4;
    add_volume(def, "Store", 61 * kBar).rigid_volume = 1e-4;
    FlowSourceDef& pump = add<FlowSourceDef>(def, "Source");
    pump.port_1 = "Tank", pump.port_2 = "Pump", pump.flow = 20 * kLitrePerMinute;
    CheckValveDef& check = add<CheckValveDef>(def, "Check");
    check.port_1 = "Pump", check.port_2 = "Store", check.common.nominal_flow = 40 * kLitrePerMinute;
    AccumulatorDef& store = add<AccumulatorDef>(def, "Accumulator");
    store.port_1 = "Store", store.gas_volume = 2e-3, store.precharge_pressure = 50 * kBar;
    store.nominal_flow = 100 * kLitrePerMinute;
    OrificeDef& consumer = add<OrificeDef>(def, "Consumer");
    consumer.port_1 = "Store", consumer.port_2 = "Tank", consumer.diameter = 1e-3;
    UnloadingValveDef& valve = add<UnloadingValveDef>(def, "Unloading");
    valve.port_1 = "Pump", valve.port_2 = "Tank", valve.port_3 = "Store";
    valve.cut_out_pressure = 120 * kBar, valve.cut_in_pressure = 90 * kBar;
    valve.nominal_flow = 40 * kLitrePerMinute;
  }
  double store() { return variable("Store.pressure") - 1 * kBar; }
};

TEST(UnloadingValve, charges_to_its_cut_out_and_again_from_its_cut_in_pressure) {
  Charging rig;
  double highest = 0, lowest = 1e9;
  int openings = 0;
  bool was_open = false;
  for (int k = 0; k < 6000; ++k) {
    rig.run(5e-3);
    const bool is_open = rig.variable("Unloading.opening") > 0.5;
    openings += is_open && !was_open ? 1 : 0;
    was_open = is_open;
    if (openings > 0) highest = std::fmax(highest, rig.store()), lowest = std::fmin(lowest, rig.store());
    if (is_open && rig.variable("Unloading.opening") > 0.999) {
      // the pump runs at 20 l/min through a valve that takes 40 at 5 bar
      EXPECT_NEAR(rig.variable("Pump.pressure") - 1 * kBar, 5 * kBar / 4, 0.5 * kBar);
    }
  }
  EXPECT_GT(openings, 2);
  // the snap takes some step responses, in which the consumer's or the pump's flow goes on
  EXPECT_NEAR(highest, 120 * kBar, 3 * kBar);
  EXPECT_NEAR(lowest, 90 * kBar, 3 * kBar);
}

TEST(UnloadingValve, that_would_shut_above_its_cut_out_pressure_is_refused) {
  Charging rig;
  auto& valve = dynamic_cast<UnloadingValveDef&>(*rig.def.components.back());
  valve.cut_in_pressure = 130 * kBar;
  Problems errors, warnings;
  validate(rig.def, errors, warnings);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].path, "Unloading.cut_in_pressure");
}

}  // namespace shuttle_unloading_test
}  // namespace slew::hydraulics::test
