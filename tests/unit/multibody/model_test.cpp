// SPDX-License-Identifier: Apache-2.0
// State, hash, live parameters, variables, joint law: the mechanism as its owner sees it.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/allocation_guard.h"
#include "multibody/joints/joint_law.h"
#include "multibody/model/parameters.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace model_test {

using testing::crane_def;
using testing::Mechanism;

std::vector<std::string> crane_rows() {
  std::vector<std::string> rows = {"ForceT_Lift", "ForceT_Jib", "ForceR_Pillar"};
  for (const std::string& name : joint_rows(crane_def())) rows.push_back(name);
  return rows;
}

std::uint64_t hash_of(const Model& model, const State& state) {
  StateHash hash;
  add_to_hash(model, state, hash);
  return hash.digest();
}

TEST(Description, OfTheCraneCountsLinksAndFreedoms) {
  const Description crane = describe(build_model(crane_def(), crane_rows()));
  EXPECT_EQ(crane.bodies, 6);
  EXPECT_EQ(crane.joints, 6);
  EXPECT_EQ(crane.degrees_of_freedom, 6);
  EXPECT_EQ(crane.rows, 6);
  ASSERT_EQ(crane.links.size(), 4u);
  EXPECT_EQ(crane.links[2].joint, "LiftBoom_JibBoomAttachment");
  EXPECT_EQ(crane.links[2].bodies,
            (std::vector<std::string>{"Truck_JibBoomAttachment", "Truck_JibBoom", "Truck_Hook"}));
  EXPECT_EQ(crane.links[3].joint_type, "spherical");
}

TEST(JointRows, AreTheJointsWithFrictionOrLimits) {
  EXPECT_EQ(joint_rows(crane_def()),
            (std::vector<std::string>{"Body_Pillar", "Pillar_LiftBoom", "LiftBoom_JibBoomAttachment"}));
  const Model model = build_model(crane_def(), crane_rows());
  EXPECT_EQ(find_row(model, "Pillar_LiftBoom"), 4);
  EXPECT_EQ(row_name(model, 2), "ForceR_Pillar");
  EXPECT_EQ(model.rows[3].law.coulomb, 800);
  EXPECT_NEAR(model.rows[4].law.limit_max, 65 * M_PI / 180, 1e-15);
}

TEST(StateHash, ChangesWithOneUlpOfEveryEntry) {
  Mechanism crane(crane_def(), crane_rows());
  const std::uint64_t before = hash_of(crane.model, crane.state);
  for (std::vector<double> State::*part : {&State::q, &State::u}) {
    for (std::size_t i = 0; i < (crane.state.*part).size(); ++i) {
      State changed = crane.state;
      (changed.*part)[i] = std::nextafter((changed.*part)[i], 1e300);
      EXPECT_NE(hash_of(crane.model, changed), before) << i;
    }
  }
}

TEST(StateHash, ChangesWithEveryLiveParameter) {
  Mechanism crane(crane_def(), crane_rows());
  const std::uint64_t before = hash_of(crane.model, crane.state);
  for (const char* path : {"Bag.mass", "Truck_Hook.mass", "ForceT_Lift.spring_constant", "ForceT_Jib.free_length",
                           "ForceR_FrictionX.damping_constant", "ForceR_Pillar.free_angle",
                           "Body_Pillar.coulomb_friction", "Pillar_LiftBoom.limit_stiffness", "mechanics.gravity.y"}) {
    const auto parameter = find_parameter(crane.model, path);
    ASSERT_TRUE(parameter.has_value()) << path;
    const double value = get_parameter(crane.model, *parameter);
    set_parameter(crane.model, *parameter, std::nextafter(value, 1e300));
    EXPECT_NE(hash_of(crane.model, crane.state), before) << path;
    set_parameter(crane.model, *parameter, value);
    EXPECT_EQ(hash_of(crane.model, crane.state), before) << path;
  }
}

TEST(Parameters, OfWhichThereIsNoneAreNotFound) {
  const Model model = build_model(crane_def(), crane_rows());
  for (const char* path : {"Bag", "Bag.inertia", "Absent.mass", "ForceT_Lift.min_length", "Hook_Bag.coulomb_friction",
                           "mechanics.formulation", "Ground.mass", ""}) {
    EXPECT_FALSE(find_parameter(model, path).has_value()) << path;
  }
}

