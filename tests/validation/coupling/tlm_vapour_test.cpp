// SPDX-License-Identifier: Apache-2.0
// Chambers of level tlm that are pulled into vapour take no more oil than they have room, or the run ends by name; and
// what is read from a chamber does not depend on its level where the level has no effect.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace tlm_vapour_test {

constexpr double kAreaB = std::numbers::pi / 4 * (0.063 * 0.063 - 0.036 * 0.036);
constexpr double kOil = 1.4e9;  // Pa, of the oil alone

// 500 kg on a vertical cylinder; B breathes through an orifice, A is fed by 40 l/min up and down.
constexpr const char* kBreathing = R"(
hydraulics: {oil_bulk_modulus: 1.4 GPa, start: equilibrium, start_return_pressure: 5 bar}
bodies:
  Load: {mass: 500 kg, inertia: [10, 10, 10]}
joints:
  Rail: {type: prismatic, body2: Load, orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0]}
forces:
  Line: {type: translational, body1: Ground, point1: [0, -1.5 m, 0], body2: Load}
volumes:
  T: {initial_pressure: 1 bar, fixed: true}
  A: {rigid_volume: 0.1 l}
  B: {rigid_volume: 0.1 l}
components:
  Cyl: {type: double_acting_cylinder, force: Line, port_a: A, port_b: B, piston_diameter: 63 mm, rod_diameter: 36 mm,
        piston_length: 40 mm, chamber_length: 800 mm, rod_length: 1000 mm, minimum_stroke: 20 mm,
        maximum_stroke: 700 mm, dead_volume: 0.05 l, seal_friction: 200 N}
  Breather: {type: orifice, port_1: B, port_2: T, diameter: 8 mm}
  Source: {type: flow_source, port_1: T, port_2: A, flow: 0}
session: {duration: 4 s, pace: free}
)";

// The source's changes that are due at step n.
void feed(CoupledRun& run, long n, double H) {
  const auto is_at = [&](double t) { return n == std::lround(t / H); };
  constexpr double kFeed = 40e-3 / 60;  // m3/s
  if (is_at(0.2)) run.change("Source.flow", kFeed, milliseconds(100));
  if (is_at(0.9)) run.change("Source.flow", -kFeed, milliseconds(50));
  if (is_at(1.5)) run.change("Source.flow", 0, milliseconds(50));
}

struct Breath {
  double unbalanced = 0;  // m3, largest difference of the oil that came in and the room that the piston made
  double stroke = 0;      // m, at the end
  double lowest = 1e9;    // Pa, of B
  bool is_empty = false;  // B cavitates at the end
};

Breath breathe(const char* level, double H) {
  const scene::Scene scene =
      scene::load_text(kBreathing, "breathing",
                       {std::string("session.coupling=") + level, "session.step=" + std::to_string(1e3 * H) + " ms"});
  CoupledRun run(scene);
  EXPECT_TRUE(run.start().is_ok());
  Breath result;
  const double start = run.variable("Cyl.stroke");
  double came = 0, flow = 0;
  for (long n = 0; n < std::lround(4 / H); ++n) {
    feed(run, n, H);
    run.step({});
    const double now = -run.variable("Breather.flow");
    came += 0.5 * H * (flow + now);
    flow = now;
    result.stroke = run.variable("Cyl.stroke");
    result.unbalanced = std::max(result.unbalanced, std::fabs(came + kAreaB * (result.stroke - start)));
    result.lowest = std::min(result.lowest, run.variable("B.pressure"));
  }
  EXPECT_FALSE(run.has_failed());
  result.is_empty = run.variable("B.is_cavitating") != 0;
  return result;
}

// The oil that comes is read from flows at the ends of steps and counted at the pressure of B, where the air in 1.4 l
// takes 7 ml at 1 bar and 14 ml at 0.5 bar.
constexpr double kAir = 20e-6;  // m3

TEST(TlmVapour, AChamberTakesNoMoreOilThanItsPistonMakesRoom) {
  const Breath reference = breathe("two", 1e-3);
  EXPECT_LT(reference.unbalanced, kAir);
  for (const double H : {1e-3, 5e-3}) {
    const Breath lines = breathe("tlm", H);
    EXPECT_LT(lines.lowest, 1e4) << H;
    EXPECT_LT(lines.unbalanced, kAir) << H;
    EXPECT_NEAR(lines.stroke, reference.stroke, 5e-3) << H;
    EXPECT_FALSE(lines.is_empty) << H;
  }
}

// A load that a valve of 60 mm2 lets fall back at once from the upper stop.
constexpr const char* kBlow = R"(
hydraulics: {entrained_air: 0.005, oil_bulk_modulus: 1.4 GPa, oil_density: 870, start: equilibrium,
             start_return_pressure: 10 bar, start_pump_pressure: 20 bar}
