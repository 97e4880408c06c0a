// SPDX-License-Identifier: Apache-2.0
// The recursion against the assembled equations of motion (assembled.h) on random trees.
#include <gtest/gtest.h>

#include "multibody/formulations/dynamics.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace agreement_test {

using namespace testing;
using namespace slew::testing;

// relative to the largest entry
constexpr double kTolerance = 1e-9;

const std::initializer_list<SeedRange> kRanges = {{1, 24}, {kFirstWithModes, 40}, {kFirstWithNodeDummies, 60}};
const std::vector<std::uint32_t> kSeeds = seeds(kRanges);
// half a second a seed for the rows: every row's derivatives by differences in long double
constexpr std::uint32_t kGateSeedsOfRows = 2;

TreeOptions options_of(std::uint32_t seed) {
  return with_modes_of(seed, {.bodies = 1 + static_cast<int>(seed) % 9, .two_coordinates = true});
}

TEST(RandomTrees, AccelerateAsInTheAssembledEquations) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    const RandomTree random = random_tree(seed, options_of(seed));
    Mechanism mechanism(random.def, random.rows);
    if (mechanism.model.degrees_of_freedom() == 0) return;  // all joints are fixed
    const Assembled reference(random.def, mechanism.model, random.points);
    const State state = random_state(seed, mechanism.model);
    evaluate(mechanism.model, state, mechanism.ws);
    const Vector q = to_vector(state.q), u = to_vector(state.u);
    EXPECT_LT(difference(to_vector(mechanism.ws.udot_free), reference.accelerations(q, u)), kTolerance);
  });
}

TEST(RandomTrees, RowsAgreeWithTheAssembledEquations) {
  for_each_seed(seeds(kRanges, kGateSeedsOfRows), [](std::uint32_t seed) {
    const RandomTree random = random_tree(seed, options_of(seed));
    Mechanism mechanism(random.def, random.rows);
    const auto rows = static_cast<Index>(random.rows.size());
    if (rows == 0) return;  // nothing to act on
    const Assembled reference(random.def, mechanism.model, random.points);
    const State state = random_state(seed, mechanism.model);
    evaluate(mechanism.model, state, mechanism.ws);
    const Vector q = to_vector(state.q), u = to_vector(state.u);
    const Vector udot = reference.accelerations(q, u);
    Matrix J(rows, u.size());
    Vector a_free(rows), x(rows), v(rows);
    for (Index k = 0; k < rows; ++k) {
      const std::string& name = random.rows[static_cast<std::size_t>(k)];
      const Vector row = reference.row_jacobian(name, q);
      J.put(k, 0, row.transposed());
      x[k] = reference.row_value(name, q);
      v[k] = row.dot(u);
      a_free[k] = row.dot(udot) + reference.row_bias(name, q, u);
    }
    const Matrix W = J * solve(reference.mass_matrix(q), J.transposed());
    EXPECT_LT(difference(to_vector(row_positions(mechanism.ws)), x), kTolerance);
    EXPECT_LT(difference(to_vector(row_speeds(mechanism.ws)), v), kTolerance);
    EXPECT_LT(difference(to_vector(row_free_accelerations(mechanism.ws)), a_free), kTolerance);
    EXPECT_LT(difference(to_vector(row_mobility(mechanism.ws)), W.flat()), kTolerance);
  });
}

