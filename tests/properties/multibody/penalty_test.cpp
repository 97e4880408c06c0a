// SPDX-License-Identifier: Apache-2.0
// Body coordinates whose joints are held by penalties, formulations `augmented` and `penalty`, against the recursion in
// joint coordinates on random trees.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "multibody/formulations/dynamics.h"
#include "tests/properties/multibody/held.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace penalty_test {

using namespace testing;
using namespace slew::testing;

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

// 341, 493, 526 and 588: flexible bodies that are fixed at nodes of others, with dummies on their nodes and one (588)
// from there to the other's
const std::vector<std::uint32_t> kSeeds = seeds({{1, 40},
                                                 {kFirstWithModes, 20},
                                                 {kFirstWithShortening, 10},
                                                 {kFirstWithNodeDummies, 20},
                                                 {kFirstWithBoth, 10},
                                                 {341, 1},
                                                 {493, 1},
                                                 {526, 1},
                                                 {588, 1}});
const std::vector<std::uint32_t> kSmoothSeeds = seeds({{1, 40}});

// One random tree in joint coordinates, with forces at its rows that are linear in time.
struct Specimen {
  explicit Specimen(std::uint32_t seed)
      : Specimen(seed, random_tree(seed, with_modes_of(seed, {.bodies = 1 + static_cast<int>(seed) % 9}))) {}
  Specimen(std::uint32_t seed, const RandomTree& tree) : recursive(tree.def, tree.rows) {
    state = random_state(seed, recursive.model);
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
  State moved_by_recursion(int steps, double h) { return moved_by_recursion(state, steps, h); }
  State moved_by_recursion(State joints, int steps, double h) {
    for (int i = 0; i < steps; ++i) {
      evaluate(recursive.model, joints, recursive.ws);
      advance(recursive.model, joints, recursive.ws, h, mean, slope);
    }
    return joints;
  }

  // what errors of the speeds of one size become over a time at worst, by what they are without forces: the largest row
  // of |dq/du| / (h steps)
  double growth(int steps, double h) {
    constexpr double kError = 1e-9;
    const State there = moved_by_recursion(steps, h);
    std::vector<double> rows(there.q.size());
    for (std::size_t j = 0; j < state.u.size(); ++j) {
      State other = state;
      other.u[j] += kError;
      other = moved_by_recursion(other, steps, h);
      for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += std::fabs(std::fabs(other.q[i]) - std::fabs(there.q[i]));
    }
    return *std::max_element(rows.begin(), rows.end()) / (kError * h * steps);
  }

  Mechanism recursive;
  State state;
  std::vector<double> mean, slope;
};

template <typename Claim>
void for_each_tree(Claim claim) {
  for_each_seed(kSeeds, [&](std::uint32_t seed) {
    Specimen specimen(seed);
    if (specimen.recursive.model.degrees_of_freedom() == 0) return;  // all joints are fixed
    claim(specimen);
  });
}

TEST(Penalties, AugmentedAcceleratesAsTheRecursionDoes) {
  for_each_tree([](Specimen& specimen) {
    Held held(specimen.recursive.model, specimen.state, Formulation::augmented);
    EXPECT_LT(specimen.acceleration_error(held), 1e-12);
  });
}

TEST(Penalties, AugmentedHasTheSameReducedModelAtTheRows) {
  for_each_tree([](Specimen& specimen) {
    Held held(specimen.recursive.model, specimen.state, Formulation::augmented);
    ASSERT_TRUE(held.see());
    specimen.expect_same_rows(held, 1e-9);
  });
}

TEST(Penalties, AugmentedTakesEveryJointTwice) {
  for_each_tree([](Specimen& specimen) {
    Held once(specimen.recursive.model, specimen.state, Formulation::augmented);
    Held twice(specimen.recursive.model, specimen.state, Formulation::augmented, once.body.constraints);
    EXPECT_LT(specimen.acceleration_error(twice), 1e-12);
    ASSERT_TRUE(once.run(50, 1e-3, specimen.mean, specimen.slope));
    ASSERT_TRUE(twice.run(50, 1e-3, specimen.mean, specimen.slope));
    // each of the 50 steps closes the joints to 1e-12, either way of writing them to its own; speeds have that over
    // 1 ms, and grow as the motion lets them
    EXPECT_LT(coordinate_difference(once.joints, twice.joints), 50 * 1e-12 * std::max(1.0, specimen.growth(50, 1e-3)));
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
  });
}

TEST(Penalties, PlainIsWrongByAShareOfItsFactor) {
  for_each_tree([](Specimen& specimen) {
    const auto error_with = [&](double factor) {
      specimen.recursive.model.penalty.factor = factor;
      Held held(specimen.recursive.model, specimen.state, Formulation::penalty);
      const double error = specimen.acceleration_error(held);
      evaluate(specimen.recursive.model, specimen.state, specimen.recursive.ws);
      EXPECT_LT(difference(row_mobility(held.ws), row_mobility(specimen.recursive.ws)), 100 / factor);
      return error;
    };
    const double soft = error_with(1e4), stiff = error_with(1e5);
    EXPECT_LT(stiff, 1e-3);
    // links that nothing holds have no error at all
    if (stiff > 1e-12) {
      EXPECT_NEAR(soft / stiff, 10, 0.1);
    }
  });
}

TEST(Penalties, PlainMovesAsTheRecursionDoes) {
  for_each_tree([](Specimen& specimen) {
    Held held(specimen.recursive.model, specimen.state, Formulation::penalty);
    const int steps = slew::testing::rounds(100, 500);
    EXPECT_TRUE(held.run(steps, 2e-4, specimen.mean, specimen.slope));
    const State joints = specimen.moved_by_recursion(steps, 2e-4);
    EXPECT_LT(coordinate_difference(held.joints, joints), 1e-7);
    EXPECT_LT(difference(held.joints.u, joints.u), 1e-6);
    EXPECT_LT(held.position_error, 1e-7);
  });
}

// no end stops and no springs whose angle may jump by a turn: there the order is one
template <typename Claim>
void for_each_smooth_tree(Claim claim) {
  for_each_seed(kSmoothSeeds, [&](std::uint32_t seed) {
    RandomTree tree = random_tree(seed, {.bodies = 1 + static_cast<int>(seed) % 9});
    for (auto& force : tree.def.translational_forces) force.end_spring_constant = force.end_damping_constant = 0;
    for (auto& force : tree.def.rotational_forces) force.spring_constant = 0;
    Specimen specimen(seed, tree);
    if (specimen.recursive.model.degrees_of_freedom() == 0) return;  // all joints are fixed
    claim(specimen);
  });
}

TEST(SmoothPenalties, AugmentedConvergesWithSecondOrder) {
  for_each_smooth_tree([](Specimen& specimen) {
    const auto error_at = [&](double h) {
      const int steps = static_cast<int>(std::lround(0.1 / h));
      Held held(specimen.recursive.model, specimen.state, Formulation::augmented);
      EXPECT_TRUE(held.run(steps, h, specimen.mean, specimen.slope));
      // whatever the step
      EXPECT_LT(held.position_error, 1e-12);
      EXPECT_LT(held.rate_error, 1e-11);
      EXPECT_LE(held.iterations, 8);
      // the same forces, which are linear in time within each step
      return coordinate_difference(held.joints, specimen.moved_by_recursion(steps, h));
    };
    const double coarse = error_at(1e-3), fine = error_at(5e-4);
    EXPECT_LT(fine, 1e-4);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.05);
  });
}

TEST(SmoothPenalties, PlainOpensItsJointsByAShareOfItsFactor) {
  for_each_smooth_tree([](Specimen& specimen) {
    const auto opening_with = [&](double factor) {
      specimen.recursive.model.penalty.factor = factor;
      Held held(specimen.recursive.model, specimen.state, Formulation::penalty);
      EXPECT_TRUE(held.run(400, 1e-4, specimen.mean, specimen.slope));
      return held.position_error;
    };
    const double soft = opening_with(1e4), stiff = opening_with(1e5);
    if (stiff > 1e-12) {
      EXPECT_NEAR(soft / stiff, 10, 0.5);
    }
  });
}

}  // namespace penalty_test
}  // namespace slew::multibody
