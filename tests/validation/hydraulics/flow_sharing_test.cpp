// SPDX-License-Identifier: Apache-2.0
// Post-compensated sections: two metering edges in the ratio 2:1 on loads of 150 and 60 bar share what the pump has.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "hydraulics/components/ls_shuttle.h"
#include "hydraulics/components/post_compensator.h"
#include "hydraulics/components/restrictions.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"
#include "tests/support/circuit_rig.h"

namespace slew::hydraulics::test {
namespace flow_sharing_test {

constexpr double kLoads[] = {150 * kBar, 60 * kBar};
constexpr double kEdges[] = {40 * kLitrePerMinute, 20 * kLitrePerMinute};  // at 10 bar
constexpr double kSpring = 1 * kBar, kRegulation = 3 * kBar;

void add_section(HydraulicsDef& def, int i) {
  const std::string n = std::to_string(i + 1);
  add_volume(def, "Metered_" + n, kLoads[i]).rigid_volume = 1e-4;
  add_tank(def, "Load_" + n, kLoads[i]);
  BleedDef& edge = add<BleedDef>(def, "Edge_" + n);
  edge.port_1 = "Pump", edge.port_2 = "Metered_" + n, edge.nominal_flow = kEdges[i];
  edge.nominal_pressure_drop = 10 * kBar;
  PostCompensatorDef& compensator = add<PostCompensatorDef>(def, "Compensator_" + n);
  compensator.port_1 = "Metered_" + n, compensator.port_2 = "Load_" + n, compensator.port_t = "Tank";
  compensator.shared_ls = "Shuttle", compensator.nominal_flow = 80 * kLitrePerMinute;
  compensator.spring_pressure = kSpring, compensator.regulation_pressure = kRegulation;
}

// A pump of a given flow, all of which goes through the sections.
std::array<double, 2> flows_of(double pump_flow) {
  CircuitRig rig;
  HydraulicsDef& def = rig.def;
  def.orifice_transition = 10, def.start = StartState::table13;
  add_tank(def, "Tank", 1 * kBar);
  add_volume(def, "Pump", kLoads[0]).rigid_volume = 1e-3;
  FlowSourceDef& pump = add<FlowSourceDef>(def, "Source");
  pump.port_1 = "Tank", pump.port_2 = "Pump", pump.flow = pump_flow;
  for (int i : {0, 1}) add_section(def, i);
  LsShuttleDef& shuttle = add<LsShuttleDef>(def, "Shuttle");
  shuttle.port_1 = "Compensator_1", shuttle.port_2 = "Compensator_2";
  rig.run(3);
  return {rig.variable("Compensator_1.flow"), rig.variable("Compensator_2.flow")};
}

// Steady flow of a section at the pressure behind the pump, from the equations by bisection of the opening u:
// edge flow at p_1 = p_LS + spring + regulation u equals u K root(p_1 - load).
double section_flow(int i, double pump_pressure) {
  const double shared = kLoads[0];  // absolute: the tank is the reference of all
  double low = 0, high = 1;
  for (int k = 0; k < 60; ++k) {
    const double u = 0.5 * (low + high), p_1 = shared + kSpring + kRegulation * u;
    const double in = kEdges[i] * std::sqrt(std::fmax(0, pump_pressure - p_1) / (10 * kBar));
    const double out = u * 80 * kLitrePerMinute * std::sqrt((p_1 - kLoads[i]) / (5 * kBar));
    (in > out ? low : high) = u;
  }
  const double p_1 = shared + kSpring + kRegulation * low;
  return kEdges[i] * std::sqrt(std::fmax(0, pump_pressure - p_1) / (10 * kBar));
}

TEST(ValidationFlowSharing, what_the_pump_has_is_shared_as_the_edges_demand) {
  for (const double litres : {60.0, 45.0, 30.0, 15.0}) {
    const double pump_flow = litres * kLitrePerMinute;
    const std::array<double, 2> flows = flows_of(pump_flow);
    EXPECT_NEAR(flows[0] + flows[1], pump_flow, 1e-4 * pump_flow);
    // the pressure behind the pump at which both sections together take its flow
    double low = kLoads[0], high = kLoads[0] + 100 * kBar;
    for (int k = 0; k < 60; ++k) {
      const double p = 0.5 * (low + high);
      (section_flow(0, p) + section_flow(1, p) < pump_flow ? low : high) = p;
    }
    EXPECT_NEAR(flows[0], section_flow(0, low), 2e-3 * pump_flow) << litres;
    EXPECT_NEAR(flows[1], section_flow(1, low), 2e-3 * pump_flow) << litres;
    // two to one while the drops over the edges are large against the regulation of the compensators, of which the one
    // at the high load is far more open
    if (litres > 40) {
      EXPECT_NEAR(flows[0] / flows[1], 2, 0.3) << litres;
    }
  }
}

}  // namespace flow_sharing_test
}  // namespace slew::hydraulics::test
