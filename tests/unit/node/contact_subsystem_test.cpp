// SPDX-License-Identifier: Apache-2.0
// Contact inside the mechanics subsystem: part of its hash, of reset and of the state that a failed step goes back to,
// and nothing at all while nothing touches.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/crane_pair.h"

namespace slew::testing {
namespace contact_subsystem_test {

// the floor just below the bag: it touches within the first steps
const std::string kHighFloor = "Ground_Mesh.position=[0, 0.936 m, 0]";

class Touching : public ::testing::TestWithParam<const char*> {
 protected:
  static std::vector<std::string> overrides() {
    return {kHighFloor, std::string("mechanics.formulation=") + GetParam()};
  }
  static constexpr std::array<double, 3> kLower = {0, -420, 0};
  // hashes of 300 steps in which the boom goes down
  static std::uint64_t chain(CranePair& crane) {
    StateHash hash;
    for (int i = 0; i < 300; ++i) {
      crane.step(kLower);
      hash.add(crane.mechanics->state_hash());
    }
    return hash.digest();
  }
};

TEST_P(Touching, IsPartOfTheHashToTheLastBit) {
  const scene::Scene scene = CranePair::load(overrides());
  CranePair crane(scene);
  crane.start();
  chain(crane);
  auto states = crane.mechanics->mutable_state().contacts.states();
  ASSERT_EQ(states.size(), 4u);
  const std::uint64_t before = crane.mechanics->state_hash();
  const auto expect_counts = [&](double& value) {
    const double kept = value;
    value = std::nextafter(value, std::numeric_limits<double>::infinity());
    EXPECT_NE(crane.mechanics->state_hash(), before);
    value = kept;
  };
  for (contact::RememberedContact& state : states) {
    expect_counts(state.normal.impact_speed);
    const double kept = state.friction.z_W[0];
    state.friction.z_W.lanes[0] = std::nextafter(kept, 1);
    EXPECT_NE(crane.mechanics->state_hash(), before);
    state.friction.z_W.lanes[0] = kept;
  }
  EXPECT_EQ(crane.mechanics->state_hash(), before);
}

TEST_P(Touching, IsForgottenByReset) {
  const scene::Scene scene = CranePair::load(overrides());
  CranePair crane(scene);
  crane.start();
  const std::uint64_t once = chain(crane);
  crane.mechanics->reset();
  crane.hydraulics->reset();
  EXPECT_TRUE(crane.mechanics->state().contacts.states().empty());
  crane.start();
  EXPECT_EQ(chain(crane), once);
}

TEST_P(Touching, GoesBackWithTheStateOfAFailedStep) {
  const scene::Scene scene = CranePair::load(overrides());
  CranePair crane(scene);
  crane.start();
  chain(crane);
  const std::vector<contact::RememberedContact> before(crane.mechanics->state().contacts.states().begin(),
                                                       crane.mechanics->state().contacts.states().end());
  ASSERT_FALSE(before.empty());
  // a force that is no number fails the step
  for (double& F : crane.hydraulics_now.actuators.F.span()) F = std::nan("");
  crane.step(kLower);
  const auto after = crane.mechanics->state().contacts.states();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].normal.impact_speed, before[i].normal.impact_speed);
    EXPECT_EQ(after[i].friction.z_W.array(), before[i].friction.z_W.array());
  }
}

TEST_P(Touching, PairsThatDoNotLeaveTheHashChainAlone) {
  const std::vector<std::string> formulation = {std::string("mechanics.formulation=") + GetParam()};
  const scene::Scene with = CranePair::load(formulation);
  scene::Scene without = CranePair::load(formulation);
  without.mechanics.contacts.clear();
  ASSERT_EQ(with.mechanics.contacts.size(), 6u);
  CranePair a(with), b(without);
  a.start();
  b.start();
  EXPECT_EQ(chain(a), chain(b));
  EXPECT_TRUE(a.mechanics->state().contacts.states().empty());
}

INSTANTIATE_TEST_SUITE_P(All, Touching, ::testing::Values("recursive", "lagrange"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace contact_subsystem_test
}  // namespace slew::testing
