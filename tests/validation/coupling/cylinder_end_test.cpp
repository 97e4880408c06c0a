// SPDX-License-Identifier: Apache-2.0
// A load that runs a cylinder into its end: the speed that it comes back with against the closed form of a spring and a
// damper that only push (tests/validation/mechanics_node/limits_test.cpp), through mechanics and hydraulics together.
// The bore is so small that its oil weighs nothing against the blow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace cylinder_end_test {

constexpr double kMass = 1000, kSpeed = 1.5;

// stroke of an end, direction of the motion into it, place of the load 0.2 m before it
struct End {
  double stroke, direction, start;
};
constexpr End kIn = {0.2, -1, 1.3}, kOut = {0.98, 1, 1.68};

scene::Scene load(double k, double c, const char* mechanics, const char* level, const End& end = kIn) {
  char ends[100], place[100];
  std::snprintf(ends, sizeof ends, "end_stiffness: %.17g N/m, end_damping: %.17g Ns/m}\n", k, c);
  std::snprintf(place, sizeof place, "Load.position=[0, %.17g, 0]", end.start);
  return scene::load_text(std::string("mechanics: {gravity: [0, 0, 0], ") + mechanics + R"(}
bodies:
  Load: {position: [0, 1.3 m, 0], mass: 1000 kg, inertia: [0, 0, 0]}
joints:
  Rail: {type: prismatic, body2: Load, orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0], initial_velocity: -1.5}
forces:
  Force_Cyl: {type: translational, body1: Ground, body2: Load}
hydraulics: {oil_bulk_modulus: 1.5e9 Pa, entrained_air: 0, start_return_pressure: 1 bar}
volumes: {Vol_A: {initial_pressure: 1 bar, fixed: true}, Vol_T: {initial_pressure: 1 bar, fixed: true}}
components:
  Cyl: {type: double_acting_cylinder, force: Force_Cyl, port_a: Vol_A, port_b: Vol_T, piston_diameter: 1 mm,
        rod_diameter: 0.5 mm, piston_length: 0, chamber_length: 1 m, rod_length: 900 mm, attachment_length: 0,
        minimum_stroke: 200 mm, maximum_stroke: 980 mm, bulk_modulus: 1e30 Pa, )" +
                              ends + "session: {duration: 1 s, pace: free, step: 1 ms, coupling: " + level + "}\n",
                          "cylinder_end",
                          {place, end.direction < 0 ? "Rail.initial_velocity=-1.5" : "Rail.initial_velocity=1.5"});
}

double rebound(double k, double c) {
  const double w = std::sqrt(k / kMass), zeta = c / (2 * w * kMass), root = std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta * std::atan2(2 * zeta * root, 2 * zeta * zeta - 1) / root);
}

TEST(CylinderEnd, ThrowsBackAsTheClosedForm) {
  for (const char* mechanics : {"integrator: rk4", "integrator: trapezoidal", "formulation: augmented"}) {
    for (const char* level : {"two", "hold"}) {
      for (const double k : {1e6, 1e9, 1e11, 1e13}) {
        for (const double zeta : {0.0, 0.1, 0.9}) {
          const double c = 2 * zeta * std::sqrt(k * kMass);
          SCOPED_TRACE(std::string(mechanics) + ", " + level + ", k = " + std::to_string(k) +
                       ", zeta = " + std::to_string(zeta));
          const scene::Scene scene = load(k, c, mechanics, level);
          CoupledRun run(scene);
          ASSERT_TRUE(run.start().is_ok());
          const double start = 0.5 * kMass * kSpeed * kSpeed;
          for (int n = 0; n < 250; ++n) {
            run.step({});
            const double v = run.mechanism().v[0], depth = std::max(0.0, 0.2 - run.mechanism().x[0]);
            // the oil behind the rod pushes with less than 0.1 N
            ASSERT_LT(0.5 * kMass * v * v + 0.5 * k * depth * depth, 1.003 * start) << n;
          }
          EXPECT_NEAR(run.mechanism().v[0] / kSpeed, rebound(k, c), 0.012);
        }
      }
    }
  }
}

