// SPDX-License-Identifier: Apache-2.0
// Equilibrium start of actuators on common volumes, by the force balances of all of them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hydraulics/circuit_integrator.h"
#include "hydraulics/components/double_acting_cylinder.h"
#include "hydraulics/components/hydraulic_motor.h"
#include "tests/properties/hydraulics/crane_circuit.h"

namespace slew::hydraulics::test {
namespace common_volumes_test {

constexpr double kReturn = 5e5, kMean = 20e5, kLeast = 1e5;  // Pa absolute

double disc(double diameter) {
  return std::numbers::pi / 4 * diameter * diameter;
}

void add_cylinder(HydraulicsDef& def, const std::string& name, const std::string& a, const std::string& b,
                  double piston, double rod) {
  DoubleActingCylinderDef& cylinder = add<DoubleActingCylinderDef>(def, name);
  cylinder.common.force = "Force_" + name, cylinder.common.port_a = a, cylinder.common.port_b = b;
  cylinder.common.piston_diameter = piston, cylinder.rod_diameter = rod;
  cylinder.common.chamber_length = 1, cylinder.rod_length = 1;
  cylinder.common.minimum_stroke = 0.05, cylinder.common.maximum_stroke = 0.9;
}

void add_motor(HydraulicsDef& def, const std::string& name, const std::string& a, const std::string& b,
               double displacement) {
  HydraulicMotorDef& motor = add<HydraulicMotorDef>(def, name);
  motor.force = "Force_" + name, motor.port_a = a, motor.port_b = b, motor.displacement = displacement;
}

HydraulicsDef with_volumes(std::initializer_list<const char*> names) {
  HydraulicsDef def;
  for (const char* name : names) add_volume(def, name).rigid_volume = 1e-3;
  return def;
}

struct Started {
  std::vector<double> y, F, missing;
};

Started start(const Circuit& circuit, std::span<const double> F, std::span<const double> W = {}) {
  Started started{std::vector<double>(static_cast<std::size_t>(circuit.state_count())), std::vector<double>(F.size()),
                  circuit.unheld_at_start(F, W)};
  circuit.start_in_equilibrium(F, started.y, W);
  circuit.pressure_forces(started.y.data(), started.F.data());
  return started;
}

double pressure(const Circuit& circuit, const Started& started, const char* volume) {
  return started.y[static_cast<std::size_t>(circuit.find_volume(volume))];
}

// Master and slave: p_M A_2 - p_B B_2 = W_2, p_A A_1 - p_M B_1 = W_1, p_B at the return pressure.
TEST(CommonVolumes, cylinders_in_series_each_hold_their_load) {
  HydraulicsDef def = with_volumes({"A", "M", "B"});
  const double A_1 = disc(0.08), B_1 = A_1 - disc(0.045), A_2 = disc(0.066), B_2 = A_2 - disc(0.035);
  add_cylinder(def, "Master", "A", "M", 0.08, 0.045);
  add_cylinder(def, "Slave", "M", "B", 0.066, 0.035);
  const Circuit circuit(def);
  const double W = 2000 * 9.81, F[] = {W, W};
  const Started started = start(circuit, F);
  const double p_M = (W + kReturn * B_2) / A_2;
  EXPECT_NEAR(pressure(circuit, started, "M"), p_M, 1e-9 * p_M);
  EXPECT_NEAR(pressure(circuit, started, "A"), (W + p_M * B_1) / A_1, 1e-9 * p_M);
  EXPECT_EQ(pressure(circuit, started, "B"), kReturn);
  for (const double one : started.missing) EXPECT_EQ(one, 0);
  EXPECT_FALSE(circuit.demand_beyond_limits(F));
}

// each has its own difference of pressure, the last one ends at 1 bar
TEST(CommonVolumes, motors_in_series_each_hold_their_torque) {
  HydraulicsDef def = with_volumes({"P", "M", "B"});
  const double D = 45e-6 / (2 * std::numbers::pi);
  add_motor(def, "First", "P", "M", D);
  add_motor(def, "Second", "M", "B", D);
  const Circuit circuit(def);
  const double torque[] = {24.5, 24.5};
  const Started started = start(circuit, torque);
  const double drop = 24.5 / D;
  EXPECT_NEAR(pressure(circuit, started, "B"), kLeast, 1e-3);
  EXPECT_NEAR(pressure(circuit, started, "M"), kLeast + drop, 1e-9 * drop);
  EXPECT_NEAR(pressure(circuit, started, "P"), kLeast + 2 * drop, 1e-9 * drop);
  // small torques: around the mean pressure
  const double small[] = {2, 2};
  const Started around = start(circuit, small);
  EXPECT_NEAR(pressure(circuit, around, "M"), kMean, 1e-3);
  EXPECT_NEAR(pressure(circuit, around, "P"), kMean + 2 / D, 1e-3);
}

// One joint on both: W has rank 1. The sum of the forces holds the load, by p_A (A_1 + A_2) - p_B (B_1 + B_2).
TEST(CommonVolumes, an_unequal_pair_on_one_joint_holds_its_load_by_the_sum_of_the_forces) {
  HydraulicsDef def = with_volumes({"A", "B"});
  add_cylinder(def, "Left", "A", "B", 0.08, 0.045);
  add_cylinder(def, "Right", "A", "B", 0.06, 0.045);
  const Circuit circuit(def);
  const double A = disc(0.08) + disc(0.06), B = A - 2 * disc(0.045), sum = 60e3;
  const double F[] = {0.5 * sum, 0.5 * sum}, W[] = {1e-3, 1e-3, 1e-3, 1e-3};
  const Started started = start(circuit, F, W);
  EXPECT_EQ(pressure(circuit, started, "B"), kReturn);
  EXPECT_NEAR(pressure(circuit, started, "A"), (sum + kReturn * B) / A, 1e-3);
  EXPECT_NEAR(started.F[0] + started.F[1], sum, 1e-6 * sum);
  for (const double one : started.missing) EXPECT_EQ(one, 0);
}

// Levers 0.3 m and -0.2 m: 0.3 F_1 - 0.2 F_2 holds the moment. The side without load has the return pressure.
TEST(CommonVolumes, cross_connected_steering_cylinders_hold_the_moment) {
  HydraulicsDef def = with_volumes({"L", "R"});
  add_cylinder(def, "Left", "L", "R", 0.07, 0.04);
  add_cylinder(def, "Right", "R", "L", 0.07, 0.04);
  const Circuit circuit(def);
  const double A = disc(0.07), B = A - disc(0.04);
  const double l_1 = 0.3, l_2 = -0.2, W[] = {l_1 * l_1, l_1 * l_2, l_1 * l_2, l_2 * l_2};
  for (const double moment : {3000.0, -3000.0}) {
    // any split will do
    const double F[] = {moment / l_1, 0};
    const Started started = start(circuit, F, W);
    EXPECT_NEAR(l_1 * started.F[0] + l_2 * started.F[1], moment, 1e-6 * std::fabs(moment));
    const char *loaded = moment > 0 ? "L" : "R", *other = moment > 0 ? "R" : "L";
    EXPECT_EQ(pressure(circuit, started, other), kReturn);
    const double per_loaded = moment > 0 ? l_1 * A - l_2 * B : l_2 * A - l_1 * B;
    const double per_other = moment > 0 ? l_2 * A - l_1 * B : l_1 * A - l_2 * B;
    const double p = (moment - per_other * kReturn) / per_loaded;
    EXPECT_NEAR(pressure(circuit, started, loaded), p, 1e-8 * p);
  }
}

// Two lifts on the same volumes with loads of 20 and 30 kN: no pressures hold both. The start lies between them, and
// what is missing is named with its sign.
TEST(CommonVolumes, loads_that_no_pressures_hold_together_are_reported_by_actuator) {
  HydraulicsDef def = with_volumes({"A", "B"});
  add_cylinder(def, "Left", "A", "B", 0.08, 0.045);
  add_cylinder(def, "Right", "A", "B", 0.08, 0.045);
  const Circuit circuit(def);
  const double F[] = {20e3, 30e3}, W[] = {1e-3, 0, 0, 1e-3};
  const Started started = start(circuit, F, W);
  EXPECT_NEAR(started.missing[0], -5e3, 5);
  EXPECT_NEAR(started.missing[1], 5e3, 5);
  EXPECT_NEAR(started.F[0], 25e3, 5);
  const double A = disc(0.08), B = A - disc(0.045);
  EXPECT_NEAR(pressure(circuit, started, "A"), (25e3 + kReturn * B) / A, 1e3);
}

// An equal pair that shares its load equally has the bits of one cylinder with half of it.
TEST(CommonVolumes, an_equal_pair_starts_as_one_cylinder_does) {
  HydraulicsDef one = with_volumes({"A", "B"}), two = with_volumes({"A", "B"});
  add_cylinder(one, "Left", "A", "B", 0.08, 0.045);
  add_cylinder(two, "Left", "A", "B", 0.08, 0.045);
  add_cylinder(two, "Right", "A", "B", 0.08, 0.045);
  const Circuit alone(one), pair(two);
  const double F[] = {25e3, 25e3}, W[] = {1e-3, 1e-3, 1e-3, 1e-3};
  const Started half = start(alone, {F, 1}), both = start(pair, F, W);
  EXPECT_EQ(pressure(pair, both, "A"), pressure(alone, half, "A"));
  EXPECT_EQ(pressure(pair, both, "B"), pressure(alone, half, "B"));
}

}  // namespace common_volumes_test
}  // namespace slew::hydraulics::test
