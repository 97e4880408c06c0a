// SPDX-License-Identifier: Apache-2.0
// Priority valve: 80 l/min at 5 bar on either edge, 7 bar of spring, 2 bar of regulation.
#include "hydraulics/components/priority_valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "hydraulics/components/compensated_orifice.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace priority_valve_test {

constexpr double kDemand = 20 * kLitrePerMinute;

struct Result {
  double priority, rest;  // m3/s
  double margin;          // Pa, priority line above its load
};

// A steering unit that demands 20 l/min at its load, an implement at another load, a pump of a given flow.
Result run(double pump_flow, double steering_load, double implement_load, double opening = 1) {
  CircuitRig rig;
  HydraulicsDef& def = rig.def;
  def.orifice_transition = 10, def.start = StartState::table13;
  add_tank(def, "Tank", 1 * kBar), add_tank(def, "Steering", 1 * kBar + steering_load);
  add_tank(def, "Implement", 1 * kBar + implement_load);
  add_volume(def, "Pump", 1 * kBar).rigid_volume = 5e-4;
  add_volume(def, "Priority", 1 * kBar).rigid_volume = 2e-4;
  FlowSourceDef& pump = add<FlowSourceDef>(def, "Source");
  pump.port_1 = "Tank", pump.port_2 = "Pump", pump.flow = pump_flow;
  CompensatedOrificeDef& steering = add<CompensatedOrificeDef>(def, "Unit");
  steering.port_p = "Priority", steering.port_a = "Steering", steering.port_t = "Tank";
  steering.compensator_pressure = 5 * kBar, steering.opening = opening;
  steering.area = kDemand / (0.67 * std::sqrt(2 * 5 * kBar / def.oil_density));
  PriorityValveDef& valve = add<PriorityValveDef>(def, "Valve");
  valve.port_1 = "Pump", valve.port_2 = "Priority", valve.port_3 = "Implement", valve.port_t = "Tank";
  valve.ls_port = "Unit", valve.nominal_flow = 80 * kLitrePerMinute;
  rig.run(3);
  return {rig.variable("Valve.priority_flow"), rig.variable("Valve.flow"),
          rig.variable("Priority.pressure") - 1 * kBar - steering_load};
}

// Whichever load is higher, the steering has its 20 l/min and the implement the rest.
TEST(PriorityValve, its_line_gets_its_demand_whatever_the_loads) {
  for (const double litres : {30.0, 60.0}) {
    for (const auto& [steering, implement] : {std::pair{80.0, 20.0}, {20.0, 150.0}, {100.0, 100.0}}) {
      const double pump = litres * kLitrePerMinute;
      const Result flows = run(pump, steering * kBar, implement * kBar);
      EXPECT_NEAR(flows.priority, kDemand, 2e-3 * kDemand) << litres << " " << steering << " " << implement;
      EXPECT_NEAR(flows.rest, pump - kDemand, 5e-3 * pump) << litres << " " << steering << " " << implement;
      EXPECT_GT(flows.margin, 7 * kBar) << steering;
      EXPECT_LT(flows.margin, 9 * kBar) << steering;
    }
  }
}

TEST(PriorityValve, of_too_small_a_pump_it_gives_everything_to_its_line) {
  const double pump = 12 * kLitrePerMinute;
  const Result flows = run(pump, 80 * kBar, 20 * kBar);
  EXPECT_NEAR(flows.priority, pump, 1e-3 * pump);
  EXPECT_NEAR(flows.rest, 0, 1e-3 * pump);
}

TEST(PriorityValve, without_demand_all_oil_goes_to_the_other_line) {
  const double pump = 60 * kLitrePerMinute;
  const Result flows = run(pump, 0, 120 * kBar, 0);
  EXPECT_NEAR(flows.priority, 0, 1e-3 * pump);
  EXPECT_NEAR(flows.rest, pump, 1e-3 * pump);
}

TEST(PriorityValve, of_one_volume_at_two_ports_is_refused) {
  HydraulicsDef def;
  add_tank(def, "A"), add_tank(def, "T");
  PriorityValveDef& valve = add<PriorityValveDef>(def, "Valve");
  valve.port_1 = "T", valve.port_2 = "A", valve.port_3 = "A", valve.port_t = "T", valve.nominal_flow = 1e-3;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].path, "Valve.port_3");
}

}  // namespace priority_valve_test
}  // namespace slew::hydraulics::test
