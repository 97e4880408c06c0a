// SPDX-License-Identifier: Apache-2.0
// A chamber under pressure whose piston moves out of it: it empties within a step, and from then on can only pull as
// much as the atmosphere pushes. The mechanics continued the force of its oil beyond the vacuum: 27 kN in the place of
// 196 N, and a fifth of the speed was lost. Against the monolith.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "scene/scene.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace emptying_chamber_test {

struct Slide {
  double mass, speed, pressure;  // kg, m/s, bar
};

// a slide that leaves with a speed; a check valve lets oil in from the tank
scene::Scene slide(const Slide& slide, const std::string& step, const std::string& level = "two") {
  return scene::load_text(fmt::format(R"(
session: {{step: {}, coupling: {}}}
bodies: {{M: {{position: [1.3, 0, 0], mass: {}, inertia: [1, 1, 1]}}}}
joints:
  J: {{type: prismatic, body2: M, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0], initial_velocity: {}}}
forces:
  L: {{type: translational, body1: Ground, body2: M}}
hydraulics: {{start: table13, relative_tolerance: 1e-6}}
volumes:
  T: {{initial_pressure: 1 bar, fixed: true}}
  A: {{initial_pressure: {} bar, rigid_volume: 0.05 l}}
components:
  Cyl: {{type: single_acting_cylinder, force: L, port_a: A, port_b: T, piston_diameter: 50 mm, piston_length: 30 mm,
         chamber_length: 1 m, rod_length: 1 m, minimum_stroke: 0.02 m, maximum_stroke: 0.95 m, cylinder_coefficient: 1}}
  S: {{type: check_valve, port_1: T, port_2: A, nominal_flow: 200 l/min}}
)",
                                      step, level, slide.mass, slide.speed, slide.pressure),
                          "slide");
}

constexpr double kEnd = 0.15;                                       // s
constexpr double kPull = std::numbers::pi / 4 * 0.05 * 0.05 * 1e5;  // N, of the atmosphere on the piston

// speed at the end, and the smallest force on the piston
struct Outcome {
  double speed = 0, least = 0;
};
Outcome run(const scene::Scene& scene) {
  CoupledRun session(scene);
  EXPECT_TRUE(session.start().is_ok());
  Outcome outcome;
  while (session.time().seconds() < kEnd - 1e-9) {
    session.step({});
    outcome.least = std::min(outcome.least, session.mechanism().F_used[0]);
  }
  EXPECT_FALSE(session.has_failed());
  outcome.speed = session.mechanism().v[0];
  return outcome;
}

TEST(EmptyingChamber, PullsNoMoreThanTheAtmosphereAndKeepsTheSpeed) {
  for (const Slide& one : {Slide{300, 1, 20}, Slide{100, 1.5, 20}, Slide{30, 2, 20}, Slide{100, 1.5, 150}}) {
    const double right = reference_traces(slide(one, "1 ms"), kEnd)[0].v.back();
    for (const char* const step : {"1 ms", "2 ms", "5 ms", "10 ms"}) {
      for (const char* const level : {"two", "linear"}) {
        const Outcome outcome = run(slide(one, step, level));
        // what the pressure does while it falls, of less than 1 ms, is not followed in time
        EXPECT_NEAR(outcome.speed, right, 0.02 * one.speed) << one.mass << " kg, " << one.pressure << " bar, " << step;
        // and a hundredth of what the chamber pushed with
        EXPECT_GT(outcome.least, -kPull - 0.01 * one.pressure * kPull)
            << one.mass << " kg, " << one.pressure << " bar, " << step;
      }
    }
  }
}

}  // namespace emptying_chamber_test
}  // namespace slew::coupling::test
