// SPDX-License-Identifier: Apache-2.0
// Gears on random trees, against the assembled equations of motion (assembled.h) with multipliers in long double:
//   M u' = Q + J^T f,   J u' = 0,   J = e_2 - r e_1 for each gear.
#include <gtest/gtest.h>

#include "multibody/build/put_joints.h"
#include "multibody/constraints/gear.h"
#include "multibody/formulations/dynamics.h"
#include "tests/properties/multibody/assembled.h"
#include "tests/properties/multibody/random_tree.h"
#include "tests/support/nightly.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace gears_test {

using namespace testing;
using namespace slew::testing;

constexpr Formulation kFormulations[] = {Formulation::recursive, Formulation::lagrange, Formulation::augmented};
constexpr double kTolerance = 1e-9;  // relative to the largest entry

GearKind kind_of(const JointDef& joint1, const JointDef& joint2) {
  if (joint2.type == JointType::revolute) return GearKind::gear;
  return joint1.type == JointType::revolute ? GearKind::rack_and_pinion : GearKind::slides;
}

// every joint with one coordinate is geared to the one before it with a chance of a half; joint 1 of a rack turns
RandomTree geared_tree(std::uint32_t seed) {
  RandomTree tree = random_tree(seed, {.bodies = 2 + static_cast<int>(seed) % 9});
  std::mt19937 random(seed + 77);
  std::uniform_real_distribution<double> number(0.3, 2);
  const JointDef* before = nullptr;
  for (JointDef& joint : tree.def.joints) {
    if (joint.type != JointType::revolute && joint.type != JointType::prismatic) continue;
    joint.initial_velocity = kNotGiven;
    const JointDef* other = before;
    before = &joint;
    if (other == nullptr || std::uniform_int_distribution<int>(0, 1)(random) == 0) continue;
    const bool is_swapped = joint.type == JointType::revolute && other->type == JointType::prismatic;
    const JointDef &joint1 = is_swapped ? joint : *other, &joint2 = is_swapped ? *other : joint;
    const double sign = std::uniform_int_distribution<int>(0, 1)(random) == 0 ? -1 : 1;
    tree.def.gears.push_back({.name = "Gear_" + joint.name,
                              .kind = kind_of(joint1, joint2),
                              .joint1 = joint1.name,
                              .joint2 = joint2.name,
                              .ratio = sign * number(random)});
  }
  return tree;
}

Matrix jacobian_of(const Model& model) {
  Matrix J(static_cast<Index>(model.gears.size()), static_cast<Index>(model.speed_count()));
  for (std::size_t k = 0; k < model.gears.size(); ++k) {
    for (const GearEnd& end : model.gears[k].ends) J(static_cast<Index>(k), end.u) += end.factor;
  }
  return J;
}

// coordinates and speeds that fit the gears: joint 2 follows, from the root of a chain outwards in the file's order
void fit(const Model& model, State& state) {
  for (std::size_t round = 0; round <= model.gears.size(); ++round) {
    for (const Gear& gear : model.gears) {
      const auto &one = gear.ends[0], &two = gear.ends[1];
      const double r = -one.factor;
      // of a gear that stands on a joint which another one holds already, the free side moves: settled by rounds
      state.q[static_cast<std::size_t>(two.q)] = r * state.q[static_cast<std::size_t>(one.q)] + gear.offset;
      state.u[static_cast<std::size_t>(two.u)] = r * state.u[static_cast<std::size_t>(one.u)];
    }
  }
}

bool is_fitting(const Model& model, const State& state) {
  for (const Gear& gear : model.gears) {
    double gap = -gear.offset;
    for (const GearEnd& end : gear.ends) gap += end.factor * state.q[static_cast<std::size_t>(end.q)];
    if (std::fabs(gap) > 1e-12) return false;
  }
  return true;
}

