// Case A10: single joints, static and moving, with the wrench that they put on Ground.
//
// Static: a body of 10 kg with its centre at (0.3, -0.2, 0.1); statics by hand, 1e-10.
// Dynamic: revolute against ADAMS (projectchrono/chrono data/testing/joints/revolute_joint Case02; 1e-3) and against
// independent solutions in absolute coordinates (joint_*.csv, energy drift 2e-13): 1e-3 of the largest value.
#include "tests/validation/multibody/csv_table.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace {

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

TEST(JointFreedoms, AreThoseOfTheJointTypes) {
  const std::pair<JointType, int> expected[] = {{JointType::revolute, 1},
                                                {JointType::prismatic, 1},
                                                {JointType::spherical, 3},
                                                {JointType::fixed, 0},
                                                {JointType::floating, 6}};
  for (const auto& [type, freedoms] : expected) {
    const Model model = build_model(static_body(type, {}));
    EXPECT_EQ(model.degrees_of_freedom(), freedoms);
    EXPECT_EQ(describe(model).degrees_of_freedom, freedoms);
  }
}

// successive x, y', z'' rotations of a matrix
Triple xyz_angles(const math::Mat3& R) {
  return {std::atan2(-R(1, 2), R(2, 2)), std::asin(R(0, 2)), std::atan2(-R(0, 1), R(0, 0))};
}

struct Moving {
  const char* table;
  JointType type;
  Triple euler;     // attitude of body and joint frame at the start
  Triple location;  // of the joint
  Triple center;    // centre of mass in the body, whose origin is the joint
  Triple rotation;  // rad/s at the start
};

void follow(const Moving& c) {
  MechanicsDef def;
  def.gravity = {0, 0, -9.80665};
  def.bodies = {{.name = "Body",
                 .position = c.location,
                 .orientation = c.euler,
                 .mass = 1,
                 .center_of_mass = c.center,
                 .inertia = {0.04, 0.1, 0.1}}};
  def.joints = {{.name = "Joint",
                 .type = c.type,
                 .point1 = c.location,
                 .orientation1 = xyz_angles(math::rotation_zxz(c.euler)),
                 .body2 = "Body",
                 .initial_rotation = c.rotation}};
  Mechanism body(def);
  double error[4] = {}, size[4] = {};
  double time = 0;
  for (const auto& row : testing::read_table(c.table)) {
    body.run(row[0] - time, kStep);
    time = row[0];
    const BodyPose pose = body.pose("Body");
    const JointReaction reaction = reaction_of(body);
    double along = 0;
    for (std::size_t k = 0; k < 4; ++k) along += pose.orientation[k] * row[k + 4];
    const double sign = along < 0 ? -1 : 1;
    for (std::size_t k = 0; k < 4; ++k)
      error[1] = std::max(error[1], std::abs(sign * pose.orientation[k] - row[k + 4]));
    size[1] = 1;
    const auto compare = [&](int which, const Triple& got, std::size_t column) {
      for (std::size_t k = 0; k < 3; ++k) {
        error[which] = std::max(error[which], std::abs(got[k] - row[column + k]));
        size[which] = std::max(size[which], std::abs(row[column + k]));
      }
    };
    compare(0, pose.center_of_mass, 1);
    compare(2, reaction.force, 8);
    compare(3, reaction.moment, 11);
  }
  EXPECT_LT(error[0], 1e-3 * size[0]) << "position";
  EXPECT_LT(error[1], 1e-3 * size[1]) << "attitude";
  EXPECT_LT(error[2], 1e-3 * size[2]) << "force";
  EXPECT_LT(error[3], 1e-3 * std::max(size[3], 1.0)) << "moment";
}

TEST(MovingJoint, RevoluteFollowsTheTable) {
  follow({"joint_revolute_adams02.csv", JointType::revolute, {0, -M_PI / 4, 0}, {1, 2, 3}, {2, 0, 0}, {}});
}

TEST(MovingJoint, SphericalFollowsTheTable) {
  follow(
      {"joint_spherical_w.csv", JointType::spherical, {M_PI / 2, M_PI / 3, -M_PI / 2}, {}, {2, 0, 0}, {0.3, -0.2, 2}});
}

TEST(MovingJoint, PrismaticFollowsTheTable) {
  follow({"joint_prismatic.csv", JointType::prismatic, {M_PI / 4, M_PI / 4, -M_PI / 4}, {}, {0.5, -0.2, -0.1}, {}});
}

TEST(MovingJoint, RevoluteAgreesWithAdams) {
  MechanicsDef def;
  def.gravity = {0, 0, -9.80665};
  def.bodies = {{.name = "Body",
                 .position = {1, 2, 3},
                 .orientation = {0, -M_PI / 4, 0},
                 .mass = 1,
                 .center_of_mass = {2, 0, 0},
                 .inertia = {0.04, 0.1, 0.1}}};
  def.joints = {{.name = "Joint", .point1 = {1, 2, 3}, .orientation1 = {-M_PI / 4, 0, 0}, .body2 = "Body"}};
  Mechanism body(def);
  // ADAMS prints with its integrator's tolerance: 1e-3 of the largest force (19.4 N)
  constexpr double kTolerance = 1e-3 * 19.4;
  expect_near(reaction_of(body).force, {0, -4.78373, -5.02292}, kTolerance);
  body.run(1, kStep);
  expect_near(reaction_of(body).force, {0.427164, 9.56081, -19.3673}, kTolerance);
  expect_near(body.pose("Body").center_of_mass, {1.0421, 3.4139, 1.5861}, 1e-3);
  body.run(1.5, kStep);
  expect_near(reaction_of(body).force, {-7.19193, -2.67074, -7.13638}, kTolerance);
}

}  // namespace
}  // namespace slew::multibody
