// SPDX-License-Identifier: Apache-2.0
// A load that swings on oil, part of which stands behind a passage: what leaves the chamber is still there
// (hydraulics/step_response.h, docs/models/coupling_levels.md). Against the monolith.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "scene/scene.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace circuit_around_test {

constexpr double kDuration = 1;

// 2 t on a cylinder at rest but for 0.02 m/s; parts: what stands behind its chamber A
std::string load_on(const std::string& volumes, const std::string& parts) {
  return R"(
mechanics: {gravity: [0, -9.81, 0]}
hydraulics: {start: table13, relative_tolerance: 1e-5}
bodies:
  M: {position: [0, 0.6, 0], mass: 2000, inertia: [1, 1, 1]}
joints:
  R: {type: prismatic, body2: M, point1: [0, 0, 0], orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0],
      point2: [0, -0.6, 0], initial_velocity: 0.02}
forces:
  F: {type: translational, body1: Ground, body2: M}
volumes:
  A: {rigid_volume: 0.1 l, initial_pressure: 50.45 bar}
  T: {fixed: true, initial_pressure: 5 bar}
)" + volumes +
         R"(
components:
  C: {type: double_acting_cylinder, force: F, port_a: A, port_b: T, piston_diameter: 80 mm, rod_diameter: 45 mm,
      piston_length: 50 mm, chamber_length: 0.8 m, rod_length: 0.3 m, minimum_stroke: 0, maximum_stroke: 0.7 m,
      dead_volume: 0.05 l, bulk_modulus: 1e10 Pa, viscous_friction: 500}
)" + parts;
}

const std::string kHose = "  V: {rigid_volume: 0.1 l, initial_pressure: 50.45 bar}\n";

struct Case {
  const char* name;
  std::string volumes, parts;
  double at_1_ms, at_5_ms;  // bounds of the stroke's error over its range
};

// with the pressures around the chamber held, the passages had errors of 0.24 to 4.5 swings at 1 ms, 7 to 56 at 5 ms
TEST(CircuitAround, OilBehindAPassageIsStillThere) {
  for (const Case& one : std::vector<Case>{
           {"narrow passage", kHose,
            "  P: {type: bleed, port_1: V, port_2: A, nominal_flow: 5 l/min, nominal_pressure_drop: 5 bar}\n", 0.05,
            0.15},
           {"passage", kHose,
            "  P: {type: bleed, port_1: V, port_2: A, nominal_flow: 40 l/min, nominal_pressure_drop: 5 bar}\n", 0.012,
            0.004},
           {"wide passage", kHose,
            "  P: {type: bleed, port_1: V, port_2: A, nominal_flow: 400 l/min, nominal_pressure_drop: 5 bar}\n", 1e-3,
            5e-3},
           {"two passages in a row", kHose + "  W: {rigid_volume: 0.2 l, initial_pressure: 50.45 bar}\n",
            "  P: {type: bleed, port_1: V, port_2: A, nominal_flow: 100 l/min, nominal_pressure_drop: 5 bar}\n"
            "  Q: {type: bleed, port_1: W, port_2: V, nominal_flow: 100 l/min, nominal_pressure_drop: 5 bar}\n",
            2e-3, 4e-3},
           {"check valve of a lock", kHose,
            "  P: {type: throttle_check_valve, port_1: V, port_2: A, nominal_flow: 100 l/min, nominal_pressure_drop: 5 "
            "bar, "
            "throttle_flow: 10 l/min}\n",
            0.03, 0.03},
           {"accumulator", "",
            "  P: {type: accumulator, port_1: A, gas_volume: 0.05 l, precharge_pressure: 30 bar, nominal_flow: 60 "
            "l/min}\n",
            3e-3, 3e-3}}) {
    const std::string text = load_on(one.volumes, one.parts);
    const scene::Scene reference_scene = scene::load_text(text, one.name);
    const Traces reference = reference_traces(reference_scene, kDuration);
    const auto [least, most] = std::minmax_element(reference[0].x.begin(), reference[0].x.end());
    for (const auto& [step, bound] : {std::pair("1 ms", one.at_1_ms), std::pair("5 ms", one.at_5_ms)}) {
      const scene::Scene scene = scene::load_text(text, one.name, {std::string("session.step=") + step});
      const Comparison result = compare(scene, reference, kDuration);
      EXPECT_FALSE(result.has_failed) << one.name << ", " << step;
      EXPECT_LT(result.ports[0].x, bound * (*most - *least)) << one.name << ", " << step;
    }
  }
}

}  // namespace circuit_around_test
}  // namespace slew::coupling::test
