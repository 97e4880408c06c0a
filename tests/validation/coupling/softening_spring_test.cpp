// SPDX-License-Identifier: Apache-2.0
// A mass between two closed chambers of oil with air, whose springs soften by up to a thousand within each half swing
// and stiffen again (hydraulics_node/foreseen_forces.h). Nothing damps it: it swings for ever between the same two
// strokes. They are computed apart, by the oil's law of docs/models/hydraulics_volumes_and_oil.md alone (Runge-Kutta of
// order 4, 20 us).
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace softening_spring_test {

constexpr double kEnd = 1.2, kLook = 0.4;  // s, and the last part of it
constexpr double kStated = 0.02;           // error of a turn over the range

struct Swing {
  double mass, p_a, p_b, speed;  // kg, bar, bar, m/s, at 500 mm
  double most, least;            // mm, the right strokes
  std::vector<std::string> steps = {"1 ms", "2 ms", "5 ms"};
};

const std::vector<Swing> kSwings = {{600, 30, 40, 0.6, 503.505, 496.806},
                                    {600, 40, 30, 1.5, 510.195, 491.666},
                                    {2000, 20, 20, 0.8, 510.181, 491.264},
                                    {200, 60, 60, 2.0, 507.037, 494.187, {"1 ms", "2 ms"}}};

scene::Scene scene_of(const Swing& swing, const std::string& step, const std::string& level) {
  return scene::load_text(fmt::format(R"(
session: {{step: {}, coupling: {}}}
mechanics: {{gravity: [0, 0, 0]}}
bodies: {{M: {{position: [1.4, 0, 0], mass: {}, inertia: [1, 1, 1]}}}}
joints:
  J: {{type: prismatic, body2: M, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0], initial_velocity: {}}}
forces:
  L: {{type: translational, body1: Ground, body2: M}}
hydraulics: {{start: table13, relative_tolerance: 1e-5}}
volumes: {{A: {{initial_pressure: {} bar}}, B: {{initial_pressure: {} bar}}}}
components:
  Cyl: {{type: double_acting_cylinder, force: L, port_a: A, port_b: B, piston_diameter: 80 mm, rod_diameter: 40 mm,
         piston_length: 0, chamber_length: 1 m, rod_length: 900 mm, minimum_stroke: 20 mm, maximum_stroke: 980 mm,
         bulk_modulus: 1e30 Pa, cylinder_coefficient: 1}}
)",
                                      step, level, swing.mass, swing.speed, swing.p_a, swing.p_b),
                          "swing");
}

struct Outcome {
  double most = 0, least = 1e3;  // mm, in the last part
  bool has_failed = false;
  std::string text;
};

Outcome run(const scene::Scene& scene, double end) {
  CoupledRun session(scene);
  const Status status = session.start();
  EXPECT_TRUE(status.is_ok()) << status.text;
  Outcome outcome;
  while (session.time().seconds() < end - 1e-9 && !session.has_failed()) {
    session.step({});
    if (session.time().seconds() < end - kLook) continue;
    outcome.most = std::max(outcome.most, 1e3 * session.mechanism().x[0]);
    outcome.least = std::min(outcome.least, 1e3 * session.mechanism().x[0]);
  }
  outcome.has_failed = session.has_failed();
  outcome.text = std::string(session.hydraulics().failure_text());
  return outcome;
}

// With the springs of the sample's instant the second one grows to twice its range within 1 s at 2 ms, to 20 times at
// 5 ms.
TEST(SofteningSpring, TurnsWithinAStatedShareOfItsRangeAtLevelTwo) {
  for (const Swing& swing : kSwings) {
    for (const std::string& step : swing.steps) {
      const Outcome outcome = run(scene_of(swing, step, "two"), kEnd);
      EXPECT_FALSE(outcome.has_failed) << outcome.text;
      const double range = swing.most - swing.least;
      EXPECT_NEAR(outcome.most, swing.most, kStated * range) << swing.mass << " kg, " << swing.p_a << " bar, " << step;
      EXPECT_NEAR(outcome.least, swing.least, kStated * range)
          << swing.mass << " kg, " << swing.p_a << " bar, " << step;
    }
  }
}

// beyond what level two follows, and level linear, whose hydraulics hold the speed: both grow, by 3 to 400 % in 1 s
TEST(SofteningSpring, OfAPortThatGainsEnergyEndsTheRunByName) {
  const Swing& swing = kSwings[0];
  for (const auto& [step, level] : {std::pair("3 ms", "linear"), {"5 ms", "linear"}}) {
    const Outcome outcome = run(scene_of(swing, step, level), 2);
    EXPECT_TRUE(outcome.has_failed) << step << ' ' << level << ' ' << outcome.most;
    EXPECT_NE(outcome.text.find("Cyl: the coupling diverges"), std::string::npos) << outcome.text;
    EXPECT_NE(outcome.text.find("coupling: two"), std::string::npos) << outcome.text;
  }
}

}  // namespace softening_spring_test
}  // namespace slew::coupling::test
