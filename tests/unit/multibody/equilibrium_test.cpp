// SPDX-License-Identifier: Apache-2.0
// Joints that nothing holds go to their stable equilibrium: pendulums, springs, loops, by closed forms.
#include "multibody/build/equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "multibody/model/model.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace equilibrium_test {

constexpr double kPi = std::numbers::pi;
// hinges about Ground's y: a positive angle turns x towards -z
constexpr Triple kAboutY = {-kPi / 2, 0, 0};

MechanicsDef under_gravity() {
  MechanicsDef def;
  def.gravity = {0, 0, -9.81};
  return def;
}

void add_hinged(MechanicsDef& def, const std::string& name, const std::string& carrier, const Triple& point,
                const BodyDef& body) {
  BodyDef& added = def.bodies.emplace_back(body);
  added.name = name;
  added.relative_to = carrier;
  added.position = point;
  def.joints.push_back({.name = name + "_Pin",
                        .body1 = carrier,
                        .point1 = point,
                        .orientation1 = kAboutY,
                        .body2 = name,
                        .orientation2 = kAboutY});
}

BodyDef bar(double mass, const Triple& center) {
  return {.mass = mass, .center_of_mass = center, .inertia = {1, 1, 1}};
}

struct Rested {
  Model model;
  State state;
  RestSearch found;

  explicit Rested(const MechanicsDef& def, const RestOptions& options = {}, std::span<const std::string> rows = {})
      : model(build_model(def, rows)), state(start_state(model)), found(find_rest(model, options, state)) {}

  [[nodiscard]] Triple center_of(const std::string& body) const {
    Workspace ws(model);
    observe(model, state, ws);
    return body_pose(model, ws, find_body(model, body)).center_of_mass;
  }
};

TEST(Equilibrium, APendulumHangsWithItsCentreBelowTheHinge) {
  MechanicsDef def = under_gravity();
  add_hinged(def, "Bob", "Ground", {1, 0, 2}, bar(3, {0.4, 0, 0.3}));
  const Rested rested(def);
  ASSERT_TRUE(rested.found.is_stable);
  EXPECT_NEAR(rested.center_of("Bob")[0], 1, 1e-9);
  EXPECT_NEAR(rested.center_of("Bob")[2], 1.5, 1e-12);
}

// exactly above the hinge no force shows the way
TEST(Equilibrium, APendulumOnItsHeadIsNoRest) {
  MechanicsDef def = under_gravity();
  add_hinged(def, "Bob", "Ground", {}, bar(3, {0, 0, 0.5}));
  const Rested rested(def);
  ASSERT_TRUE(rested.found.is_stable);
  EXPECT_NEAR(rested.center_of("Bob")[2], -0.5, 1e-12);
}

// m_1 r_1 + m_2 l is plumb, the second bar below its own hinge
TEST(Equilibrium, TwoBarsHangByTheSumOfTheirMoments) {
  MechanicsDef def = under_gravity();
  add_hinged(def, "Hook", "Ground", {}, bar(20, {0.1, 0, -0.3}));
  add_hinged(def, "Load", "Hook", {-0.2, 0, -0.6}, bar(500, {0.3, 0, 0.9}));
  const Rested rested(def);
  ASSERT_TRUE(rested.found.is_stable);
  const Triple hook = rested.center_of("Hook"), load = rested.center_of("Load");
  EXPECT_NEAR(20 * hook[0] + 500 * load[0], 0, 520 * 1e-9);
  const double x = 20 * 0.1 - 500 * 0.2, z = -20 * 0.3 - 500 * 0.6;
  EXPECT_NEAR(20 * hook[2] + 500 * (load[2] + std::hypot(0.3, 0.9)), -std::hypot(x, z), 520 * 1e-9);
}

TEST(Equilibrium, ASpringIsStretchedByTheWeight) {
  MechanicsDef def = under_gravity();
  def.bodies.push_back({.name = "Mass", .position = {0, 0, -1}, .mass = 40, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "Guide", .type = JointType::prismatic, .body2 = "Mass"});
  TranslationalForceDef spring;
  spring.name = "Spring";
  spring.body1 = "Ground", spring.body2 = "Mass";
  spring.spring_constant = 2e4, spring.free_length = 1;
  def.translational_forces.push_back(spring);
  const Rested rested(def);
  ASSERT_TRUE(rested.found.is_stable);
  EXPECT_NEAR(rested.center_of("Mass")[2], -1 - 40 * 9.81 / 2e4, 1e-10);
}

TEST(Equilibrium, AJointThatFallsHasNone) {
  MechanicsDef def = under_gravity();
  def.bodies.push_back({.name = "Mass", .mass = 40, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "Guide", .type = JointType::prismatic, .body2 = "Mass"});
  const Rested rested(def);
  EXPECT_FALSE(rested.found.is_stable);
  EXPECT_EQ(rested.found.joint, "Guide");
  EXPECT_FALSE(rested.found.turns);
  EXPECT_NEAR(rested.found.acceleration, -9.81, 1e-9);
  // stated, it stays
  EXPECT_TRUE(Rested(def, {.coordinates = {{0, 0}}}).found.is_stable);
}

