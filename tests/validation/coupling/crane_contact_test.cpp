// SPDX-License-Identifier: Apache-2.0
// The whole crane with its six pairs: the bag is set down on the ground, and swung against the truck's body.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "build_paths.h"
#include "tests/validation/coupling/coupled_run.h"

namespace slew::coupling::test {
namespace crane_contact_test {

constexpr double kWeight = 500 * 9.81;  // N, of the bag

scene::Scene load(const std::string& file) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file);
}

// The sums are those of any rigid body at rest: what floor and hook carry is its weight.
TEST(CraneContact, SetsTheBagDownAndItComesToRest) {
  const scene::Scene scene = load("truck_crane_contact.yaml");
  CoupledRun run(scene);
  ASSERT_TRUE(run.start().is_ok());
  Operator lever(scene, scene.session.step_duration());
  for (StepIndex n = 0; n < 6000; ++n) run.step(lever.controls(run.time()));
  EXPECT_FALSE(run.has_failed());
  EXPECT_EQ(run.flags() & static_cast<std::uint32_t>(StepFlag::coupling_creates_energy), 0u);
  EXPECT_EQ(run.flags() & static_cast<std::uint32_t>(StepFlag::not_converged), 0u);
  EXPECT_EQ(run.variable("Ground_Bag.contacts"), 4);
  EXPECT_EQ(run.variable("Ground_Truck_Body.contacts"), 0);
  const double N = run.variable("Ground_Bag.normal_force.y");
  EXPECT_NEAR(N - run.variable("Hook_Bag.reaction_force.y"), kWeight, 1e-2 * kWeight);
  EXPECT_NEAR(run.variable("Ground_Bag.friction_force.x") - run.variable("Hook_Bag.reaction_force.x"), 0,
              1e-2 * kWeight);
  EXPECT_NEAR(run.variable("Bag.center_of_mass.y"), 0.5 - N / 5e7, 2e-4);
  for (const char* axis : {".x", ".y", ".z"}) {
    EXPECT_LT(std::fabs(run.variable(std::string("Bag.velocity") + axis)), 1e-3);
  }
}

// slewing back without lifting: the bag meets the body's side 0.16 m below its edge, tips and leans on it
TEST(CraneContact, SlewingBackTipsTheBagOverTheTrucksEdge) {
  const scene::Scene scene = load("truck_crane.yaml");
  CoupledRun run(scene);
  ASSERT_TRUE(run.start().is_ok());
  double hardest = 0, deepest = 0;
  for (StepIndex n = 0; n < 6000; ++n) {
    const double slew = n < 500 ? static_cast<double>(n) : 500;
    run.step(std::array{-slew, 0.0, 0.0});
    hardest = std::max(hardest, std::hypot(run.variable("Truck_Body_Bag.normal_force.x"),
                                           run.variable("Truck_Body_Bag.normal_force.z")));
    deepest = std::max(deepest, run.variable("Truck_Body_Bag.depth"));
  }
  EXPECT_FALSE(run.has_failed());
  EXPECT_EQ(run.flags() & static_cast<std::uint32_t>(StepFlag::not_converged), 0u);
  EXPECT_GT(hardest, 1e3);
  EXPECT_LT(deepest, 5e-3);
  EXPECT_GT(run.variable("Bag.center_of_mass.y"), 1.5);
}

}  // namespace crane_contact_test
}  // namespace slew::coupling::test
