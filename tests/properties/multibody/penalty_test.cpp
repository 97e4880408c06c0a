// Body coordinates whose joints are held by penalties, formulations `augmented` and `penalty`, against the recursion in
// joint coordinates on random trees.
#include <gtest/gtest.h>

#include <cmath>

#include "multibody/dynamics.h"
#include "tests/properties/multibody/held.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using namespace testing;

double difference(std::span<const double> a, std::span<const double> b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0, scale = 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::fabs(a[i] - b[i]));
    scale = std::max(scale, std::fabs(b[i]));
  }
  return largest / scale;
}

// a quaternion and its opposite are one attitude
double coordinate_difference(const State& a, const State& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.q.size(); ++i) {
    largest = std::max(largest, std::fabs(std::fabs(a.q[i]) - std::fabs(b.q[i])));
  }
  return largest;
}

class Penalties : public ::testing::TestWithParam<unsigned> {
 protected:
  Penalties()
      : tree(random_tree(GetParam(), with_modes_of(GetParam(), {.bodies = 1 + static_cast<int>(GetParam()) % 9}))),
        recursive(tree.def, tree.rows) {}
  void SetUp() override {
    if (recursive.model.degrees_of_freedom() == 0) GTEST_SKIP() << "all joints are fixed";
    state = random_state(GetParam(), recursive.model);
    mean.resize(recursive.model.rows.size());
    slope.resize(mean.size());
    for (std::size_t k = 0; k < mean.size(); ++k) {
      mean[k] = 3 - 2.0 * static_cast<double>(k);
      slope[k] = 5.0 * static_cast<double>(k) - 4;
    }
  }
  // accelerations of all links' origins and angular ones, by the recursion
  std::vector<double> link_accelerations() {
    std::vector<double> udot(recursive.state.u.size()), result;
    evaluate(recursive.model, state, recursive.ws);
    accelerations(recursive.model, recursive.ws, mean, udot);
    for (std::size_t i = 1; i < recursive.model.links.size(); ++i) {
      const LinkMotion& m = recursive.ws.motion[i];
      const math::Vec3 a = m.a + recursive.ws.delta_a[i] + recursive.model.gravity;
      for (const double x : a.array()) result.push_back(x);
      for (const double x : (m.alpha + recursive.ws.delta_alpha[i]).array()) result.push_back(x);
    }
    for_each_mode(recursive.model, [&](std::size_t, std::size_t u) { result.push_back(udot[u]); });
    return result;
  }
  double acceleration_error(Held& held) {
    std::vector<double> udot(held.pws.udot.size());
    EXPECT_TRUE(held.see());
    accelerations(held.model, held.pws, mean, udot);
    return difference(udot, link_accelerations());
  }
  void expect_same_rows(const Held& held, double tolerance) {
    evaluate(recursive.model, state, recursive.ws);
    EXPECT_LT(difference(row_positions(held.ws), row_positions(recursive.ws)), 1e-12);
    EXPECT_LT(difference(row_speeds(held.ws), row_speeds(recursive.ws)), 1e-12);
    EXPECT_LT(difference(row_free_accelerations(held.ws), row_free_accelerations(recursive.ws)), tolerance);
    EXPECT_LT(difference(row_mobility(held.ws), row_mobility(recursive.ws)), tolerance);
  }
  State moved_by_recursion(int steps, double h) {
    State joints = state;
    for (int i = 0; i < steps; ++i) {
      evaluate(recursive.model, joints, recursive.ws);
      advance(recursive.model, joints, recursive.ws, h, mean, slope);
    }
    return joints;
  }

  RandomTree tree;
  Mechanism recursive;
  State state;
  std::vector<double> mean, slope;
};

TEST_P(Penalties, AugmentedAcceleratesAsTheRecursionDoes) {
  Held held(recursive.model, state, Formulation::augmented);
  EXPECT_LT(acceleration_error(held), 1e-12);
}

TEST_P(Penalties, AugmentedHasTheSameReducedModelAtTheRows) {
  Held held(recursive.model, state, Formulation::augmented);
  ASSERT_TRUE(held.see());
  expect_same_rows(held, 1e-9);
}

