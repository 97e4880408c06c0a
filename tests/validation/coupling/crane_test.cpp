// SPDX-License-Identifier: Apache-2.0
// The truck crane in level two against the monolith: default manoeuvre, start from 1 bar, and a live change of mass.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace crane_test {

constexpr double kManoeuvre = 14;  // s: lift from 1 to 5.5 s, slew from 5 to 12 s
constexpr std::size_t kLift = 1;   // port

const scene::Overrides kFrictionless = {
    "Cyl_Lift.cylinder_coefficient=1",     "Cyl_Lift.seal_friction=0 N",
    "Cyl_Jib.cylinder_coefficient=1",      "Cyl_Jib.seal_friction=0 N",
    "SlewCyl_CraneSlew.seal_friction=0 N", "SlewCyl_CraneSlew.cylinder_coefficient=1",
    "Body_Pillar.coulomb_friction=0 Nm",   "Body_Pillar.viscous_friction=0 Nms/rad"};

scene::Scene load(const scene::Overrides& overrides = {}) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/truck_crane.yaml", overrides);
}

void expect_within(const Comparison& run, double share) {
  EXPECT_FALSE(run.has_failed);
  for (const PortError& port : run.ports) EXPECT_LT(port.F, share * port.F_range);
}

TEST(Crane, forces_are_within_half_a_per_cent_of_their_range_up_to_5_ms) {
  scene::Scene scene = load();
  const Traces reference = reference_traces(scene, kManoeuvre);
  ASSERT_EQ(reference.size(), 3u);
  const Comparison fine = compare(scene, 1e-3, Level::two, reference, kManoeuvre);
  for (std::size_t i = 0; i < 3; ++i) {
    RecordProperty("share_of_port_" + std::to_string(i), std::to_string(fine.ports[i].F / fine.ports[i].F_range));
  }
  expect_within(fine, 5e-4);
  const Comparison coarse = compare(scene, 5e-3, Level::two, reference, kManoeuvre);
  expect_within(coarse, 5e-3);
  EXPECT_EQ(coarse.flags & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy), 0u);
}

TEST(Crane, a_friction_curve_of_monotone_cubics_is_followed_as_closely_as_straight_lines) {
  scene::Scene scene = load({"Spline_CylinderFriction.interpolation=pchip"});
  const double duration = 8;
  const Traces reference = reference_traces(scene, duration);
  const Comparison run = compare(scene, 1e-3, Level::two, reference, duration);
  for (std::size_t i = 0; i < 3; ++i) {
    RecordProperty("share_of_port_" + std::to_string(i), std::to_string(run.ports[i].F / run.ports[i].F_range));
  }
  expect_within(run, 5e-4);
  // sixteen times the kinks, the same smooth law: the implicit solve still ends
  EXPECT_EQ(run.flags & static_cast<std::uint32_t>(StepFlag::not_converged), 0u);
}

TEST(Crane, level_two_stays_stable_at_20_ms_and_without_friction) {
  scene::Scene scene = load(kFrictionless);
  scene.session.coupling_alarm = scene::CouplingAlarm::warn;  // beyond the level's limit at 20 ms
  const Traces reference = reference_traces(scene, kManoeuvre);
  expect_within(compare(scene, 1e-3, Level::two, reference, kManoeuvre), 5e-4);
  expect_within(compare(scene, 5e-3, Level::two, reference, kManoeuvre), 5e-3);
  // errors of phase over some hundred swings
  expect_within(compare(scene, 20e-3, Level::two, reference, kManoeuvre), 3e-2);
}

TEST(Crane, hold_has_many_times_the_error_of_level_two_and_is_flagged_when_unstable) {
  scene::Scene scene = load(kFrictionless);
  const double duration = 4;
  const Traces reference = reference_traces(scene, duration);
  const Comparison hold = compare(scene, 0.2e-3, Level::hold, reference, duration);
  const Comparison two = compare(scene, 0.2e-3, Level::two, reference, duration);
  EXPECT_GT(hold.ports[kLift].F, 20 * two.ports[kLift].F);
  const Comparison unstable = compare(scene, 5e-3, Level::hold, reference, duration);
  EXPECT_GT(unstable.ports[kLift].F, unstable.ports[kLift].F_range);
  EXPECT_NE(unstable.flags & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy), 0u);
}

TEST(Crane, start_from_one_bar_falls_as_the_reference_does) {
  // table13: nothing holds the boom at first, it drops onto its oil
  scene::Scene scene = load({"hydraulics.start=table13"});
  const double duration = 2;
  const Traces reference = reference_traces(scene, duration);
  EXPECT_LT(*std::min_element(reference[kLift].x.begin(), reference[kLift].x.end()), reference[kLift].x.front() - 5e-3);
  const Comparison run = compare(scene, 1e-3, Level::two, reference, duration);
  for (const PortError& port : run.ports) EXPECT_LT(port.F, 1e-3 * port.F_range + 1);
}

double raising_angle_deg(double rad) {
  return rad * 180 / std::numbers::pi;
}

// both machines step by step, mass and controls alike
struct LiveMass {
  scene::Scene scene = load();
  CoupledRun run{scene};
  monolith::Monolith reference{scene};
  double worst = 0, low = 1e9, high = -1e9;  // N, lift

  void advance(double t_end, double lift_signal) {
    std::vector<double> controls(scene.inputs.size(), 0.0);
    controls[1] = lift_signal;
    while (run.time().seconds() < t_end - 1e-9) {
      run.step(controls);
      ASSERT_TRUE(reference.advance_to(run.time(), controls).is_ok());
      const double F = reference.ports()[kLift].F;
      worst = std::max(worst, std::fabs(F - run.actuators().F[kLift]));
      low = std::min(low, F);
      high = std::max(high, F);
    }
  }
  // spread over 1 s as the nodes do
  void change_mass(double from, double to) {
    run.change("Bag.mass", to, {1'000'000'000});
    for (int n = 1; n <= 1000; ++n) {
      ASSERT_TRUE(reference.set_parameter("Bag.mass", from + (to - from) * n / 1000.0).is_ok());
      advance(run.time().seconds() + 1e-3, 0);
    }
  }
};

TEST(Crane, settles_near_13_degrees_with_1500_kg_and_cannot_lift_them) {
  LiveMass crane;
  ASSERT_TRUE(crane.run.start().is_ok());
  ASSERT_TRUE(crane.reference.start().is_ok());
  crane.advance(0.5, 0);
  crane.change_mass(500, 1500);
  crane.advance(4, 0);
  const double settled = crane.run.variable("Pillar_LiftBoom.position");
  EXPECT_GT(raising_angle_deg(settled), 12);
  EXPECT_LT(raising_angle_deg(settled), 13.2);
  // full command: the valve's load-sensing limit of 180 bar is below the pressure that the load requires
  crane.advance(8, 500);
  const double commanded = crane.run.variable("Pillar_LiftBoom.position");
  EXPECT_NEAR(raising_angle_deg(commanded), raising_angle_deg(settled), 0.3);
  EXPECT_GT(crane.run.actuators().p_A[kLift], 188e5);
  EXPECT_LT(crane.worst, 1e-3 * (crane.high - crane.low));
  EXPECT_FALSE(crane.run.has_failed());
}

}  // namespace crane_test
}  // namespace slew::coupling::test
