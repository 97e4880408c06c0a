// SPDX-License-Identifier: Apache-2.0
// Body coordinates with multipliers against the recursion in joint coordinates, on random trees.
#include "multibody/formulations/body_coordinates.h"

#include <gtest/gtest.h>

#include <cmath>

#include "multibody/constraints/loops.h"
#include "multibody/formulations/dynamics.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace body_coordinates_test {

using namespace testing;
using namespace slew::testing;

// relative to the largest entry
constexpr double kTolerance = 1e-9;

double difference(std::span<const double> a, std::span<const double> b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0, scale = 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::fabs(a[i] - b[i]));
    scale = std::max(scale, std::fabs(b[i]));
  }
  return largest / scale;
}

// One mechanism under both formulations.
class Both {
 public:
  explicit Both(const RandomTree& tree)
      : recursive(tree.def, tree.rows),
        body(build_body_model(recursive.model)),
        ws(recursive.model),
        bws(recursive.model, body) {}

  void evaluate_at(const State& state) {
    evaluate(recursive.model, state, recursive.ws);
    joints = state;
    ASSERT_TRUE(evaluate(recursive.model, body, body_state(recursive.model, state), joints, ws, bws));
  }
  // accelerations of all links' origins and angular ones, by the recursion
  [[nodiscard]] std::vector<double> link_accelerations(std::span<const double> forces) {
    std::vector<double> udot(recursive.state.u.size()), result;
    accelerations(recursive.model, recursive.ws, forces, udot);
    for (std::size_t i = 1; i < recursive.model.links.size(); ++i) {
      const LinkMotion& m = recursive.ws.motion[i];
      const math::Vec3 a = m.a + recursive.ws.delta_a[i] + recursive.model.gravity;
      for (const double x : a.array()) result.push_back(x);
      for (const double x : (m.alpha + recursive.ws.delta_alpha[i]).array()) result.push_back(x);
    }
    for_each_mode(recursive.model, [&](std::size_t, std::size_t u) { result.push_back(udot[u]); });
    return result;
  }

  Mechanism recursive;
  BodyModel body;
  Workspace ws;
  BodyWorkspace bws;
  State joints;
};

const std::vector<std::uint32_t> kSeeds = seeds(
    {{1, 40}, {kFirstWithModes, 20}, {kFirstWithShortening, 20}, {kFirstWithNodeDummies, 30}, {kFirstWithBoth, 20}});

template <typename Claim>
void for_each_tree(Claim claim) {
  for_each_seed(kSeeds, [&](std::uint32_t seed) {
    Both both(
        random_tree(seed, with_modes_of(seed, {.bodies = 1 + static_cast<int>(seed) % 9, .two_coordinates = true})));
    if (both.recursive.model.degrees_of_freedom() == 0) return;  // all joints are fixed
    const State state = random_state(seed, both.recursive.model);
    both.evaluate_at(state);
    claim(both, state);
  });
}

TEST(BodyCoordinates, LieOnTheJointsThatTheyWereMadeFrom) {
  for_each_tree([](Both& both, const State&) {
    const Drift off = drift(both.bws);
    EXPECT_LT(off.position, 1e-13);
    EXPECT_LT(off.rate, 1e-12);
    EXPECT_EQ(both.bws.ldl.redundant_rows(), 0);
  });
}

TEST(BodyCoordinates, GiveTheJointCoordinatesBack) {
  for_each_tree([](Both& both, const State& state) {
    EXPECT_LT(difference(both.joints.u, state.u), 1e-12);
    // a quaternion and its opposite are one attitude
    for (std::size_t i = 0; i < state.q.size(); ++i) {
      EXPECT_LT(std::fabs(std::fabs(both.joints.q[i]) - std::fabs(state.q[i])), 1e-12);
    }
  });
}

TEST(BodyCoordinates, AccelerateAsTheRecursionDoes) {
  for_each_tree([](Both& both, const State&) {
    std::vector<double> forces(both.recursive.model.rows.size());
    for (std::size_t k = 0; k < forces.size(); ++k) forces[k] = 3 - 2.0 * static_cast<double>(k);
    std::vector<double> udot(both.bws.udot.size());
    accelerations(both.recursive.model, both.body, both.bws, forces, udot);
    EXPECT_LT(difference(udot, both.link_accelerations(forces)), kTolerance);
  });
}

TEST(BodyCoordinates, HaveTheSameReducedModelAtTheRows) {
  for_each_tree([](Both& both, const State&) {
    EXPECT_LT(difference(row_positions(both.ws), row_positions(both.recursive.ws)), 1e-12);
    EXPECT_LT(difference(row_speeds(both.ws), row_speeds(both.recursive.ws)), 1e-12);
    EXPECT_LT(difference(row_free_accelerations(both.ws), row_free_accelerations(both.recursive.ws)), kTolerance);
    EXPECT_LT(difference(row_mobility(both.ws), row_mobility(both.recursive.ws)), kTolerance);
  });
}

TEST(BodyCoordinates, MoveAsTheRecursionDoes) {
  for_each_tree([](Both& both, const State& state) {
    const Model& model = both.recursive.model;
    BodyState bodies = body_state(model, state);
    std::vector<double> mean(model.rows.size()), slope(model.rows.size());
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = 3 - 2.0 * static_cast<double>(k);
    constexpr double h = 1e-4;
    State joints = state;
    both.joints = state;
    const int steps = slew::testing::rounds(100, 500);
    for (int i = 0; i < steps; ++i) {
      evaluate(model, joints, both.recursive.ws);
      advance(model, joints, both.recursive.ws, h, mean, slope);
      ASSERT_TRUE(evaluate(model, both.body, bodies, both.joints, both.ws, both.bws));
      ASSERT_TRUE(advance(model, both.body, bodies, both.joints, both.ws, both.bws, h, mean, slope));
    }
    EXPECT_LT(difference(both.joints.u, joints.u), 1e-8);
    for (std::size_t i = 0; i < joints.q.size(); ++i) {
      EXPECT_LT(std::fabs(std::fabs(both.joints.q[i]) - std::fabs(joints.q[i])), 1e-8);
    }
  });
}

TEST(BodyCoordinates, ComeBackToTheirJointsFromFarOff) {
  for_each_tree([](Both& both, const State& state) {
    const Model& model = both.recursive.model;
    BodyState bodies = body_state(model, state);
    for (std::size_t i = 0; i < bodies.q.size(); ++i) bodies.q[i] += 0.01 * std::sin(static_cast<double>(i));
    for (std::size_t i = 0; i < bodies.u.size(); ++i) bodies.u[i] += 0.1 * std::cos(static_cast<double>(i));
    both.joints = state;
    EXPECT_TRUE(project(model, both.body, bodies, both.joints, both.ws, both.bws));
    EXPECT_LE(drift(both.bws).position, kClosed * extent_of(both.ws).length);
    EXPECT_LE(drift(both.bws).rate, kClosed * extent_of(both.ws).speed);
  });
}

}  // namespace body_coordinates_test
}  // namespace slew::multibody
