// SPDX-License-Identifier: Apache-2.0
// Rows over a step against dense algebra in joint coordinates: M^-1 K and M^-1 D are there the slopes of the
// recursion's accelerations, found by differences, where the code under test assembles K and D in body coordinates.
#include "multibody/formulations/step_rows.h"

#include <random>

#include "multibody/constraints/loops.h"
#include "multibody/formulations/passes.h"
#include "tests/properties/multibody/random_modes.h"
#include "tests/support/reference_algebra.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace step_rows_test {

using namespace testing;
using slew::testing::Index;
using Matrix = slew::testing::Dense<double>;
using Vector = slew::testing::Dense<double>;
using math::Vec3;

constexpr double kH = 5e-3;

Vector to_vector(std::span<const double> values) {
  return Vector::column({values.begin(), values.end()});
}

// a_free and W of all rows over H, for a mechanism without strain, force and gravity
struct Dense {
  Vector a_free;
  Matrix W;

  Dense(Mechanism& m, double H) {
    const auto n = static_cast<Index>(m.state.u.size()), rows = static_cast<Index>(m.model.rows.size());
    evaluate(m.model, m.state, m.ws);
    const Vector u = to_vector(m.state.u), udot = to_vector(m.ws.udot_free);
    const Vector a_instant = to_vector(row_free_accelerations(m.ws));
    Matrix J(rows, n), R(n, rows);
    for (Index i = 0; i < rows * n; ++i) J(i / n, i % n) = row_jacobian(m.ws)[static_cast<std::size_t>(i)];
    std::vector<double> column(m.state.u.size());
    for (Index k = 0; k < rows; ++k) {
      response_column(m.model, m.ws, static_cast<int>(k), column);
      R.put(0, k, to_vector(column));
    }
    Matrix K(n, n), D(n, n);
    for (Index j = 0; j < n; ++j) {
      K.put(0, j, (accelerations_at(m, j, -kStep, 0) - accelerations_at(m, j, kStep, 0)) / (2 * kStep));
      D.put(0, j, (accelerations_at(m, j, 0, -kStep) - accelerations_at(m, j, 0, kStep)) / (2 * kStep));
    }
    const Matrix A = Matrix::identity(n) + H * D + H * H / 2 * K;
    a_free = J * solve(A, udot - H * K * u) + (a_instant - J * udot);
    W = J * solve(A, R);
  }

 private:
  static constexpr double kStep = 1e-6;

  // away from the state along one speed, or with that speed alone
  static Vector accelerations_at(Mechanism& m, Index j, double way, double speed) {
    std::vector<double> q = m.state.q, u(m.state.u.size()), rate(q.size());
    u[static_cast<std::size_t>(j)] = 1;
    update_motion(m.model, q, u, m.ws);
    coordinate_rates(m.model, m.ws, q, u, rate);
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += way * rate[i];
    normalize_quaternions(m.model, q);
    u[static_cast<std::size_t>(j)] = speed;
    forward_dynamics(m.model, q, u, {}, m.ws);
    return to_vector(m.ws.udot);
  }
};

// small: forces of dampers would pull, and what pulls is in K of a step but not in that of this reference
void set_speeds(Mechanism& m) {
  for (std::size_t i = 0; i < m.state.u.size(); ++i) m.state.u[i] = 1e-6 * (1 + 0.3 * static_cast<double>(i % 5));
}

void expect_same(Mechanism& m, double H) {
  const Dense dense(m, H);
  StepRows rows(m.model);
  ASSERT_TRUE(rows.evaluate(m.model, m.state, m.ws, H));
  const Vector a = to_vector(rows.free_accelerations()), W = to_vector(rows.mobility());
  EXPECT_LT((a - dense.a_free).norm(), 1e-5 * dense.a_free.norm());
  const Vector flat = dense.W.transposed().flat();
  EXPECT_LT((W - flat).norm(), 1e-6 * flat.norm());
  // springs matter here
  evaluate(m.model, m.state, m.ws);
  EXPECT_GT((to_vector(row_mobility(m.ws)) - W).norm(), 0.01 * W.norm());
}

// m1 at a row, m2 behind a spring and a damper, on a line
MechanicsDef two_masses() {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "A", .position = {1, 0, 0}, .mass = 2, .inertia = {1, 1, 1}},
                {.name = "B", .position = {3, 0, 0}, .mass = 5, .inertia = {1, 1, 1}}};
  // z of both joints' frames along x of Ground
  const Triple along = {0, M_PI / 2, 0};
  def.joints = {{.name = "First",
                 .type = JointType::prismatic,
                 .body1 = "Ground",
                 .point1 = {1, 0, 0},
                 .orientation1 = along,
                 .body2 = "A",
                 .orientation2 = along},
                {.name = "Second",
                 .type = JointType::prismatic,
                 .body1 = "Ground",
                 .point1 = {3, 0, 0},
                 .orientation1 = along,
                 .body2 = "B",
                 .orientation2 = along}};
  def.translational_forces = {{.name = "Cyl", .body1 = "A", .body2 = "Ground"},
                              {.name = "Spring",
                               .body1 = "B",
                               .body2 = "A",
                               .spring_constant = 3e5,
                               .damping_constant = 700,
                               .free_length = 1.9}};
  return def;
}

