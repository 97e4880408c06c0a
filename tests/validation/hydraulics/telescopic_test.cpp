// SPDX-License-Identifier: Apache-2.0
// Telescopic cylinder: pressures and order of its stages, oil and work over a change of stage, its spring, its rules.
#include "hydraulics/components/telescopic_cylinder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/sources.h"
#include "hydraulics/staged_area.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace telescopic_test {

constexpr double kAir = 1e5, kTransition = 2e-3;  // Pa, m
constexpr double kEnds[] = {0.3, 0.6, 0.9}, kDiameters[] = {0.1, 0.08, 0.06};

double area(int stage) {
  return std::numbers::pi / 4 * kDiameters[stage] * kDiameters[stage];
}

HydraulicsDef jack() {
  HydraulicsDef def;
  def.relative_tolerance = 1e-6, def.orifice_transition = 10;
  add_volume(def, "A").rigid_volume = 1e-3;
  add_tank(def, "Air", kAir);
  TelescopicCylinderDef& cylinder = add<TelescopicCylinderDef>(def, "Jack");
  cylinder.common.force = "Force", cylinder.common.port_a = "A", cylinder.common.port_b = "Air";
  for (int i = 0; i < 3; ++i) cylinder.stages.push_back({kEnds[i], kDiameters[i]});
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.9;
  cylinder.stage_transition = kTransition;
  return def;
}

TEST(StagedArea, ContentIsTheIntegralOfTheArea) {
  const StagedArea stages({{0.3, 8e-3}, {0.6, 5e-3}, {0.9, 3e-3}}, kTransition);
  EXPECT_DOUBLE_EQ(stages.area_at(0.1).value, 8e-3);
  EXPECT_DOUBLE_EQ(stages.area_at(0.3).value, 6.5e-3);  // the middle of the step
  EXPECT_DOUBLE_EQ(stages.area_at(0.45).value, 5e-3);
  EXPECT_NEAR(stages.content_at(0.9), 0.3 * 16e-3, 1e-15);
  // by Simpson's rule, and slopes by differences
  double V = 0;
  const double h = 1e-4;
  for (int k = 0; k < 9000; ++k) {
    const double x = k * h, dx = 1e-7;
    V += h / 6 * (stages.area_at(x).value + 4 * stages.area_at(x + h / 2).value + stages.area_at(x + h).value);
    EXPECT_NEAR(stages.content_at(x + h), V, 1e-12) << x;
    // not at the ends of a step, where the slope has a kink
    const double at = x + 0.3 * h;
    const double slope = (stages.area_at(at + dx).value - stages.area_at(at - dx).value) / (2 * dx);
    EXPECT_NEAR(stages.area_at(at).slope, slope, 1e-6 * 3e-3 / kTransition) << at;
  }
}

TEST(ValidationTelescopic, holds_its_load_by_the_area_of_the_present_stage) {
  const HydraulicsDef def = jack();
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_TRUE(errors.empty()) << errors.front().path;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  for (int i = 0; i < 3; ++i) {
    const double x[] = {0.15 + 0.3 * i}, v[] = {0}, F[] = {20e3};
    integrator.start(x, v, F);
    EXPECT_NEAR(integrator.actuators()[0].p_a, kAir + 20e3 / area(i), 1) << i;
    EXPECT_NEAR(integrator.actuators()[0].F, 20e3, 1e-6) << i;
    for (int k = 0; k < 200; ++k) integrator.step(1e-3, MassLoad({{2000, 20e3, 0}}));
    EXPECT_NEAR(integrator.actuators()[0].x, x[0], 1e-9) << i;
  }
}

// A constant flow under a constant load: v = Q/A_i, p = p_air + F/A_i, the largest stage first; the smallest first with
// the flow reversed.
TEST(ValidationTelescopic, stages_extend_from_the_largest_and_retract_from_the_smallest) {
  HydraulicsDef def = jack();
  constexpr double kFlow = 5e-4;
  FlowSourceDef& source = add<FlowSourceDef>(def, "Source");
  source.port_1 = "Air", source.port_2 = "A", source.flow = 0, source.flow_per_signal = kFlow;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  // damping of the load alone ends the swing; it carries a share of the force
  const double x[] = {0.1}, v[] = {0}, F[] = {20e3}, kDamping = 6e4;
  integrator.start(x, v, F);
  const MassLoad load({{2000, 20e3, kDamping}});
  for (const double sign : {1.0, -1.0}) {
    circuit.set_control(circuit.find_control("Source"), sign);
    double left = 1e9;
    for (int stage = sign > 0 ? 0 : 2; stage >= 0 && stage<3; stage += sign> 0 ? 1 : -1) {
      // to the middle of the stage, where the change before it has died away
      const double middle = kEnds[stage] - 0.08 + (sign > 0 ? 0 : -0.14);
      for (int k = 0; k < 20000; ++k) {
        left = sign * (middle - integrator.actuators()[0].x);
        if (left < 0) break;
        ASSERT_FALSE(integrator.step(1e-3, load).has_failed());
      }
      ASSERT_LT(left, 0) << stage;
      const double speed = sign * kFlow / area(stage);
      EXPECT_NEAR(integrator.actuators()[0].v, speed, 0.01 * std::fabs(speed)) << stage << ' ' << sign;
      const double p = kAir + (20e3 + kDamping * speed) / area(stage);
      EXPECT_NEAR(integrator.actuators()[0].p_a, p, 0.01 * p) << stage << ' ' << sign;
    }
    // into the middle of the last stage again before the flow turns
    if (sign > 0) {
      for (int k = 0; k < 100; ++k) integrator.step(1e-3, load);
    }
  }
}

