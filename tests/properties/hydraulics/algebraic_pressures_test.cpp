// SPDX-License-Identifier: Apache-2.0
// Pressures of quasi-static volumes where Newton's method has no slope: valves that are shut at the start, by the
// valves' own laws.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/check_valves.h"
#include "hydraulics/components/direct_relief_valve.h"
#include "hydraulics/components/restrictions.h"
#include "hydraulics/components/shuttle_valve.h"
#include "hydraulics/components/sources.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace algebraic_pressures_test {

constexpr double kStep = 1e-3;
constexpr double kFlow = 20 * kLitrePerMinute;

// direct_relief_valve.h, no flow force: Q = C_d w (p - p_c) A_p / k sqrt(2 p / rho) below the largest lift
double relief_flow(const DirectReliefValveDef& valve, double rho, double p) {
  const double area = std::numbers::pi / 4 * valve.seat_diameter * valve.seat_diameter;
  const double w = std::numbers::pi * valve.seat_diameter * std::sin(valve.half_angle);
  const double lift = (p - valve.crack_pressure) * area / valve.spring_constant;
  return valve.discharge_coefficient * w * std::min(lift, valve.maximum_lift) * std::sqrt(2 * p / rho);
}

double pressure_at(const DirectReliefValveDef& valve, double rho, double flow) {
  double below = valve.crack_pressure, above = 2 * below;
  for (int k = 0; k < 60; ++k) {
    const double middle = (below + above) / 2;
    (relief_flow(valve, rho, middle) < flow ? below : above) = middle;
  }
  return above;
}

DirectReliefValveDef& add_relieved_source(HydraulicsDef& def, const std::string& into, const std::string& from) {
  add_tank(def, "Tank");
  FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
  source.port_1 = "Tank", source.port_2 = into, source.flow = kFlow;
  DirectReliefValveDef& valve = add<DirectReliefValveDef>(def, "Relief");
  valve.port_1 = from, valve.port_2 = "Tank", valve.seat_diameter = 0.01, valve.crack_pressure = 80 * kBar;
  valve.spring_constant = 4e4;
  return valve;
}

TEST(AlgebraicPressures, BalanceBehindAShutReliefValve) {
  for (const Solver solver : {Solver::rodas3, Solver::implicit_euler}) {
    // with and without content; from below, near to and far above the pressure that balances
    for (const double content : {1e-5, 0.0}) {
      for (const double start : {5.0, 50.0, 79.0, 120.0, 300.0}) {
        HydraulicsDef def;
        def.solver = solver, def.start = StartState::table13;
        VolumeDef& node = add_volume(def, "Node", start * kBar);
        node.quasi_static = true, node.rigid_volume = content;
        const DirectReliefValveDef& valve = add_relieved_source(def, "Node", "Node");
        const double p = def.volumes.back().initial_pressure + pressure_at(valve, def.oil_density, kFlow);
        Circuit circuit(def);
        CircuitIntegrator integrator(circuit, def);
        integrator.start({}, {}, {});
        for (int k = 0; k < 20; ++k) {
          EXPECT_FALSE(integrator.step(kStep, HeldSpeed(0)).has(StepFlag::not_converged)) << start << " " << k;
        }
        EXPECT_NEAR(integrator.state()[0], p, 1e-4 * p) << start << " " << content;
      }
    }
  }
}

// two nodes with a shut check valve between them: the first reaches the relief valve only through the second
TEST(AlgebraicPressures, BalanceThroughAShutValveOneByOne) {
  HydraulicsDef def;
  def.start = StartState::table13;
  for (const char* name : {"First", "Second"}) add_volume(def, name, 50 * kBar).quasi_static = true;
  def.volumes[0].initial_pressure = 30 * kBar;
  const DirectReliefValveDef& valve = add_relieved_source(def, "First", "Second");
  CheckValveDef& check = add<CheckValveDef>(def, "Check");
  check.port_1 = "First", check.port_2 = "Second", check.common.nominal_flow = 60 * kLitrePerMinute;
  const double p = def.volumes.back().initial_pressure + pressure_at(valve, def.oil_density, kFlow);
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  for (int k = 0; k < 20; ++k) {
    EXPECT_FALSE(integrator.step(kStep, HeldSpeed(0)).has(StepFlag::not_converged)) << k;
  }
  EXPECT_NEAR(integrator.state()[1], p, 1e-4 * p);
  EXPECT_GT(integrator.state()[0], integrator.state()[1]);
}