TEST(Parameters, LiveMassGivesTheModelOfTheHeavierScene) {
  // the scene's inertia scales with the mass, as the live change does
  Mechanism live(crane_def(), crane_rows()), built(crane_def({.bag_mass = 1500}), crane_rows());
  set_body_mass(live.model, find_body(live.model, "Bag"), 1500);
  set_body_mass(live.model, find_body(live.model, "Truck_Hook"), 20);
  evaluate(live.model, live.state, live.ws);
  evaluate(built.model, built.state, built.ws);
  for (std::size_t i = 0; i < live.ws.udot_free.size(); ++i) {
    EXPECT_NEAR(live.ws.udot_free[i], built.ws.udot_free[i], 1e-12 * (1 + std::abs(built.ws.udot_free[i])));
  }
}

TEST(Parameters, GravityTurnsOffLive) {
  Mechanism crane(crane_def(), crane_rows());
  set_parameter(crane.model, *find_parameter(crane.model, "mechanics.gravity.y"), 0);
  evaluate(crane.model, crane.state, crane.ws);
  for (const double rate : crane.ws.udot_free) EXPECT_NEAR(rate, 0, 1e-12);
}

TEST(Step, NeitherAllocatesNorFrees) {
  Mechanism crane(crane_def(), crane_rows());
  const std::vector<double> mean(6, 100.0), slope(6, -50.0);
  std::vector<double> values(variables(crane.model).size());
  std::vector<JointReaction> reactions(crane.model.joints.size());
  const Parameter mass = *find_parameter(crane.model, "Bag.mass");
  const AllocationGuard guard;
  for (int i = 0; i < 1000; ++i) {
    set_parameter(crane.model, mass, 500 + i);
    evaluate(crane.model, crane.state, crane.ws);
    advance(crane.model, crane.state, crane.ws, 1e-4, mean, slope);
    observe(crane.model, crane.state, crane.ws);
    read_variables(crane.model, crane.state, crane.ws, mean, values);
    joint_reactions(crane.model, crane.state, crane.ws, mean, reactions);
    (void)hash_of(crane.model, crane.state);
  }
  EXPECT_EQ(guard.allocations(), 0u);
  EXPECT_EQ(guard.frees(), 0u);
  EXPECT_TRUE(is_finite(crane.state));
}

TEST(Step, GivesTheSameBitsFromTheSameState) {
  Mechanism a(crane_def(), crane_rows()), b(crane_def(), crane_rows());
  const std::vector<double> mean(6, 100.0), slope(6, -50.0);
  for (int i = 0; i < 100; ++i) {
    for (Mechanism* m : {&a, &b}) {
      evaluate(m->model, m->state, m->ws);
      advance(m->model, m->state, m->ws, 1e-3, mean, slope);
    }
    // readings in between leave the motion alone
    b.see();
    (void)b.total_energy();
  }
  EXPECT_EQ(hash_of(a.model, a.state), hash_of(b.model, b.state));
}

TEST(Step, SeesANonFiniteState) {
  Mechanism crane(crane_def());
  EXPECT_TRUE(is_finite(crane.state));
  crane.state.u[2] = std::nan("");
  EXPECT_FALSE(is_finite(crane.state));
}

TEST(Substeps, DivideTheStepEvenly) {
  Model model = build_model(crane_def());
  EXPECT_EQ(substep_count(model, 1e-3), 1);
  EXPECT_EQ(substep_count(model, 1e-4), 1);
  EXPECT_EQ(substep_count(model, 5e-3), 5);
  EXPECT_EQ(substep_count(model, 1.5e-3), 2);
}