TEST(StepRows, TwoMassesOnASpringAreAsWrittenOut) {
  Mechanism m(two_masses(), {"Cyl"});
  m.state.u = {0.3, -0.2};
  evaluate(m.model, m.state, m.ws);
  const double k = 3e5, d = 700, pull = k * 0.1 + d * -0.5;
  for (const double H : {1e-4, 1e-3, 1e-2, 0.1}) {
    StepRows rows(m.model);
    ASSERT_TRUE(rows.evaluate(m.model, m.state, m.ws, H));
    const double s = H * d + H * H / 2 * k;
    // A = (2 + s, -s; -s, 5 + s)
    const double determinant = (2 + s) * (5 + s) - s * s;
    const double force = pull + H * k * -0.5;
    EXPECT_NEAR(rows.mobility()[0], (5 + s) / determinant, 1e-12);
    const double a = ((5 + s) * force - s * force) / determinant;
    EXPECT_NEAR(rows.free_accelerations()[0], a, 1e-9 * std::fabs(a)) << H;
  }
}

MechanicsDef bodies_on_bushings() {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {
      {.name = "A", .mass = 20, .center_of_mass = {0.4, 0.1, 0}, .inertia = {1, 2, 1.5}},
      {.name = "B", .position = {1, 0.1, 0.2}, .mass = 3, .center_of_mass = {0.2, 0, 0.1}, .inertia = {.1, .2, .2}},
      {.name = "C", .position = {2, 0, 0}, .orientation = {0.3, -0.2, 0.5}, .mass = 40, .inertia = {3, 2, 4}}};
  def.joints = {{.name = "Pin", .orientation1 = {0.2, 0.1, 0}, .body2 = "A", .orientation2 = {0.2, 0.1, 0}},
                {.name = "FreeB", .type = JointType::floating, .body2 = "B"},
                {.name = "FreeC", .type = JointType::floating, .body2 = "C"}};
  const auto join = [&](const char* name, const char* body1, Triple point1, const char* body2) {
    BushingDef bushing;
    bushing.name = name;
    bushing.frames = {.body1 = body1, .point1 = point1, .body2 = body2};
    bushing.stiffness = {4e6, 1e6, 2e6};
    bushing.rotational_stiffness = {3e5, 8e5, 5e5};
    bushing.damping = {4e3, 9e2, 3e3};
    bushing.rotational_damping = {200, 300, 100};
    def.bushings.push_back(bushing);
  };
  join("AB", "A", {1, 0.1, 0.2}, "B");
  def.bodies[2].orientation = {};
  join("BC", "B", {1, -0.1, -0.2}, "C");
  def.translational_forces = {
      {.name = "Cyl", .body1 = "B", .point1 = {0.1, 0.2, 0}, .body2 = "Ground", .point2 = {0, -1, 0.3}},
      {.name = "Other", .body1 = "C", .point1 = {0.3, 0, 0.2}, .body2 = "A", .point2 = {0, 1, 0}}};
  return def;
}

TEST(StepRows, BodiesOnBushingsAreAsInDenseAlgebra) {
  Mechanism m(bodies_on_bushings(), {"Cyl", "Other", "Pin"});
  set_speeds(m);
  expect_same(m, kH);
}

MechanicsDef flexible_arm(ModalBody modes) {
  MechanicsDef def;
  def.gravity = {};
  def.max_substep = 1e-5;
  BodyDef arm{.name = "Arm"};
  arm.type = BodyType::flexible;
  def.bodies = {arm, {.name = "Tip", .mass = 4, .inertia = {1, 1, 1}}};
  take_mass(modes, def.bodies[0]);
  const Vec3 place = modes.nodes[2].position;
  def.bodies[1].position = place.array();
  def.joints = {{.name = "Pin", .body2 = "Arm"}, {.name = "Hook", .body1 = "Arm.Node3", .body2 = "Tip"}};
  def.translational_forces = {
      {.name = "Cyl", .body1 = "Tip", .point1 = {0.3, 0.2, 0.1}, .body2 = "Ground", .point2 = {0, -2, 0.3}}};
  def.flexible_bodies = {
      {.body = "Arm", .modes = std::make_shared<ModalBody>(std::move(modes)), .relative_damping = {0.05}}};
  return def;
}

