// SPDX-License-Identifier: Apache-2.0
// Random mechanisms with loops, every joint type among those that close them, against the equations assembled from the
// Def in long double: M u' + J^T lambda = Q, J u' = -J' u, solved by least squares so that redundant rows do no harm.
#include "multibody/constraints/loops.h"

#include <gtest/gtest.h>

#include <cmath>

#include "multibody/constraints/constraint.h"
#include "multibody/formulations/body_coordinates.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/model/topology.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_loops.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/angles.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace loops_test {

using namespace testing;
using namespace slew::testing;
using math::Mat3;
using math::Vec3;

constexpr Real kTolerance = 1e-9L;

// twelve seeds on end close loops with every joint type
constexpr std::uint32_t kGateSeeds = 12;
const std::vector<std::uint32_t> kSeeds = seeds({{1, 60}}, kGateSeeds);

struct MovingLoops {
  explicit MovingLoops(std::uint32_t seed)
      : closing(random_loops(seed)), mechanism(closing.def, rows()), reference(closing.def, mechanism.model) {}

  // of two joints on one coordinate the tree may hold the later one
  [[nodiscard]] std::vector<std::string> rows() const {
    std::vector<std::string> names;
    for (const std::string& row : closing.rows) {
      Problems problems;
      validate_rows(closing.def, std::vector<std::string>{row}, problems);
      const bool is_force = row[0] == 'F';
      if (problems.empty() && is_force) names.push_back(row);
    }
    return names;
  }

  // speeds at random along the joints; false: the loops do not close
  [[nodiscard]] bool start(std::uint32_t seed) {
    State& state = mechanism.state;
    std::mt19937 random(seed);
    for (double& speed : state.u) speed = std::uniform_real_distribution<double>(-1, 1)(random);
    if (!mechanism.model.cuts.empty()) {
      forward_dynamics(mechanism.model, state.q, state.u, {}, mechanism.ws);
      if (!project(mechanism.model, state.q, state.u, mechanism.ws)) return false;
    }
    evaluate(mechanism.model, state, mechanism.ws);
    q = to_vector(state.q);
    u = to_vector(state.u);
    collect();
    return true;
  }

  void collect() {
    const Index n = mechanism.model.speed_count();
    J = Matrix(0, n);
    bias = Vector(0);
    for (std::size_t j = 0; j < closing.def.joints.size(); ++j) {
      if (mechanism.model.joints[j].cut < 0) continue;
      const Matrix here = reference.cut_jacobian(j, q);
      if (here.largest() < 1e-10L) continue;  // between bodies that fixed joints merge
      J.append_rows(here);
      bias.append_rows(reference.cut_bias(j, q, u));
    }
    M = reference.mass_matrix(q);
  }

  // u' of M u' = Q + J^T f with J u' = right
  [[nodiscard]] Vector solve(const Vector& Q, const Vector& right) const {
    const Vector free = slew::testing::solve(M, Q);
    if (J.rows() == 0) return free;
    const Matrix response = slew::testing::solve(M, J.transposed());
    return free + response * smallest_solution(J * response, right - J * free, 1e-12L).x;
  }

  RandomTree closing;
  Mechanism mechanism;
  Assembled reference;
  Vector q, u, bias;
  Matrix J, M;
};

template <typename Claim>
void for_each_mechanism(Claim claim, const std::vector<std::uint32_t>& chosen = kSeeds) {
  for_each_seed(chosen, [&](std::uint32_t seed) {
    MovingLoops loops(seed);
    if (loops.mechanism.model.speed_count() == 0) return;  // nothing moves in the tree
    ASSERT_TRUE(loops.start(seed));
    claim(loops);
  });
}

TEST(RandomLoops, HaveTheFreedomsThatTheJacobianLeaves) {
  for_each_mechanism([](MovingLoops& loops) {
    if (loops.J.rows() == 0) return;  // no cut
    EXPECT_EQ(loops.mechanism.model.degrees_of_freedom(),
              loops.mechanism.model.speed_count() - column_rank(loops.J.transposed(), 1e-9L));
  });
}

TEST(RandomLoops, MoveAlongTheirJoints) {
  for_each_mechanism([](MovingLoops& loops) {
    if (loops.J.rows() == 0) return;  // no cut
    EXPECT_LT((loops.J * loops.u).largest(), 1e-9L);
  });
}

