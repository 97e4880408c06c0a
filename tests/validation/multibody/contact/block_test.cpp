// SPDX-License-Identifier: Apache-2.0
// Case D03 through the whole path: a block on an incline sticks or slips, stops on the flat, rests at its depth.
#include <gtest/gtest.h>

#include "core/state_hash.h"
#include "scene_cases.h"
#include "support/nightly.h"

namespace slew::multibody {
namespace block_test {

using namespace testing;
using slew::testing::rounds;

constexpr double kGravity = 9.81;
constexpr Triple kSize = {0.4, 0.2, 0.4};
const contact::NormalLawDef kHard{.stiffness = 1e6, .restitution = 0.1, .smallest_impact_speed = 0.1};

// the incline is level and gravity leans instead: down the slope is +x
MechanicsDef block(double angle, double mu, const Triple& velocity = {}) {
  MechanicsDef def;
  def.gravity = {kGravity * std::sin(angle), -kGravity * std::cos(angle), 0};
  add_free(def, box_body("Block", 2, kSize, {0, 0.1, 0}), velocity);
  def.shapes = {box_shape("Sides", "Block", kSize), ground_shape("Floor")};
  def.frictions = {dry_friction("Dry", mu)};
  def.contacts = {pair_of("Sides", "Floor", kHard, "Dry")};
  return def;
}

class Block : public EveryWay {};
INSTANTIATE_TEST_SUITE_P(D03, Block, ::testing::ValuesIn(gate_ways()), name_of_way);
INSTANTIATE_TEST_SUITE_P(D03Nightly, Block, ::testing::ValuesIn(nightly_ways()), name_of_way);

TEST_P(Block, RestsAtTheDepthOfItsWeight) {
  Motion motion(block(0, 0.3), GetParam());
  motion.run(2, 1e-3);
  RecordProperty("rest_error_1e_6",
                 std::to_string(1e6 * (motion.value("Sides_Floor.depth") / (2 * kGravity / 1e6) - 1)));
  EXPECT_NEAR(motion.value("Sides_Floor.depth"), 2 * kGravity / 1e6, 1e-3 * 2e-5);
  EXPECT_NEAR(motion.value("Sides_Floor.normal_force.y"), 2 * kGravity, 1e-3 * 20);
  EXPECT_EQ(motion.value("Sides_Floor.contacts"), 4);
  EXPECT_NEAR(motion.value("Sides_Floor.center_of_pressure.x"), 0, 1e-6);
  EXPECT_LT(std::fabs(motion.pose("Block").velocity[1]), 1e-6);
}

// F = K d^1.5 with K = 1e8, shared by four points of equal depth
TEST_P(Block, RestsAtTheDepthOfHertzsLaw) {
  MechanicsDef def = block(0, 0.3);
  def.contacts[0].normal = {.stiffness = 1e8, .restitution = 0.1, .exponent = 1.5, .smallest_impact_speed = 0.1};
  Motion motion(def, GetParam());
  motion.run(2, 1e-3);
  EXPECT_NEAR(motion.value("Sides_Floor.depth"), 3.376494153e-5, 1e-3 * 3.4e-5);
}

TEST_P(Block, SticksOnAFlatInclineWithoutCreep) {
  Motion motion(contact_scene("incline"), GetParam());
  motion.run(2, 1e-3);
  EXPECT_NEAR(motion.value("Sides_Floor.friction_force.x"), -2 * 2.539014832, 1e-3 * 5);
  EXPECT_NEAR(motion.value("Sides_Floor.normal_force.y"), 2 * 9.475732356, 1e-3 * 19);
  const double x = motion.pose("Block").position[0];
  motion.run(is_recursion(GetParam()) ? rounds(20.0, 3600.0) : 5.0, 1e-3);
  RecordProperty("creep_1e_15_m", std::to_string(1e15 * (motion.pose("Block").position[0] - x)));
  EXPECT_NEAR(motion.pose("Block").position[0], x, 1e-9);
  EXPECT_LT(std::fabs(motion.pose("Block").velocity[0]), 1e-9);
}

TEST_P(Block, SlipsOnASteepIncline) {
  Motion motion(block(30 * kDegree, 0.3), GetParam());
  motion.run(0.5, 1e-3);
  const double v = motion.pose("Block").velocity[0];
  motion.run(0.5, 1e-3);
  const double a = (motion.pose("Block").velocity[0] - v) / 0.5;
  RecordProperty("slip_acceleration_error_1e_6", std::to_string(1e6 * (a / 2.356287237 - 1)));
  EXPECT_NEAR(a, 2.356287237, 1e-3 * 2.356);
}

TEST_P(Block, StopsOnTheFlat) {
  Motion motion(block(0, 0.3, {2, 0, 0}), GetParam());
  motion.run(0.3, 1e-3);  // off the start, where it drops onto its own depth
  const double v = motion.pose("Block").velocity[0], x = motion.pose("Block").position[0];
  motion.run(1.5, 1e-3);
  const double way = motion.pose("Block").position[0] - x, expected = v * v / (2 * 0.3 * kGravity);
  RecordProperty("stop_error_1e_6", std::to_string(1e6 * (way / expected - 1)));
  EXPECT_NEAR(way, expected, 1e-3 * expected);
  EXPECT_LT(std::fabs(motion.pose("Block").velocity[0]), 1e-6);
}

// the points of the sum: corners of the block with a quarter of its weight and friction each
TEST_P(Block, ShowsTheContactPointsThatItStandsOn) {
  Motion motion(contact_scene("incline"), GetParam());
  motion.run(2, 1e-3);
  math::Vec3 normal, friction;
  double corners = 0;  // sum of x z over the corners' signs: each of the four once
  for (int n = 1; n <= 4; ++n) {
    const std::string point = "Sides_Floor.point" + std::to_string(n);
    const auto vector = [&](const std::string& quantity) {
      return math::Vec3(motion.value(point + quantity + ".x"), motion.value(point + quantity + ".y"),
                        motion.value(point + quantity + ".z"));
    };
    const math::Vec3 p = vector(".position"), n_W = vector(".normal");
    EXPECT_NEAR(std::fabs(p.x() - motion.pose("Block").position[0]), 0.2, 1e-4);
    EXPECT_NEAR(std::fabs(p.z()), 0.2, 1e-4);
    corners += std::copysign(2.0, p.x()) + std::copysign(1.0, p.z());
    EXPECT_LT(norm(n_W - math::Vec3(0, 1, 0)), 1e-4);
    EXPECT_GT(motion.value(point + ".depth"), 0);
    EXPECT_NEAR(p.y(), -motion.value(point + ".depth") / 2, 1e-9);
    normal += n_W * motion.value(point + ".normal_force");
    friction += vector(".friction_force");
  }
  EXPECT_EQ(corners, 0);
  EXPECT_NEAR(normal.y(), motion.value("Sides_Floor.normal_force.y"), 1e-9 * 19);
  EXPECT_NEAR(friction.x(), motion.value("Sides_Floor.friction_force.x"), 1e-9 * 5);
  EXPECT_NEAR(friction.x(), -2 * 2.539014832, 1e-3 * 5);
}

TEST(Points, OfWhichThereAreMoreThanSlotsAreTheDeepest) {
  MechanicsDef def = contact_scene("incline");
  def.contacts[0].point_variables = 2;
  Motion motion(def);
  motion.run(2, 1e-3);
  // pushed down the slope at its middle, the block stands deeper on its lower edge
  for (const char* point : {"Sides_Floor.point1", "Sides_Floor.point2"}) {
    EXPECT_GT(motion.value(std::string(point) + ".position.x"), 0);
  }
  for (const ElementVariable& variable : variables(motion.model)) {
    EXPECT_EQ(variable.name.find("point3"), std::string::npos) << variable.name;
  }
}

TEST(Points, ThatAreNotThereAreZero) {
  Motion motion(block(0, 0.3, {0, 3, 0}));
  motion.run(0.1, 1e-3);
  EXPECT_EQ(motion.value("Sides_Floor.contacts"), 0);
  for (const char* quantity : {".position.x", ".normal.y", ".depth", ".normal_force", ".friction_force.z"}) {
    EXPECT_EQ(motion.value(std::string("Sides_Floor.point1") + quantity), 0) << quantity;
  }
}

// a shape on one of two merged bodies, and the reaction of their fixed joint
TEST_P(Block, LoadsTheJointOfTheBodyThatCarriesTheShape) {
  MechanicsDef def = block(0, 0.3);
  BodyDef foot = box_body("Foot", 1, {0.2, 0.2, 0.2}, {0, -0.2, 0});
  foot.relative_to = "Block";
  def.bodies[0].position[1] = 0.3;
  def.joints[0].point1[1] = 0.3;
  def.bodies.push_back(foot);
  JointDef joint;
  joint.name = "Weld";
  joint.type = JointType::fixed;
  joint.body1 = "Block";
  joint.point1 = {0, -0.1, 0};
  joint.body2 = "Foot";
  joint.point2 = {0, 0.1, 0};
  def.joints.push_back(joint);
  def.shapes[0] = box_shape("Sides", "Foot", {0.2, 0.2, 0.2});
  Motion motion(def, GetParam());
  motion.run(2, 1e-3);
  std::vector<JointReaction> reactions(motion.model.joints.size());
  joint_reactions(motion.model, motion.state, motion.ws, {}, reactions);
  // the foot carries the block: the joint pushes the block, its body 1, up
  EXPECT_NEAR(reactions[1].force[1], 2 * kGravity, 1e-3 * 20);
  EXPECT_NEAR(reactions[0].force[1], 0, 1e-3 * 20);
}

std::uint64_t hash_of(const Motion& motion) {
  StateHash hash;
  add_to_hash(motion.model, motion.state, hash);
  motion.dynamics.add_to_hash(hash);
  return hash.digest();
}

TEST_P(Block, TouchingIsPartOfTheStateHash) {
  Motion motion(block(15 * kDegree, 0.3), GetParam());
  motion.run(0.1, 1e-3);
  const std::uint64_t before = hash_of(motion);
  ASSERT_EQ(motion.state.contacts.states().size(), 4u);
  double& v0 = motion.state.contacts.states()[0].normal.impact_speed;
  v0 = std::nextafter(v0, 1);
  EXPECT_NE(hash_of(motion), before);
  v0 = std::nextafter(v0, 0);
  EXPECT_EQ(hash_of(motion), before);
  math::Vec3& z = motion.state.contacts.states()[3].friction.z_W;
  z.lanes[0] = std::nextafter(z[0], 1);
  EXPECT_NE(hash_of(motion), before);
}

// a restored state continues with the same bits
TEST(Blocks, GoOnWithTheSameBitsFromACopy) {
  // in joint coordinates: those of bodies are kept inside Dynamics
  Motion motion(block(30 * kDegree, 0.3));
  motion.run(0.1, 1e-3);
  State copy = start_state(motion.model);
  copy_state(motion.state, copy);
  motion.run(0.1, 1e-3);
  const std::uint64_t once = hash_of(motion);
  copy_state(copy, motion.state);
  motion.run(0.1, 1e-3);
  EXPECT_EQ(hash_of(motion), once);
}

TEST(Pairs, ThatDoNotTouchLeaveEveryBitAlone) {
  MechanicsDef with = block(10 * kDegree, 0.3, {1, 6, 0});
  with.bodies[0].position[1] = with.joints[0].point1[1] = 0.11;
  MechanicsDef without = with;
  without.contacts.clear();
  for (const Formulation formulation : {Formulation::recursive, Formulation::lagrange}) {
    Motion a(with, formulation), b(without, formulation);
    // upwards, and long before it comes down
    a.run(0.5, 1e-3);
    b.run(0.5, 1e-3);
    ASSERT_EQ(a.value("Sides_Floor.contacts"), 0);
    EXPECT_EQ(hash_of(a), hash_of(b));
  }
}

TEST(Pairs, ThatCannotMoveAgainstEachOtherAreKnownAndNotTested) {
  MechanicsDef def = block(0, 0.3);
  ShapeDef bed = box_shape("Bed", "Ground", {1, 1, 1});
  bed.position = {5, 0, 0};  // half in the floor
  def.shapes.push_back(bed);
  def.contacts.push_back(pair_of("Bed", "Floor", kHard));
  Motion motion(def);
  motion.run(0.1, 1e-3);
  EXPECT_EQ(motion.model.contact->pairs[1].tested, -1);
  EXPECT_EQ(motion.value("Bed_Floor.contacts"), 0);
}

}  // namespace block_test
}  // namespace slew::multibody