TEST(Rows, InactiveOnesActOnNothing) {
  Mechanism crane(crane_def(), crane_rows());
  evaluate(crane.model, crane.state, crane.ws);
  const double W00 = row_mobility(crane.ws)[0], x1 = row_positions(crane.ws)[1];
  deactivate_row(crane.ws, 1);
  evaluate(crane.model, crane.state, crane.ws);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(row_mobility(crane.ws)[6 + k], 0);
    EXPECT_EQ(row_mobility(crane.ws)[6 * k + 1], 0);
  }
  EXPECT_EQ(row_mobility(crane.ws)[0], W00);
  EXPECT_EQ(row_free_accelerations(crane.ws)[1], 0);
  EXPECT_EQ(row_positions(crane.ws)[1], x1);
  State pushed = crane.state, idle = crane.state;
  const std::vector<double> zero(6, 0.0), push = {0, 1e6, 0, 0, 0, 0};
  advance(crane.model, pushed, crane.ws, 1e-3, push, zero);
  evaluate(crane.model, idle, crane.ws);
  advance(crane.model, idle, crane.ws, 1e-3, zero, zero);
  EXPECT_EQ(pushed.u, idle.u);
  activate_row(crane.ws, 1);
  evaluate(crane.model, crane.state, crane.ws);
  EXPECT_NE(row_mobility(crane.ws)[7], 0);
}

TEST(Variables, HaveUniqueNamesAndFiniteValues) {
  Mechanism crane(crane_def(), crane_rows());
  const std::vector<ElementVariable> names = variables(crane.model);
  std::set<std::string> unique;
  for (const ElementVariable& variable : names) unique.insert(variable.name);
  EXPECT_EQ(unique.size(), names.size());
  std::vector<double> values(names.size(), std::nan(""));
  const std::vector<double> forces = {251e3, 107e3, 0, 7, 0, 0};
  read_variables(crane.model, crane.state, crane.ws, forces, values);
  const auto value_of = [&](const std::string& name) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == name) return values[i];
    }
    return std::nan("");
  };
  for (const double value : values) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(value_of("ForceT_Lift.force"), 251e3);
  EXPECT_EQ(value_of("Body_Pillar.torque"), 7);
  EXPECT_NEAR(value_of("Pillar_LiftBoom.position"), 15 * M_PI / 180, 1e-12);
  EXPECT_NEAR(value_of("Bag.center_of_mass.y"), value_of("Bag.position.y") - 0.6, 1e-9);
}

TEST(JointLaw, SlopesAreThoseOfTheForce) {
  const JointLaw law{.coulomb = 800,
                     .viscous = 3000,
                     .friction_speed = 1e-3,
                     .limit_min = -0.2,
                     .limit_max = 1.1,
                     .limit_stiffness = 2e7,
                     .limit_damping = 2e6};
  for (const double x : {-0.21, 0.0, 1.2}) {
    for (const double v : {-0.3, -5e-4, 0.0, 2e-3, 0.2}) {
      const JointForce f = evaluate(law, x, v);
      const double h = 1e-8;
      const double d_x = (evaluate(law, x + h, v).force - evaluate(law, x - h, v).force) / (2 * h);
      const double d_v = (evaluate(law, x, v + h).force - evaluate(law, x, v - h).force) / (2 * h);
      EXPECT_NEAR(f.d_x, d_x, 1e-5 * (1 + std::abs(f.d_x)));
      EXPECT_NEAR(f.d_v, d_v, 1e-5 * (1 + std::abs(f.d_v)));
    }
  }
}

TEST(JointLaw, LimitsNeverPullAndFrictionNeverDrives) {
  const JointLaw stop{.limit_min = -1, .limit_max = 1, .limit_stiffness = 100, .limit_damping = 10};
  EXPECT_EQ(evaluate(stop, 1.1, -5).force, 0);
  EXPECT_EQ(evaluate(stop, -1.1, 5).force, 0);
  EXPECT_LT(evaluate(stop, 1.1, 0).force, 0);
  EXPECT_GT(evaluate(stop, -1.1, 0).force, 0);
  EXPECT_EQ(evaluate(stop, 0.99, 50).force, 0);
  EXPECT_TRUE(touches_limit(stop, 1.1));
  EXPECT_FALSE(touches_limit(stop, 0));
  const JointLaw friction{.coulomb = 5, .viscous = 2, .limit_min = -9, .limit_max = 9};
  for (const double v : {-2.0, -1e-4, 0.0, 1e-4, 2.0}) EXPECT_LE(evaluate(friction, 0, v).force * v, 0);
  EXPECT_NEAR(evaluate(friction, 0, 1).force, -7, 1e-12);
}

