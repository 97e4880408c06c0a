// SPDX-License-Identifier: Apache-2.0
// End cushions inside the circuit: pressure of the enclosed oil, its heat, its cavitation on the way out.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/double_rod_cylinder.h"
#include "hydraulics/components/restrictions.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace cushion_test {

constexpr double kArea = std::numbers::pi / 4 * (0.1 * 0.1 - 0.06 * 0.06);  // m2, enclosed by a plunger of 60 mm

HydraulicsDef cushioned() {
  HydraulicsDef def;
  add_tank(def, "A", 20e5), add_tank(def, "Tank", 1e5);
  add_volume(def, "B", 20e5).rigid_volume = 1e-3;
  DoubleRodCylinderDef& cylinder = add<DoubleRodCylinderDef>(def, "Cyl");
  cylinder.common.force = "Force", cylinder.common.port_a = "A", cylinder.common.port_b = "B";
  cylinder.common.piston_diameter = 0.1, cylinder.rod_diameter = 0.05, cylinder.common.chamber_length = 0.7;
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.6;
  CushionParameters& cushion = cylinder.common.cushion_b;
  cushion.length = 0.05, cushion.plunger_diameter = 0.06, cushion.orifice_diameter = 6e-3;
  BleedDef& bleed = add<BleedDef>(def, "Bleed");
  bleed.port_1 = "B", bleed.port_2 = "Tank", bleed.nominal_flow = 1e-3, bleed.nominal_pressure_drop = 10e5;
  return def;
}

CushionParameters& cushion_of(HydraulicsDef& def) {
  return static_cast<DoubleRodCylinderDef&>(*def.components.front()).common.cushion_b;
}

double value(Circuit& circuit, const CircuitIntegrator& integrator, const std::string& name) {
  std::vector<double> values(circuit.variables().size());
  circuit.read_variables(integrator.state().data(), values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (circuit.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << name;
  return 0;
}

// 10 ms at 0.1 m/s towards the end, or away from it, from a stroke.
StepReport move(CircuitIntegrator& integrator, double stroke, double speed) {
  const double x[] = {stroke}, v[] = {speed}, F[] = {0};
  integrator.start(x, v, F);
  StepReport all;
  for (int k = 0; k < 10; ++k) all.flags |= integrator.step(1e-3, HeldSpeed(1)).flags;
  return all;
}

TEST(ValidationCushion, pressure_of_the_enclosed_oil_is_that_of_the_displaced_flow) {
  const HydraulicsDef def = cushioned();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  move(integrator, 0.56, 0.1);
  const double K = 0.67 * std::numbers::pi / 4 * 6e-3 * 6e-3 * std::sqrt(2 / def.oil_density);
  const double drop = std::pow(kArea * 0.1 / K, 2);
  EXPECT_NEAR(value(circuit, integrator, "Cyl.cushion_pressure_b") - value(circuit, integrator, "Cyl.pressure_b"), drop,
              0.01 * drop);
  EXPECT_GT(drop, 1e5);
  // outside of its length it is the chamber's
  move(integrator, 0.4, 0.1);
  EXPECT_EQ(value(circuit, integrator, "Cyl.cushion_pressure_b"), value(circuit, integrator, "Cyl.pressure_b"));
}

TEST(ValidationCushion, throttle_heats_the_oil_of_its_chamber) {
  const auto heat = [](double length, double& drop) {
    HydraulicsDef def = cushioned();
    def.oil_temperature = OilTemperature::by_volume, def.hot_viscosity = 10e-6;
    cushion_of(def).length = length;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    move(integrator, 0.56, 0.1);
    drop = length > 0 ? value(circuit, integrator, "Cyl.cushion_pressure_b") - value(circuit, integrator, "B.pressure")
                      : 0;
    return value(circuit, integrator, "B.heat");
  };
  double drop = 0, none = 0;
  const double with = heat(0.05, drop), without = heat(0, none);
  EXPECT_NEAR(with - without, kArea * 0.1 * drop, 1e-3 * kArea * 0.1 * drop);
  EXPECT_GT(drop, 1e5);
}

TEST(ValidationCushion, drawn_empty_through_its_throttle_it_is_reported_as_cavitation) {
  HydraulicsDef def = cushioned();
  for (const CushionReturn way : {CushionReturn::check_valve, CushionReturn::throttle}) {
    cushion_of(def).flow_back = way;
    cushion_of(def).orifice_diameter = 1e-3;
    Circuit circuit(def);
    CircuitIntegrator integrator(circuit, def);
    const StepReport report = move(integrator, 0.59, -0.1);
    EXPECT_EQ(report.has(StepFlag::cavitating), way == CushionReturn::throttle);
  }
}

}  // namespace cushion_test
}  // namespace slew::hydraulics::test
