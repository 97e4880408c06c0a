// SPDX-License-Identifier: Apache-2.0
#include "analysis/description/liftable_load.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "analysis/description/instant.h"
#include "build_paths.h"
#include "core/failure.h"

namespace slew::analysis {
namespace liftable_load_test {

scene::Scene load(const std::string& name, const scene::Overrides& overrides = {}) {
  return scene::load_file(SLEWRING_SOURCE_DIR "/scenes/" + name, overrides);
}

double value(const PlayedScene& played, wire::Role role, const std::string& name) {
  const coupling::Subsystem& subsystem = *played.session().subsystem(role);
  std::vector<double> values(subsystem.variables().size());
  subsystem.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (subsystem.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << name;
  return 0;
}

// how far the named cylinder goes in its lifting direction with a payload, its lever pushed from 1 s to 4 s
double way(const std::string& scene_name, const LiftableLoad& found, double mass) {
  const LiftingPort& port = found.limit();
  const scene::Scene scene =
      load(scene_name, {found.payload + ".mass=" + std::to_string(mass), "script.interpolation=step",
                        "script.inputs={" + port.input + ": [[0 s, 0], [1 s, " + std::to_string(port.stick) + "]]}"});
  PlayedScene played(scene);
  play_to(played, 1);
  const double before = value(played, wire::Role::hydraulics, port.name + ".stroke");
  play_to(played, 4);
  const double after = value(played, wire::Role::hydraulics, port.name + ".stroke");
  return port.force_per_kg > 0 ? after - before : before - after;
}

// a cylinder first compresses its oil: a lifted load goes on
constexpr double kLifted = 0.01, kNotLifted = 0.004;  // m

TEST(LiftableLoad, OfTheCraneIsLiftedAndMoreIsNot) {
  scene::Scene scene = load("truck_crane.yaml");
  const LiftableLoad found = find_liftable(scene, {}, ListedSettings::named);
  ASSERT_TRUE(found.has_answer());
  EXPECT_EQ(found.payload, "Bag");
  EXPECT_GT(way("truck_crane.yaml", found, 0.97 * found.limit().load), kLifted);
  EXPECT_LT(way("truck_crane.yaml", found, 1.03 * found.limit().load), kNotLifted);
}

TEST(LiftableLoad, OfASingleCylinderIsLiftedAndMoreIsNot) {
  scene::Scene scene = load("single_cylinder.yaml");
  const LiftableLoad found = find_liftable(scene, {}, ListedSettings::named);
  ASSERT_TRUE(found.has_answer());
  EXPECT_EQ(found.limit().name, "Cyl_Lift");
  EXPECT_GT(way("single_cylinder.yaml", found, 0.97 * found.limit().load), kLifted);
  EXPECT_LT(way("single_cylinder.yaml", found, 1.03 * found.limit().load), kNotLifted);
}

// the valve takes no more oil at its load-sensing limit and the compensator's 8 bar; the pump could do 205 bar
TEST(LiftableLoad, NamesTheSettingsThatLimitIt) {
  scene::Scene scene = load("single_cylinder.yaml");
  const LiftingPort port = find_liftable(scene, {}, ListedSettings::named).limit();
  ASSERT_EQ(port.settings.size(), 2u);
  EXPECT_EQ(port.settings[0].path, "L90Lift.maximum_ls_pressure_a");
  EXPECT_EQ(port.settings[1].path, "L90Lift.compensator_pressure");
  EXPECT_NEAR(port.settings[0].effect, 1, 0.05);
  EXPECT_NEAR(port.pressure, 189e5, 1e5);
  EXPECT_EQ(port.chamber, "Vol_LiftCyl_A");
  // with a pump relief below it that one limits
  scene::Scene relieved = load("single_cylinder.yaml", {"PRV_MainPump.setting_pressure=120 bar"});
  const LiftingPort lower = find_liftable(relieved, {}, ListedSettings::named).limit();
  ASSERT_FALSE(lower.settings.empty());
  EXPECT_EQ(lower.settings[0].path, "PRV_MainPump.setting_pressure");
  EXPECT_NEAR(lower.pressure, 124e5, 4e5) << "its setting, and what of its opening the pump's flow needs";
  EXPECT_LT(lower.load, port.load);
}

// Lever arms of the scene's header: 0.713 m of the cylinder, 3.5 m of the load, 1.75 m of the boom's 400 kg.
TEST(LiftableLoad, OfASingleCylinderIsTheBalanceOfMoments) {
  scene::Scene scene = load("single_cylinder.yaml");
  const LiftingPort port = find_liftable(scene, {}, ListedSettings::left_out).limit();
  const double F = 0.25 * 3.14159265 * (0.2 * 0.2 * port.pressure - (0.2 * 0.2 - 0.105 * 0.105) * 1e5);
  const double lever = 0.713;
  EXPECT_NEAR(port.load, (F * lever / 9.81 - 400 * 1.75) / 3.5, 0.01 * port.load);
}

TEST(LiftableLoad, APoseChangesItAndTheSceneStaysAsItWas) {
  scene::Scene scene = load("truck_crane.yaml");
  const double at_start = find_liftable(scene, {}, ListedSettings::named).limit().load;
  EXPECT_EQ(find_liftable(scene, {}, ListedSettings::named).limit().load, at_start);
  const LiftableLoad raised =
      find_liftable(scene, {.at = 0, .joints = {"Pillar_LiftBoom=50 deg"}}, ListedSettings::left_out);
  ASSERT_TRUE(raised.has_answer());
  EXPECT_NE(raised.limit().load, at_start);
  EXPECT_THROW(static_cast<void>(find_liftable(scene, {.at = 0, .joints = {"Absent=1"}}, ListedSettings::left_out)),
               Failure);
  EXPECT_THROW(static_cast<void>(find_liftable(scene, {.at = 0, .joints = {"Hook_Bag=1"}}, ListedSettings::left_out)),
               Failure);
}

TEST(LiftableLoad, IsFoundForEachBodyOfThePayload) {
  scene::Scene scene = load("truck_crane.yaml");
  scene.mechanics.payload = "Bag";
  scene.other_payloads = {"Truck_Hook"};
  const std::vector<LiftableLoad> found = find_liftable_of_each(scene, {}, ListedSettings::left_out);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].payload, "Bag");
  EXPECT_EQ(found[1].payload, "Truck_Hook");
  EXPECT_EQ(scene.mechanics.payload, "Bag");
  scene::Scene alone = load("truck_crane.yaml", {"mechanics.payload=Truck_Hook"});
  const LiftableLoad hook = find_liftable(alone, {}, ListedSettings::left_out);
  ASSERT_TRUE(hook.has_answer());
  EXPECT_EQ(found[1].limit().load, hook.limit().load);
}

// pressures at stall are those of the start: 6.7 bar in A from 10 bar on the return side
TEST(LiftableLoad, OfACircuitWithoutASupplyHasNoFigure) {
  const std::string file = SLEWRING_SOURCE_DIR "/tests/unit/analysis/lift_without_supply.yaml";
  scene::Scene scene = scene::load_file(file, {});
  const LiftableLoad found = find_liftable(scene, {}, ListedSettings::named);
  EXPECT_FALSE(found.has_answer());
  EXPECT_EQ(found.refusal, "nothing feeds the cylinders: the circuit has no pump, source or accumulator");
  // a tank does not feed, a fixed volume at the pressure of a supply does
  scene::Scene fed = scene::load_file(file, {"S.initial_pressure=200 bar"});
  EXPECT_TRUE(find_liftable(fed, {}, ListedSettings::left_out).has_answer());
}

// The pressures balance: what is left of them is rounding, and the missing input is named.
TEST(LiftableLoad, BehindAValveWithoutAnInputIsNoneAndNamesTheValve) {
  const std::string file = SLEWRING_SOURCE_DIR "/tests/unit/analysis/lift_without_input.yaml";
  scene::Scene scene = scene::load_file(file, {});
  const LiftableLoad found = find_liftable(scene, {}, ListedSettings::left_out);
  ASSERT_TRUE(found.has_answer());
  EXPECT_EQ(found.limit().largest_force, 0);
  EXPECT_EQ(limit_text(found), "0 kg of Load: Cylinder has no force, 33 bar in A: no input commands Lift");
}

TEST(LiftableLoad, ASceneWithoutCylindersHasNone) {
  scene::Scene scene = load("four_bar.yaml");
  EXPECT_FALSE(find_liftable(scene, {}, ListedSettings::named).has_answer());
}

}  // namespace liftable_load_test
}  // namespace slew::analysis
