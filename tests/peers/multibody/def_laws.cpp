// SPDX-License-Identifier: Apache-2.0
#include "tests/peers/multibody/def_laws.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace slew::multibody::testing {
namespace {

using math::Mat3;
using math::Vec3;

Vec3 unit(Vec3 a) {
  return a * (1 / norm(a));
}

template <typename Def>
const Def* find(const std::vector<Def>& defs, const std::string& name) {
  const auto it = std::find_if(defs.begin(), defs.end(), [&](const Def& def) { return def.name == name; });
  return it == defs.end() ? nullptr : &*it;
}

void add_force(const BodyMotion& body, Vec3 point, Vec3 force, Wrench& wrench) {
  wrench.force += force;
  wrench.torque += cross(point - body.p, force);
}

double end_force(double x, double v, double min, double max, double k, double d) {
  if (k > 0 && x < min) return std::max(0.0, k * (min - x) - d * v);
  if (k > 0 && x > max) return -std::max(0.0, k * (x - max) + d * v);
  return 0;
}

double end_energy(double x, double min, double max, double k) {
  const double depth = std::max({0.0, min - x, x - max});
  return k > 0 ? 0.5 * k * depth * depth : 0;
}

// Angle of f2 in the plane of f1 and g1 with c = f2 . f1, s = f2 . g1 taken in body 1's axes, where f1 and g1 rest.
struct Angle {
  Vec3 axis, gradient;         // Ground axes; phi' = gradient . w_rel
  double x = 0, v = 0, a = 0;  // rad, rad/s, rad/s2
};

Angle angle_of(const MechanicsDef& def, const RotationalForceDef& force, const Motions& motions) {
  const BodyMotion& b1 = motions[body_number(def, force.body1)];
  const BodyMotion& b2 = motions[body_number(def, force.body2)];
  const Vec3 f1 = unit(Vec3(force.f1)), axis = unit(cross(f1, Vec3(force.g1))), g1 = cross(axis, f1);
  const Mat3 R_12 = transpose(b1.R) * b2.R;
  const Vec3 w = transpose_multiply(b1.R, b2.w - b1.w);
  const Vec3 alpha = transpose_multiply(b1.R, b2.alpha - b1.alpha - cross(b1.w, b2.w - b1.w));
  const Vec3 f2 = R_12 * unit(Vec3(force.f2));
  const Vec3 f2_dot = cross(w, f2), f2_ddot = cross(alpha, f2) + cross(w, f2_dot);
  const double c = dot(f2, f1), s = dot(f2, g1), square = c * c + s * s;
  const double c_dot = dot(f2_dot, f1), s_dot = dot(f2_dot, g1);
  Angle angle;
  angle.axis = b1.R * axis;
  angle.gradient = b1.R * (cross(f2, g1 * c - f1 * s) * (1 / square));
  angle.x = std::atan2(s, c);
  angle.v = (c * s_dot - s * c_dot) / square;
  angle.a = (c * dot(f2_ddot, g1) - s * dot(f2_ddot, f1) - 2 * angle.v * (c * c_dot + s * s_dot)) / square;
  return angle;
}

// a revolute joint's angle, or a prismatic joint's displacement
RowMotion joint_motion(const MechanicsDef& def, const JointDef& joint, const Motions& motions) {
  const BodyMotion& b1 = motions[body_number(def, joint.body1)];
  const BodyMotion& b2 = motions[body_number(def, joint.body2)];
  const Frame in1 = frame1(joint), in2 = frame2(joint);
  const Mat3 R1 = b1.R * in1.R, R2 = b2.R * in2.R;
  const Vec3 z = R1.c[2];
  const Vec3 w_rel = b2.w - b1.w;
  if (joint.type == JointType::revolute) {
    return {.x = std::atan2(dot(R1.c[1], R2.c[0]), dot(R1.c[0], R2.c[0])),
            .v = dot(z, w_rel),
            .a = dot(z, b2.alpha - b1.alpha - cross(b1.w, w_rel)),
            .is_angle = true};
  }
  const PointMotion P1 = motion_of_point(b1, in1.p), P2 = motion_of_point(b2, in2.p);
  // as seen from body 1
  const Vec3 d = P2.p - P1.p, v = P2.v - P1.v - cross(b1.w, d);
  const Vec3 a = P2.a - P1.a - cross(b1.alpha, d) - cross(b1.w, cross(b1.w, d)) - cross(b1.w, v) * 2;
  return {.x = dot(z, d), .v = dot(z, v), .a = dot(z, a)};
}

}  // namespace

std::size_t body_number(const MechanicsDef& def, const std::string& name) {
  if (name == kGroundName) return 0;
  const BodyDef* body = find(def.bodies, name);
  if (body == nullptr) throw std::invalid_argument("no body " + name);
  return static_cast<std::size_t>(body - def.bodies.data()) + 1;
}

Mat3 central_inertia(const BodyDef& body) {
  const auto [xx, yy, zz] = body.inertia;
  const auto [xy, xz, yz] = body.products;
  const Mat3 I{Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)};
  if (body.inertia_about == InertiaPoint::center_of_mass) return I;
  // Steiner: I_o = I_c + m (c.c 1 - c c^T)
  const Vec3 c(body.center_of_mass);
  const double square = dot(c, c);
  return I - (Mat3::diagonal(square, square, square) - outer(c, c)) * body.mass;
}

