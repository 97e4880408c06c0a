// Random mechanisms with loops, every joint type among those that close them, against the equations assembled from the
// Def in long double: M u' + J^T lambda = Q, J u' = -J' u, solved by least squares so that redundant rows do no harm.
#include "multibody/loops.h"

#include <gtest/gtest.h>

#include <cmath>

#include "multibody/body_coordinates.h"
#include "multibody/constraint.h"
#include "multibody/dynamics.h"
#include "multibody/topology.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_loops.h"
#include "tests/validation/multibody/angles.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using namespace testing;
using math::Mat3;
using math::Vec3;

constexpr Real kTolerance = 1e-9L;

Vector to_vector(const std::vector<double>& values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) v[static_cast<Eigen::Index>(i)] = values[i];
  return v;
}

Real difference(const Vector& a, const Vector& b) {
  if (b.size() == 0) return 0;
  return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff());
}

class RandomLoops : public ::testing::TestWithParam<unsigned> {
 protected:
  RandomLoops()
      : closing(random_loops(GetParam())), mechanism(closing.def, rows()), reference(closing.def, mechanism.model) {}

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

  void SetUp() override {
    if (mechanism.model.speed_count() == 0) GTEST_SKIP() << "nothing moves in the tree";
    State& state = mechanism.state;
    std::mt19937 random(GetParam());
    for (double& speed : state.u) speed = std::uniform_real_distribution<double>(-1, 1)(random);
    if (!mechanism.model.cuts.empty()) {
      forward_dynamics(mechanism.model, state.q, state.u, {}, mechanism.ws);
      ASSERT_TRUE(project(mechanism.model, state.q, state.u, mechanism.ws));
    }
    evaluate(mechanism.model, state, mechanism.ws);
    q = to_vector(state.q);
    u = to_vector(state.u);
    collect();
  }

  void collect() {
    const Eigen::Index n = mechanism.model.speed_count();
    J.resize(0, n);
    bias.resize(0);
    for (std::size_t j = 0; j < closing.def.joints.size(); ++j) {
      if (mechanism.model.joints[j].cut < 0) continue;
      const Matrix here = reference.cut_jacobian(j, q);
      if (here.cwiseAbs().maxCoeff() < 1e-10L) continue;  // between bodies that fixed joints merge
      const Vector b = reference.cut_bias(j, q, u);
      J.conservativeResize(J.rows() + here.rows(), n);
      J.bottomRows(here.rows()) = here;
      bias.conservativeResize(bias.size() + b.size());
      bias.tail(b.size()) = b;
    }
    M = reference.mass_matrix(q);
  }

  // u' of M u' = Q + J^T f with J u' = right
  [[nodiscard]] Vector solve(const Vector& Q, const Vector& right) const {
    const Vector free = M.ldlt().solve(Q);
    if (J.rows() == 0) return free;
    const Matrix response = M.ldlt().solve(J.transpose());
    const Matrix W = J * response;
    Eigen::CompleteOrthogonalDecomposition<Matrix> inverse;
    inverse.setThreshold(1e-12L);
    inverse.compute(W);
    return free + response * inverse.solve(right - J * free);
  }

  RandomTree closing;
  Mechanism mechanism;
  Assembled reference;
  Vector q, u, bias;
  Matrix J, M;
};

TEST_P(RandomLoops, HaveTheFreedomsThatTheJacobianLeaves) {
  if (J.rows() == 0) GTEST_SKIP() << "no cut";
  Eigen::ColPivHouseholderQR<Matrix> qr;
  qr.setThreshold(1e-9L);
  qr.compute(J.transpose());
  EXPECT_EQ(mechanism.model.degrees_of_freedom(), mechanism.model.speed_count() - qr.rank());
}

TEST_P(RandomLoops, MoveAlongTheirJoints) {
  if (J.rows() == 0) GTEST_SKIP() << "no cut";
  EXPECT_LT((J * u).cwiseAbs().maxCoeff(), 1e-9L);
}

TEST_P(RandomLoops, AccelerateAsTheAssembledEquationsSay) {
  const Vector expected = solve(reference.forces(q, u), -bias);
  EXPECT_LT(difference(to_vector(mechanism.ws.udot_free), expected), kTolerance);
}

TEST_P(RandomLoops, GiveTheirRowsTheMobilityOfTheClosedMechanism) {
  const std::vector<std::string> names = rows();
  if (names.empty()) GTEST_SKIP() << "no row";
  const auto count = static_cast<Eigen::Index>(names.size());
  const Vector udot = solve(reference.forces(q, u), -bias);
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    const Vector row = reference.row_jacobian(name, q);
    const Real a = row.dot(udot) + reference.row_bias(name, q, u);
    EXPECT_NEAR(static_cast<double>(a), mechanism.ws.row_a_free[static_cast<std::size_t>(k)],
                1e-8 * (1 + std::fabs(static_cast<double>(a))));
    const Vector response = solve(row, Vector::Zero(J.rows()));
    for (Eigen::Index l = 0; l < count; ++l) {
      const Real w = reference.row_jacobian(names[static_cast<std::size_t>(l)], q).dot(response);
      EXPECT_NEAR(static_cast<double>(w), mechanism.ws.row_W[static_cast<std::size_t>(l * count + k)],
                  1e-8 * (1 + std::fabs(static_cast<double>(w))));
    }
  }
}

TEST_P(RandomLoops, AreTheSameInBodyCoordinates) {
  const BodyModel body = build_body_model(mechanism.model);
  Workspace ws(mechanism.model);
  BodyWorkspace bws(mechanism.model, body);
  State joints = mechanism.state;
  ASSERT_TRUE(evaluate(mechanism.model, body, body_state(mechanism.model, mechanism.state), joints, ws, bws));
  EXPECT_LT(difference(to_vector(joints.u), u), 1e-12L);
  EXPECT_LT(difference(to_vector(ws.row_a_free), to_vector(mechanism.ws.row_a_free)), kTolerance);
  EXPECT_LT(difference(to_vector(ws.row_W), to_vector(mechanism.ws.row_W)), kTolerance);
}

TEST_P(RandomLoops, StayClosedAndKeepTheirEnergy) {
  MechanicsDef def = closing.def;
  def.translational_forces.clear();
  def.rotational_forces.clear();
  for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
    def.formulation = formulation;
    Formulated moving(def);
    if (moving.model.degrees_of_freedom() == 0) GTEST_SKIP() << "locked";
    for (std::size_t i = 0; i < moving.state.u.size(); ++i) moving.state.u[i] = 0.2 * mechanism.state.u[i];
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
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLoops, ::testing::Range(1u, 61u));

}  // namespace
}  // namespace slew::multibody