bodies:
  Load: {mass: 500 kg, inertia: [10, 10, 10]}
joints:
  Rail: {type: prismatic, body2: Load, orientation1: [-90 deg, 0, 0], orientation2: [-90 deg, 0, 0]}
forces:
  Line: {type: translational, body1: Ground, point1: [0, -1.5 m, 0], body2: Load}
volumes:
  T: {initial_pressure: 1 bar, fixed: true}
  P: {initial_pressure: 90 bar, fixed: true}
  A: {rigid_volume: 0.1 l}
  B: {rigid_volume: 0.1 l}
components:
  Cyl: {type: double_acting_cylinder, force: Line, port_a: A, port_b: B, piston_diameter: 63 mm, rod_diameter: 36 mm,
        piston_length: 40 mm, chamber_length: 800 mm, rod_length: 1000 mm, minimum_stroke: 20 mm,
        maximum_stroke: 700 mm, dead_volume: 0.05 l, seal_friction: 0}
  Valve: {type: four_way_valve, port_p: P, port_a: A, port_b: B, port_t: T, edge_area: 60 mm2, neutral_opening: 0.5,
          opening_gain: 0.5}
inputs:
  Lever: {type: analog, primitive: Valve}
session: {duration: 3 s, pace: free}
)";

double lever(double t) {
  if (t < 0.2) return 0;
  if (t < 0.3) return 0.8 * (t - 0.2) / 0.1;
  if (t < 1.5) return 0.8;
  return t < 1.6 ? 0.8 - 1.7 * (t - 1.5) / 0.1 : -0.9;
}

TEST(TlmVapour, ABlowThatAStepCannotFollowEndsTheRunByName) {
  for (const char* level : {"tlm", "two"}) {
    const scene::Scene scene = scene::load_text(kBlow, "blow", {std::string("session.coupling=") + level});
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok());
    for (int n = 0; n < 3000 && !run.has_failed(); ++n) {
      const double signal = lever((n + 0.5) * 1e-3);
      run.step({&signal, 1});
      ASSERT_LT(run.variable("B.pressure"), 250e5) << level;
    }
    EXPECT_EQ(run.has_failed(), std::string(level) == "tlm");
    if (!run.has_failed()) continue;
    const std::string text(run.hydraulics().failure_text());
    EXPECT_EQ(text.substr(0, 3), "B: ") << text;
    for (const char* part : {"level tlm", "coupling: two", "session.step"}) {
      EXPECT_NE(text.find(part), std::string::npos) << text;
    }
  }
}

// In a monolith no level has an effect: the force is that of the pressures less the friction, no stop touched.
TEST(TlmVapour, ReadingsOfAMonolithDoNotDependOnTheLevel) {
  for (const char* level : {"hold", "linear", "two", "tlm"}) {
    const scene::Scene scene = scene::load_text(
        kBreathing, "breathing", {std::string("session.coupling=") + level, "session.solution=monolithic"});
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok());
    double off = 0, stiffest = 0, largest = 0;
    for (long n = 0; n < 600; ++n) {
      feed(run, n, 1e-3);
      run.step({});
      ASSERT_FALSE(run.has_failed()) << level;
      const double line = run.variable("Cyl.pressure_force") - run.variable("Cyl.friction_force");
      off = std::max(off, std::fabs(run.variable("Cyl.force") - line));
      largest = std::max(largest, std::fabs(line));
      for (const char* name : {"A.effective_bulk_modulus", "B.effective_bulk_modulus"}) {
        stiffest = std::max(stiffest, run.variable(name));
      }
    }
    EXPECT_GT(largest, 4e3) << level;
    EXPECT_LT(off, 1e-9 * largest) << level;
    EXPECT_GT(stiffest, 0.5 * kOil) << level;
    EXPECT_LT(stiffest, kOil) << level;
  }
}

TEST(TlmVapour, TheEffectiveModulusIsAtMostThatOfTheOil) {
  for (const char* level : {"two", "tlm"}) {
    const scene::Scene scene = scene::load_text(kBreathing, "breathing", {std::string("session.coupling=") + level});
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok());
    double stiffest = 0;
    for (long n = 0; n < 900; ++n) {
      feed(run, n, 1e-3);
      run.step({});
      for (const char* name : {"A.effective_bulk_modulus", "B.effective_bulk_modulus"}) {
        stiffest = std::max(stiffest, run.variable(name));
      }
    }
    EXPECT_GT(stiffest, 0.5 * kOil) << level;
    EXPECT_LT(stiffest, kOil) << level;
  }
}

}  // namespace tlm_vapour_test
}  // namespace slew::coupling::test