Frame frame1(const JointDef& joint) {
  return {math::rotation_xyz(joint.orientation1), Vec3(joint.point1)};
}

Frame frame2(const JointDef& joint) {
  return {math::rotation_xyz(joint.orientation2), Vec3(joint.point2)};
}

Line line_of(const MechanicsDef& def, const TranslationalForceDef& force, const Motions& motions) {
  const PointMotion P1 = motion_of_point(motions[body_number(def, force.body1)], Vec3(force.point1));
  const PointMotion P2 = motion_of_point(motions[body_number(def, force.body2)], Vec3(force.point2));
  const Vec3 d = P1.p - P2.p, v = P1.v - P2.v, a = P1.a - P2.a;
  Line line;
  line.P1 = P1.p;
  line.P2 = P2.p;
  line.x = norm(d);
  line.e = d * (1 / line.x);
  line.v = dot(line.e, v);
  line.e_dot = (v - line.e * line.v) * (1 / line.x);
  line.a = dot(line.e, a) + dot(line.e_dot, v);
  return line;
}

void add_element_forces(const MechanicsDef& def, const Motions& motions, Wrenches& wrenches) {
  for (const TranslationalForceDef& f : def.translational_forces) {
    const Line line = line_of(def, f, motions);
    const double force =
        -f.spring_constant * (line.x - f.free_length) - f.damping_constant * line.v +
        end_force(line.x, line.v, f.min_length, f.max_length, f.end_spring_constant, f.end_damping_constant);
    add_row_force(def, f.name, force, motions, wrenches);
  }
  for (const RotationalForceDef& f : def.rotational_forces) {
    const Angle angle = angle_of(def, f, motions);
    const std::size_t b1 = body_number(def, f.body1), b2 = body_number(def, f.body2);
    Vec3 torque = angle.axis * (-f.damping_constant * dot(angle.axis, motions[b2].w - motions[b1].w));
    // a damper alone needs no gradient, which f2 on the axis would not have
    if (f.spring_constant > 0 || f.end_spring_constant > 0) {
      torque += angle.gradient *
                (-f.spring_constant * (angle.x - f.free_angle) +
                 end_force(angle.x, angle.v, f.min_angle, f.max_angle, f.end_spring_constant, f.end_damping_constant));
    }
    wrenches[b1].torque -= torque;
    wrenches[b2].torque += torque;
  }
}

double spring_energy(const MechanicsDef& def, const Motions& motions) {
  double energy = 0;
  for (const TranslationalForceDef& f : def.translational_forces) {
    const double x = line_of(def, f, motions).x;
    energy += 0.5 * f.spring_constant * (x - f.free_length) * (x - f.free_length) +
              end_energy(x, f.min_length, f.max_length, f.end_spring_constant);
  }
  for (const RotationalForceDef& f : def.rotational_forces) {
    if (f.spring_constant == 0 && f.end_spring_constant == 0) continue;
    const double x = angle_of(def, f, motions).x;
    energy += 0.5 * f.spring_constant * (x - f.free_angle) * (x - f.free_angle) +
              end_energy(x, f.min_angle, f.max_angle, f.end_spring_constant);
  }
  return energy;
}

void add_row_force(const MechanicsDef& def, const std::string& row, double force, const Motions& motions,
                   Wrenches& wrenches) {
  const auto numbers = [&](const auto& element) {
    return std::pair(body_number(def, element.body1), body_number(def, element.body2));
  };
  if (const TranslationalForceDef* line_def = find(def.translational_forces, row)) {
    const auto [b1, b2] = numbers(*line_def);
    const Line line = line_of(def, *line_def, motions);
    add_force(motions[b1], line.P1, line.e * force, wrenches[b1]);
    add_force(motions[b2], line.P2, line.e * -force, wrenches[b2]);
  } else if (const RotationalForceDef* angle_def = find(def.rotational_forces, row)) {
    const auto [b1, b2] = numbers(*angle_def);
    const Vec3 torque = angle_of(def, *angle_def, motions).gradient * force;
    wrenches[b1].torque -= torque;
    wrenches[b2].torque += torque;
  } else if (const JointDef* joint = find(def.joints, row)) {
    const auto [b1, b2] = numbers(*joint);
    const Vec3 along = motions[b1].R * frame1(*joint).R.c[2] * force;
    if (joint->type == JointType::revolute) {
      wrenches[b1].torque -= along;
      wrenches[b2].torque += along;
    } else {
      const Vec3 point = motion_of_point(motions[b2], frame2(*joint).p).p;
      add_force(motions[b1], point, -along, wrenches[b1]);
      add_force(motions[b2], point, along, wrenches[b2]);
    }
  } else {
    throw std::invalid_argument("no row " + row);
  }
}

RowMotion row_motion(const MechanicsDef& def, const std::string& row, const Motions& motions) {
  if (const TranslationalForceDef* force = find(def.translational_forces, row)) {
    const Line line = line_of(def, *force, motions);
    return {.x = line.x, .v = line.v, .a = line.a};
  }
  if (const RotationalForceDef* force = find(def.rotational_forces, row)) {
    const Angle angle = angle_of(def, *force, motions);
    return {.x = angle.x, .v = angle.v, .a = angle.a, .is_angle = true};
  }
  const JointDef* joint = find(def.joints, row);
  if (joint == nullptr) throw std::invalid_argument("no row " + row);
  return joint_motion(def, *joint, motions);
}

}  // namespace slew::multibody::testing
