// SPDX-License-Identifier: Apache-2.0
// Case A10: single joints at rest, with the wrench that they put on Ground; how many rows each type has. Moving ones:
// moving_joint_test.cpp.
//
// A body of 10 kg with its centre at (0.3, -0.2, 0.1); statics by hand, 1e-10.
// Figures: docs/validation/A10_joints.md.
#include "multibody/constraints/loops.h"
#include "tests/validation/multibody/angles.h"
#include "tests/validation/multibody/every_formulation.h"

namespace slew::multibody {
namespace joint_test {

using testing::expect_figure;
using testing::Formulated;
using testing::Mechanism;

constexpr double kStep = 1e-3;

MechanicsDef static_body(JointType type, Triple orientation) {
  MechanicsDef def;
  def.gravity = {0, 0, -9.81};
  def.bodies = {{.name = "Block", .mass = 10, .center_of_mass = {0.3, -0.2, 0.1}, .inertia = {1, 2, 2.5}}};
  def.joints = {
      {.name = "Joint", .type = type, .orientation1 = orientation, .body2 = "Block", .orientation2 = orientation}};
  return def;
}

JointReaction reaction_of(Mechanism& mechanism, const std::vector<double>& row_forces = {}) {
  std::vector<JointReaction> reactions(mechanism.model.joints.size());
  joint_reactions(mechanism.model, mechanism.state, mechanism.ws, row_forces, reactions);
  return reactions[0];
}

void expect_near(const Triple& got, const Triple& expected, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(got[k], expected[k], tolerance) << "component " << k;
}

constexpr Triple kWeight = {0, 0, -98.1};
constexpr Triple kMoment = {19.62, 29.43, 0};

TEST(StaticJoint, FixedCarriesWeightAndMoment) {
  Mechanism weld(static_body(JointType::fixed, {}));
  EXPECT_EQ(weld.model.degrees_of_freedom(), 0);
  const JointReaction reaction = reaction_of(weld);
  expect_near(reaction.force, kWeight, 1e-10);
  expect_near(reaction.moment, kMoment, 1e-10);
}

// A spring between two bodies that are welded: its torque is k phi_0 n with n = f2 x (c g1 - s f1)/(c^2 + s^2), which
// f2 tilts away from f1 x g1.
TEST(StaticJoint, FixedCarriesTheTorqueOfASpringBesideIt) {
  MechanicsDef def = static_body(JointType::fixed, {});
  def.gravity = {0, 0, 0};
  def.rotational_forces = {{.name = "Spring",
                            .body1 = "Ground",
                            .f1 = {1, 0, 0},
                            .g1 = {0, 1, 0},
                            .body2 = "Block",
                            .f2 = {1, 0, 0.5},
                            .spring_constant = 10,
                            .free_angle = M_PI / 6}};
  Mechanism weld(def);
  const JointReaction reaction = reaction_of(weld);
  expect_near(reaction.force, {0, 0, 0}, 1e-12);
  expect_near(reaction.moment, {-5 * M_PI / 6, 0, 10 * M_PI / 6}, 1e-10);
}

TEST(StaticJoint, RevoluteNeedsTheMomentAboutItsAxis) {
  // axis along global x
  Mechanism hinge(static_body(JointType::revolute, {0, M_PI / 2, 0}), {"Joint"});
  evaluate(hinge.model, hinge.state, hinge.ws);
  const double holding = -row_free_accelerations(hinge.ws)[0] / row_mobility(hinge.ws)[0];
  EXPECT_NEAR(holding, -19.62, 1e-10);
  const JointReaction reaction = reaction_of(hinge, {holding});
  expect_near(reaction.force, kWeight, 1e-10);
  expect_near(reaction.moment, kMoment, 1e-10);
  for (const double rate : hinge.ws.udot) EXPECT_NEAR(rate, 0, 1e-12);
}

TEST(StaticJoint, PrismaticNeedsTheForceAlongItsAxis) {
  // axis tilted by 30 deg from the vertical
  Mechanism slider(static_body(JointType::prismatic, {M_PI / 6, 0, 0}), {"Joint"});
  evaluate(slider.model, slider.state, slider.ws);
  const double holding = -row_free_accelerations(slider.ws)[0] / row_mobility(slider.ws)[0];
  EXPECT_NEAR(holding, 98.1 * std::cos(M_PI / 6), 1e-10);
  const JointReaction reaction = reaction_of(slider, {holding});
  expect_near(reaction.force, kWeight, 1e-10);
  expect_near(reaction.moment, kMoment, 1e-10);
}

TEST(StaticJoint, SphericalHangsWithoutMoment) {
  MechanicsDef def = static_body(JointType::spherical, {});
  def.bodies[0].center_of_mass = {0, 0, -0.4};
  Mechanism ball(def);
  const JointReaction reaction = reaction_of(ball);
  expect_near(reaction.force, kWeight, 1e-10);
  expect_near(reaction.moment, {}, 1e-10);
}

// two cylinder parts of 4 and 6 kg on a horizontal line of 2 m, 0.5 m from their ends: the lever rule
TEST(StaticJoint, FixedCarriesItsShareOfACylinderAcrossIt) {
  MechanicsDef def = static_body(JointType::fixed, {});
  def.translational_forces = {
      {.name = "Strut", .body1 = "Ground", .point1 = {-1.7, -0.2, 0.1}, .body2 = "Block", .point2 = {0.3, -0.2, 0.1}}};
  def.force_dummies = {{"Tube", "Strut", 1, 4, {-0.5, 0, 0}, {}}, {"Rod", "Strut", 2, 6, {0.5, 0, 0}, {}}};
  for (const bool is_ground_first : {true, false}) {
    if (!is_ground_first) std::swap(def.joints[0].body1, def.joints[0].body2);
    Mechanism weld(def);
    // 4/4 + 6 3/4 kg on the block's point, beside its own 10 kg
    const double share = (10 + 5.5) / 10, sign = is_ground_first ? 1 : -1;
    const JointReaction reaction = reaction_of(weld);
    expect_near(reaction.force, {0, 0, sign * share * kWeight[2]}, 1e-10);
    expect_near(reaction.moment, {sign * share * kMoment[0], sign * share * kMoment[1], 0}, 1e-10);
  }
}

// A door on two hinges of one upright axis, L apart: statics leaves five numbers open. With F and -F across and M in
// either hinge L F + 2 M = c m g, and F^2 + M^2 is smallest for F = c m g L / (L^2 + 4), M = 2 c m g / (L^2 + 4).
TEST(StaticJoint, TwoHingesOfADoorShareItsWeightByTheSmallestReactions) {
  constexpr double kApart = 1.5, kAside = 0.3, kLoad = 98.1;
  MechanicsDef def = static_body(JointType::revolute, {});
  def.bodies[0].center_of_mass = {kAside, 0, 0.4};
  JointDef upper = def.joints[0];
  upper.name = "Upper";
  upper.point1 = upper.point2 = {0, 0, kApart};
  def.joints.push_back(upper);
  Mechanism door(def);
  EXPECT_EQ(door.model.degrees_of_freedom(), 1);
  EXPECT_EQ(describe(door.model).cuts.at(0).redundant.size(), 5U);
  std::vector<JointReaction> reactions(2);
  joint_reactions(door.model, door.state, door.ws, {}, reactions);
  const double share = kAside * kLoad / (kApart * kApart + 4);
  expect_near(reactions[0].force, {-share * kApart, 0, -kLoad / 2}, 1e-10);
  expect_near(reactions[1].force, {share * kApart, 0, -kLoad / 2}, 1e-10);
  expect_near(reactions[0].moment, {0, 2 * share, 0}, 1e-10);
  expect_near(reactions[1].moment, {0, 2 * share, 0}, 1e-10);
}

TEST(StaticJoint, ReactionDoesNotDependOnTheOrderOfTheBodies) {
  MechanicsDef def = static_body(JointType::revolute, {0.3, 0.2, 0});
  std::swap(def.joints[0].body1, def.joints[0].body2);
  def.joints[0].initial_velocity = 1.5;
  MechanicsDef plain = static_body(JointType::revolute, {0.3, 0.2, 0});
  plain.joints[0].initial_velocity = -1.5;
  Mechanism reversed(def), forward(plain);
  const JointReaction a = reaction_of(reversed), b = reaction_of(forward);
  // the reaction is that on body 1, which is the block in one and Ground in the other
  expect_near(a.force, {-b.force[0], -b.force[1], -b.force[2]}, 1e-10);
  expect_near(a.moment, {-b.moment[0], -b.moment[1], -b.moment[2]}, 1e-10);
  // the coordinate is frame 2 relative to frame 1: it changes sign
  reversed.run(0.5, kStep);
  forward.run(0.5, kStep);
  EXPECT_NEAR(reversed.value("Joint.position"), -forward.value("Joint.position"), 1e-12);
}

// ---- in every formulation ---------------------------------------------------------------------------------------

class HeldJoint : public testing::EveryFormulation {};

// what holds a body still is found from the reduced model of its row; it then stays for a second
TEST_P(HeldJoint, CarriesTheWeightForASecond) {
  const std::pair<JointType, Triple> kHeld[] = {{JointType::revolute, {0, M_PI / 2, 0}},
                                                {JointType::prismatic, {M_PI / 6, 0, 0}}};
  for (const auto& [type, orientation] : kHeld) {
    Formulated body = start(tuned(static_body(type, orientation), 1e9, 100), {"Joint"});
    body.dynamics.evaluate(body.model, body.state, body.ws);
    const std::vector<double> holding = {-row_free_accelerations(body.ws)[0] / row_mobility(body.ws)[0]};
    const Triple begin = body.pose("Block").center_of_mass;
    body.run(1, kStep, holding);
    const JointReaction reaction = reaction_of(body, holding);
    const BodyPose pose = body.pose("Block");
    double wrench = 0, moved = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      wrench = std::max({wrench, std::abs(reaction.force[k] - kWeight[k]), std::abs(reaction.moment[k] - kMoment[k])});
      moved = std::max(moved, std::abs(pose.center_of_mass[k] - begin[k]));
    }
    const std::string name = type == JointType::revolute ? "revolute" : "prismatic";
    expect_figure("A10", setting(kStep), {name + ": reaction, of 98.1 N", wrench / 98.1, 1e-8});
    expect_figure("A10", setting(kStep), {name + ": moved in 1 s [m]", moved, 1e-8});
  }
}

struct TypeRows {
  const char* name;
  JointType type;
  int rows;
};
constexpr TypeRows kRows[] = {{"revolute", JointType::revolute, 5},
                              {"prismatic", JointType::prismatic, 5},
                              {"spherical", JointType::spherical, 3},
                              {"fixed", JointType::fixed, 6},
                              {"floating", JointType::floating, 0},
                              {"universal", JointType::universal, 4},
                              {"cylindrical", JointType::cylindrical, 4},
                              {"in_plane", JointType::in_plane, 1},
                              {"in_line", JointType::in_line, 2},
                              {"perpendicular", JointType::perpendicular, 1},
                              {"spherical_spherical", JointType::spherical_spherical, 1},
                              {"revolute_spherical", JointType::revolute_spherical, 2},
                              {"revolute_revolute", JointType::revolute_revolute, 4}};

// the joint alone between Ground and a body whose point stands where the type allows it
MechanicsDef joined_body(JointType type) {
  MechanicsDef def = static_body(type, {0.2, -0.3, 0.4});
  def.bodies[0].inertia = {1, 2, 2.5};
  JointDef& joint = def.joints[0];
  const bool is_crossed = type == JointType::universal || type == JointType::perpendicular;
  const bool is_link = type >= JointType::spherical_spherical;
  if (is_crossed) {
    const math::Mat3 R = math::rotation_xyz(joint.orientation1);
    // y of frame 1 becomes z of frame 2
    joint.orientation2 = testing::angles_xyz(math::Mat3{R.c[2], R.c[0], R.c[1]});
  }
  if (is_link) {
    // 0.5 m long, its hinges askew
    joint.point1 = {-0.4, 0.3, 0};
    joint.orientation2 = {-0.5, 0.1, 0.2};
  }
  return def;
}

TEST(JointFreedoms, AreSixLessTheRowsOfTheType) {
  for (const TypeRows& row : kRows) {
    const Model model = build_model(joined_body(row.type));
    EXPECT_EQ(model.degrees_of_freedom(), 6 - row.rows) << row.name;
    EXPECT_EQ(describe(model).degrees_of_freedom, 6 - row.rows) << row.name;
  }
}

// 10 s of free motion in which nothing may open or creep
class JointDrift : public testing::EveryFormulation {};

TEST_P(JointDrift, StaysBelowTheToleranceFor10s) {
  const double step = is(Formulation::penalty) ? 0.5 * kStep : kStep;
  for (const TypeRows& row : kRows) {
    if (row.type == JointType::fixed || row.type == JointType::floating) continue;
    MechanicsDef def = joined_body(row.type);
    // types that let the body fall would leave the mechanism's own scale
    if (row.rows < 3 || row.type == JointType::prismatic || row.type == JointType::cylindrical) def.gravity = {};
    def = tuned(def, 1e9, 30);
    Formulated body = start(def);
    for (std::size_t k = 0; k < body.state.u.size(); ++k) body.state.u[k] = 0.8 - 0.3 * static_cast<double>(k);
    if (body.model.cut_row_count() > 0) {
      forward_dynamics(body.model, body.state.q, body.state.u, {}, body.ws);
      ASSERT_TRUE(project(body.model, body.state.q, body.state.u, body.ws)) << row.name;
    }
    body.dynamics = Dynamics(GetParam(), body.model, body.state);
    double open = 0, rate = 0;
    for (int i = 0; i < 100; ++i) {
      body.run(0.1, step);
      // near any moment: rates of penalties ring while positions pass zero
      const JointGap gap = testing::opening(body);
      open = std::max(open, gap.position);
      rate = std::max(rate, gap.rate);
    }
    expect_figure("A10", setting(step), {std::string(row.name) + ": |g| in 10 s [m, 1]", open, 1e-8});
    expect_figure("A10", setting(step), {std::string(row.name) + ": |g'| in 10 s [m/s, 1/s]", rate, 1e-8});
  }
}

INSTANTIATE_TEST_SUITE_P(In, HeldJoint, testing::kEveryFormulation, testing::kFormulationName);
INSTANTIATE_TEST_SUITE_P(In, JointDrift, testing::kEveryFormulation, testing::kFormulationName);

}  // namespace joint_test
}  // namespace slew::multibody
