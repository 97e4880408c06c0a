// SPDX-License-Identifier: Apache-2.0
// The crane's mechanics under another formulation, with unchanged hydraulics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/crane_pair.h"

namespace slew::testing {
namespace formulation_test {

constexpr StepIndex kSteps = 1000;

// Distance from the recursion: `lagrange` rounds otherwise; a penalty of 3e10 kg beside ports that feel 1e6 kg is wrong
// by 3e-5 of the forces; the trapezoidal rule is of second order, and the oil's spring takes 1e-6 m for 100 N.
struct Case {
  const char* formulation;
  double position, force;  // m, N
};

class CraneUnder : public ::testing::TestWithParam<Case> {
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

  const scene::Scene of_recursive = CranePair::load();
  const scene::Scene of_bodies = CranePair::load({std::string("mechanics.formulation=") + GetParam().formulation});
  CranePair recursive{of_recursive}, bodies{of_bodies};
};

TEST_P(CraneUnder, MovesAsUnderTheRecursion) {
  double way = 0;
  for (StepIndex i = 0; i < kSteps; ++i) {
    step();
    compare();
    way = std::max(way, std::fabs(recursive.mechanics_now.mechanism.v[1]));
  }
  EXPECT_GT(way, 1e-3) << "nothing moved";
  EXPECT_LT(position_error, GetParam().position);
  EXPECT_LT(force_error, GetParam().force);
}

// second order in steps of 1 ms, and the same forces from hydraulics
TEST(Integrators, MoveTheCraneImplicitlyAsUnderRungeKutta) {
  const scene::Scene of_recursive = CranePair::load();
  for (const std::string formulation : {"recursive", "lagrange"}) {
    for (const std::string integrator : {"trapezoidal", "generalised_alpha", "sdirk2"}) {
      const scene::Scene scene =
          CranePair::load({"mechanics.formulation=" + formulation, "mechanics.integrator=" + integrator});
      CranePair other(scene), runge_kutta(of_recursive);
      other.start();
      runge_kutta.start();
      double error = 0;
      for (StepIndex i = 0; i < kSteps; ++i) {
        other.step(CranePair::levers(other.n));
        runge_kutta.step(CranePair::levers(runge_kutta.n));
        for (std::size_t k = 0; k < other.mechanics_now.mechanism.x.size(); ++k) {
          error =
              std::max(error, std::fabs(other.mechanics_now.mechanism.x[k] - runge_kutta.mechanics_now.mechanism.x[k]));
        }
      }
      EXPECT_LT(error, 1e-4) << formulation << ' ' << integrator;
      EXPECT_GT(error, 0) << formulation << ' ' << integrator;
    }
  }
}

TEST_P(CraneUnder, HasAStateOfItsOwnInTheHash) {
  EXPECT_NE(recursive.mechanics->state_hash(), bodies.mechanics->state_hash());
}

TEST_P(CraneUnder, AfterAResetDoesTheSameBitForBit) {
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

TEST_P(CraneUnder, FollowsALiveChangeOfMass) {
  for (CranePair* crane : {&recursive, &bodies}) {
    static_cast<void>(crane->mechanics->change_parameter(0, {"Bag.mass", 900, milliseconds(50)}));
  }
  for (StepIndex i = 0; i < 300; ++i) {
    step();
    compare();
  }
  EXPECT_LT(position_error, GetParam().position);
  EXPECT_LT(force_error, GetParam().force);
}

INSTANTIATE_TEST_SUITE_P(Formulations, CraneUnder,
                         ::testing::Values(Case{"lagrange", 1e-8, 1}, Case{"penalty", 2e-6, 100},
                                           Case{"augmented", 5e-6, 300}),
                         [](const auto& test) { return std::string(test.param.formulation); });

}  // namespace formulation_test
}  // namespace slew::testing
