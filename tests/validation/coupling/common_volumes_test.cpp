// SPDX-License-Identifier: Apache-2.0
// Cylinders on common volumes: one volume of oil answers the motion of all pistons (hydraulics_node/shared_volumes.h).
// Against one cylinder of their total area, and against the monolith. With K of each port alone the errors below were
// 1.1 mm of 1 mm at 10 ms.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace common_volumes_test {

struct Piston {
  double bore, rod;         // mm
  bool is_opposed = false;  // from above, its chambers on the volumes of the other's
};

// a mass of 4000 kg on cylinders whose chambers share two closed volumes, with a speed at the start
scene::Scene lift(const std::vector<Piston>& pistons, const std::string& step) {
  std::string forces, components;
  double up = 0, back = 0;  // areas towards A and B [mm2], without pi/4
  for (std::size_t i = 0; i < pistons.size(); ++i) {
    const auto& [bore, rod, is_opposed] = pistons[i];
    forces += fmt::format(
        "  F{}: {{type: translational, body1: Ground, point1: [{}, {}, 0], body2: M, point2: [{}, 0, 0]}}\n", i,
        0.1 * i, is_opposed ? 3.2 : 0.0, 0.1 * i);
    components += fmt::format(
        "  C{}: {{type: double_acting_cylinder, force: F{}, port_a: {}, port_b: {}, piston_diameter: {} mm, "
        "rod_diameter: {} mm, piston_length: 0, chamber_length: 1 m, rod_length: 1.1 m, minimum_stroke: 20 mm, "
        "maximum_stroke: 980 mm, cylinder_coefficient: 1, bulk_modulus: 1e30}}\n",
        i, i, is_opposed ? "B" : "A", is_opposed ? "A" : "B", bore, rod);
    up += is_opposed ? bore * bore - rod * rod : bore * bore;
    back += is_opposed ? bore * bore : bore * bore - rod * rod;
  }
  const double p_B = 20e5, p_A = (4000 * 9.81 / (std::acos(-1.0) / 4 * 1e-6) + p_B * back) / up;
  return scene::load_text(fmt::format(R"(
session: {{step: {}}}
mechanics: {{gravity: [0, -9.81, 0]}}
bodies:
  M: {{position: [0, 1.6, 0], mass: 4000, inertia: [1, 1, 1]}}
joints:
  R: {{type: prismatic, body2: M, point1: [0, 1.6, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0],
      initial_velocity: 0.05}}
forces:
{}hydraulics: {{start: table13, oil_bulk_modulus: 1.5e9, entrained_air: 0, relative_tolerance: 1e-8}}
volumes:
  A: {{rigid_volume: 3e-4, initial_pressure: {}}}
  B: {{rigid_volume: 3e-4, initial_pressure: {}}}
components:
{})",
                                      step, forces, p_A, p_B, components),
                          "lift");
}

std::vector<double> strokes(const scene::Scene& scene) {
  CoupledRun run(scene);
  EXPECT_TRUE(run.start().is_ok());
  std::vector<double> x;
  while (run.time() < SimTime{} + milliseconds(500) && !run.has_failed()) {
    run.step({});
    x.push_back(run.mechanism().x[0]);
  }
  EXPECT_FALSE(run.has_failed());
  return x;
}

TEST(CommonVolumes, CylindersSideBySideMoveAsOneOfTheirTotalAreaAtEveryStep) {
  for (const char* const step : {"1 ms", "5 ms", "10 ms"}) {
    const std::vector<double> one = strokes(lift({{100, 50}}, step));
    for (const auto& [first, second] :
         {std::pair(Piston{80, 40}, Piston{60, 30}), std::pair(Piston{96, 48}, Piston{28, 14})}) {
      const std::vector<double> two = strokes(lift({first, second}, step));
      ASSERT_EQ(two.size(), one.size());
      for (std::size_t n = 0; n < one.size(); ++n) ASSERT_NEAR(two[n], one[n], 1e-8) << step << ", step " << n;
    }
  }
}

// Two masses of 2000 kg on a cylinder each between volumes A and B, side by side or in series. v: speed of the second
// at the start [m/s].
scene::Scene two_lifts(bool in_series, double v, const char* step) {
  return scene::load_text(fmt::format(R"(
session: {{step: {}}}
mechanics: {{gravity: [0, -9.81, 0]}}
templates:
  Mass: {{mass: 2000, inertia: [1, 1, 1]}}
  Slide: {{type: prismatic, orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0]}}
  Cylinder: {{type: double_acting_cylinder, piston_diameter: 71 mm, rod_diameter: 35 mm, piston_length: 0,
      chamber_length: 1 m, rod_length: 1.1 m, minimum_stroke: 20 mm, maximum_stroke: 980 mm, cylinder_coefficient: 1,
      bulk_modulus: 1e30}}
bodies:
  M: {{use: Mass, position: [0, 1.6, 0]}}
  N: {{use: Mass, position: [1, 1.6, 0]}}
joints:
  R: {{use: Slide, body2: M, point1: [0, 1.6, 0], initial_velocity: 0.05}}
  S: {{use: Slide, body2: N, point1: [1, 1.6, 0], initial_velocity: {}}}
forces:
  F: {{type: translational, body1: Ground, body2: M}}
  G: {{type: translational, body1: Ground, point1: [1, 0, 0], body2: N}}
hydraulics: {{start: table13, oil_bulk_modulus: 1.5e9, entrained_air: 0, relative_tolerance: 1e-8}}
volumes:
  A: {{rigid_volume: 3e-4, initial_pressure: {}}}
  Q: {{rigid_volume: 3e-4, initial_pressure: 64 bar}}
  B: {{rigid_volume: 3e-4, initial_pressure: 20 bar}}
components:
  C: {{use: Cylinder, force: F, port_a: A, port_b: {}}}
  D: {{use: Cylinder, force: G, port_a: {}, port_b: B}}
)",
                                      step, v, in_series ? 97e5 : 64e5, in_series ? "Q" : "B", in_series ? "Q" : "A"),
                          "two lifts");
}

// largest error of the strokes against the monolith, over their ranges
double error(const scene::Scene& scene, const Traces& reference) {
  const Comparison result = compare(scene, reference, 0.5);
  EXPECT_FALSE(result.has_failed);
  double largest = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const auto [least, most] = std::minmax_element(reference[i].x.begin(), reference[i].x.end());
    largest = std::max(largest, result.ports[i].x / (*most - *least));
  }
  return largest;
}

TEST(CommonVolumes, CylindersAreAsAccurateAsOneHoweverTheyMove) {
  constexpr double kBound = 1e-3;
  const std::vector<Piston> opposed = {{70, 40}, {60, 30, true}};
  for (const char* const step : {"2 ms", "5 ms", "10 ms"}) {
    EXPECT_LT(error(lift({{100, 50}}, step), reference_traces(lift({{100, 50}}, "1 ms"), 0.5)), kBound) << step;
    EXPECT_LT(error(lift(opposed, step), reference_traces(lift(opposed, "1 ms"), 0.5)), kBound) << step;
    for (const bool in_series : {false, true}) {
      // together, against each other, one of them alone
      for (const double v : {0.05, -0.05, 0.0}) {
        const Traces reference = reference_traces(two_lifts(in_series, v, "1 ms"), 0.5);
        EXPECT_LT(error(two_lifts(in_series, v, step), reference), kBound) << step << ", " << in_series << ", " << v;
      }
    }
  }
}

}  // namespace common_volumes_test
}  // namespace slew::coupling::test