// Closed chamber moved over a change of stage and back: its oil is the same.
TEST(ValidationTelescopic, keeps_its_oil_over_a_change_of_stage) {
  const HydraulicsDef def = jack();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0.3 + 5e-4}, rest[] = {0}, F[] = {20e3};
  integrator.start(x, rest, F);
  const double p = integrator.state()[0];
  std::vector<double> C_before(2), C_after(2);
  circuit.capacities(integrator.state().data(), C_before.data());
  const double in[] = {0.3 - 5e-4};
  integrator.align(in, rest);
  circuit.capacities(integrator.state().data(), C_after.data());
  const StagedArea stages({{0.3, area(0)}, {0.6, area(1)}, {0.9, area(2)}}, kTransition);
  // dp = -dV/C, by Simpson's rule with the capacity in the middle
  std::vector<double> C_middle(2), middle(integrator.state().begin(), integrator.state().end());
  middle[0] = 0.5 * (p + middle[0]);
  middle[static_cast<std::size_t>(circuit.position(0))] = 0.3;
  circuit.capacities(middle.data(), C_middle.data());
  const double dV = stages.content_at(in[0]) - stages.content_at(x[0]);
  const double expected = p - dV / 6 * (1 / C_before[0] + 4 / C_middle[0] + 1 / C_after[0]);
  EXPECT_NEAR(integrator.state()[0], expected, 1e-3 * (expected - p));
  integrator.align(x, rest);
  EXPECT_NEAR(integrator.state()[0], p, 1e-6 * p);
}

// dF/dx of a closed chamber by two displacements, within the stages and over their change.
TEST(ValidationTelescopic, publishes_the_stiffness_of_oil_and_change_of_stage) {
  const HydraulicsDef def = jack();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  for (const double stroke : {0.15, 0.2995, 0.3, 0.3003, 0.45, 0.6, 0.75}) {
    const double x[] = {stroke}, rest[] = {0}, F[] = {20e3}, d = 1e-8;
    const auto force = [&](double dx) {
      integrator.start(x, rest, F);
      const double moved[] = {stroke + dx};
      integrator.align(moved, rest);
      integrator.refresh();
      return integrator.actuators()[0].F;
    };
    const double K = -(force(d) - force(-d)) / (2 * d);
    integrator.start(x, rest, F);
    EXPECT_NEAR(integrator.actuators()[0].K, K, 1e-3 * K) << stroke;
  }
}

// F_dot at a held speed by two short steps.
TEST(ValidationTelescopic, publishes_the_rate_of_its_force_over_a_change_of_stage) {
  const HydraulicsDef def = jack();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  for (const double speed : {-0.1, 0.1}) {
    const double x[] = {0.3}, v[] = {speed}, F[] = {20e3}, h = 1e-7;
    integrator.start(x, v, F);
    const double F_dot = integrator.actuators()[0].F_dot, before = integrator.actuators()[0].F;
    integrator.step(h, HeldSpeed(1));
    EXPECT_NEAR((integrator.actuators()[0].F - before) / h, F_dot, 1e-3 * std::fabs(F_dot));
    double sum = 0;
    for (const math::RelaxingSpring& spring : integrator.actuators()[0].springs) sum += spring.F_dot;
    EXPECT_NEAR(sum, integrator.actuators()[0].F_dot, 1e-9 * std::fabs(F_dot));
  }
}

// Work of the pressure force over a change of stage is what the oil gives: int p dV of the closed chamber.
TEST(ValidationTelescopic, change_of_stage_creates_no_energy) {
  HydraulicsDef def = jack();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0.302}, v[] = {-0.02}, F[] = {20e3};
  integrator.start(x, v, F);
  double work = 0, oil = 0, p = integrator.state()[0];
  const StagedArea stages({{0.3, area(0)}, {0.6, area(1)}, {0.9, area(2)}}, kTransition);
  double V = stages.content_at(x[0]);
  for (int k = 0; k < 200; ++k) {
    integrator.step(1e-3, HeldSpeed(1));
    work += integrator.actuators()[0].work;
    const double V_now = stages.content_at(integrator.actuators()[0].x), p_now = integrator.state()[0];
    oil += (0.5 * (p + p_now) - kAir) * (V_now - V);
    p = p_now, V = V_now;
  }
  EXPECT_NEAR(integrator.actuators()[0].x, 0.298, 1e-9);
  EXPECT_NEAR(work, oil, 1e-4 * std::fabs(oil));
}

TEST(ValidationTelescopic, refuses_stages_that_contradict_each_other_and_the_stroke) {
  const auto first_error = [](auto change) {
    HydraulicsDef def = jack();
    change(static_cast<TelescopicCylinderDef&>(*def.components.back()));
    Problems errors, warnings;
    validate(def, errors, warnings);
    return errors.size() == 1 ? errors.front().path + ": " + errors.front().what : std::to_string(errors.size());
  };
  EXPECT_EQ(first_error([](TelescopicCylinderDef& jack) { jack.stages[1][1] = 0.1; }),
            "Jack.stages: stage 2 is not thinner than the one before: 0.1 after 0.1 m");
  EXPECT_EQ(first_error([](TelescopicCylinderDef& jack) { jack.stages[0][0] = 0.5985; }),
            "Jack.stages: stage 2 is 0.0015 m long, and stage_transition 0.002 m");
  EXPECT_EQ(first_error([](TelescopicCylinderDef& jack) { jack.common.maximum_stroke = 0.8; }),
            "Jack.maximum_stroke: the stages end at 0.9 m, the stroke at 0.8 m");
}

}  // namespace telescopic_test
}  // namespace slew::hydraulics::test
