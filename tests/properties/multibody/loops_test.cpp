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
#include "tests/properties/multibody/random_tree.h"
#include "tests/validation/multibody/angles.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

using namespace testing;
using math::Mat3;
using math::Vec3;

constexpr Real kTolerance = 1e-9L;

constexpr JointType kTypes[] = {JointType::revolute,
                                JointType::prismatic,
                                JointType::spherical,
                                JointType::universal,
                                JointType::cylindrical,
                                JointType::in_plane,
                                JointType::in_line,
                                JointType::perpendicular,
                                JointType::spherical_spherical,
                                JointType::revolute_spherical,
                                JointType::revolute_revolute,
                                JointType::fixed};

Vector to_vector(const std::vector<double>& values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) v[static_cast<Eigen::Index>(i)] = values[i];
  return v;
}

Real difference(const Vector& a, const Vector& b) {
  if (b.size() == 0) return 0;
  return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff());
}

// A tree with one or two joints more, which the start fits.
class Closing {
 public:
  explicit Closing(unsigned seed) : random_(seed + 77) {
    tree =
        random_tree(seed, {.bodies = 3 + static_cast<int>(seed) % 6, .with_dummies = false, .two_coordinates = true});
    Problems problems;
    poses_ = start_poses(tree.def, problems);
    add(kTypes[seed % std::size(kTypes)]);
    if (seed % 3 == 0) add(kTypes[(seed / 3) % std::size(kTypes)]);
  }

  RandomTree tree;

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Mat3 rotation() { return math::rotation_xyz({number(-3, 3), number(-1.5, 1.5), number(-3, 3)}); }

  void add(JointType type) {
    const int bodies = static_cast<int>(poses_.size());
    const int a = std::uniform_int_distribution<int>(0, bodies - 1)(random_);
    const int b = (a + std::uniform_int_distribution<int>(1, bodies - 1)(random_)) % bodies;
    const Mat3 R1 = rotation();
    const Vec3 P1 = poses_[static_cast<std::size_t>(a)].p + vector(0.5);
    Mat3 R2 = R1;
    Vec3 P2 = P1;
    switch (type) {
      case JointType::revolute:
        R2 = R1 * math::rotation_z(number(-3, 3));
        break;
      case JointType::prismatic:
        P2 = P1 + R1.c[2] * number(-1, 1);
        break;
      case JointType::cylindrical:
        R2 = R1 * math::rotation_z(number(-3, 3));
        [[fallthrough]];
      case JointType::in_line:
        P2 = P1 + R1.c[2] * number(-1, 1);
        break;
      case JointType::in_plane:
        P2 = P1 + R1.c[0] * number(-1, 1) + R1.c[1] * number(-1, 1);
        break;
      case JointType::universal:
      case JointType::perpendicular:
        R2 = R1 * math::rotation_z(number(-3, 3)) * math::rotation_xyz({0, M_PI / 2, 0}) * math::rotation_z(1);
        break;
      case JointType::fixed:
      case JointType::spherical:
        break;
      default:
        P2 = P1 + vector(1);
        R2 = rotation();
    }
    const auto into = [&](int body, const Mat3& R, Vec3 P, Triple& point, Triple& orientation, std::string& name) {
      const Pose& pose = poses_[static_cast<std::size_t>(body)];
      point = (transpose(pose.R) * (P - pose.p)).array();
      orientation = angles_xyz(transpose(pose.R) * R);
      name = body_name(tree.def, body);
    };
    JointDef joint{.name = "C" + std::to_string(tree.def.joints.size()), .type = type};
    into(a, R1, P1, joint.point1, joint.orientation1, joint.body1);
    into(b, R2, P2, joint.point2, joint.orientation2, joint.body2);
    tree.def.joints.push_back(joint);
  }

  std::mt19937 random_;
  std::vector<Pose> poses_;
};

class RandomLoops : public ::testing::TestWithParam<unsigned> {
 protected:
  RandomLoops()
      : closing(GetParam()), mechanism(closing.tree.def, rows()), reference(closing.tree.def, mechanism.model) {}

  // of two joints on one coordinate the tree may hold the later one
  [[nodiscard]] std::vector<std::string> rows() const {
    std::vector<std::string> names;
    for (const std::string& row : closing.tree.rows) {
      Problems problems;
      validate_rows(closing.tree.def, std::vector<std::string>{row}, problems);
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
    for (std::size_t j = 0; j < closing.tree.def.joints.size(); ++j) {
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

  Closing closing;
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
  MechanicsDef def = closing.tree.def;
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
                                        moving.ws.motion[static_cast<std::size_t>(cut.link2)]);
        EXPECT_LT(std::fabs(value.g), 1e-9) << name_of(formulation);
        EXPECT_LT(std::fabs(value.rate), 1e-8) << name_of(formulation);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomLoops, ::testing::Range(1u, 61u));

}  // namespace
}  // namespace slew::multibody
