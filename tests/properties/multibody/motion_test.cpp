// SPDX-License-Identifier: Apache-2.0
// Prescribed motion on random trees, against the assembled equations of motion (assembled.h) with the prescribed u'
// put in: M_ff u'_f = Q_f - M_fd p'' for the free speeds, and the drives' forces from the rows that are left.
#include <gtest/gtest.h>

#include "multibody/formulations/dynamics.h"
#include "multibody/joints/joint_gauge.h"
#include "multibody/motions/build_drives.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace motion_test {

using namespace testing;
using namespace slew::testing;

// relative to the largest entry
constexpr double kTolerance = 1e-9;
constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange, Formulation::augmented,
                                         Formulation::penalty};

MotionDef random_motion(std::mt19937& random, const JointDef& joint, MotionKind kind, int axis) {
  std::uniform_real_distribution<double> number(0.2, 1);
  return {.name = joint.name + (kind == MotionKind::rotation ? "_Turn" : "_Slide") + std::to_string(axis),
          .kind = kind,
          .shape = MotionShape::harmonic,
          .joint = joint.name,
          .axis = axis,
          .amplitude = 0.3 * number(random),
          .frequency = number(random),
          .phase = number(random)};
}

// every other coordinate of the tree's joints follows a sine
RandomTree driven_tree(unsigned seed) {
  RandomTree tree = random_tree(seed, {.bodies = 1 + static_cast<int>(seed) % 9, .two_coordinates = true});
  std::mt19937 random(seed + 31);
  for (JointDef& joint : tree.def.joints) {
    for (const MotionKind kind : {MotionKind::rotation, MotionKind::translation}) {
      for (const int axis : {1, 2}) {
        MotionDef motion = random_motion(random, joint, kind, axis);
        const int number = kind == MotionKind::translation && axis == 2 ? -1 : driven_coordinate(motion, joint.type);
        if (number < 0 || std::uniform_int_distribution<int>(0, 1)(random) == 0) continue;
        (number == 0 ? joint.initial_velocity : joint.initial_velocity_2) = kNotGiven;
        tree.def.motions.push_back(motion);
      }
    }
  }
  return tree;
}

const std::vector<std::uint32_t> kSeeds = seeds({{1, 24}});
// 0.8 s a seed for the ports: every row's derivatives by differences in long double, in four formulations
constexpr std::uint32_t kGateSeedsOfPorts = 3;
constexpr double kTime = 0.7;  // s

// random, except for prescribed coordinates
State state_at(const Mechanism& mechanism, std::uint32_t seed) {
  State state = random_state(seed, mechanism.model);
  state.time = kTime;
  for (const Drive& drive : mechanism.model.drives) {
    const MotionValue value = evaluate(drive.law, kTime);
    state.q[static_cast<std::size_t>(drive.q)] = value.position;
    state.u[static_cast<std::size_t>(drive.u)] = value.speed;
  }
  return state;
}

// u' of all speeds, and the forces that the drives need, from the assembled equations
struct Expected {
  Vector udot, forces;
  Matrix free_mobility;  // M_ff^-1, zero along prescribed speeds
};

Expected solve(const Assembled& reference, const Model& model, const Vector& q, const Vector& u) {
  const Matrix M = reference.mass_matrix(q);
  const Vector Q = reference.forces(q, u);
  std::vector<Index> free;
  Vector known(u.size());
  std::vector<bool> is_driven(static_cast<std::size_t>(u.size()), false);
  for (const Drive& drive : model.drives) {
    is_driven[static_cast<std::size_t>(drive.u)] = true;
    known[drive.u] = evaluate(drive.law, kTime).acceleration;
  }
  for (Index j = 0; j < u.size(); ++j) {
    if (!is_driven[static_cast<std::size_t>(j)]) free.push_back(j);
  }
  Expected expected{known, Vector(static_cast<Index>(model.drives.size())), Matrix(u.size(), u.size())};
  if (!free.empty()) {
    const Matrix own = inverse(M.chosen(free, free));
    const Vector right = Q - M * known;
    for (std::size_t k = 0; k < free.size(); ++k) {
      for (std::size_t l = 0; l < free.size(); ++l) {
        const Real mobility = own(static_cast<Index>(k), static_cast<Index>(l));
        expected.udot[free[k]] += mobility * right[free[l]];
        expected.free_mobility(free[k], free[l]) = mobility;
      }
    }
  }
  const Vector needed = M * expected.udot - Q;
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    expected.forces[static_cast<Index>(k)] = needed[model.drives[k].u];
  }
  return expected;
}