TEST(Equilibrium, AJointWithoutForceStays) {
  MechanicsDef def = under_gravity();
  def.bodies.push_back({.name = "Upper", .mass = 40, .center_of_mass = {2, 0, 0}, .inertia = {1, 1, 1}});
  def.joints.push_back({.name = "Slew", .body2 = "Upper"});
  add_hinged(def, "Load", "Upper", {3, 0, 0}, bar(100, {0.3, 0, -0.9}));
  const Rested rested(def);
  ASSERT_TRUE(rested.found.is_stable);
  EXPECT_NEAR(rested.state.q[0], 0, 1e-6);
  EXPECT_NEAR(rested.center_of("Load")[0], 3, 1e-8);
}

// the boom's cylinder keeps its length while the load swings below the boom's end, whatever it weighs
TEST(Equilibrium, AHeldLineCarriesAndTheLoadHangs) {
  MechanicsDef def = under_gravity();
  add_hinged(def, "Boom", "Ground", {}, bar(300, {1.5, 0, 0.1}));
  add_hinged(def, "Load", "Boom", {3, 0, 0.2}, bar(5000, {0.8, 0, -0.3}));
  TranslationalForceDef line;
  line.name = "Line";
  line.body1 = "Ground", line.point1 = {0.5, 0, -1.1};
  line.body2 = "Boom", line.point2 = {1, 0, -0.1};
  def.translational_forces.push_back(line);
  const std::string rows[] = {"Line"};
  const Rested rested(def, {.held_rows = 1}, rows);
  ASSERT_TRUE(rested.found.is_stable);
  EXPECT_NEAR(rested.state.q[0], 0, 1e-10);
  EXPECT_NEAR(rested.center_of("Load")[0], 3, 1e-8);
  EXPECT_NEAR(rested.center_of("Load")[2], 0.2 - std::hypot(0.8, 0.3), 1e-10);
}

// a swing on two ropes of one length hangs level below its two hinges; from 60 degrees
TEST(Equilibrium, AParallelogramHangsStraightDown) {
  const double s = std::sin(kPi / 3), c = std::cos(kPi / 3);
  MechanicsDef def = under_gravity();
  add_hinged(def, "Left", "Ground", {}, bar(1, {0.5 * s, 0, -0.5 * c}));
  add_hinged(def, "Seat", "Left", {s, 0, -c}, bar(30, {1, 0, 0}));
  add_hinged(def, "Right", "Ground", {2, 0, 0}, bar(1, {0.5 * s, 0, -0.5 * c}));
  def.joints.push_back({.name = "Closing",
                        .body1 = "Seat",
                        .point1 = {2, 0, 0},
                        .orientation1 = kAboutY,
                        .body2 = "Right",
                        .point2 = {s, 0, -c},
                        .orientation2 = kAboutY});
  const Rested rested(def);
  ASSERT_EQ(rested.model.cuts.size(), 1u);
  ASSERT_TRUE(rested.found.is_stable);
  EXPECT_NEAR(rested.center_of("Seat")[0], 1, 1e-8);
  EXPECT_NEAR(rested.center_of("Seat")[2], -1, 1e-10);
  EXPECT_NEAR(rested.center_of("Right")[0], 2, 1e-8);
}

// a held joint and a held line in one loop, which the start leaves open by some nanometres
TEST(Equilibrium, ALoadHangsFromALoopWhoseJointAndLineAreBothHeld) {
  const double s = std::sin(kPi / 3), c = std::cos(kPi / 3);
  MechanicsDef def = under_gravity();
  add_hinged(def, "Left", "Ground", {}, bar(1, {0.5 * s, 0, -0.5 * c}));
  add_hinged(def, "Seat", "Left", {s, 0, -c}, bar(30, {1, 0, 0}));
  add_hinged(def, "Right", "Ground", {2, 0, 0}, bar(1, {0.5 * s, 0, -0.5 * c}));
  add_hinged(def, "Load", "Seat", {1, 0, 0}, bar(500, {0.3, 0, -0.9}));
  def.joints.push_back({.name = "Closing",
                        .body1 = "Seat",
                        .point1 = {2, 0, 0},
                        .orientation1 = kAboutY,
                        .body2 = "Right",
                        .point2 = {s, 0, -c},
                        .orientation2 = kAboutY});
  TranslationalForceDef line;
  line.name = "Line";
  line.body1 = "Ground", line.point1 = {0.5, 0, -2};
  line.body2 = "Seat", line.point2 = {1.5, 0, 0};
  def.translational_forces.push_back(line);
  const std::string rows[] = {"Line"};
  const Model model = build_model(def, rows);
  State state = start_state(model);
  for (double& coordinate : state.q) coordinate += 3e-9;
  const RestSearch found = find_rest(model, {.held_rows = 1, .coordinates = {{0, 0}}}, state);
  ASSERT_TRUE(found.is_stable);
  Workspace ws(model);
  observe(model, state, ws);
  const Triple load = body_pose(model, ws, find_body(model, "Load")).center_of_mass;
  EXPECT_NEAR(load[0], s + 1, 3e-8);
  EXPECT_NEAR(load[2], -c - std::hypot(0.3, 0.9), 3e-8);
}

}  // namespace equilibrium_test
}  // namespace slew::multibody