TEST(GearedTrees, AccelerateAsInTheAssembledEquationsWithMultipliers) {
  int tested = 0;
  for_each_seed(seeds({{1, 24}}), [&](std::uint32_t seed) {
    RandomTree tree = geared_tree(seed);
    if (tree.def.gears.empty()) return;
    Mechanism mechanism(tree.def);
    State state = random_state(seed, mechanism.model);
    fit(mechanism.model, state);
    if (!is_fitting(mechanism.model, state)) return;  // a joint that two gears drive
    ++tested;
    const Assembled reference(tree.def, mechanism.model);
    const Vector q = to_vector(state.q), u = to_vector(state.u);
    const Matrix mobility = inverse(reference.mass_matrix(q)), J = jacobian_of(mechanism.model);
    const Vector free = mobility * reference.forces(q, u);
    const Vector f = inverse(J * mobility * J.transposed()) * (J * free) * Real(-1);
    const Vector expected = free + mobility * (J.transposed() * f);
    forward_dynamics(mechanism.model, state.q, state.u, {}, mechanism.ws);
    EXPECT_LT(difference(to_vector(mechanism.ws.udot), expected), kTolerance);
    std::vector<JointReaction> reactions(mechanism.model.joints.size());
    joint_reactions(mechanism.model, state, mechanism.ws, {}, reactions);
    std::vector<double> forces;
    for (std::size_t k = 0; k < mechanism.model.gears.size(); ++k) {
      forces.push_back(gear_force(mechanism.model, mechanism.ws, k, 1));
    }
    EXPECT_LT(difference(to_vector(forces), f), kTolerance);
  });
  EXPECT_GT(tested, 3);
}

TEST(GearedTrees, MoveAlikeInEveryFormulation) {
  for_each_seed(seeds({{1, 24}}), [](std::uint32_t seed) {
    RandomTree tree = geared_tree(seed);
    if (tree.def.gears.empty()) return;
    std::vector<double> by_recursion;
    for (const Formulation formulation : kFormulations) {
      tree.def.formulation = formulation;
      Formulated moving(tree.def);
      moving.run(0.05, 5e-4);
      if (by_recursion.empty()) by_recursion = moving.state.u;
      const double tolerance = formulation == Formulation::augmented ? 2e-3 : 1e-7;
      EXPECT_LT(difference(to_vector(moving.state.u), to_vector(by_recursion)), tolerance) << name_of(formulation);
      for (const Gear& gear : moving.model.gears) {
        double gap = -gear.offset;
        for (const GearEnd& end : gear.ends) gap += end.factor * moving.state.q[static_cast<std::size_t>(end.q)];
        EXPECT_NEAR(gap, 0, 1e-7) << name_of(formulation);
      }
    }
  });
}

// a start of 200 degrees, of which poses show -160: every formulation takes over the coordinate and its gear
TEST(Gears, StartBeyondHalfATurnInEveryFormulation) {
  MechanicsDef def;
  def.bodies = {{.name = "A", .mass = 1, .inertia = {1, 1, 1}},
                {.name = "B", .position = {1, 0, 0}, .mass = 1, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "J1", .body2 = "A", .initial_velocity = 1}, {.name = "J2", .point1 = {1, 0, 0}, .body2 = "B"}};
  def.gears = {{.name = "G", .joint1 = "J1", .joint2 = "J2", .ratio = 0.5, .offset = 0}};
  Problems problems;
  put_joints(def, std::vector<StartCoordinate>{{"J1", 0, 200 * M_PI / 180}}, problems);
  ASSERT_TRUE(problems.empty());
  for (const Formulation formulation : kFormulations) {
    def.formulation = formulation;
    Formulated moving(def);
    moving.run(0.1, 1e-3);
    EXPECT_NEAR(moving.state.q[0], 200 * M_PI / 180 + 0.1, 1e-6) << name_of(formulation);
    EXPECT_NEAR(moving.state.q[1], 100 * M_PI / 180 + 0.05, 1e-6) << name_of(formulation);
  }
}