TEST(RandomLoops, AccelerateAsInTheAssembledEquations) {
  for_each_mechanism([](MovingLoops& loops) {
    const Vector expected = loops.solve(loops.reference.forces(loops.q, loops.u), -loops.bias);
    EXPECT_LT(difference(to_vector(loops.mechanism.ws.udot_free), expected), kTolerance);
  });
}

TEST(RandomLoops, GiveTheirRowsTheMobilityOfTheClosedMechanism) {
  const auto claim = [](MovingLoops& loops) {
    const std::vector<std::string> names = loops.rows();
    if (names.empty()) return;  // no row
    const auto count = static_cast<Index>(names.size());
    const Vector udot = loops.solve(loops.reference.forces(loops.q, loops.u), -loops.bias);
    for (Index k = 0; k < count; ++k) {
      const std::string& name = names[static_cast<std::size_t>(k)];
      const Vector row = loops.reference.row_jacobian(name, loops.q);
      const Real a = row.dot(udot) + loops.reference.row_bias(name, loops.q, loops.u);
      EXPECT_NEAR(static_cast<double>(a), loops.mechanism.ws.row_a_free[static_cast<std::size_t>(k)],
                  1e-8 * (1 + std::fabs(static_cast<double>(a))));
      const Vector response = loops.solve(row, Vector(loops.J.rows()));
      for (Index l = 0; l < count; ++l) {
        const Real w = loops.reference.row_jacobian(names[static_cast<std::size_t>(l)], loops.q).dot(response);
        EXPECT_NEAR(static_cast<double>(w), loops.mechanism.ws.row_W[static_cast<std::size_t>(l * count + k)],
                    1e-8 * (1 + std::fabs(static_cast<double>(w))));
      }
    }
  };
  for_each_mechanism(claim, seeds({{1, 60}}, 3));
}

TEST(RandomLoops, AreTheSameInBodyCoordinates) {
  for_each_mechanism([](MovingLoops& loops) {
    const BodyModel body = build_body_model(loops.mechanism.model);
    Workspace ws(loops.mechanism.model);
    BodyWorkspace bws(loops.mechanism.model, body);
    State joints = loops.mechanism.state;
    ASSERT_TRUE(evaluate(loops.mechanism.model, body, body_state(loops.mechanism.model, loops.mechanism.state), joints,
                         ws, bws));
    EXPECT_LT(difference(to_vector(joints.u), loops.u), 1e-12L);
    EXPECT_LT(difference(to_vector(ws.row_a_free), to_vector(loops.mechanism.ws.row_a_free)), kTolerance);
    EXPECT_LT(difference(to_vector(ws.row_W), to_vector(loops.mechanism.ws.row_W)), kTolerance);
  });
}

TEST(RandomLoops, StayClosedAndKeepTheirEnergy) {
  for_each_mechanism([](MovingLoops& loops) {
    MechanicsDef def = loops.closing.def;
    def.translational_forces.clear();
    def.rotational_forces.clear();
    for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
      def.formulation = formulation;
      Formulated moving(def);
      if (moving.model.degrees_of_freedom() == 0) return;  // locked
      for (std::size_t i = 0; i < moving.state.u.size(); ++i) moving.state.u[i] = 0.2 * loops.mechanism.state.u[i];
      moving.dynamics = Dynamics(formulation, moving.model, moving.state);
      moving.see();
      const double before = moving.total_energy();
      const double scale = 1 + energy(moving.model, moving.ws).kinetic + std::fabs(before);
      moving.run(0.2, 5e-4);
      EXPECT_LT(std::fabs(moving.total_energy() - before), 1e-7 * scale) << name_of(formulation);
      for (const Cut& cut : moving.model.cuts) {
        for (const ConstraintRow& row : cut.rows) {
          const RowValue value = evaluate(row, cut, moving.ws.motion[static_cast<std::size_t>(cut.link1)],
                                          moving.ws.motion[static_cast<std::size_t>(cut.link2)], moving.ws.drives);
          EXPECT_LT(std::fabs(value.g), 1e-9) << name_of(formulation);
          EXPECT_LT(std::fabs(value.rate), 1e-8) << name_of(formulation);
        }
      }
    }
  });
}

}  // namespace loops_test
}  // namespace slew::multibody
