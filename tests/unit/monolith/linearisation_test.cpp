// SPDX-License-Identifier: Apache-2.0
#include "monolith/linearisation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "build_paths.h"
#include "hydraulics_node/hydraulics_subsystem.h"
#include "mechanics_node/mechanics_subsystem.h"

namespace slew::monolith {
namespace linearisation_test {

const std::string kScenes = std::string(SLEWRING_SOURCE_DIR) + "/scenes/";

double share_of(const SceneMode& mode, const std::string& name) {
  for (const OwnerShare& one : mode.owners) {
    if (one.owner.name == name) return one.share;
  }
  return 0;
}

// the oscillation with the largest share of an owner
const SceneMode& oscillation_of(const SceneModes& modes, const std::string& name) {
  const SceneMode* best = nullptr;
  for (const SceneMode& mode : modes.modes) {
    if (mode.value.imag() > 0 && (best == nullptr || share_of(mode, name) > share_of(*best, name))) best = &mode;
  }
  EXPECT_NE(best, nullptr);
  return *best;
}

// The indicator's own estimate, omega^2 = K W at the port, is the frequency of the load on the oil column; the weight
// of the boom turns it by less than a part in a thousand.
TEST(Linearisation, TheOilColumnSwingsWithTheSquareRootOfKW) {
  const scene::Scene scene = scene::load_file(kScenes + "single_cylinder.yaml");
  mechanics_node::MechanicsSubsystem mechanics(scene);
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  coupling::OwnSample m, h;
  ASSERT_TRUE(mechanics.first_sample(m));
  ASSERT_TRUE(hydraulics.start({&m.mechanism, nullptr}, h).is_ok());
  const double omega = std::sqrt(h.actuators.K[0] * m.mechanism.W[0]);
  SceneEquations equations(scene);
  std::vector<double> y(equations.size());
  equations.take(mechanics.model(), mechanics.state(), &hydraulics.circuit(), hydraulics.integrator().state(), y);
  SceneModes modes;
  ASSERT_TRUE(find_modes(equations, 0, y, Part::all, modes).is_ok());
  const SceneMode& column = oscillation_of(modes, "Vol_LiftCyl_A");
  EXPECT_NEAR(std::abs(column.value) / omega, 1, 2e-3);
  EXPECT_GT(share_of(column, "Ground_Boom"), 0.3);
  EXPECT_GT(share_of(column, "Vol_LiftCyl_A"), 0.1);
  // without the cylinder's reaction nothing is left that swings
  SceneModes held;
  ASSERT_TRUE(find_modes(equations, 0, y, Part::mechanics_with_held_rows, held).is_ok());
  EXPECT_EQ(held.states, 2);
  for (const SceneMode& mode : held.modes) EXPECT_LT(std::abs(mode.value), 5);
  // and the machine is as it was
  SceneModes again;
  ASSERT_TRUE(find_modes(equations, 0, y, Part::all, again).is_ok());
  ASSERT_EQ(again.modes.size(), modes.modes.size());
  EXPECT_EQ(again.modes[0].value, modes.modes[0].value);
}

TEST(Linearisation, TheStartOfTheEquationsIsTheStartThatIsTaken) {
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane.yaml");
  mechanics_node::MechanicsSubsystem mechanics(scene);
  hydraulics_node::HydraulicsSubsystem hydraulics(scene);
  coupling::OwnSample m, h;
  ASSERT_TRUE(mechanics.first_sample(m));
  ASSERT_TRUE(hydraulics.start({&m.mechanism, nullptr}, h).is_ok());
  SceneEquations equations(scene);
  std::vector<double> own(equations.size()), taken(equations.size());
  ASSERT_TRUE(equations.start(own).is_ok());
  equations.take(mechanics.model(), mechanics.state(), &hydraulics.circuit(), hydraulics.integrator().state(), taken);
  const std::vector<double> scale = equations.absolute_scales();
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_NEAR(own[i], taken[i], 1e-7 * scale[i]) << equations.state_name(i);
  }
}

// a sliding speed of 0.1 mm/s smooths the friction of the cylinders: faster than anything else, and gone without it
TEST(Linearisation, DryFrictionAtRestIsTheStiffestOfTheCrane) {
  const scene::Scene scene = scene::load_file(kScenes + "truck_crane.yaml");
  SceneEquations equations(scene);
  std::vector<double> y(equations.size());
  ASSERT_TRUE(equations.start(y).is_ok());
  SceneModes with, without;
  ASSERT_TRUE(find_modes(equations, 0, y, Part::all, with).is_ok());
  equations.neglect_dry_friction();
  ASSERT_TRUE(find_modes(equations, 0, y, Part::all, without).is_ok());
  EXPECT_EQ(with.states, without.states);
  EXPECT_GT(std::abs(with.modes[0].value), 2 * std::abs(without.modes[0].value));
  EXPECT_EQ(with.modes[0].owners[0].owner.kind, StateOwner::Kind::joint);
  // spools, of the three valves' common time constant of 0.1 s / 3
  const auto spools = std::find_if(with.modes.begin(), with.modes.end(), [](const SceneMode& mode) {
    return mode.count >= 3 && std::fabs(mode.value.real() + 30) < 1e-3;
  });
  ASSERT_NE(spools, with.modes.end());
  EXPECT_GT(share_of(*spools, "L90Lift"), 0.1);
  EXPECT_GT(share_of(*spools, "L90Jib"), 0.1);
}

}  // namespace linearisation_test
}  // namespace slew::monolith
