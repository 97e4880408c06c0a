// SPDX-License-Identifier: Apache-2.0
// Scenes played in this process: those of the validation's loops, and a script's part in the motion.
#include "analysis/comparison/played_scene.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "build_paths.h"
#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::analysis {
namespace played_scene_test {

using wire::Role;

scene::Scene load(const std::string& name, const scene::Overrides& overrides = {}) {
  return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + name, overrides);
}

void advance_to(PlayedScene& played, double time) {
  while (played.time().seconds() < time - 1e-9) played.advance();
}

double value(const PlayedScene& played, const std::string& name) {
  const coupling::Subsystem& mechanics = *played.session().subsystem(Role::mechanics);
  std::vector<double> values(mechanics.variables().size());
  mechanics.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (mechanics.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << name;
  return 0;
}

// case A02, N = 2: position within 1e-3 m at 10 s, after ten passes through the flat position
TEST(PlayedScene, FourBarsAreWhereTheCaseHasThem) {
  const scene::Scene scene = load("four_bar.yaml");
  PlayedScene played(scene);
  EXPECT_NEAR(value(played, "mechanics.kinetic_energy") + value(played, "mechanics.potential_energy"), 35.835, 1e-9);
  advance_to(played, 10);
  EXPECT_NEAR(value(played, "Coupler0.position.x"), 0.328458111539, 1e-3);
  EXPECT_NEAR(value(played, "Coupler0.position.y"), 0.944518538179, 1e-3);
  EXPECT_NEAR(value(played, "Coupler0.velocity.x"), 1.42305147020, 1e-2);
}

// case A08: slider within 2e-4 m, crank within 1e-2 rad at 5 s
TEST(PlayedScene, TheSliderCrankIsWhereTheCaseHasIt) {
  const scene::Scene scene = load("slider_crank.yaml");
  PlayedScene played(scene);
  EXPECT_NEAR(value(played, "mechanics.kinetic_energy") + value(played, "mechanics.potential_energy"), 0.76643568,
              1e-8);
  advance_to(played, 1);
  EXPECT_NEAR(value(played, "Slider.position.x"), 0.2117216614, 2e-4);
  advance_to(played, 5);
  EXPECT_NEAR(value(played, "Slider.position.x"), 0.2407195737, 2e-4);
  EXPECT_NEAR(value(played, "Pivot.position"), 54.3333321688, 1e-2);
}

TEST(PlayedScene, TheScriptMovesTheMachineAndIsTheSameEveryTime) {
  const scene::Scene scene = load("tipper.yaml");
  PlayedScene first(scene), second(scene);
  advance_to(first, 1);
  const double rest = value(first, "Hinge.position");
  advance_to(first, 2);
  EXPECT_GT(value(first, "Hinge.position"), rest + 0.02);
  advance_to(second, 2);
  EXPECT_EQ(first.state_hashes(), second.state_hashes());
  EXPECT_NE(first.state_hashes().hydraulics, 0U);
  second.advance();
  EXPECT_NE(first.state_hashes(), second.state_hashes());
}

TEST(PlayedScene, ParameterChangesOfTheScriptAreCarriedOut) {
  const scene::Scene scene = scene::load_text(
      "bodies:\n  Rod: {mass: 2 kg, center_of_mass: [1 m, 0, 0], inertia: [0, 1, 1]}\n"
      "joints:\n  Hinge: {type: revolute, body1: Ground, body2: Rod}\n"
      "script:\n  parameters:\n    - {at: 10 ms, set: Rod.mass, value: 3 kg, over: 10 ms}\n"
      "session: {duration: 1 s}\n",
      "rod.yaml");
  PlayedScene played(scene);
  advance_to(played, 0.01);
  EXPECT_DOUBLE_EQ(value(played, "Rod.mass"), 2);
  advance_to(played, 0.03);
  EXPECT_DOUBLE_EQ(value(played, "Rod.mass"), 3);
}

// 1000 kg on an arm of 0.3 m: a torque, which no motor of 100 cc/rev holds below its relief valve
TEST(DirectSession, RefusesAStartWithTheTorqueOfAMotorInItsUnit) {
  const scene::Scene scene = scene::load_text(
      "bodies:\n  W: {mass: 1000 kg, inertia: [1000, 1000, 1000], center_of_mass: [0.3 m, 0, 0]}\n"
      "joints:\n  J: {type: revolute, body2: W}\n"
      "forces:\n  R: {type: rotational, body1: Ground, f1: [1, 0, 0], g1: [0, 1, 0], body2: W, f2: [1, 0, 0]}\n"
      "volumes:\n  T: {initial_pressure: 2 bar, fixed: true}\n  A: {rigid_volume: 0.2 l}\n  B: {rigid_volume: 0.2 l}\n"
      "components:\n"
      "  M: {type: hydraulic_motor, force: R, port_a: A, port_b: B, displacement: 100 cc/rev, gear_ratio: 1}\n"
      "  RA: {type: relief_valve, port_1: A, port_2: T, nominal_flow: 100 l/min, setting_pressure: 320 bar}\n",
      "winch");
  session::DirectSession session(scene);
  EXPECT_NE(session.start().text.find(" bar in A to hold 2.943 kN m on M, but RA opens fully at 329 bar."),
            std::string::npos);
}

}  // namespace played_scene_test
}  // namespace slew::analysis
