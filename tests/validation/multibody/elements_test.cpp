// SPDX-License-Identifier: Apache-2.0
// Force elements against closed forms.
//
// Beam: case B01 (cantilever of 2 m, 0.1 m square, E 2.1e11, nu 0.3, 5/6): 1.5267809524e-3 m under 1 kN at its end with
// shear, 1.5238095238e-3 without, rotation 1.14285714e-3; torsion, tension and tip moment by the formulas of strength
// of materials. Deflections of 1e-6 of the length, where geometry is linear: 1e-6 relative.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "multibody/model/parameters.h"
#include "tests/validation/multibody/mechanism.h"

namespace slew::multibody {
namespace elements_test {

using math::Mat3;
using math::Vec3;
using testing::Mechanism;

constexpr double kE = 2.1e11, kG = kE / 2.6, kSide = 0.1, kLength = 2, kShear = 5.0 / 6;
constexpr double kArea = kSide * kSide, kSecond = kSide * kSide * kSide * kSide / 12, kTorsion = 0.1406e-4;

MechanicsDef free_body(Triple position) {
  MechanicsDef def;
  def.gravity = {};
  def.bodies = {{.name = "Load", .position = position, .mass = 100, .inertia = {2, 2, 2}}};
  def.joints = {{.name = "Free", .type = JointType::floating, .point1 = position, .body2 = "Load"}};
  return def;
}

BeamDef cantilever(double shear_factor) {
  return {.name = "Beam",
          .frames = {.body1 = "Ground", .body2 = "Load"},
          .length = kLength,
          .youngs_modulus = kE,
          .area = kArea,
          .second_moment_y = kSecond,
          .second_moment_z = kSecond,
          .torsion_constant = kTorsion,
          .shear_factor_y = shear_factor,
          .shear_factor_z = shear_factor};
}

// Wrench that holds the load's body where `displaced` puts it: minus that of the beam.
struct Holding {
  Vec3 force, moment;
};
Holding holding(const MechanicsDef& def, const std::function<void(State&)>& displaced) {
  Mechanism mechanism(def);
  displaced(mechanism.state);
  mechanism.see();
  Holding held;
  for_each_wrench(mechanism.model.elements, mechanism.ws.motion, 0, [&](int link, int, const Wrench& wrench) {
    if (link == 0) return;
    held = {-wrench.f, -wrench.n};
  });
  return held;
}

// Deflection and rotation of a cantilever's end under a force and a moment across it, by strength of materials; shear:
// E times I over k G A.
struct End {
  double w, slope;
};
End end_of_cantilever(double F, double M, double shear_factor) {
  const double EI = kE * kSecond, l = kLength;
  const double shear = shear_factor > 0 ? F * l / (shear_factor * kG * kArea) : 0;
  return {F * l * l * l / (3 * EI) + M * l * l / (2 * EI) + shear, F * l * l / (2 * EI) + M * l / EI};
}

void set_pose(State& state, Vec3 p, Vec3 small_rotation) {
  for (int k = 0; k < 3; ++k) state.q[static_cast<std::size_t>(k)] = p[k];
  const double angle = norm(small_rotation);
  const double share = angle > 0 ? std::sin(angle / 2) / angle : 0;
  state.q[3] = std::cos(angle / 2);
  for (int k = 0; k < 3; ++k) state.q[static_cast<std::size_t>(k) + 4] = small_rotation[k] * share;
}

TEST(Cantilever, HasThePublishedDeflections) {
  EXPECT_NEAR(end_of_cantilever(1e3, 0, kShear).w, 1.5267809524e-3, 1e-12);
  EXPECT_NEAR(end_of_cantilever(1e3, 0, 0).w, 1.5238095238e-3, 1e-12);
  EXPECT_NEAR(end_of_cantilever(1e3, 0, 0).slope, 1.14285714e-3, 1e-11);
}

TEST(Cantilever, CarriesForceAndMomentAcrossIt) {
  for (const double shear : {0.0, kShear}) {
    MechanicsDef def = free_body({kLength, 0, 0});
    def.beams = {cantilever(shear)};
    for (const auto& [F, M] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {0.7, -0.4}}) {
      const End end = end_of_cantilever(F, M, shear);
      // along y, with the rotation about z; then along z, where the rotation about y has the other sign
      const Holding y = holding(def, [&](State& s) { set_pose(s, {kLength, end.w, 0}, {0, 0, end.slope}); });
      EXPECT_NEAR(y.force[1], F, 1e-6);
      EXPECT_NEAR(y.moment[2], M, 1e-6);
      const Holding z = holding(def, [&](State& s) { set_pose(s, {kLength, 0, end.w}, {0, -end.slope, 0}); });
      EXPECT_NEAR(z.force[2], F, 1e-6);
      EXPECT_NEAR(z.moment[1], -M, 1e-6);
    }
  }
}

TEST(Cantilever, CarriesTensionAndTorsion) {
  MechanicsDef def = free_body({kLength, 0, 0});
  def.beams = {cantilever(kShear)};
  const double stretch = 1e-6, twist = 1e-5;
  const Holding held = holding(def, [&](State& s) { set_pose(s, {kLength + stretch, 0, 0}, {twist, 0, 0}); });
  EXPECT_NEAR(held.force[0], kE * kArea / kLength * stretch, 1e-6);
  EXPECT_NEAR(held.moment[0], kG * kTorsion / kLength * twist, 1e-9);
}

TEST(Cantilever, OscillatesAtTheFrequencyOfItsLoad) {
  // torsion alone: omega^2 = G J / (l I)
  MechanicsDef def = free_body({kLength, 0, 0});
  def.beams = {cantilever(kShear)};
  Mechanism mechanism(def);
  const double omega = std::sqrt(kG * kTorsion / kLength / 2);
  set_pose(mechanism.state, {kLength, 0, 0}, {1e-4, 0, 0});
  const double quarter = M_PI / 2 / omega;
  mechanism.run(quarter, quarter / 100);
  EXPECT_NEAR(mechanism.state.u[3], -1e-4 * omega, 1e-7 * omega);
}

// The cantilever as `segments` beams between heavy bodies in a viscous medium, so that an explicit step can follow it
// to rest: Node0, Node1, ..., the last one at the end.
MechanicsDef chain_of_segments(int segments) {
  const double part = kLength / segments;
  MechanicsDef def;
  def.gravity = {};
  for (int i = 0; i < segments; ++i) {
    const std::string number = std::to_string(i), name = "Node" + number;
    const Triple place = {part * (i + 1), 0, 0};
    def.bodies.push_back({.name = name, .position = place, .mass = 1e5, .inertia = {1e4, 1e4, 1e4}});
    def.joints.push_back({.name = "Free" + number, .type = JointType::floating, .point1 = place, .body2 = name});
    BeamDef beam = cantilever(kShear);
    beam.name = "Beam" + number;
    beam.length = part;
    beam.damping_time = 2e-3;
    beam.frames.body1 = i == 0 ? "Ground" : "Node" + std::to_string(i - 1);
    beam.frames.body2 = name;
    def.beams.push_back(beam);
    def.bushings.push_back({.name = "Medium" + number,
                            .frames = {.body1 = "Ground", .point1 = place, .body2 = name},
                            .damping = {3e5, 3e5, 3e5},
                            .rotational_damping = {1e5, 1e5, 1e5}});
  }
  return def;
}

TEST(Cantilever, OfManySegmentsIsTheSame) {
  constexpr double kForce = 1000;
  MechanicsDef def = chain_of_segments(4);
  def.point_forces = {{.name = "Tip", .body = "Node3", .direction = {0, 1, 0}, .force = kForce}};
  Mechanism mechanism(def);
  mechanism.run(30, 2e-3);
  const End end = end_of_cantilever(kForce, 0, kShear);
  EXPECT_NEAR(mechanism.pose("Node3").position[1], end.w, 1e-5 * end.w);
}

// a tip moment bends a beam to an arc: by 1 rad over its length, with an error that falls with the square of the
// segments
TEST(Cantilever, OfManySegmentsBendsToAnArc) {
  double error[2];
  for (const int segments : {4, 8}) {
    MechanicsDef def = chain_of_segments(segments);
    const std::string tip = "Node" + std::to_string(segments - 1);
    def.point_torques = {{.name = "Tip",
                          .body = tip,
                          .direction = {0, 0, 1},
                          .axes = LoadAxes::ground,
                          .torque = kE * kSecond / kLength}};
    Mechanism mechanism(def);
    mechanism.run(40, 2e-3);
    const Triple end = mechanism.pose(tip).position;
    error[segments / 8] = std::hypot(end[0] - kLength * std::sin(1), end[1] - kLength * (1 - std::cos(1)));
  }
  EXPECT_LT(error[1], 5e-3 * kLength);
  EXPECT_NEAR(error[0] / error[1], 4, 0.4);
}

TEST(PointForce, InGroundAxesAcceleratesItsBodyAndTurnsIt) {
  MechanicsDef def = free_body({});
  def.point_forces = {{.name = "Push",
                       .body = "Load",
                       .point = {0, 0.5, 0},
                       .direction = {2, 0, 0},
                       .axes = LoadAxes::ground,
                       .force = 50}};
  Mechanism mechanism(def);
  forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
  EXPECT_NEAR(mechanism.ws.udot[0], 50.0 / 100, 1e-14);
  EXPECT_NEAR(mechanism.ws.udot[5], -0.5 * 50 / 2, 1e-14);
  EXPECT_EQ(mechanism.value("Push.force"), 50);
}

TEST(PointForce, InBodyAxesTurnsWithItsBody) {
  MechanicsDef def = free_body({});
  def.bodies[0].orientation = {M_PI / 2, 0, 0};
  def.point_forces = {{.name = "Jet", .body = "Load", .direction = {1, 0, 0}, .force = 50}};
  def.point_torques = {{.name = "Motor", .body = "Load", .direction = {0, 1, 0}, .torque = 3}};
  Mechanism mechanism(def);
  forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
  EXPECT_NEAR(mechanism.ws.udot[1], 0.5, 1e-14);
  EXPECT_NEAR(mechanism.ws.udot[3], -1.5, 1e-14);
}

// A body turned by 90 degrees about z, pushed by 50 N along (0.6, 0.8, 0) at its point (0, 0.5, 0), which is (-0.5, 0,
// 0) of Ground; alone, and fixed to another body of the same mass whose axes are those of Ground.
TEST(PointForce, ActsAtItsPointOfATurnedBody) {
  constexpr Triple kTurned{M_PI / 2, 0, 0};
  for (const bool is_fixed : {false, true}) {
    MechanicsDef def = free_body({});
    if (is_fixed) {
      def.bodies.push_back({.name = "Arm", .orientation = kTurned, .mass = 100, .inertia = {2, 2, 2}});
      def.joints.push_back({.name = "Weld",
                            .type = JointType::fixed,
                            .body1 = "Load",
                            .body2 = "Arm",
                            .orientation2 = {0, 0, -M_PI / 2}});
    } else {
      def.bodies[0].orientation = kTurned;
    }
    const double mass = is_fixed ? 200 : 100, inertia = is_fixed ? 4 : 2;
    for (const LoadAxes axes : {LoadAxes::ground, LoadAxes::body}) {
      def.point_forces = {{.name = "Push",
                           .body = is_fixed ? "Arm" : "Load",
                           .point = {0, 0.5, 0},
                           .direction = {0.6, 0.8, 0},
                           .axes = axes,
                           .force = 50}};
      const Vec3 F = axes == LoadAxes::ground ? Vec3(30, 40, 0) : Vec3(-40, 30, 0);
      Mechanism mechanism(def);
      forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
      EXPECT_NEAR(mechanism.ws.udot[0], F.x() / mass, 1e-14) << is_fixed;
      EXPECT_NEAR(mechanism.ws.udot[1], F.y() / mass, 1e-14) << is_fixed;
      EXPECT_NEAR(mechanism.ws.udot[5], -0.5 * F.y() / inertia, 1e-13) << is_fixed;
    }
  }
}

// F = 100 t up to 1 s, then 100 N, on 100 kg: v = t^2/2, then 1/2 + (t - 1)
TEST(PointForce, FollowsItsTableOverTime) {
  MechanicsDef def = free_body({});
  def.point_forces = {{.name = "Push", .body = "Load", .force_table = {{0, 0}, {1, 100}}}};
  Mechanism mechanism(def);
  mechanism.run(1, 1e-3);
  EXPECT_NEAR(mechanism.state.u[0], 0.5, 1e-12);
  EXPECT_NEAR(mechanism.state.q[0], 1.0 / 6, 1e-12);
  mechanism.run(2, 1e-3);
  EXPECT_NEAR(mechanism.state.u[0], 2.5, 1e-12);
  EXPECT_NEAR(mechanism.value("Push.force"), 100, 1e-12);
}

TEST(Bushing, HangsALoadAtWeightOverStiffness) {
  MechanicsDef def = free_body({});
  def.gravity = {0, -9.81, 0};
  def.bushings = {{.name = "Mount",
                   .frames = {.body1 = "Ground", .body2 = "Load"},
                   .stiffness = {1e5, 2e4, 1e5},
                   .rotational_stiffness = {1e4, 1e4, 1e4},
                   .damping = {3e3, 3e3, 3e3}}};
  Mechanism mechanism(def);
  mechanism.run(10, 1e-3);
  EXPECT_NEAR(mechanism.value("Mount.deflection.y"), -981 / 2e4, 1e-9);
  EXPECT_NEAR(mechanism.value("Mount.force.y"), 981, 1e-4);
}

TEST(Bushing, CouplesADeflectionToAMoment) {
  MechanicsDef def = free_body({});
  BushingDef mount{.name = "Mount", .frames = {.body1 = "Ground", .body2 = "Load"}};
  mount.stiffness_matrix.assign(36, 0.0);
  mount.stiffness_matrix[6 * 1 + 5] = mount.stiffness_matrix[6 * 5 + 1] = -700;
  mount.preload_force = {0, 0, 12};
  def.bushings = {mount};
  const Holding held = holding(def, [](State& s) { set_pose(s, {0, 1e-3, 0}, {}); });
  EXPECT_NEAR(held.moment[2], -0.7, 1e-12);
  EXPECT_NEAR(held.force[2], -12, 1e-12);
}

// about one axis a rotational spring's moment is k times the angle, however large
TEST(Bushing, IsExactAtLargeAngles) {
  MechanicsDef def = free_body({});
  def.bushings = {
      {.name = "Mount", .frames = {.body1 = "Ground", .body2 = "Load"}, .rotational_stiffness = {10, 10, 10}}};
  for (const double angle : {0.1, 1.0, 2.5, 3.1}) {
    const Vec3 axis = Vec3(2, -1, 2) * (1.0 / 3);
    const Holding held = holding(def, [&](State& s) { set_pose(s, {}, axis * angle); });
    EXPECT_LT(norm(held.moment - axis * (10 * angle)), 1e-11) << angle;
  }
}

// weight m g on a rope of three strands (block with two falls beside one pulley): T = m g / 2 over the moving block
MechanicsDef tackle() {
  MechanicsDef def = free_body({0, -3, 0});
  def.gravity = {0, -9.81, 0};
  def.ropes = {{.name = "Rope",
                .bodies = {"Ground", "Load", "Ground"},
                .points = {{-0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0}},
                .free_length = 6,
                .axial_rigidity = 6e6}};
  return def;
}

TEST(Rope, SharesALoadBetweenItsStrands) {
  MechanicsDef def = tackle();
  Mechanism mechanism(def);
  // V over the load: 2 T cos = m g; cos of the angle of a strand of half the rope's length
  const double strand = std::hypot(0.5, 3.0), stretch = 2 * strand - 6;
  const double tension = 6e6 / 6 * stretch;
  EXPECT_NEAR(mechanism.value("Rope.tension"), tension, 1e-6 * tension);
  EXPECT_NEAR(mechanism.value("Rope.length"), 2 * strand, 1e-12);
  forward_dynamics(mechanism.model, mechanism.state.q, mechanism.state.u, {}, mechanism.ws);
  EXPECT_NEAR(mechanism.ws.udot[1], 2 * tension * 3 / strand / 100 - 9.81, 1e-9 * tension);
  EXPECT_NEAR(mechanism.ws.udot[0], 0, 1e-10);
}

TEST(Rope, IsSlackBelowItsFreeLength) {
  MechanicsDef def = tackle();
  def.ropes[0].free_length = 6.5;
  Mechanism mechanism(def);
  EXPECT_EQ(mechanism.value("Rope.tension"), 0);
  EXPECT_NEAR(mechanism.value("Rope.slack"), 6.5 - 2 * std::hypot(0.5, 3.0), 1e-12);
  mechanism.run(0.1, 1e-3);
  EXPECT_NEAR(mechanism.state.u[1], -0.981, 1e-12);
}

TEST(Rope, NeverPushesHoweverFastItSlackens) {
  MechanicsDef def = tackle();
  def.ropes[0].damping_constant = 1e6;
  Mechanism mechanism(def);
  mechanism.state.u[1] = 10;
  mechanism.see();
  EXPECT_EQ(mechanism.value("Rope.tension"), 0);
  mechanism.state.u[1] = -10;
  mechanism.see();
  const double spring = 1e6 * (2 * std::hypot(0.5, 3.0) - 6);
  EXPECT_NEAR(mechanism.value("Rope.tension"), 2 * spring, 1e-6 * spring);
}

TEST(Rope, IsHauledInByItsFreeLength) {
  MechanicsDef def = tackle();
  def.ropes[0].damping_constant = 3e4;
  Mechanism mechanism(def);
  set_parameter(mechanism.model, find_parameter(mechanism.model, "Rope.free_length").value(), 5.0);
  mechanism.run(20, 1e-3);
  // at rest the tension is that of half the weight over the strand's slope
  const double y = mechanism.pose("Load").position[1], strand = std::hypot(0.5, y);
  EXPECT_NEAR(mechanism.value("Rope.tension"), 981.0 / 2 * strand / -y, 1e-3);
  EXPECT_NEAR(2 * strand, 5 * (1 + mechanism.value("Rope.tension") / 6e6), 1e-8);
}

TEST(Table, OfASpringIsItsCharacteristic) {
  MechanicsDef def = free_body({1, 0, 0});
  def.translational_forces = {{.name = "Spring",
                               .body1 = "Ground",
                               .body2 = "Load",
                               .free_length = 0.9,
                               .spring_table = {{-0.2, -900}, {0, 0}, {0.1, 100}, {0.2, 500}}}};
  Mechanism mechanism(def);
  // at a point of the table: the force is minus its value
  EXPECT_NEAR(mechanism.value("Spring.force"), -100, 1e-9);
  // let go, it oscillates with the energy it had
  const double before = mechanism.total_energy();
  mechanism.run(3, 1e-3);
  EXPECT_NEAR(mechanism.total_energy(), before, 1e-7 * before);
}

TEST(Table, OfADamperIsItsCharacteristic) {
  MechanicsDef def = free_body({1, 0, 0});
  def.joints[0].initial_translation = {0.5, 0, 0};
  def.translational_forces = {
      {.name = "Damper", .body1 = "Ground", .body2 = "Load", .damper_table = {{-1, -50}, {0, 0}, {0.5, 80}, {1, 90}}}};
  Mechanism mechanism(def);
  EXPECT_NEAR(mechanism.value("Damper.force"), -80, 1e-12);
  def.translational_forces.clear();
  def.rotational_forces = {{.name = "Brake",
                            .body1 = "Ground",
                            .f1 = {1, 0, 0},
                            .g1 = {0, 1, 0},
                            .body2 = "Load",
                            .f2 = {1, 0, 0},
                            .damper_table = {{-1, -5}, {0, 0}, {2, 7}}}};
  def.joints[0].initial_rotation = {0, 0, 2};
  Mechanism brake(def);
  EXPECT_NEAR(brake.value("Brake.torque"), -7, 1e-12);
}

}  // namespace elements_test
}  // namespace slew::multibody
