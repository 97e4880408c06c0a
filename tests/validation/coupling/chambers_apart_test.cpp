// SPDX-License-Identifier: Apache-2.0
// One chamber keeps its oil, the other one is drained within a step: two springs of which one relaxes and the other
// does not (math/relaxing_spring.h, docs/models/coupling_levels.md). Against the closed form of the oil spring and the
// monolith.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace chambers_apart_test {

constexpr double kBore = 0.08, kRod = 0.045, kStroke = 0.5, kRigidVolume = 3e-4;  // m, m3
constexpr double kBulkModulus = 1.5e9, kTank = 1e5;                               // Pa
constexpr double kMass = 1000, kSpeed = 0.05;                                     // kg, m/s
constexpr double kGravity = 9.81;
constexpr double kA = std::numbers::pi / 4 * kBore * kBore;
constexpr double kB = kA - std::numbers::pi / 4 * kRod * kRod;

// a mass on a cylinder, chamber A closed, B to the tank through an orifice, with a speed at the start
scene::Scene cylinder(const std::string& diameter, const scene::Overrides& overrides) {
  const std::string pressure = std::to_string((kMass * kGravity + kTank * kB) / kA);
  return scene::load_text(R"(
mechanics: {gravity: [0, -9.81, 0]}
bodies:
  M: {position: [0, 1.6, 0], mass: 1000, inertia: [1, 1, 1]}
joints:
  R: {type: prismatic, body2: M, point1: [0, 1.6, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0],
      initial_velocity: 0.05}
forces:
  F: {type: translational, body1: Ground, body2: M}
hydraulics: {start: table13, oil_bulk_modulus: 1.5e9, entrained_air: 0, relative_tolerance: 1e-6}
volumes:
  A: {rigid_volume: 3e-4, initial_pressure: )" +
                              pressure + R"(}
  B: {rigid_volume: 2e-4, initial_pressure: 1e5}
  T: {fixed: true, initial_pressure: 1e5}
components:
  C: {type: double_acting_cylinder, force: F, port_a: A, port_b: B, piston_diameter: 80 mm, rod_diameter: 45 mm, piston_length: 0,
      chamber_length: 1 m, rod_length: 1.1 m, minimum_stroke: 20 mm, maximum_stroke: 980 mm, cylinder_coefficient: 1,
      bulk_modulus: 1e30, viscous_friction: 0}
  O: {type: orifice, port_1: B, port_2: T, diameter: )" +
                              diameter + R"(}
)",
                          "drained rod side", overrides);
}

// largest of a trace less its smallest
double range(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most - *least;
}

TEST(ChambersApart, AClosedOneKeepsItsSpringBesideADrainedOneAtEveryStep) {
  constexpr double kDuration = 0.5;
  const double spring = kBulkModulus * kA * kA / (kRigidVolume + kA * kStroke);
  const double swing = 2 * kSpeed / std::sqrt(spring / kMass);
  for (const char* const diameter : {"6 mm", "12 mm", "20 mm"}) {
    const Traces reference = reference_traces(cylinder(diameter, {}), kDuration);
    const double reached = range(reference[0].x);
    EXPECT_NEAR(reached, swing, 0.15 * swing) << diameter;  // the drain damps a little
    for (const auto& [step, two, linear] :
         {std::tuple("1 ms", 5e-3, 2e-2), std::tuple("2 ms", 1e-2, 5e-2), std::tuple("5 ms", 3e-2, 0.2)}) {
      for (const auto& [level, bound] : {std::pair("two", two), std::pair("linear", linear)}) {
        const scene::Scene scene =
            cylinder(diameter, {std::string("session.step=") + step, std::string("session.coupling=") + level});
        const Comparison result = compare(scene, reference, kDuration);
        EXPECT_FALSE(result.has_failed);
        EXPECT_LT(result.ports[0].x, bound * reached) << diameter << ", " << step << ", " << level;
      }
    }
  }
}

}  // namespace chambers_apart_test
}  // namespace slew::coupling::test