TEST(ForceDummies, OnBodiesThatAreOneKeepTheirInertia) {
  // a cylinder or a piston alone, on a line along x between an arm and a load that is welded to it
  for (const std::int64_t index : {1, 2}) {
    MechanicsDef def;
    def.bodies = {{.name = "Arm", .mass = 2, .inertia = {0.1, 0.1, 0.1}},
                  {.name = "Load", .relative_to = "Arm", .position = {1, 0, 0}, .mass = 5, .inertia = {1, 1, 1}}};
    def.joints = {{.name = "Hinge", .body2 = "Arm"},
                  {.name = "Weld", .type = JointType::fixed, .body1 = "Arm", .point1 = {1, 0, 0}, .body2 = "Load"}};
    def.translational_forces = {{.name = "Strut", .body1 = "Arm", .point1 = {0.2, 0, 0}, .body2 = "Load"}};
    def.force_dummies = {{.name = "Part",
                          .relative_to = "Strut",
                          .index = index,
                          .mass = 3,
                          .center_of_mass = {index == 1 ? -0.1 : 0.1, 0, 0},
                          .inertia = {0.01, 0.7, 0.7}}};
    Mechanism arm(def);
    arm.state.u[0] = 1;
    arm.see();
    // element axis: from the load to the arm, -x; centres at 0.3 and 0.9 m
    const double r = index == 1 ? 0.3 : 0.9;
    const double inertia = 0.1 + 1 + 5 * 1.0 + 0.7 + 3 * r * r;
    EXPECT_NEAR(energy(arm.model, arm.ws).kinetic, 0.5 * inertia, 1e-12) << index;
  }
}

TEST(RotationalForce, ShowsTheTorqueThatItsDamperExerts) {
  // on a ball joint, turned away from the axis: the gradient of the angle is another direction than the axis
  MechanicsDef def;
  def.gravity = {0, 0, 0};
  def.bodies = {{.name = "Ball", .mass = 2, .inertia = {0.4, 0.4, 0.4}}};
  def.joints = {{.name = "Joint", .type = JointType::spherical, .body2 = "Ball", .initial_rotation = {1, 2, 3}}};
  def.rotational_forces = {{.name = "Damper", .body1 = "Ground", .body2 = "Ball", .damping_constant = 5}};
  Mechanism ball(def);
  ball.state.q = {std::cos(0.4), std::sin(0.4), 0, 0};
  ball.see();
  const Triple w = ball.pose("Ball").angular_velocity;
  const double shown = ball.value("Damper.torque");
  EXPECT_NEAR(shown, -5 * w[1], 1e-12);  // the axis is y
  EXPECT_GT(std::fabs(ball.value("Damper.rate") - w[1]), 0.1);
  // and it is the torque about the axis that turns the ball
  const Triple before = momentum(ball.model, ball.ws).angular;
  ball.run(1e-6, 1e-6);
  EXPECT_NEAR((momentum(ball.model, ball.ws).angular[1] - before[1]) / 1e-6, shown, 1e-3);
}

TEST(RotationalForce, CountsTurnsOfACoaxialHinge) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Wheel", .mass = 1, .inertia = {1, 1, 1}}};
  def.joints = {{.name = "Axle", .body2 = "Wheel", .initial_velocity = 10}};
  def.rotational_forces = {
      {.name = "Drive", .body1 = "Ground", .f1 = {1, 0, 0}, .g1 = {0, 1, 0}, .body2 = "Wheel", .f2 = {0, 1, 0}}};
  Mechanism wheel(def, {"Drive"});
  wheel.run(2, 1e-2);
  EXPECT_NEAR(wheel.value("Drive.angle"), 20 + M_PI / 2, 1e-9);
  EXPECT_NEAR(wheel.value("Drive.rate"), 10, 1e-12);
  // axis against the joint's: the angle runs backwards
  std::swap(def.rotational_forces[0].f1, def.rotational_forces[0].g1);
  Mechanism backwards(def, {"Drive"});
  backwards.run(2, 1e-2);
  EXPECT_NEAR(backwards.value("Drive.angle"), -20, 1e-9);
}

}  // namespace model_test
}  // namespace slew::multibody
