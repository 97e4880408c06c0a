// SPDX-License-Identifier: Apache-2.0
// The levels against the monolith, alone, mixed, and changed while the machine moves. Bounds are about twice what
// docs/coupling-results.md has measured.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace levels_test {

constexpr double kDuration = 8;  // s: lift from 1 to 5.5 s, slew from 5 s on

scene::Scene load(const std::string& file, const scene::Overrides& overrides = {}) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file, overrides);
}

double worst_share(const Comparison& run) {
  double worst = 0;
  for (const PortError& port : run.ports) worst = std::max(worst, port.F / port.F_range);
  return worst;
}

bool creates_energy(const Comparison& run) {
  return (run.flags & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy)) != 0;
}

struct Bound {
  double step;  // s
  double share;
};

void expect_within(scene::Scene& scene, Level level, const Traces& reference, const std::vector<Bound>& bounds) {
  for (const Bound& bound : bounds) {
    const Comparison run = compare(scene, bound.step, level, reference, kDuration);
    ::testing::Test::RecordProperty(
        "share_" + std::to_string(static_cast<int>(level)) + "_" + std::to_string(bound.step),
        std::to_string(worst_share(run)));
    EXPECT_FALSE(run.has_failed) << bound.step;
    EXPECT_LT(worst_share(run), bound.share) << "level " << static_cast<int>(level) << " at " << bound.step;
  }
}

TEST(Levels, OnTheCraneAreWithinWhatIsMeasured) {
  scene::Scene scene = load("truck_crane.yaml");
  const Traces reference = reference_traces(scene, kDuration);
  expect_within(scene, Level::two, reference, {{1e-3, 5e-4}, {5e-3, 2e-3}, {10e-3, 5e-3}});
  expect_within(scene, Level::linear, reference, {{1e-3, 5e-4}, {5e-3, 1e-2}, {10e-3, 4e-2}});
  expect_within(scene, Level::tlm, reference, {{0.5e-3, 4e-3}, {1e-3, 6e-3}, {5e-3, 5e-2}});
  expect_within(scene, Level::hold, reference, {{1e-3, 2e-2}});
}

TEST(Levels, LinearIsOfSecondOrder) {
  scene::Scene scene = load("single_cylinder.yaml", {"hydraulics.relative_tolerance=1e-6"});
  const Traces reference = reference_traces(scene, 3);
  double coarser = compare(scene, 4e-3, Level::linear, reference, 3).ports[0].F;
  for (const double H : {2e-3, 1e-3}) {
    const double error = compare(scene, H, Level::linear, reference, 3).ports[0].F;
    EXPECT_NEAR(std::log2(coarser / error), 2, 0.35) << H;
    coarser = error;
  }
}

TEST(Levels, TlmNeverCreatesEnergyWithoutFriction) {
  // its parasitic mass makes it wrong and slow at long steps, not unstable
  scene::Scene scene = load("single_cylinder.yaml");
  const Traces reference = reference_traces(scene, 3);
  for (const double H : {1e-3, 5e-3, 20e-3}) {
    const Comparison run = compare(scene, H, Level::tlm, reference, 3);
    EXPECT_FALSE(run.has_failed) << H;
    EXPECT_FALSE(creates_energy(run)) << H;
    EXPECT_LT(run.ports[0].F, 1.5 * run.ports[0].F_range) << H;
  }
}

TEST(Levels, MixedOnOneMachineAreAsGoodAsTheirWorst) {
  scene::Scene scene = load("truck_crane.yaml", {"Cyl_Jib.coupling=linear", "SlewCyl_CraneSlew.coupling=tlm"});
  const Traces reference = reference_traces(scene, kDuration);
  const Comparison run = compare(scene, 1e-3, Level::two, reference, kDuration);
  EXPECT_FALSE(run.has_failed);
  EXPECT_FALSE(creates_energy(run));
  constexpr std::size_t kSlew = 0, kLift = 1, kJib = 2;
  RecordProperty("lift", std::to_string(run.ports[kLift].F / run.ports[kLift].F_range));
  RecordProperty("jib", std::to_string(run.ports[kJib].F / run.ports[kJib].F_range));
  RecordProperty("slew", std::to_string(run.ports[kSlew].F / run.ports[kSlew].F_range));
  EXPECT_LT(run.ports[kLift].F, 5e-4 * run.ports[kLift].F_range);
  EXPECT_LT(run.ports[kJib].F, 5e-4 * run.ports[kJib].F_range);
  EXPECT_LT(run.ports[kSlew].F, 3e-3 * run.ports[kSlew].F_range);
}

// a cylinder that is a line every other quarter of a second has not lost its oil: it goes where the others go
TEST(Levels, ChangedWhileItMovesKeepTheOil) {
  const scene::Scene scene =
      load("single_cylinder.yaml", {"Cyl_Lift.friction_curve=Spline_CylinderFriction",
                                    "Cyl_Lift.cylinder_coefficient=0.9", "Cyl_Lift.seal_friction=1 kN"});
  const Traces reference = reference_traces(scene, 3);
  CoupledRun run(scene);
  ASSERT_TRUE(run.start().is_ok());
  Operator op(scene, kControlGrid);
  constexpr std::array kChoices = {4.0, 2.0, 1.0, 4.0, 3.0, 0.0};
  double worst_x = 0;
  for (StepIndex n = 0; n < 3000; ++n) {
    if (n % 250 == 0)
      run.change("Cyl_Lift.coupling", kChoices[static_cast<std::size_t>(n / 250) % kChoices.size()], {});
    run.step(op.controls(run.time()));
    worst_x = std::max(worst_x, std::fabs(run.mechanism().x[0] - reference[0].x[static_cast<std::size_t>(n) + 1]));
  }
  EXPECT_FALSE(run.has_failed());
  RecordProperty("worst_x_um", std::to_string(1e6 * worst_x));
  const double way = reference[0].x.back() - reference[0].x.front();
  EXPECT_GT(way, 0.015);
  EXPECT_LT(worst_x, 1e-5);
}

}  // namespace levels_test
}  // namespace slew::coupling::test
