// The crane's mechanics under another formulation, against hydraulics that does not know of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/crane_pair.h"

namespace slew::testing {
namespace {

constexpr StepIndex kSteps = 1000;

class Lagrange : public ::testing::Test {
 protected:
  void SetUp() override {
    recursive.start();
    bodies.start();
  }
  void step() {
    recursive.step(CranePair::levers(recursive.n));
    bodies.step(CranePair::levers(bodies.n));
  }
  // largest difference of a port's position and force so far
  double position_error = 0, force_error = 0;
  void compare() {
    for (std::size_t i = 0; i < recursive.mechanics_now.mechanism.x.size(); ++i) {
      const double dx = bodies.mechanics_now.mechanism.x[i] - recursive.mechanics_now.mechanism.x[i];
      const double dF = bodies.hydraulics_now.actuators.F[i] - recursive.hydraulics_now.actuators.F[i];
      position_error = std::max(position_error, std::fabs(dx));
      force_error = std::max(force_error, std::fabs(dF));
    }
  }

  const scene::Scene of_recursive = CranePair::load(), of_bodies = CranePair::load({"mechanics.formulation=lagrange"});
  CranePair recursive{of_recursive}, bodies{of_bodies};
};

TEST_F(Lagrange, MovesTheCraneAsTheRecursionDoes) {
  double way = 0;
  for (StepIndex i = 0; i < kSteps; ++i) {
    step();
    compare();
    way = std::max(way, std::fabs(recursive.mechanics_now.mechanism.v[1]));
  }
  EXPECT_GT(way, 1e-3) << "nothing moved";
  EXPECT_LT(position_error, 1e-8);
  EXPECT_LT(force_error, 1);
}

TEST_F(Lagrange, HasAStateOfItsOwnInTheHash) {
  EXPECT_NE(recursive.mechanics->state_hash(), bodies.mechanics->state_hash());
}

TEST_F(Lagrange, AfterAResetDoesTheSameBitForBit) {
  std::vector<std::uint64_t> first;
  for (int round = 0; round < 2; ++round) {
    bodies.mechanics->reset();
    bodies.hydraulics->reset();
    bodies.start();
    for (std::size_t i = 0; i < 200; ++i) {
      bodies.step(CranePair::levers(bodies.n));
      if (round == 0) {
        first.push_back(bodies.mechanics->state_hash());
      } else {
        ASSERT_EQ(bodies.mechanics->state_hash(), first[i]) << "step " << i;
      }
    }
  }
}

TEST_F(Lagrange, FollowsALiveChangeOfMass) {
  for (CranePair* crane : {&recursive, &bodies}) {
    static_cast<void>(crane->mechanics->change_parameter(0, {"Bag.mass", 900, milliseconds(50)}));
  }
  for (StepIndex i = 0; i < 300; ++i) {
    step();
    compare();
  }
  EXPECT_LT(position_error, 1e-8);
  EXPECT_LT(force_error, 1);
}

}  // namespace
}  // namespace slew::testing
