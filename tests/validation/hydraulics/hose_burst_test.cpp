// SPDX-License-Identifier: Apache-2.0
// Hose-burst valve: its closing flow, and a load whose hose bursts.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/hose_burst_valve.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace hose_burst_test {

constexpr double kD = 0.1, kArea = std::numbers::pi / 4 * kD * kD, kTank = 1e5, kLoad = 60e3;  // m, m2, Pa, N

// A load on a cylinder behind the valve, 0.5 l of hose in front of it, a burst of any size to the tank, a source that
// lowers at a constant flow.
HydraulicsDef machine() {
  HydraulicsDef def;
  def.relative_tolerance = 1e-6, def.orifice_transition = 100;
  add_volume(def, "Load").rigid_volume = 1e-4;
  add_volume(def, "Line", kLoad / kArea + kTank).rigid_volume = 0.5e-3;
  add_tank(def, "Tank", kTank);
  HoseBurstValveDef& valve = add<HoseBurstValveDef>(def, "Valve");
  valve.port_1 = "Line", valve.port_2 = "Load", valve.nominal_flow = 1e-3, valve.closing_flow = 1.2e-3;
  valve.leak_flow = 1e-6;
  DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
  cylinder.rod_diameter = 0.06, cylinder.rod_length = 1, cylinder.common.force = "Force";
  cylinder.common.port_a = "Load", cylinder.common.port_b = "Tank";
  cylinder.common.piston_diameter = kD, cylinder.common.chamber_length = 1;
  cylinder.common.minimum_stroke = 0.02, cylinder.common.maximum_stroke = 0.95;
  FlowSourceDef& lowering = add<FlowSourceDef>(def, "Lowering");
  lowering.port_1 = "Line", lowering.port_2 = "Tank";
  BleedDef& burst = add<BleedDef>(def, "Burst");
  burst.port_1 = "Line", burst.port_2 = "Tank", burst.nominal_flow = 0, burst.nominal_pressure_drop = 10e5;
  return def;
}

class Machine {
 public:
  Machine() : def_(machine()), circuit_(def_), integrator_(circuit_, def_), load_({{6000, kLoad, 5e4}}) {
    const double x[] = {0.8}, v[] = {0}, F[] = {kLoad - kTank * ring()};
    integrator_.start(x, v, F);
    load_.loads()[0].force = F[0];
    // the line at the load's pressure, the valve open
    integrator_.mutable_state()[1] = integrator_.state()[0];
    integrator_.mutable_state().back() = 1;
    integrator_.refresh();
  }
  void set(const char* path, double value) {
    ASSERT_EQ(circuit_.set_parameter(circuit_.find_parameter(path), value), ParameterResult::ok);
  }
  void run(double seconds) {
    for (int k = 0; k < std::lround(seconds / 1e-3); ++k) ASSERT_FALSE(integrator_.step(1e-3, load_).has_failed());
  }
  [[nodiscard]] double opening() const { return integrator_.state().back(); }
  [[nodiscard]] double x() const { return integrator_.actuators()[0].x; }
  [[nodiscard]] double v() const { return integrator_.actuators()[0].v; }
  [[nodiscard]] double pressure() const { return integrator_.actuators()[0].p_a; }

 private:
  static double ring() { return kArea - std::numbers::pi / 4 * 0.06 * 0.06; }

  HydraulicsDef def_;
  Circuit circuit_;
  CircuitIntegrator integrator_;
  MassLoad load_;
};

TEST(HoseBurstValve, stays_open_below_its_closing_flow) {
  Machine machine;
  machine.set("Lowering.flow", 1.1e-3);
  machine.run(2);
  EXPECT_NEAR(machine.opening(), 1, 1e-6);
  EXPECT_NEAR(machine.v(), -1.1e-3 / kArea, 1e-4 * 1.1e-3 / kArea);
}

TEST(HoseBurstValve, a_burst_hose_drops_the_load_by_the_way_of_closing_and_a_leak) {
  Machine machine;
  machine.run(0.1);
  const double x_0 = machine.x();
  machine.set("Burst.nominal_flow", 0.02);
  machine.run(0.5);
  EXPECT_LT(machine.opening(), 1e-6);
  // oil lost until it is shut, and the expansion of the oil column where the pressure fell meanwhile: none in the end
  const double K = 1e-3 / std::sqrt(5e5), tau = 0.02 / 3, most = tau * K * std::sqrt(machine.pressure()) / kArea;
  const double dropped = x_0 - machine.x();
  EXPECT_GT(dropped, 0.2 * most);
  EXPECT_LT(dropped, 1.3 * most);
  // then it sinks by the leak of the valve
  machine.run(2);
  const double x_1 = machine.x();
  machine.run(2);
  const double leak = 1e-6 * (machine.pressure() - kTank) / 100e5;
  EXPECT_NEAR((x_1 - machine.x()) / 2, leak / kArea, 0.01 * leak / kArea);
}

TEST(HoseBurstValve, without_it_the_load_falls) {
  Machine machine;
  machine.set("Valve.closing_flow", 1);
  machine.run(0.1);
  machine.set("Burst.nominal_flow", 0.02);
  machine.run(0.5);
  EXPECT_NEAR(machine.opening(), 1, 1e-6);
  EXPECT_LT(machine.v(), -0.3);
}

}  // namespace hose_burst_test
}  // namespace slew::hydraulics::test
