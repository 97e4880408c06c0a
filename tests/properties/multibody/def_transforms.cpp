// SPDX-License-Identifier: Apache-2.0
#include "tests/properties/multibody/def_transforms.h"

#include <string>

#include "tests/validation/multibody/angles.h"

namespace slew::multibody::testing {

using math::Mat3;
using math::Vec3;

namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

void scale(Triple& values, double factor) {
  for (double& x : values) x *= factor;
}

template <typename Change>
void change(double* x, Change f) {
  const Triple result = f(Vec3(x[0], x[1], x[2])).array();
  for (std::size_t k = 0; k < 3; ++k) x[k] = result[k];
}

}  // namespace

MechanicsDef turned_and_moved(MechanicsDef def, const Mat3& R, Vec3 p) {
  const auto place = [&](Triple& point) { point = (R * Vec3(point) + p).array(); };
  for (BodyDef& body : def.bodies) {
    if (body.relative_to != kGroundName) continue;
    place(body.position);
    body.orientation = angles_zxz(R * math::rotation_zxz(body.orientation));
  }
  for (JointDef& joint : def.joints) {
    const auto turn = [&](Triple& point, Triple& orientation) {
      place(point);
      orientation = angles_xyz(R * math::rotation_xyz(orientation));
    };
    if (joint.body1 == kGroundName) turn(joint.point1, joint.orientation1);
    if (joint.body2 == kGroundName) turn(joint.point2, joint.orientation2);
  }
  for (TranslationalForceDef& force : def.translational_forces) {
    if (force.body1 == kGroundName) place(force.point1);
    if (force.body2 == kGroundName) place(force.point2);
  }
  for (RotationalForceDef& force : def.rotational_forces) {
    if (force.body1 == kGroundName) {
      force.f1 = (R * Vec3(force.f1)).array();
      force.g1 = (R * Vec3(force.g1)).array();
    }
    if (force.body2 == kGroundName) force.f2 = (R * Vec3(force.f2)).array();
  }
  def.gravity = (R * Vec3(def.gravity)).array();
  return def;
}

State turned_and_moved(const Model& model, State state, const Mat3& R, Vec3 p) {
  const math::Quaternion turn = math::quaternion_of(R);
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    double *q = state.q.data() + link.q, *u = state.u.data() + link.u;
    const auto rotate = [&](Vec3 x) { return R * x; };
    if (link.joint == LinkJoint::floating) {
      change(q, [&](Vec3 x) { return R * x + p; });
      change(u, rotate);
      q += 3;
      u += 3;
    }
    if (link.joint != LinkJoint::floating && link.joint != LinkJoint::spherical) continue;
    const math::Quaternion turned = turn * math::Quaternion{q[0], q[1], q[2], q[3]};
    q[0] = turned.w;
    q[1] = turned.x;
    q[2] = turned.y;
    q[3] = turned.z;
    change(u, rotate);
  }
  return state;
}

MechanicsDef in_units(MechanicsDef def, const Units& units) {
  const double L = units.length, M = units.mass, T = units.time;
  const double stiffness = M / (T * T), damping = M / T, inertia = M * L * L;
  scale(def.gravity, L / (T * T));
  def.penalty_frequency /= T;
  for (BodyDef& body : def.bodies) {
    scale(body.position, L);
    body.mass *= M;
    scale(body.center_of_mass, L);
    scale(body.inertia, inertia);
    scale(body.products, inertia);
  }
  for (JointDef& joint : def.joints) {
    scale(joint.point1, L);
    scale(joint.point2, L);
    joint.length *= L;
  }
  for (TranslationalForceDef& force : def.translational_forces) {
    scale(force.point1, L);
    scale(force.point2, L);
    for (double* x : {&force.free_length, &force.min_length, &force.max_length}) *x *= L;
    for (double* x : {&force.spring_constant, &force.end_spring_constant}) *x *= stiffness;
    for (double* x : {&force.damping_constant, &force.end_damping_constant}) *x *= damping;
  }
  for (RotationalForceDef& force : def.rotational_forces) {
    for (double* x : {&force.spring_constant, &force.end_spring_constant}) *x *= stiffness * L * L;
    for (double* x : {&force.damping_constant, &force.end_damping_constant}) *x *= damping * L * L;
  }
  for (ForceDummyDef& dummy : def.force_dummies) {
    dummy.mass *= M;
    scale(dummy.center_of_mass, L);
    scale(dummy.inertia, inertia);
  }
  for (StaticDummyDef& dummy : def.static_dummies) {
    scale(dummy.position, L);
    dummy.mass *= M;
    scale(dummy.center_of_mass, L);
    scale(dummy.inertia, inertia);
  }
  return def;
}

State in_units(const Model& model, State state, const Units& units) {
  const double L = units.length, T = units.time;
  for (double& u : state.u) u /= T;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    // lengths among the coordinates: of a slide, of the second coordinate of a cylinder, of a free position
    int first = 0, count = 0;
    if (link.joint == LinkJoint::prismatic) count = 1;
    if (link.joint == LinkJoint::cylindrical) first = count = 1;
    if (link.joint == LinkJoint::floating) count = 3;
    for (int k = first; k < first + count; ++k) {
      state.q[at(link.q + k)] *= L;
      state.u[at(link.u + k)] *= L;
    }
  }
  return state;
}

}  // namespace slew::multibody::testing
