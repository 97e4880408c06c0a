// SPDX-License-Identifier: Apache-2.0
// Case C07: a cylinder with closed ports is pulled until a chamber cavitates, and let go. Nothing can leave its
// chambers, so that it comes back to where it began: 0.5 m, 20 bar in B, and in A what balances it, 20 bar (1 -
// (45/80)^2). Twenty pulls make any oil that is lost or made twenty times visible.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/nightly.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace closed_cylinder_test {

constexpr double kStart = 0.5, kStartB = 20e5, kStartA = kStartB * (1 - 45.0 * 45 / (80 * 80));
constexpr int kPulls = 20;
constexpr double kPeriod = 3;  // s: up in 1 s, down in another, rest

// Air makes oil soft: what a method's error in a pressure is in oil is larger there, and least exact at loose
// tolerances.
constexpr double kWithoutAir = 2e-3, kWithAir = 1e-2;

std::string pulls(double force) {
  std::string table = "[[0, 0]";
  for (int k = 0; k < kPulls; ++k) {
    const double t = k * kPeriod;
    for (const auto& [after, F] : {std::pair(0.6, force), {1.0, force}, {1.6, 0.0}, {3.0, 0.0}}) {
      table += ", [" + std::to_string(t + after) + ", " + std::to_string(F) + "]";
    }
  }
  return table + "]";
}

struct Plant {
  double force = 60e3;            // N
  double viscous_friction = 2e5;  // N s/m
  std::string volume_b = "{}";    // of Vol_B
  std::string more_components = {};
};

scene::Scene plant(const Plant& plant, const scene::Overrides& overrides) {
  const std::string text = R"(
mechanics: {gravity: [0, 0, 0]}
bodies:
  Load: {position: [1.4 m, 0, 0], mass: 1000 kg, inertia: [0, 0, 0]}
joints:
  Rail: {type: prismatic, body2: Load, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0]}
forces:
  Force_Cyl: {type: translational, body1: Ground, body2: Load}
  Pull: {type: point_force, body: Load, direction: [1, 0, 0], force_table: )" +
                           pulls(plant.force) + R"(}
hydraulics: {entrained_air: 0, start_return_pressure: 20 bar}
volumes: {Vol_A: {}, Vol_B: )" +
                           plant.volume_b + R"(}
components:
)" + plant.more_components +
                           R"(
  Cyl: {type: double_acting_cylinder, force: Force_Cyl, port_a: Vol_A, port_b: Vol_B, piston_diameter: 80 mm,
        rod_diameter: 45 mm, piston_length: 0, chamber_length: 1 m, rod_length: 900 mm, minimum_stroke: 20 mm,
        maximum_stroke: 980 mm, bulk_modulus: 1e30 Pa, viscous_friction: )" +
                           std::to_string(plant.viscous_friction) + R"( Ns/m}
session: {pace: free}
)";
  return scene::load_text(text, "closed_cylinder", overrides);
}

bool has(std::uint32_t flags, StepFlag flag) {
  return (flags & static_cast<std::uint32_t>(flag)) != 0;
}

// Runs all pulls and rests at the end.
void expect_return(const scene::Scene& scene, double tolerance, const std::string& what) {
  CoupledRun run(scene);
  ASSERT_TRUE(run.start().is_ok()) << what;
  const auto steps = std::lround(kPulls * kPeriod / scene.session.step_duration().seconds());
  for (long n = 0; n < steps; ++n) run.step({});
  ASSERT_FALSE(run.has_failed()) << what;
  EXPECT_NEAR(run.variable("Vol_A.pressure"), kStartA, tolerance * kStartA) << what;
  EXPECT_NEAR(run.variable("Vol_B.pressure"), kStartB, tolerance * kStartB) << what;
  EXPECT_NEAR(run.mechanism().x[0], kStart, 2e-5) << what;
}

void expect_return(const scene::Overrides& overrides, double tolerance) {
  std::string what;
  for (const std::string& setting : overrides) what += setting + " ";
  expect_return(plant({}, overrides), tolerance, what);
}

TEST(ClosedCylinder, returns_after_twenty_pulls_into_vapour_at_a_coarse_and_a_fine_tolerance) {
  for (const char* tolerance : {"1e-3", "1e-6"}) {
    expect_return({std::string("hydraulics.relative_tolerance=") + tolerance}, kWithoutAir);
  }
}

TEST(ClosedCylinder, cavitates_in_every_pull) {
  const scene::Scene scene = plant({}, {});
  CoupledRun run(scene);
  ASSERT_TRUE(run.start().is_ok());
  for (int n = 0; n < 1000; ++n) run.step({});
  EXPECT_TRUE(has(run.flags(), StepFlag::cavitating));
  EXPECT_EQ(run.variable("Vol_A.is_cavitating"), 1);
  EXPECT_GT(run.variable("Vol_A.pressure"), 0);
}