TEST(StepRows, ModesAreAsInDenseAlgebra) {
  for (const unsigned seed : {1U, 2U, 5U}) {
    std::mt19937 random(seed);
    std::vector<MassPoint> points;
    ModalBody modes = random_modes(random, Vec3(), points);
    for (double& k : modes.stiffness) k *= 1e6;
    Mechanism m(flexible_arm(std::move(modes)), {"Cyl", "Hook"});
    set_speeds(m);
    expect_same(m, kH);
  }
}

// a flexible arm in a loop, with elements across each kind of joint and to Ground
MechanicsDef sprung_mechanism(ModalBody modes) {
  MechanicsDef def = flexible_arm(std::move(modes));
  def.gravity = {0, -9.81, 0};
  const Triple tip = def.bodies[1].position;
  def.bodies[1].mass = 40;
  const auto beside = [&](double x, double y, double z) { return Triple{tip[0] + x, tip[1] + y, tip[2] + z}; };
  def.bodies.push_back({.name = "Ball", .position = beside(0.2, -0.5, 0.1), .mass = 5, .inertia = {.1, .2, .3}});
  def.bodies.push_back({.name = "Fork", .position = beside(0.4, 0.3, 0), .mass = 2, .inertia = {.1, .2, .1}});
  def.bodies.push_back({.name = "Slide", .position = beside(0, 0, 0.6), .mass = 3, .inertia = {.2, .2, .1}});
  def.bodies.push_back({.name = "Rod", .position = {0, -1, 0}, .mass = 6, .inertia = {.5, .5, .1}});
  def.joints.push_back({.name = "Hang",
                        .type = JointType::spherical,
                        .body1 = "Tip",
                        .point1 = {0.2, -0.4, 0.1},
                        .body2 = "Ball",
                        .point2 = {0, 0.1, 0}});
  def.joints.push_back({.name = "Cross",
                        .type = JointType::universal,
                        .body1 = "Tip",
                        .point1 = {0.4, 0.3, 0},
                        .body2 = "Fork",
                        .orientation2 = {0, M_PI / 2, 0}});
  def.joints.push_back(
      {.name = "Rail", .type = JointType::prismatic, .body1 = "Tip", .point1 = {0, 0, 0.6}, .body2 = "Slide"});
  def.joints.push_back({.name = "Foot", .type = JointType::spherical, .point1 = {0, -1, 0}, .body2 = "Rod"});
  def.joints.push_back({.name = "Close",
                        .type = JointType::spherical,
                        .body1 = "Tip",
                        .point1 = {0, -0.2, 0},
                        .body2 = "Rod",
                        .point2 = beside(0, 0.8, 0)});
  const auto join = [&](const char* name, const char* body1, Triple point1, const char* body2, double stiffness) {
    BushingDef bushing;
    bushing.name = name;
    bushing.frames = {.body1 = body1, .point1 = point1, .body2 = body2};
    bushing.stiffness = {4 * stiffness, stiffness, 2 * stiffness};
    bushing.rotational_stiffness = {stiffness, 2 * stiffness, 3 * stiffness};
    bushing.damping = {1e-3 * stiffness, 0, 2e-3 * stiffness};
    bushing.rotational_damping = {2e-3 * stiffness, 1e-3 * stiffness, 0};
    def.bushings.push_back(bushing);
  };
  join("OnBall", "Tip", {0.2, -0.5, 0.1}, "Ball", 1e4);
  join("OnFork", "Tip", {0.4, 0.3, 0}, "Fork", 3e4);
  join("OnSlide", "Tip", {0, 0, 0.6}, "Slide", 2e4);
  join("ToGround", "Ground", {0, -1, 0}, "Rod", 1e3);
  // without stiffness: see below
  join("Far", "Ball", {}, "Slide", 0);
  def.translational_forces.push_back({.name = "Stay",
                                      .body1 = "Fork",
                                      .body2 = "Ground",
                                      .point2 = {0, 3, 1},
                                      .spring_constant = 2e5,
                                      .damping_constant = 300,
                                      .free_length = 1});
  return def;
}