// A relieved pump, a shuttle valve with a wide seat and two orifices in a row, whose nodes must rise together from
// pressures below and above the tank's; the pressures by bisection of the flow through the row.
TEST(AlgebraicPressures, OfNodesInARowAreFoundFromBelowTheTank) {
  for (const double tank : {1.0, 2.0, 5.0}) {
    for (const double share : {0.12, 0.3, 0.9, 1.0, 4.0}) {
      for (const double diameter : {0.4e-3, 0.6e-3, 1e-3, 3e-3}) {
        SCOPED_TRACE(std::to_string(tank) + " " + std::to_string(share) + " " + std::to_string(diameter));
        HydraulicsDef def;
        def.start = StartState::table13;
        for (const char* name : {"P", "X", "Y"}) add_volume(def, name, share * tank * kBar).quasi_static = true;
        def.volumes[1].initial_pressure *= 1.7;
        const DirectReliefValveDef& relief = add_relieved_source(def, "P", "P");
        def.volumes.back().initial_pressure = tank * kBar;
        ShuttleValveDef& shuttle = add<ShuttleValveDef>(def, "Shuttle");
        shuttle.port_1 = "P", shuttle.port_2 = "Tank", shuttle.port_3 = "X";
        shuttle.nominal_flow = 60 * kLitrePerMinute;
        const auto add_orifice = [&](const char* name, const char* from, const char* to, double d) {
          OrificeDef& orifice = add<OrificeDef>(def, name);
          orifice.port_1 = from, orifice.port_2 = to, orifice.diameter = d;
          return orifice.discharge_coefficient * std::numbers::pi / 4 * d * d * std::sqrt(2 / def.oil_density);
        };
        const double K_S = shuttle.nominal_flow / std::sqrt(shuttle.nominal_pressure_drop);
        const double K_X = add_orifice("OX", "X", "Y", diameter), K_Y = add_orifice("OY", "Y", "Tank", 1.2e-3);
        // above the tank, d of Q = K d/(d^2 + d_t^2)^(1/4)
        const auto drop = [&](double Q, double K) {
          const double s = Q * Q / (K * K), d_t = def.orifice_transition;
          return std::sqrt(0.5 * s * (s + std::sqrt(s * s + 4 * d_t * d_t)));
        };
        double below = 0, above = kFlow;
        for (int k = 0; k < 60; ++k) {
          const double Q = (below + above) / 2, p = drop(Q, K_Y) + drop(Q, K_X) + drop(Q, K_S);
          const double relieved = p > relief.crack_pressure ? relief_flow(relief, def.oil_density, p) : 0;
          (Q + relieved < kFlow ? below : above) = Q;
        }
        const double p_Y = tank * kBar + drop(below, K_Y), p_X = p_Y + drop(below, K_X);
        Circuit circuit(def);
        CircuitIntegrator integrator(circuit, def);
        integrator.start({}, {}, {});
        for (int k = 0; k < 5; ++k) {
          ASSERT_FALSE(integrator.step(kStep, HeldSpeed(0)).has(StepFlag::not_converged)) << k;
        }
        // the valve's seat has a law of its own below d_t
        const double p_P = p_X + drop(below, K_S);
        EXPECT_NEAR(integrator.state()[0], p_P, 1e-3 * p_P + 0.5 * def.orifice_transition);
        EXPECT_NEAR(integrator.state()[1], p_X, 1e-3 * p_X + 0.5 * def.orifice_transition);
        EXPECT_NEAR(integrator.state()[2], p_Y, 1e-3 * p_Y);
      }
    }
  }
}

// a source into a node that nothing leaves has no pressure: reported, and the pressure stays
TEST(AlgebraicPressures, ThatNoPressureBalancesAreReported) {
  HydraulicsDef def;
  def.start = StartState::table13;
  add_volume(def, "Node", 50 * kBar).quasi_static = true;
  add_tank(def, "Tank");
  FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
  source.port_1 = "Tank", source.port_2 = "Node", source.flow = kFlow;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  integrator.start({}, {}, {});
  const StepReport report = integrator.step(kStep, HeldSpeed(0));
  EXPECT_TRUE(report.has(StepFlag::not_converged));
  EXPECT_EQ(report.offender, 0);
}

}  // namespace algebraic_pressures_test
}  // namespace slew::hydraulics::test
