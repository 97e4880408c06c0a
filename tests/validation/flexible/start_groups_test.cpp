// SPDX-License-Identifier: Apache-2.0
// Bodies that rest, are held by more than their root, close a loop, and fall, in one scene: each group starts as it
// would alone. They all started undeformed where one was held or in a loop, and a falling one was bent by its weight.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "multibody/build/validate.h"
#include "tests/validation/flexible/flexible_def.h"
#include "tests/validation/flexible/segmented_def.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace start_groups_test {

using namespace testing;

constexpr double kG = 9.81, kLength = 2, kSide = 0.1, kModulus = 2.1e11, kMassPerLength = 7850 * kSide * kSide;

// w L^4/(8 E I) and the shear of the weight [m]
double sag() {
  const double w = kMassPerLength * kG, EI = kModulus * std::pow(kSide, 4) / 12;
  const double kGA = 5.0 / 6 * kModulus / 2.6 * kSide * kSide;
  return w * std::pow(kLength, 4) / (8 * EI) + w * kLength * kLength / (2 * kGA);
}

void add_beam(MechanicsDef& def, const std::string& name, double z, int segments) {
  def.bodies.push_back({.name = name, .type = BodyType::segmented, .position = {0, 0, z}});
  def.segmented_bodies.push_back(
      {.body = name, .chain = slew::testing::segments_of(flex::testing::cantilever_b01(4), segments)});
}

MechanicsDef cantilever(int segments) {
  MechanicsDef def;
  def.integrator = Integrator::trapezoidal;
  add_beam(def, "Rests", 0, segments);
  def.joints = {{.name = "Clamp", .type = JointType::fixed, .body2 = "Rests"}};
  return def;
}

void add_falling(MechanicsDef& def) {
  add_beam(def, "Falls", 1, 10);
  def.joints.push_back({.name = "Free", .type = JointType::floating, .body2 = "Falls"});
}

// clamped at its tip, of which the root is a part
void add_held(MechanicsDef& def) {
  add_beam(def, "Held", 2, 10);
  def.joints.push_back(
      {.name = "Tip", .type = JointType::fixed, .point1 = {kLength, 0, 2}, .body2 = "Held", .point2 = {kLength, 0, 0}});
}

// two bars and a slider
void add_loop(MechanicsDef& def) {
  const Triple slot = {0, M_PI / 2, 0};
  def.bodies.push_back({.name = "Crank",
                        .position = {0, 0, 3},
                        .orientation = {M_PI / 2, 0, 0},
                        .mass = 2,
                        .center_of_mass = {0.05, 0, 0},
                        .inertia = {0.01, 0.02, 0.02}});
  def.bodies.push_back({.name = "Conrod",
                        .position = {0, 0.3, 3},
                        .orientation = {-std::asin(0.6), 0, 0},
                        .mass = 1,
                        .center_of_mass = {0.25, 0, 0},
                        .inertia = {0.01, 0.02, 0.02}});
  def.bodies.push_back({.name = "Slider", .position = {0.4, 0, 3}, .mass = 0.5, .inertia = {1e-3, 1e-3, 1e-3}});
  def.joints.push_back({.name = "Pivot", .point1 = {0, 0, 3}, .body2 = "Crank"});
  def.joints.push_back({.name = "Crank_Pin", .body1 = "Crank", .point1 = {0.3, 0, 0}, .body2 = "Conrod"});
  def.joints.push_back({.name = "Wrist", .body1 = "Conrod", .point1 = {0.5, 0, 0}, .body2 = "Slider"});
  def.joints.push_back({.name = "Slot",
                        .type = JointType::prismatic,
                        .point1 = {0, 0, 3},
                        .orientation1 = slot,
                        .body2 = "Slider",
                        .orientation2 = slot});
}

bool mentions(const Problems& warnings, const std::string& path, const std::string& text) {
  return std::any_of(warnings.begin(), warnings.end(), [&](const Problem& warning) {
    return warning.path == path && warning.what.find(text) != std::string::npos;
  });
}

