// SPDX-License-Identifier: Apache-2.0
// Stall pressures behind a valve without leak: those that the pump holds, not those of its overshoot.
#include "hydraulics/stall.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "hydraulics/circuit.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/pump.h"
#include "hydraulics/components/relief_valve.h"
#include "hydraulics/components/restrictions.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace stall_test {

constexpr double kTank = 2e5, kCutOff = 180e5;  // Pa absolute, Pa above tank

// Pump with cut-off and a relief valve above it, check valve, two cylinders: A is fed, M lies between them, B is at
// tank.
HydraulicsDef fed_by_a_pump(double time_constant) {
  HydraulicsDef def;
  add_tank(def, "T", kTank);
  for (const char* name : {"P", "A", "M", "B"}) add_volume(def, name).rigid_volume = 0.5e-3;
  PumpDef& pump = add<PumpDef>(def, "Pump");
  pump.port_a = "P", pump.port_b = "T", pump.speed = 157, pump.displacement = 6.4e-6;
  pump.maximum_pressure = kCutOff, pump.time_constant = time_constant;
  ReliefValveDef& relief = add<ReliefValveDef>(def, "Relief");
  relief.port_1 = "P", relief.port_2 = "T", relief.nominal_flow = 2e-3, relief.setting_pressure = 230e5;
  CheckValveDef& check = add<CheckValveDef>(def, "Check");
  check.port_1 = "P", check.port_2 = "A", check.common.nominal_flow = 2e-3;
  BleedDef& bleed = add<BleedDef>(def, "Return");
  bleed.port_1 = "B", bleed.port_2 = "T", bleed.nominal_flow = 1e-3, bleed.nominal_pressure_drop = 5e5;
  for (const auto& [name, a, b] : {std::tuple("First", "A", "M"), std::tuple("Second", "M", "B")}) {
    DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, name);
    cylinder.common.force = std::string("Force_") + name, cylinder.common.port_a = a, cylinder.common.port_b = b;
    cylinder.common.piston_diameter = 0.08, cylinder.rod_diameter = 0.045;
    cylinder.common.chamber_length = 1, cylinder.rod_length = 1;
    cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.9;
  }
  return def;
}

TEST(Stall, behind_a_check_valve_is_the_pumps_cut_off_however_slowly_its_swash_returns) {
  const double x[] = {0.3, 0.3};
  // the slow one overshoots to the relief valve, whose pressure the check valve would hold
  for (const double time_constant : {0.02, 0.1, 0.5}) {
    const HydraulicsDef def = fed_by_a_pump(time_constant);
    const Circuit circuit(def);
    const Stall stall = find_stall(def, x, {});
    EXPECT_TRUE(stall.is_steady);
    EXPECT_NEAR(stall.pressures[static_cast<std::size_t>(circuit.find_volume("A"))], kTank + kCutOff, 1e5)
        << time_constant;
  }
}

TEST(Stall, names_the_volumes_whose_pressure_no_flow_holds) {
  const double x[] = {0.3, 0.3};
  const HydraulicsDef def = fed_by_a_pump(0.1);
  const Circuit circuit(def);
  const int volumes[] = {circuit.find_volume("A"), circuit.find_volume("M"), circuit.find_volume("B")};
  EXPECT_EQ(unheld_volumes(def, x, {}, volumes), std::vector<int>{circuit.find_volume("M")});
}

}  // namespace stall_test
}  // namespace slew::hydraulics::test