TEST(RandomTrees, RowForcesActAsInTheirColumns) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    const RandomTree random = random_tree(seed, options_of(seed));
    Mechanism mechanism(random.def, random.rows);
    const std::size_t rows = random.rows.size(), dof = mechanism.state.u.size();
    if (rows == 0) return;  // nothing to act on
    const State state = random_state(seed, mechanism.model);
    std::vector<double> forces(rows);
    for (std::size_t k = 0; k < rows; ++k) forces[k] = 3 - 2.0 * static_cast<double>(k);
    evaluate(mechanism.model, state, mechanism.ws);
    // by the sum of columns, by one combined solution, and with the forces inside the recursion
    std::vector<double> by_columns = mechanism.ws.udot_free, combined(dof), column(dof);
    for (std::size_t k = 0; k < rows; ++k) {
      response_column(mechanism.model, mechanism.ws, static_cast<int>(k), column);
      for (std::size_t j = 0; j < dof; ++j) by_columns[j] += column[j] * forces[k];
    }
    accelerations(mechanism.model, mechanism.ws, forces, combined);
    forward_dynamics(mechanism.model, state.q, state.u, forces, mechanism.ws);
    EXPECT_LT(difference(to_vector(by_columns), to_vector(mechanism.ws.udot)), kTolerance);
    EXPECT_LT(difference(to_vector(combined), to_vector(mechanism.ws.udot)), kTolerance);
  });
}

// Lagrange's equations themselves, from the kinetic energy T = u^T M(q) u / 2 and the potential:
//   M u' + M' u - dT/dq + dV/dq = 0, all derivatives by differences; u = q' holds for joints with one coordinate
TEST(RandomTrees, ObeyLagrangesEquations) {
  for_each_seed(kSeeds, [](std::uint32_t seed) {
    TreeOptions o = options_of(seed);
    o.only_one_coordinate = true;
    o.with_forces = false;
    const RandomTree random = random_tree(seed, o);
    Mechanism mechanism(random.def, {});
    const Assembled reference(random.def, mechanism.model, random.points);
    const State state = random_state(seed, mechanism.model);
    const Vector q = to_vector(state.q), u = to_vector(state.u);
    Vector rest = derivative_at_zero([&](Real t) { return reference.mass_matrix(q + t * u) * u; });
    for (Index k = 0; k < q.size(); ++k) {
      const Vector e = Vector::unit(q.size(), k);
      rest[k] -= derivative_at_zero([&](Real t) {
        const Vector there = q + t * e;
        return Real(0.5L * u.dot(reference.mass_matrix(there) * u) - reference.potential(there));
      });
    }
    const Vector expected = solve(reference.mass_matrix(q), -rest);
    forward_dynamics(mechanism.model, state.q, state.u, {}, mechanism.ws);
    EXPECT_LT(difference(to_vector(mechanism.ws.udot), expected), kTolerance);
  });
}

// purpose of the seeds with dummies at nodes
TEST(NodeDummies, AreOfEveryKindInTheRandomTrees) {
  int within = 0, at_outer = 0, at_inner = 0, at_both = 0, in_pairs = 0;
  for (unsigned seed = kFirstWithNodeDummies; seed < kFirstWithNodeDummies + 60; ++seed) {
    const TreeOptions options =
        with_modes_of(seed, {.bodies = 1 + static_cast<int>(seed) % 9, .two_coordinates = true});
    const Model model = build_model(random_tree(seed, options).def);
    int last = 0;
    for (const NodeDummy& dummy : model.node_dummies) {
      within += dummy.carrier == dummy.outer ? 1 : 0;
      if (dummy.child == 0) continue;
      const bool is_outer = dummy.outer_part >= 0, is_inner = dummy.inner_part >= 0;
      at_outer += is_outer && !is_inner ? 1 : 0;
      at_inner += is_inner && !is_outer ? 1 : 0;
      at_both += is_inner && is_outer ? 1 : 0;
      in_pairs += dummy.child == last ? 1 : 0;
      last = dummy.child;
    }
  }
  for (const int count : {within, at_outer, at_inner, at_both, in_pairs}) EXPECT_GE(count, 5);
  for (const auto& [name, count] : {
           std::pair("within", within),
           {"outer", at_outer},
           {"inner", at_inner},
           {"both", at_both},
           {"pairs", in_pairs},
       }) {
    RecordProperty(name, count);
  }
}

}  // namespace agreement_test
}  // namespace slew::multibody