TEST_P(Penalties, AugmentedTakesEveryJointTwice) {
  Held once(recursive.model, state, Formulation::augmented);
  Held twice(recursive.model, state, Formulation::augmented, once.body.constraints);
  EXPECT_LT(acceleration_error(twice), 1e-12);
  ASSERT_TRUE(once.run(50, 1e-3, mean, slope));
  ASSERT_TRUE(twice.run(50, 1e-3, mean, slope));
  // each of the 50 steps closes the joints to 1e-12, either way of writing them to its own; speeds have that over 1 ms
  EXPECT_LT(coordinate_difference(once.joints, twice.joints), 50 * 1e-12);
  EXPECT_LT(difference(once.joints.u, twice.joints.u), 0.5 * 1e-12 / 1e-3);
  EXPECT_LT(twice.position_error, 1e-12);
  // 1e-12 of speeds that go beyond 10 m/s
  EXPECT_LT(twice.rate_error, 2e-11);
  // each of a pair carries the same half: the multipliers of the smallest norm
  ASSERT_TRUE(once.see());
  ASSERT_TRUE(twice.see());
  const std::size_t rows = once.body.alpha.size();
  std::vector<double> halves(once.pws.free_multipliers);
  for (double& lambda : halves) lambda *= 0.5;
  const std::span<const double> both = twice.pws.free_multipliers;
  EXPECT_LT(difference(both.first(rows), halves), 1e-6);
  EXPECT_LT(difference(both.subspan(rows), halves), 1e-6);
}

TEST_P(Penalties, PlainIsWrongByAShareOfItsFactor) {
  const auto error_with = [this](double factor) {
    recursive.model.penalty.factor = factor;
    Held held(recursive.model, state, Formulation::penalty);
    const double error = acceleration_error(held);
    evaluate(recursive.model, state, recursive.ws);
    EXPECT_LT(difference(row_mobility(held.ws), row_mobility(recursive.ws)), 100 / factor);
    return error;
  };
  const double soft = error_with(1e4), stiff = error_with(1e5);
  EXPECT_LT(stiff, 1e-3);
  // links that nothing holds have no error at all
  if (stiff > 1e-12) {
    EXPECT_NEAR(soft / stiff, 10, 0.1);
  }
}

TEST_P(Penalties, PlainMovesAsTheRecursionDoes) {
  Held held(recursive.model, state, Formulation::penalty);
  EXPECT_TRUE(held.run(500, 2e-4, mean, slope));
  const State joints = moved_by_recursion(500, 2e-4);
  EXPECT_LT(coordinate_difference(held.joints, joints), 1e-7);
  EXPECT_LT(difference(held.joints.u, joints.u), 1e-6);
  EXPECT_LT(held.position_error, 1e-7);
}

// no end stops and no springs whose angle may jump by a turn: there the order is one
class SmoothPenalties : public Penalties {
 protected:
  void SetUp() override {
    for (auto& force : tree.def.translational_forces) force.end_spring_constant = force.end_damping_constant = 0;
    for (auto& force : tree.def.rotational_forces) force.spring_constant = 0;
    recursive = Mechanism(tree.def, tree.rows);
    Penalties::SetUp();
  }
};

TEST_P(SmoothPenalties, AugmentedConvergesWithSecondOrder) {
  const auto error_at = [&](double h) {
    const int steps = static_cast<int>(std::lround(0.1 / h));
    Held held(recursive.model, state, Formulation::augmented);
    EXPECT_TRUE(held.run(steps, h, mean, slope));
    // whatever the step
    EXPECT_LT(held.position_error, 1e-12);
    EXPECT_LT(held.rate_error, 1e-11);
    EXPECT_LE(held.iterations, 8);
    // the same forces, which are linear in time within each step
    return coordinate_difference(held.joints, moved_by_recursion(steps, h));
  };
  const double coarse = error_at(1e-3), fine = error_at(5e-4);
  EXPECT_LT(fine, 1e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05);
}

TEST_P(SmoothPenalties, PlainOpensItsJointsByAShareOfItsFactor) {
  const auto opening_with = [this](double factor) {
    recursive.model.penalty.factor = factor;
    Held held(recursive.model, state, Formulation::penalty);
    EXPECT_TRUE(held.run(400, 1e-4, mean, slope));
    return held.position_error;
  };
  const double soft = opening_with(1e4), stiff = opening_with(1e5);
  if (stiff > 1e-12) {
    EXPECT_NEAR(soft / stiff, 10, 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Penalties, ::testing::Range(1u, 41u));
INSTANTIATE_TEST_SUITE_P(WithModes, Penalties, ::testing::Range(kFirstWithModes, kFirstWithModes + 20));
INSTANTIATE_TEST_SUITE_P(WithShortening, Penalties, ::testing::Range(kFirstWithShortening, kFirstWithShortening + 10));
INSTANTIATE_TEST_SUITE_P(WithNodeDummies, Penalties,
                         ::testing::Range(kFirstWithNodeDummies, kFirstWithNodeDummies + 20));
// flexible bodies that are fixed at nodes of others: dummies on their nodes, and one (588) from there to the other's
INSTANTIATE_TEST_SUITE_P(WithNestedBodies, Penalties, ::testing::Values(341u, 493u, 526u, 588u));
INSTANTIATE_TEST_SUITE_P(WithBoth, Penalties, ::testing::Range(kFirstWithBoth, kFirstWithBoth + 10));
INSTANTIATE_TEST_SUITE_P(Seeds, SmoothPenalties, ::testing::Range(1u, 41u));

}  // namespace
}  // namespace slew::multibody
