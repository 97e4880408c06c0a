// SPDX-License-Identifier: Apache-2.0
// Spool valve on a cylinder against the closed forms of its orifice network: four edges of different areas, and an open
// centre fed by a constant flow.
#include "hydraulics/components/spool_valve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace spool_valve_test {

constexpr double kD = 0.1, kRod = 0.06, kMass = 2000;                                                // m, kg
constexpr double kA = std::numbers::pi / 4 * kD * kD, kB = kA - std::numbers::pi / 4 * kRod * kRod;  // m2
constexpr double kTank = 1e5;                                                                        // Pa

// conductance of an edge [m3/s/sqrt(Pa)]
double conductance(double area) {
  return 0.67 * area * std::sqrt(2 / 870.0);
}

HydraulicsDef machine() {
  HydraulicsDef def;
  def.orifice_transition = 10, def.relative_tolerance = 1e-6;
  add_volume(def, "A").rigid_volume = 1e-3;
  add_volume(def, "B").rigid_volume = 1e-3;
  add_tank(def, "Tank", kTank);
  DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, "Cylinder");
  cylinder.rod_diameter = kRod, cylinder.rod_length = 1, cylinder.common.force = "Force";
  cylinder.common.port_a = "A", cylinder.common.port_b = "B";
  cylinder.common.piston_diameter = kD, cylinder.common.chamber_length = 2;
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 1.95;
  SpoolValveDef& valve = add<SpoolValveDef>(def, "Valve");
  valve.port_p = "P", valve.port_a = "A", valve.port_b = "B", valve.port_t = "Tank";
  valve.pa.area = 8e-6, valve.bt.area = 14e-6, valve.pb.area = 10e-6, valve.at.area = 6e-6;
  return def;
}

struct Motion {
  double v = 0, p_a = 0, p_b = 0;  // m/s, Pa
};

Motion steady_motion(const HydraulicsDef& def, double signal, double load) {
  Problems errors, warnings;
  validate(def, errors, warnings);
  for (const Problem& problem : errors) ADD_FAILURE() << problem.path << ": " << problem.what;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {1}, v[] = {0}, F[] = {load};
  integrator.start(x, v, F);
  circuit.set_control(circuit.find_control("Valve"), signal);
  MassLoad moved({{kMass, load, 200}});
  // half a second is the longest time constant of oil and edges
  for (int k = 0; k < 700; ++k) EXPECT_FALSE(integrator.step(1e-2, moved).has_failed());
  const ActuatorLinearisation& piston = integrator.actuators()[0];
  return {piston.v, piston.p_a, piston.p_b};
}

// p_P - p_A = (v A_A/K_PA)^2, p_B - p_T = (v A_B/K_BT)^2, p_A A_A - p_B A_B = F:
//   v^2 (A_A^3/K_PA^2 + A_B^3/K_BT^2) = p_P A_A - p_T A_B - F        extending, and alike retracting
TEST(ValidationSpoolValve, a_cylinder_moves_at_the_speed_of_its_two_edges_in_either_direction) {
  constexpr double supply = 150e5, damping = 200;
  HydraulicsDef def = machine();
  add_tank(def, "P", supply);
  for (const double share : {1.0, 0.4}) {
    const double out = conductance(share * 14e-6), in = conductance(share * 8e-6);
    for (const double load : {0.0, 60e3}) {
      const double network = kA * kA * kA / (in * in) + kB * kB * kB / (out * out);
      const double drive = supply * kA - kTank * kB - load;
      const double v = (std::sqrt(damping * damping + 4 * network * drive) - damping) / (2 * network);
      const Motion motion = steady_motion(def, share, load);
      EXPECT_NEAR(motion.v, v, 1e-4 * v) << share << " " << load;
      EXPECT_NEAR(motion.p_a, supply - std::pow(v * kA / in, 2), 2e-4 * supply);
    }
    const double back_in = conductance(share * 10e-6), back_out = conductance(share * 6e-6);
    const double network = kB * kB * kB / (back_in * back_in) + kA * kA * kA / (back_out * back_out);
    const double drive = supply * kB - kTank * kA + 20e3;
    const double v = (std::sqrt(damping * damping + 4 * network * drive) - damping) / (2 * network);
    EXPECT_NEAR(steady_motion(def, -share, 20e3).v, -v, 1e-4 * v) << share;
  }
}

// An open centre fed by the flow Q: at the spool position s the bypass takes what the load's pressure lets it,
//   Q = K_C(s) sqrt(p_P - p_T) + A_A v,   p_P - p_A = (A_A v/K_PA)^2,   p_A A_A - p_B A_B = F + d v               (1)
// solved here by bisection on v. Before the bypass reaches the load's pressure the load stands.
TEST(ValidationSpoolValve, an_open_centre_shares_a_constant_flow_between_bypass_and_load) {
  constexpr double Q = 5e-4, damping = 200, load = 50e3, area = 3e-5;
  HydraulicsDef def = machine();
  add_volume(def, "P").rigid_volume = 1e-3;
  FlowSourceDef& pump = add<FlowSourceDef>(def, "Pump");
  pump.port_1 = "Tank", pump.port_2 = "P", pump.flow = Q;
  SpoolValveDef& valve = dynamic_cast<SpoolValveDef&>(*def.components[1]);
  valve.bypass_area = area, valve.bypass_closing = 0.1, valve.bypass_closed = 0.9;
  double slowest = 1e9;
  for (const double s : {0.8, 0.78, 0.76}) {
    const double x = (0.9 - s) / 0.8, K_C = x * conductance(area), K_PA = s * conductance(8e-6);
    const double K_BT = s * conductance(14e-6);
    double low = 0, high = Q / kA;
    for (int k = 0; k < 100; ++k) {
      const double v = 0.5 * (low + high);
      const double p_B = kTank + std::pow(v * kB / K_BT, 2);
      const double p_A = (load + damping * v + p_B * kB) / kA;
      const double p_P = p_A + std::pow(v * kA / K_PA, 2);
      (K_C * std::sqrt(p_P - kTank) + kA * v < Q ? low : high) = v;
    }
    ASSERT_GT(low, 1e-3);
    ASSERT_LT(low, slowest);
    slowest = low;
    EXPECT_NEAR(steady_motion(def, s, load).v, low, 1e-3 * low) << s;
  }
}

// at rest the pump circulates at the drop of the open bypass, (Q/K_C)^2
TEST(ValidationSpoolValve, an_open_centre_at_rest_circulates_the_pumps_flow) {
  constexpr double Q = 5e-4, area = 3e-5;
  HydraulicsDef def = machine();
  add_volume(def, "P").rigid_volume = 1e-3;
  FlowSourceDef& pump = add<FlowSourceDef>(def, "Pump");
  pump.port_1 = "Tank", pump.port_2 = "P", pump.flow = Q;
  dynamic_cast<SpoolValveDef&>(*def.components[1]).bypass_area = area;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {1}, v[] = {0}, F[] = {50e3};
  integrator.start(x, v, F);
  for (int k = 0; k < 500; ++k) integrator.step(1e-3, MassLoad({{kMass, 50e3, 0}}));
  const auto p = static_cast<std::size_t>(circuit.find_volume("P"));
  EXPECT_NEAR(integrator.state()[p] - kTank, std::pow(Q / conductance(area), 2), 10);
  EXPECT_NEAR(integrator.actuators()[0].v, 0, 1e-6);
}

}  // namespace spool_valve_test
}  // namespace slew::hydraulics::test
