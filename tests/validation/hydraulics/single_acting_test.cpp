// SPDX-License-Identifier: Apache-2.0
// Single-acting cylinder: rest under a load, lowering through an orifice, a pull beyond the vacuum, its rule.
#include "hydraulics/components/single_acting_cylinder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydraulics/circuit_integrator.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace single_acting_test {

constexpr double kD = 0.08, kArea = std::numbers::pi / 4 * kD * kD, kAir = 1e5;  // m, m2, Pa

HydraulicsDef plunger() {
  HydraulicsDef def;
  def.relative_tolerance = 1e-6, def.orifice_transition = 10;
  add_volume(def, "A").rigid_volume = 1e-3;
  add_tank(def, "Air", kAir);
  SingleActingCylinderDef& cylinder = add<SingleActingCylinderDef>(def, "Plunger");
  cylinder.common.force = "Force", cylinder.common.port_a = "A", cylinder.common.port_b = "Air";
  cylinder.common.piston_diameter = kD, cylinder.common.chamber_length = 1;
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.9;
  return def;
}

TEST(ValidationSingleActing, holds_its_load_by_one_pressure_over_that_of_the_air) {
  const HydraulicsDef def = plunger();
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_TRUE(errors.empty()) << errors.front().path;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0.5}, v[] = {0}, F[] = {30e3};
  integrator.start(x, v, F);
  EXPECT_NEAR(integrator.actuators()[0].p_a, kAir + 30e3 / kArea, 1e-3);
  EXPECT_NEAR(integrator.actuators()[0].F, 30e3, 1e-6);
  for (int k = 0; k < 500; ++k) integrator.step(1e-3, MassLoad({{3000, 30e3, 0}}));
  EXPECT_NEAR(integrator.actuators()[0].x, 0.5, 1e-9);
  // one oil column
  std::vector<double> capacity(2);
  circuit.capacities(integrator.state().data(), capacity.data());
  EXPECT_NEAR(integrator.actuators()[0].K, kArea * kArea / capacity[0], 1e-6 * integrator.actuators()[0].K);
}

TEST(ValidationSingleActing, a_pulling_load_at_the_start_is_refused_by_name) {
  const HydraulicsDef def = plunger();
  const Circuit circuit(def);
  const double held[] = {-400}, pulled[] = {-600};  // the air holds kAir kArea = 503 N
  EXPECT_FALSE(circuit.demand_beyond_limits(held));
  const std::optional<StartDemand> demand = circuit.demand_beyond_limits(pulled);
  ASSERT_TRUE(demand);
  EXPECT_LT(demand->pressure, 0);
}

// A load F lowered through an orifice K to tank: A v = K sqrt(F/A), steady.
TEST(ValidationSingleActing, sinks_through_an_orifice_at_the_speed_of_the_closed_form) {
  HydraulicsDef def = plunger();
  BleedDef& bleed = add<BleedDef>(def, "Lower");
  bleed.port_1 = "A", bleed.port_2 = "Air", bleed.nominal_flow = 2e-4, bleed.nominal_pressure_drop = 100e5;
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0.8}, v[] = {0}, F[] = {30e3};
  integrator.start(x, v, F);
  for (int k = 0; k < 5000; ++k) integrator.step(1e-3, MassLoad({{3000, 30e3, 2e4}}));
  const double speed = integrator.actuators()[0].v;
  // the damping of 2e4 N s/m, which ends the swing, carries a share of the load
  const double expected = -2e-4 * std::sqrt((30e3 + 2e4 * speed) / kArea / 100e5) / kArea;
  EXPECT_NEAR(speed, expected, 1e-4 * std::fabs(expected));
  EXPECT_LT(speed, -0.02);
}

// Pulled out and let go: the chamber cavitates, the force ends at the air's, and the oil is there again afterwards.
TEST(ValidationSingleActing, pulls_no_more_than_the_air_and_keeps_its_oil) {
  HydraulicsDef def = plunger();
  Circuit circuit(def);
  CircuitIntegrator integrator(circuit, def);
  const double x[] = {0.4}, F[] = {5e3}, rest[] = {0}, out[] = {0.5}, back[] = {-0.5};
  integrator.start(x, rest, F);
  const double p = integrator.actuators()[0].p_a;
  double position = 0.4;
  StepReport all;
  for (const double* speed : {out, back}) {
    for (int k = 0; k < 500; ++k) {
      const double at[] = {position};
      integrator.align(at, {speed, 1});
      all.flags |= integrator.step(1e-3, HeldSpeed(1)).flags;
      EXPECT_GE(integrator.actuators()[0].F, -kAir * kArea);
      position += 1e-3 * *speed;
    }
  }
  EXPECT_TRUE(all.has(StepFlag::cavitating));
  EXPECT_FALSE(all.has(StepFlag::non_finite));
  const double at[] = {position};
  integrator.align(at, rest);
  integrator.refresh();
  EXPECT_NEAR(integrator.actuators()[0].p_a, p, 1e-3 * p);
}

TEST(ValidationSingleActing, its_open_side_must_be_at_a_fixed_pressure) {
  HydraulicsDef def = plunger();
  def.volumes[1].fixed = false, def.volumes[1].rigid_volume = 1e-3;
  Problems errors, warnings;
  validate(def, errors, warnings);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors.front().path, "Plunger.port_b");
  EXPECT_EQ(errors.front().what, "the open side is not open: 'Air' is not held at a fixed pressure");
}

}  // namespace single_acting_test
}  // namespace slew::hydraulics::test