// An element between links that are not neighbours takes the rows to body coordinates, with or without stiffness.
TEST(StepRows, AreTheSameInTheRecursionAndInBodyCoordinates) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U}) {
    std::mt19937 random(seed);
    std::vector<MassPoint> points;
    ModalBody modes = random_modes(random, Vec3(), points);
    for (double& k : modes.stiffness) k *= 1e6;
    MechanicsDef def = sprung_mechanism(std::move(modes));
    const std::vector<std::string> names = {"Cyl", "Hook", "Rail", "Stay"};
    Mechanism in_bodies(def, names);
    std::erase_if(def.bushings, [](const BushingDef& bushing) { return bushing.name == "Far"; });
    Mechanism in_tree(def, names);
    for (std::size_t k = 0; k < in_tree.state.u.size(); ++k)
      in_tree.state.u[k] = 0.3 - 0.07 * static_cast<double>(k % 9);
    evaluate(in_tree.model, in_tree.state, in_tree.ws);
    ASSERT_TRUE(project(in_tree.model, in_tree.state.q, in_tree.state.u, in_tree.ws));
    StepRows tree(in_tree.model), bodies(in_bodies.model);
    for (Mechanism* m : {&in_tree, &in_bodies}) evaluate(m->model, in_tree.state, m->ws);
    ASSERT_TRUE(tree.evaluate(in_tree.model, in_tree.state, in_tree.ws, kH));
    ASSERT_TRUE(bodies.evaluate(in_bodies.model, in_tree.state, in_bodies.ws, kH));
    const Vector a_tree = to_vector(tree.free_accelerations()), W_tree = to_vector(tree.mobility());
    EXPECT_LT((a_tree - to_vector(bodies.free_accelerations())).norm(), 1e-9 * a_tree.norm());
    EXPECT_LT((W_tree - to_vector(bodies.mobility())).norm(), 1e-9 * W_tree.norm());
    const StepShares damping{.position = 0, .rate = 1, .strain = 0};
    ASSERT_TRUE(tree.evaluate(in_tree.model, in_tree.state, in_tree.ws, kH, damping));
    ASSERT_TRUE(bodies.evaluate(in_bodies.model, in_tree.state, in_bodies.ws, kH, damping));
    const Vector W_damped = to_vector(tree.mobility());
    EXPECT_LT((W_damped - to_vector(bodies.mobility())).norm(), 1e-9 * W_damped.norm());
    // all springs matter
    EXPECT_GT((to_vector(row_mobility(in_tree.ws)) - W_tree).norm(), 0.01 * W_tree.norm());
  }
}

TEST(StepRows, AreThoseOfTheInstantOverNoTime) {
  Mechanism m(bodies_on_bushings(), {"Cyl", "Other", "Pin"});
  for (std::size_t i = 0; i < m.state.u.size(); ++i) m.state.u[i] = 0.5 - 0.07 * static_cast<double>(i);
  deactivate_row(m.ws, 1);
  evaluate(m.model, m.state, m.ws);
  StepRows rows(m.model);
  ASSERT_TRUE(rows.evaluate(m.model, m.state, m.ws, 0));
  for (std::size_t k = 0; k < m.model.rows.size(); ++k) {
    const double a = row_free_accelerations(m.ws)[k];
    EXPECT_NEAR(rows.free_accelerations()[k], a, 1e-9 * (1 + std::fabs(a))) << k;
    for (std::size_t l = 0; l < m.model.rows.size(); ++l) {
      const double W = row_mobility(m.ws)[k * m.model.rows.size() + l];
      EXPECT_NEAR(rows.mobility()[k * m.model.rows.size() + l], W, 1e-12) << k << " " << l;
    }
  }
}

// what turns as one has no strain: the pulls between the parts must not show as one
TEST(StepRows, ATurnOfAllPartsTogetherIsNoStrain) {
  MechanicsDef def = bodies_on_bushings();
  Mechanism m(def, {"Cyl", "Pin"});
  for (BushingDef& bushing : def.bushings) bushing.preload_force = {2e4, 0, 0};
  Mechanism loaded(def, {"Cyl", "Pin"});
  const auto turn = [](Mechanism& mechanism, double speed) {
    State& state = mechanism.state;
    std::fill(state.u.begin(), state.u.end(), 0.0);
    state.u[static_cast<std::size_t>(mechanism.model.links[1].u)] = speed;
    update_motion(mechanism.model, state.q, state.u, mechanism.ws);
    const LinkMotion frame = mechanism.ws.motion[1];
    for (std::size_t i = 2; i < mechanism.model.links.size(); ++i) {
      const auto u = static_cast<std::size_t>(mechanism.model.links[i].u);
      const Vec3 v = cross(frame.w, mechanism.ws.motion[i].p - frame.p);
      for (std::size_t k = 0; k < 3; ++k) {
        state.u[u + k] = v[static_cast<int>(k)];
        state.u[u + 3 + k] = frame.w[static_cast<int>(k)];
      }
    }
    evaluate(mechanism.model, state, mechanism.ws);
    StepRows rows(mechanism.model);
    EXPECT_TRUE(rows.evaluate(mechanism.model, state, mechanism.ws, kH));
    return std::vector<double>(rows.free_accelerations().begin(), rows.free_accelerations().end());
  };
  for (Mechanism* mechanism : {&m, &loaded}) {
    const std::vector<double> still = turn(*mechanism, 0), slow = turn(*mechanism, 1e-4);
    for (std::size_t k = 0; k < still.size(); ++k)
      EXPECT_NEAR(slow[k], still[k], 1e-6 * (1 + std::fabs(still[k]))) << k;
  }
}

}  // namespace step_rows_test
}  // namespace slew::multibody