TEST(StartGroup, SagsWithTheSquareOfTheSegmentsBesideOneThatIsHeld) {
  double before = 0;
  for (const int segments : {5, 10, 20}) {
    MechanicsDef def = cantilever(segments);
    add_held(def);
    const double error = Mechanism(def).value("Rests.deflection.y") / -sag() - 1;
    EXPECT_LT(std::fabs(error), 0.3 / (segments * segments)) << segments;
    if (segments > 5) {
      EXPECT_NEAR(before / error, 4, 0.1) << segments;
    }
    before = error;
  }
}

class StartGroups : public EveryFormulation {};

TEST_P(StartGroups, RestWhereOthersAreHeldOrFall) {
  const double alone = Mechanism(cantilever(10)).value("Rests.deflection.y");
  MechanicsDef def = cantilever(10);
  add_falling(def);
  add_held(def);
  add_loop(def);
  Problems warnings;
  find_start_changes(def, warnings);
  EXPECT_TRUE(mentions(warnings, "Falls.segments", "connects it to Ground"));
  EXPECT_TRUE(mentions(warnings, "Held.segments", "joints hold more of it than its root"));
  EXPECT_FALSE(mentions(warnings, "Rests.segments", ""));
  if (is(Formulation::augmented) || is(Formulation::penalty)) def.integrator = Integrator::own;
  def.max_substep = is(Formulation::penalty) ? 1e-5 : 1e-4;
  Formulated scene = start(def);
  const double before = scene.value("Rests.deflection.y");
  EXPECT_NEAR(before, alone, 1e-9 * std::fabs(alone));
  // rounding of the poses
  EXPECT_LT(scene.value("Falls.strain_energy"), 1e-18);
  EXPECT_LT(scene.value("Held.strain_energy"), 1e-18);
  const double y = scene.pose("Falls").position[1], time = 0.02;
  scene.run(time, def.max_substep);
  EXPECT_NEAR(scene.value("Rests.deflection.y"), before, 1e-5 * std::fabs(before));
  EXPECT_NEAR(scene.pose("Falls").position[1], y - kG / 2 * time * time, 1e-6 * kG / 2 * time * time);
  // of 1 mm in each of ten connectors: the weight would leave 1e-2
  EXPECT_LT(scene.value("Falls.strain_energy"), 1e-9);
}

// the same by modes: of two, the one without a joint falls
TEST_P(StartGroups, BodiesWithModesFallUnstrained) {
  MechanicsDef def;
  const auto modes = slew::testing::modes_of(flex::testing::cantilever_b01(10), flex::testing::with_modes(4), {});
  for (const char* name : {"Rests", "Falls"}) {
    def.bodies.push_back({.name = name, .type = BodyType::flexible});
    def.flexible_bodies.push_back({.body = name, .modes = modes});
  }
  def.bodies[1].position = {0, 0, 1};
  def.joints = {{.name = "Clamp", .type = JointType::fixed, .body2 = "Rests"},
                {.name = "Free", .type = JointType::floating, .body2 = "Falls"}};
  const double y = 0, time = 0.02;
  def.max_substep = 2e-5;
  Formulated scene = start(def);
  const double before = scene.value("Rests.deflection.y");
  EXPECT_NEAR(before, -sag(), 0.02 * sag());
  EXPECT_EQ(scene.value("Falls.deflection.y"), 0);
  scene.run(time, def.max_substep);
  EXPECT_NEAR(scene.value("Rests.deflection.y"), before, 1e-6 * sag());
  EXPECT_NEAR(scene.value("Falls.deflection.y"), 0, 1e-9 * sag());
  EXPECT_NEAR(scene.pose("Falls").position[1], y - kG / 2 * time * time, 1e-6 * kG / 2 * time * time);
}

INSTANTIATE_TEST_SUITE_P(Flexible, StartGroups, kEveryFormulation, kFormulationName);

}  // namespace start_groups_test
}  // namespace slew::multibody
