// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/peers/models.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "multibody/constraints/loops.h"
#include "multibody/formulations/dynamics.h"
#include "tests/support/chain_def.h"
#include "tests/validation/multibody/crane_def.h"
#include "tests/validation/multibody/cylinder_bodies.h"

namespace slew::peers {

using namespace multibody;
using math::Mat3;
using math::Vec3;

namespace {

Rotation rows_of(const Mat3& R) {
  return {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
}

Joint joint_of(LinkJoint joint) {
  switch (joint) {
    case LinkJoint::revolute:
      return Joint::revolute;
    case LinkJoint::prismatic:
      return Joint::prismatic;
    case LinkJoint::universal:
      return Joint::universal;
    case LinkJoint::spherical:
      return Joint::spherical;
    case LinkJoint::floating:
      return Joint::floating;
    case LinkJoint::cylindrical:
    case LinkJoint::node:
      break;
  }
  throw std::invalid_argument("a joint that no case has");
}

MechanicsDef crane_with_cylinders() {
  MechanicsDef def = testing::crane_def();
  for (const char* force : {"ForceT_Lift", "ForceT_Jib"}) {
    testing::replace_dummies(def, force, {0, 0, 1});
    // about the cylinder's axis, where peers want some
    for (BodyDef* body : {&def.bodies.back(), &def.bodies[def.bodies.size() - 2]}) body->inertia[0] = 0.2;
  }
  return def;
}

MechanicsDef crane_with_box() {
  MechanicsDef def = testing::crane_def({.dummies = testing::Dummies::without});
  constexpr double kEdge = 0.8, kMass = 500, kStiffness = 1e7;
  const double moment = kMass * kEdge * kEdge / 6;
  def.bodies.push_back({.name = "Box",
                        .position = {20, kEdge / 2 - kMass * 9.81 / kStiffness, 0},
                        .mass = kMass,
                        .inertia = {moment, moment, moment}});
  def.joints.push_back({.name = "Flight", .type = JointType::floating, .body2 = "Box"});
  ShapeDef ground, box;
  ground.name = "Ground_Plane";
  ground.type = contact::ShapeType::plane;
  ground.orientation = {0, -M_PI / 2, 0};
  box.name = "Box_Shape";
  box.body = "Box";
  box.type = contact::ShapeType::box;
  box.size = {kEdge, kEdge, kEdge};
  def.shapes = {ground, box};
  FrictionDef friction;
  friction.name = "Dry";
  friction.law.static_coefficient = friction.law.dynamic_coefficient = 0.5;
  def.frictions = {friction};
  ContactPairDef pair;
  pair.name = "Box_Ground";
  pair.shape_a = "Box_Shape";
  pair.shape_b = "Ground_Plane";
  pair.friction = "Dry";
  pair.normal.stiffness = kStiffness;
  def.contacts = {pair};
  def.contact_substep = 1e-3;
  return def;
}

double damping_of(const MechanicsDef& def, LinkJoint joint) {
  if (joint != LinkJoint::spherical) return 0;
  for (const RotationalForceDef& force : def.rotational_forces) {
    if (force.damping_constant > 0) return force.damping_constant;
  }
  return 0;
}

}  // namespace

std::vector<Case> cases() {
  std::vector<Case> list = {{"crane", testing::crane_def({.dummies = testing::Dummies::without})},
                            {"crane_loops", crane_with_cylinders()},
                            {"crane_contact", crane_with_box()}};
  for (const int n : {5, 10, 20, 50, 100}) {
    list.push_back({fmt::format("chain{}", n), testing::chain_def(n)});
    list.back().def.gravity = {0, 0, -9.81};
  }
  return list;
}

Mechanism mechanism_of(const MechanicsDef& def, const Model& model) {
  Mechanism mechanism;
  mechanism.gravity = model.gravity.array();
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const Vec3 c = link.h_L * (1 / link.mass);
    const Mat3 shift = Mat3::diagonal(dot(c, c), dot(c, c), dot(c, c)) - outer(c, c);
    mechanism.bodies.push_back({.parent = link.parent - 1,
                                .joint = joint_of(link.joint),
                                .R_PJ = rows_of(link.R_PJ),
                                .p_PJ = link.p_PJ.array(),
                                .mass = link.mass,
                                .center = c.array(),
                                .inertia = rows_of(link.I_L - shift * link.mass),
                                .damping = damping_of(def, link.joint)});
  }
  for (const Cut& cut : model.cuts) {
    if (cut.rows.size() != 3) throw std::invalid_argument("a closure that is not a ball");
    mechanism.closures.push_back({cut.link1 - 1, cut.link2 - 1, cut.p_L1.array(), cut.p_L2.array()});
  }
  if (!def.contacts.empty()) {
    const auto flies = [](const Body& body) { return body.joint == Joint::floating; };
    const auto box = std::find_if(mechanism.bodies.begin(), mechanism.bodies.end(), flies);
    mechanism.box = static_cast<int>(box - mechanism.bodies.begin());
    mechanism.box_size = def.shapes.back().size;
    mechanism.friction = def.frictions.back().law.static_coefficient;
  }
  return mechanism;
}

State state_of(const Model& model, const multibody::State& state, const Workspace& ws) {
  State to{state.q, state.u};
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    if (link.joint != LinkJoint::spherical) continue;
    const auto q = static_cast<std::size_t>(link.q), u = static_cast<std::size_t>(link.u);
    const Mat3 frame = ws.motion[static_cast<std::size_t>(link.parent)].R * link.R_PJ;
    const math::Quaternion turned = math::quaternion_of(transpose(frame) * ws.motion[i].R);
    const Vec3 w = transpose_multiply(frame, Vec3(state.u[u], state.u[u + 1], state.u[u + 2]));
    to.q[q] = turned.w;
    to.q[q + 1] = turned.x;
    to.q[q + 2] = turned.y;
    to.q[q + 3] = turned.z;
    for (std::size_t k = 0; k < 3; ++k) to.u[u + k] = w[static_cast<int>(k)];
  }
  return to;
}

std::vector<double> accelerations_of(const Model& model, const multibody::State& state, const Workspace& ws) {
  std::vector<double> udot = ws.udot;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    if (link.joint != LinkJoint::spherical) continue;
    const auto u = static_cast<std::size_t>(link.u);
    const LinkMotion& parent = ws.motion[static_cast<std::size_t>(link.parent)];
    const auto three = [u](const std::vector<double>& x) { return Vec3(x[u], x[u + 1], x[u + 2]); };
    const Vec3 alpha = transpose_multiply(parent.R * link.R_PJ, three(ws.udot) - cross(parent.w, three(state.u)));
    for (std::size_t k = 0; k < 3; ++k) udot[u + k] = alpha[static_cast<int>(k)];
  }
  return udot;
}

std::vector<multibody::State> motion_of(const Model& model, int states) {
  Workspace ws(model);
  multibody::State state = start_state(model);
  std::mt19937 random(1);
  for (double& u : state.u) u += std::uniform_real_distribution<double>(-0.2, 0.2)(random);
  if (!model.cuts.empty()) {
    forward_dynamics(model, state.q, state.u, {}, ws);
    if (!project(model, state.q, state.u, ws)) throw std::runtime_error("the loops do not close");
  }
  std::vector<multibody::State> list;
  for (int i = 0; i < states; ++i) {
    list.push_back(state);
    for (int k = 0; k < 5; ++k) advance_free(model, state, ws, 1e-3);
  }
  return list;
}

}  // namespace slew::peers