TEST(CylinderEnd, ThrowsBackAtEitherEndOfTheStroke) {
  for (const End& end : {kIn, kOut}) {
    for (const double zeta : {0.0, 0.1, 0.9}) {
      const double k = 1e9, c = 2 * zeta * std::sqrt(k * kMass);
      SCOPED_TRACE("end at " + std::to_string(end.stroke) + " m, zeta = " + std::to_string(zeta));
      const scene::Scene scene = load(k, c, "integrator: rk4", "two", end);
      CoupledRun run(scene);
      ASSERT_TRUE(run.start().is_ok());
      ASSERT_NEAR(run.mechanism().x[0], end.stroke - 0.2 * end.direction, 1e-12);
      for (int n = 0; n < 250; ++n) run.step({});
      EXPECT_NEAR(run.mechanism().v[0] / kSpeed, -end.direction * rebound(k, c), 0.012);
    }
  }
}

// c h/m from 1e-2 to 1e6 with a spring of 1e5 N/m, which gives back no more than it takes before the damper has all
TEST(CylinderEnd, ThatDampsGivesNothingBack) {
  for (const double per_step : {10.0, 1e3, 1e6}) {
    SCOPED_TRACE(per_step);
    const scene::Scene scene = load(1e5, per_step * kMass / 1e-3, "integrator: rk4", "two");
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok());
    for (int n = 0; n < 250; ++n) {
      run.step({});
      ASSERT_LT(run.mechanism().v[0], 1e-4 * kSpeed) << n;
    }
    EXPECT_NEAR(run.mechanism().x[0], 0.2, 2e-4);
  }
}

// 100 bar on 63 mm press the piston against a stop that only damps: it creeps on by F/d, and the run ends by name where
// it is a tenth of its way of 1 m out of its barrel.
TEST(CylinderEnd, ThatOnlyDampsLetsThePistonCreepOutOfItsBarrelByName) {
  const double A = std::numbers::pi / 4 * 0.063 * 0.063, B = A - std::numbers::pi / 4 * 0.036 * 0.036;
  const double creep = (100e5 * A - 1e5 * B) / 1e5;
  for (const char* solution : {"split", "monolithic"}) {
    SCOPED_TRACE(solution);
    scene::Scene scene = load(0, 1e5, "integrator: rk4", "two", kOut);
    scene = scene::load_text(scene.expanded_text, "cylinder_end",
                             {"Cyl.piston_diameter=63 mm", "Cyl.rod_diameter=36 mm", "Vol_A.initial_pressure=100 bar",
                              "hydraulics.start=table13", std::string("session.solution=") + solution});
    EXPECT_TRUE(std::any_of(scene.warnings.begin(), scene.warnings.end(), [](const std::string& warning) {
      return warning.find(
                 "Cyl.end_stiffness: the stop has no stiffness: a piston pressed into it creeps on, by 312 "
                 "mm/s at 100 bar") != std::string::npos;
    }));
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok());
    double last = 0;
    for (int n = 0; n < 2000 && !run.has_failed(); ++n) {
      last = run.mechanism().x[0];
      run.step({});
      if (last > 1.05 && !run.has_failed()) {
        EXPECT_NEAR(run.mechanism().v[0], creep, 1e-3 * creep);
      }
    }
    ASSERT_TRUE(run.has_failed());
    EXPECT_NEAR(last, 1.1, 1e-3 * creep);
    const std::string text(run.failure_text());
    EXPECT_EQ(text.substr(0, 5), "Cyl: ") << text;
    EXPECT_NE(text.find("out of its barrel, in which it goes from 0 to 1 m"), std::string::npos) << text;
  }
}

}  // namespace cylinder_end_test
}  // namespace slew::coupling::test
