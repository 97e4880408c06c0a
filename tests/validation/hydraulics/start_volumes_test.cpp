// SPDX-License-Identifier: Apache-2.0
// Equilibrium start of volumes beside an actuator's: oil at rest has one pressure on both sides of an open passage.
#include <gtest/gtest.h>

#include <numbers>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/accumulator.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/flow_divider.h"
#include "hydraulics/components/hose_burst_valve.h"
#include "hydraulics/components/line.h"
#include "hydraulics/components/pump.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/restrictions.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace start_volumes_test {

constexpr double kForce = 20e3, kReturn = 5e5;               // N, Pa absolute
constexpr double kA = std::numbers::pi / 4 * 0.063 * 0.063;  // m2
constexpr double kB = kA - std::numbers::pi / 4 * 0.036 * 0.036;
constexpr double kHeld = (kForce + kReturn * kB) / kA;  // Pa absolute, by the balance of the piston

// A cylinder on A and B, further volumes, a tank.
HydraulicsDef cylinder_and(std::initializer_list<const char*> volumes) {
  HydraulicsDef def;
  for (const char* name : {"A", "B"}) add_volume(def, name).rigid_volume = 1e-3;
  for (const char* name : volumes) add_volume(def, name).rigid_volume = 1e-4;
  add_volume(def, "T").fixed = true;
  DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
  cylinder.common.force = "Force", cylinder.common.port_a = "A", cylinder.common.port_b = "B";
  cylinder.common.piston_diameter = 0.063, cylinder.rod_diameter = 0.036;
  cylinder.common.chamber_length = 1, cylinder.rod_length = 1;
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.9;
  return def;
}

template <typename Def>
Def& between(HydraulicsDef& def, const char* name, const char* port_1, const char* port_2) {
  Def& component = add<Def>(def, name);
  component.port_1 = port_1, component.port_2 = port_2;
  return component;
}

BleedDef& bleed(HydraulicsDef& def, const char* name, const char* port_1, const char* port_2) {
  BleedDef& passage = between<BleedDef>(def, name, port_1, port_2);
  passage.nominal_flow = 1e-3, passage.nominal_pressure_drop = 1e5;
  return passage;
}

struct Start {
  explicit Start(const HydraulicsDef& def) : circuit(def), y(static_cast<std::size_t>(circuit.state_count())) {
    const double F[] = {kForce};
    circuit.start_in_equilibrium(F, y);
  }
  [[nodiscard]] double pressure(const char* volume) const {
    return y[static_cast<std::size_t>(circuit.find_volume(volume))];
  }
  Circuit circuit;
  std::vector<double> y;
};

TEST(StartVolumes, behind_open_passages_begin_at_the_pressure_of_the_load) {
  HydraulicsDef def = cylinder_and({"Throttled", "Hose", "Far", "Return"});
  ThrottleCheckValveDef& throttle = between<ThrottleCheckValveDef>(def, "Throttle", "Throttled", "A");
  throttle.throttle_flow = 1e-4, throttle.common.nominal_flow = 1e-3;
  LineDef& line = between<LineDef>(def, "Line", "Throttled", "Hose");
  line.length = 4, line.diameter = 0.016;
  HoseBurstValveDef& burst = between<HoseBurstValveDef>(def, "Burst", "Far", "Hose");
  burst.nominal_flow = 1e-3, burst.closing_flow = 1e-3;
  bleed(def, "Back", "B", "Return");
  const Start start(def);
  EXPECT_NEAR(start.pressure("A"), kHeld, 1e-9 * kHeld);
  for (const char* volume : {"Throttled", "Hose", "Far"}) EXPECT_EQ(start.pressure(volume), start.pressure("A"));
  EXPECT_EQ(start.pressure("Return"), kReturn);
}

// a suspension: gas of the load's pressure
TEST(StartVolumes, with_an_accumulator_begin_with_its_gas_at_the_pressure_of_the_load) {
  HydraulicsDef def = cylinder_and({"Store"});
  bleed(def, "Damper", "A", "Store");
  AccumulatorDef& accumulator = add<AccumulatorDef>(def, "Gas");
  accumulator.port_1 = "Store", accumulator.gas_volume = 1e-3, accumulator.precharge_pressure = 20e5;
  accumulator.nominal_flow = 1e-3, accumulator.polytropic_exponent = 1;
  const Start start(def);
  EXPECT_NEAR(start.pressure("Store"), kHeld, 1e-9 * kHeld);
  EXPECT_NEAR(start.y.back(), 1 - 20e5 / kHeld, 1e-9);  // oil over gas_volume
}

TEST(StartVolumes, joined_to_a_tank_or_a_pump_or_with_a_pressure_of_their_own_keep_it) {
  HydraulicsDef def = cylinder_and({"Leak", "Line", "Stated", "Shut"});
  bleed(def, "To_leak", "B", "Leak");
  bleed(def, "To_tank", "Leak", "T");
  bleed(def, "To_stated", "A", "Stated");
  def.volumes[4].initial_pressure = 30e5;
  CheckValveDef& check = between<CheckValveDef>(def, "Check", "Shut", "A");
  check.common.nominal_flow = 1e-3;
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "Line", pump.port_b = "T", pump.speed = 100, pump.displacement = 1e-6;
  {
    const Start start(def);
    EXPECT_EQ(start.pressure("Leak"), VolumeDef{}.initial_pressure);
    EXPECT_EQ(start.pressure("Stated"), 30e5);
    EXPECT_EQ(start.pressure("Shut"), VolumeDef{}.initial_pressure);
  }
  bleed(def, "To_line", "Shut", "Line");
  bleed(def, "To_shut", "A", "Shut");
  const Start start(def);
  EXPECT_EQ(start.pressure("Shut"), VolumeDef{}.initial_pressure);
  EXPECT_EQ(start.pressure("Line"), def.start_pump_pressure);
}

// what stands behind an open passage has its own relief: it would let the load down
TEST(StartVolumes, behind_a_passage_are_held_against_their_relief) {
  HydraulicsDef def = cylinder_and({"Hose"});
  bleed(def, "Passage", "A", "Hose");
  ReliefValveDef& relief = between<ReliefValveDef>(def, "Relief", "Hose", "T");
  relief.nominal_flow = 1e-3, relief.setting_pressure = 20e5;
  const double F[] = {kForce};
  const Circuit circuit(def);
  const auto demand = circuit.demand_beyond_limits(F);
  ASSERT_TRUE(demand);
  EXPECT_EQ(demand->valve, "Relief");
  EXPECT_NEAR(demand->pressure, kHeld, 1e-9 * kHeld);
}

}  // namespace start_volumes_test
}  // namespace slew::hydraulics::test
