// SPDX-License-Identifier: Apache-2.0
// The matrix of an implicit stage holds the derivatives of stiff force elements: where a law is linear and the motion
// small, Newton's method settles in one correction and sees so in the next, however stiff the element is and however
// the bodies lie. A derivative that is wrong by a per cent would need several more.
#include <gtest/gtest.h>

#include <random>

#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace stage_jacobian_test {

using namespace testing;

constexpr int kMostCorrections = 3;

class StageJacobian : public ::testing::TestWithParam<std::tuple<Formulation, Integrator>> {
 protected:
  // two bodies that float anywhere and lie in any way
  static MechanicsDef pair_of_bodies(unsigned seed) {
    std::mt19937 random(seed);
    const auto vector = [&](double size) {
      std::uniform_real_distribution<double> number(-size, size);
      return Triple{number(random), number(random), number(random)};
    };
    MechanicsDef def;
    def.gravity = {};
    std::tie(def.formulation, def.integrator) = GetParam();
    for (const char* name : {"A", "B"}) {
      def.bodies.push_back({.name = name,
                            .position = vector(1),
                            .orientation = vector(3),
                            .mass = 1,
                            .center_of_mass = vector(0.2),
                            .inertia = {0.1, 0.12, 0.15}});
      def.joints.push_back({.name = std::string("Free") + name, .type = JointType::floating, .body2 = name});
    }
    def.bodies[1].position[0] += 3;
    return def;
  }
  static int corrections(const MechanicsDef& def, double speed) {
    Formulated bodies(def);
    for (std::size_t k = 0; k < bodies.state.u.size(); ++k) {
      bodies.state.u[k] = speed * (1 - 0.17 * static_cast<double>(k));
    }
    bodies.dynamics = Dynamics(def.formulation, bodies.model, bodies.state, step_rule(def));
    EXPECT_TRUE(bodies.try_run(1e-3, 1e-3));
    return bodies.dynamics.iterations();
  }
};

TEST_P(StageJacobian, OfALineIsExact) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    MechanicsDef def = pair_of_bodies(seed);
    def.translational_forces = {
        {.name = "Line", .body1 = "A", .point1 = {0.2, 0.1, -0.3}, .body2 = "B", .point2 = {-0.1, 0.3, 0.2}}};
    TranslationalForceDef& line = def.translational_forces[0];
    line.spring_constant = 1e9;
    line.damping_constant = 1e5;
    // unloaded as it lies
    Mechanism mechanism(def);
    def.translational_forces[0].free_length = mechanism.value("Line.length");
    EXPECT_LE(corrections(def, 1e-6), kMostCorrections) << "seed " << seed;
  }
}

TEST_P(StageJacobian, OfAnAngleIsExact) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    MechanicsDef def = pair_of_bodies(seed);
    def.bodies[1].position = def.bodies[0].position;
    def.bodies[1].orientation = def.bodies[0].orientation;
    // a hinge, whose only motion the spring resists
    def.joints[1] = {.name = "Hinge", .body1 = "A", .body2 = "B"};
    def.rotational_forces = {{.name = "Spring",
                              .body1 = "A",
                              .f1 = {1, 0, 0},
                              .g1 = {0, 1, 0},
                              .body2 = "B",
                              .f2 = {1, 0, 0},
                              .spring_constant = 1e9,
                              .damping_constant = 1e5}};
    EXPECT_LE(corrections(def, 1e-6), kMostCorrections) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(In, StageJacobian,
                         ::testing::Combine(::testing::Values(Formulation::recursive, Formulation::lagrange),
                                            ::testing::Values(Integrator::trapezoidal, Integrator::generalised_alpha)),
                         [](const ::testing::TestParamInfo<std::tuple<Formulation, Integrator>>& tested) {
                           return name_of(std::get<0>(tested.param)) + "_" + name_of(std::get<1>(tested.param));
                         });

}  // namespace stage_jacobian_test
}  // namespace slew::multibody