// a telescope whose chain moves the second stage: a load of ten times its mass behind a hinge goes along and hangs
TEST(Gears, StartMovesTheGearedStageAndLeavesTheHingeBehindIt) {
  constexpr Triple kAlongX = {0, M_PI / 2, 0};
  MechanicsDef def;
  def.bodies = {{.name = "Stage_1", .mass = 80, .inertia = {5, 5, 5}},
                {.name = "Stage_2", .mass = 50, .inertia = {3, 3, 3}},
                {.name = "Load", .mass = 500, .center_of_mass = {0, -1, 0}, .inertia = {5, 5, 5}}};
  def.joints = {{.name = "Slide_1",
                 .type = JointType::prismatic,
                 .orientation1 = kAlongX,
                 .body2 = "Stage_1",
                 .orientation2 = kAlongX},
                {.name = "Slide_2",
                 .type = JointType::prismatic,
                 .body1 = "Stage_1",
                 .orientation1 = kAlongX,
                 .body2 = "Stage_2",
                 .orientation2 = kAlongX},
                {.name = "Hang", .body1 = "Stage_2", .body2 = "Load"}};
  def.gears = {
      {.name = "Chain", .kind = GearKind::slides, .joint1 = "Slide_1", .joint2 = "Slide_2", .ratio = 2, .offset = 0.5}};
  def.bodies[1].position = {0.5, 0, 0};
  def.bodies[2].position = {0.5, 0, 0};
  for (const StartCoordinate& named : {StartCoordinate{"Slide_1", 0, 1}, StartCoordinate{"Slide_2", 0, 2.5}}) {
    MechanicsDef put = def;
    Problems problems;
    put_joints(put, std::vector<StartCoordinate>{named}, problems);
    ASSERT_TRUE(problems.empty());
    EXPECT_NEAR(put.bodies[0].position[0], 1, 1e-9) << named.joint;
    EXPECT_NEAR(put.bodies[2].position[0], 3.5, 1e-9) << named.joint;
    for (const double angle : put.bodies[2].orientation) EXPECT_NEAR(angle, 0, 1e-9) << named.joint;
  }
}

// Three shafts at 0, K = -J by a stated offset, L = -2 K by the written poses: L = -2 K whichever shaft is named.
MechanicsDef three_shafts() {
  MechanicsDef def;
  for (const auto& [body, joint, x] : {std::tuple("A", "J", 0.0), {"B", "K", 1.0}, {"C", "L", 2.0}}) {
    def.bodies.push_back({.name = body, .position = {x, 0, 0}, .mass = 1, .inertia = {0.1, 0.1, 0.1}});
    def.joints.push_back({.name = joint, .point1 = {x, 0, 0}, .body2 = body});
  }
  def.gears = {{.name = "JK", .joint1 = "J", .joint2 = "K", .ratio = -1, .offset = 0},
               {.name = "KL", .joint1 = "K", .joint2 = "L", .ratio = -2}};
  return def;
}

TEST(Gears, WithoutOffsetKeepTheRelationOfTheWrittenPosesAtAStart) {
  constexpr double kDegree = M_PI / 180;
  using Starts = std::vector<StartCoordinate>;
  for (const Starts& named :
       {Starts{{"J", 0, 30 * kDegree}}, Starts{{"K", 0, -30 * kDegree}}, Starts{{"L", 0, 60 * kDegree}},
        Starts{{"K", 0, -30 * kDegree}, {"L", 0, 60 * kDegree}}}) {
    MechanicsDef def = three_shafts();
    Problems problems;
    put_joints(def, named, problems);
    ASSERT_TRUE(problems.empty()) << testing::text_of(problems);
    Formulated shafts(def);
    EXPECT_NEAR(shafts.value("J.position"), 30 * kDegree, 1e-9) << named[0].joint;
    EXPECT_NEAR(shafts.value("K.position"), -30 * kDegree, 1e-9) << named[0].joint;
    EXPECT_NEAR(shafts.value("L.position"), 60 * kDegree, 1e-9) << named[0].joint;
  }
}

TEST(Gears, WithoutOffsetRefuseAStartOfAllTheirJointsThatDisagrees) {
  for (const char* other : {"J", "K"}) {
    MechanicsDef def = three_shafts();
    Problems problems;
    put_joints(def, std::vector<StartCoordinate>{{other, 0, 0.5}, {"L", 0, 0.3}}, problems);
    ASSERT_EQ(problems.size(), 1u) << other;
    EXPECT_EQ(problems[0].path, "start");
    EXPECT_NE(problems[0].what.find("cannot be closed with these coordinates"), std::string::npos) << problems[0].what;
  }
}

// 0 holds joint 2 wherever it is put
TEST(Gears, OfRatioZeroHoldAJointWhereTheStartPutsIt) {
  MechanicsDef def = three_shafts();
  def.gears[1].ratio = 0;
  Problems problems;
  put_joints(def, std::vector<StartCoordinate>{{"L", 0, 0.3}}, problems);
  ASSERT_TRUE(problems.empty()) << testing::text_of(problems);
  EXPECT_NEAR(Formulated(def).value("L.position"), 0.3, 1e-9);
}

}  // namespace gears_test
}  // namespace slew::multibody