TEST(ClosedCylinder, returns_with_another_solver_and_oil_law) {
  expect_return({"hydraulics.solver=implicit_euler"}, kWithoutAir);
  expect_return({"hydraulics.oil_law=density_parabola"}, kWithoutAir);
}

TEST(ClosedCylinder, returns_with_air) {
  for (const char* air : {"1e-4", "0.05"}) {
    expect_return({std::string("hydraulics.entrained_air=") + air}, kWithAir);
  }
}

TEST(ClosedCylinder, returns_with_every_solver_oil_law_and_toleranceNightly) {
  for (const char* solver : {"rodas3", "rk4", "implicit_euler", "cvode"}) {
    for (const char* tolerance : {"1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8"}) {
      for (const char* oil : {"entrained_air=0", "entrained_air=0.005", "oil_law=density_parabola"}) {
        const double most = std::string(oil) == "entrained_air=0.005" ? kWithAir : 2 * kWithoutAir;
        expect_return({std::string("hydraulics.solver=") + solver,
                       std::string("hydraulics.relative_tolerance=") + tolerance, std::string("hydraulics.") + oil},
                      most);
      }
    }
  }
}

TEST(ClosedCylinder, returns_with_a_hose_and_a_block) {
  Plant with_hose;
  with_hose.more_components = "  Hose: {type: hose, volume: Vol_A, length: 3 m, diameter: 20 mm}";
  expect_return(plant(with_hose, {}), kWithoutAir, "hose");
}

TEST(ClosedCylinder, returns_with_chambers_that_are_lines) {
  expect_return({"session.coupling=tlm"}, kWithoutAir);
  expect_return({"session.coupling=tlm", "hydraulics.entrained_air=1e-4"}, kWithAir);
  // air that makes the oil soft over all of the motion
  expect_return({"session.coupling=tlm", "hydraulics.entrained_air=0.005"}, 4e-2);
}

TEST(ClosedCylinder, returns_with_steps_of_5_ms) {
  expect_return({"session.step=5ms"}, kWithoutAir);
}

TEST(ClosedCylinder, returns_with_held_forcesNightly) {
  expect_return({"session.coupling=hold", "session.step=0.1ms"}, kWithoutAir);
}

// B on a tank of 20 bar: the piston goes 0.4 m into the vapour, and the tank's pressure brings it back slowly
Plant far() {
  Plant plant;
  plant.viscous_friction = 5e4;
  plant.volume_b = "{fixed: true, initial_pressure: 20 bar}";
  return plant;
}

TEST(ClosedCylinder, follows_the_monolith_deep_into_vapour_whatever_the_level_and_solver) {
  constexpr int kSteps = 3000;
  const scene::Scene whole = plant(far(), {});
  monolith::Monolith reference(whole);
  ASSERT_TRUE(reference.start().is_ok());
  double farthest = 0;
  for (int n = 1; n <= kSteps; ++n) {
    const Status status = reference.advance_to({n * 1'000'000LL}, {});
    ASSERT_TRUE(status.is_ok()) << status.text;
    farthest = std::max(farthest, reference.ports()[0].x);
  }
  EXPECT_GT(farthest, 0.8);
  for (const char* setting : {"session.coupling=two", "session.coupling=tlm", "hydraulics.solver=implicit_euler",
                              "hydraulics.solver=cvode", "hydraulics.relative_tolerance=1e-8"}) {
    const scene::Scene scene = plant(far(), {setting});
    CoupledRun run(scene);
    ASSERT_TRUE(run.start().is_ok());
    for (int n = 0; n < kSteps; ++n) run.step({});
    EXPECT_NEAR(run.mechanism().x[0], reference.ports()[0].x, 1e-5) << setting;
  }
}

TEST(ClosedCylinder, returns_in_the_monolith) {
  const scene::Scene scene = plant({}, {});
  monolith::Monolith reference(scene);
  ASSERT_TRUE(reference.start().is_ok());
  for (int n = 1; n <= std::lround(1e3 * kPulls * kPeriod); ++n) {
    const Status status = reference.advance_to({n * 1'000'000LL}, {});
    ASSERT_TRUE(status.is_ok()) << status.text;
  }
  EXPECT_NEAR(reference.variable("Vol_A.pressure"), kStartA, 1e-5 * kStartA);
  EXPECT_NEAR(reference.variable("Vol_B.pressure"), kStartB, 1e-5 * kStartB);
}

}  // namespace closed_cylinder_test
}  // namespace slew::coupling::test