TEST(DrivenTrees, AccelerateAndLoadTheirDrivesAsInTheAssembledEquations) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    RandomTree tree = driven_tree(seed);
    Mechanism mechanism(tree.def, tree.rows);
    if (mechanism.model.speed_count() == 0) return;  // all joints are fixed
    const Assembled reference(tree.def, mechanism.model);
    const State state = state_at(mechanism, seed);
    const Expected expected = solve(reference, mechanism.model, to_vector(state.q), to_vector(state.u));
    evaluate(mechanism.model, state, mechanism.ws);
    std::vector<double> udot(state.u.size());
    accelerations(mechanism.model, mechanism.ws, {}, udot);
    EXPECT_LT(difference(to_vector(udot), expected.udot), kTolerance);
    std::vector<JointReaction> reactions(mechanism.model.joints.size());
    joint_reactions(mechanism.model, state, mechanism.ws, {}, reactions);
    std::vector<double> forces;
    for (std::size_t k = 0; k < mechanism.model.drives.size(); ++k) {
      forces.push_back(drive_force(mechanism.model, mechanism.ws, k, {}, reactions));
    }
    EXPECT_LT(difference(to_vector(forces), expected.forces), kTolerance);
  });
}

TEST(DrivenTrees, ShowTheirPortsWhatIsLeftToMove) {
  for_each_seed(seeds({{1, 24}}, kGateSeedsOfPorts), [](std::uint32_t seed) {
    RandomTree tree = driven_tree(seed);
    const auto rows = static_cast<Index>(tree.rows.size());
    if (rows == 0) return;  // nothing to act on
    for (const Formulation formulation : kFormulations) {
      tree.def.formulation = formulation;
      Mechanism mechanism(tree.def, tree.rows);
      const Assembled reference(tree.def, mechanism.model);
      State state = state_at(mechanism, seed);
      const Vector q = to_vector(state.q), u = to_vector(state.u);
      const Expected expected = solve(reference, mechanism.model, q, u);
      Matrix J(rows, u.size());
      Vector a_free(rows);
      for (Index k = 0; k < rows; ++k) {
        const std::string& name = tree.rows[static_cast<std::size_t>(k)];
        const Vector row = reference.row_jacobian(name, q);
        J.put(k, 0, row.transposed());
        a_free[k] = row.dot(expected.udot) + reference.row_bias(name, q, u);
      }
      const Matrix W = J * expected.free_mobility * J.transposed();
      Dynamics dynamics(formulation, mechanism.model, state);
      dynamics.evaluate(mechanism.model, state, mechanism.ws);
      const double tolerance = formulation == Formulation::penalty ? 1e-4 : 1e-8;
      EXPECT_LT(difference(to_vector(row_free_accelerations(mechanism.ws)), a_free), tolerance) << name_of(formulation);
      EXPECT_LT(difference(to_vector(row_mobility(mechanism.ws)), W.flat()), tolerance) << name_of(formulation);
    }
  });
}

TEST(DrivenTrees, MoveAlikeInEveryFormulation) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    RandomTree tree = driven_tree(seed);
    std::vector<double> by_recursion;
    for (const Formulation formulation : kFormulations) {
      tree.def.formulation = formulation;
      Formulated moving(tree.def);
      moving.run(0.05, 5e-4);
      const double tolerance =
          formulation == Formulation::penalty || formulation == Formulation::augmented ? 2e-3 : 1e-7;
      if (by_recursion.empty()) by_recursion = moving.state.u;
      EXPECT_LT(difference(to_vector(moving.state.u), to_vector(by_recursion)), tolerance) << name_of(formulation);
      moving.dynamics.observe(moving.model, moving.state, moving.ws);
      const JointGap gap = JointGauge(moving.model).measure(moving.ws);
      EXPECT_LT(gap.position, formulation == Formulation::penalty ? 1e-4 : 1e-8) << name_of(formulation);
      EXPECT_LT(gap.rate, formulation == Formulation::penalty ? 1e-2 : 1e-7) << name_of(formulation);
    }
  });
}

}  // namespace motion_test
}  // namespace slew::multibody
