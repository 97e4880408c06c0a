// SPDX-License-Identifier: Apache-2.0
#include "urdf/placement.h"

#include <fmt/format.h>

#include <cmath>

#include "core/index.h"
#include "math/euler_angles.h"
#include "math/rotation.h"

namespace slew::urdf {

using math::Mat3;
using math::Vec3;

namespace {

// share of a joint's load below which its inertia about the axis is rounding
constexpr double kNoInertia = 1e-12;

Mat3 parallel_axes(double mass, Vec3 r) {
  const double square = dot(r, r);
  return (Mat3::diagonal(square, square, square) - outer(r, r)) * mass;
}

}  // namespace

std::vector<Group> find_groups(const Robot& robot) {
  std::vector<Group> groups(robot.links.size());
  for (const int link : robot.order) {
    const int joint = robot.parent_joint[at(link)];
    if (joint < 0 || robot.joints[at(joint)].kind != JointKind::fixed) {
      groups[at(link)] = {link, {}};
    } else {
      const Group& parent = groups[at(robot.joints[at(joint)].parent)];
      groups[at(link)] = {parent.head, parent.pose * pose_of(robot.joints[at(joint)].origin)};
    }
  }
  return groups;
}

Mat3 tensor_of(const Inertial& inertial) noexcept {
  const auto [xx, yy, zz] = inertial.moments;
  const auto [xy, xz, yz] = inertial.products;
  return {Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)};
}

Lump lump_of(const Inertial& inertial) noexcept {
  const Pose pose = pose_of(inertial.origin);
  return {.mass = inertial.mass,
          .h = pose.p * inertial.mass,
          .I = pose.R * tensor_of(inertial) * transpose(pose.R) + parallel_axes(inertial.mass, pose.p)};
}

Mat3 central_inertia(const Lump& lump) noexcept {
  return lump.mass > 0 ? lump.I - parallel_axes(lump.mass, lump.h * (1 / lump.mass)) : lump.I;
}

void add_lump(Lump& lump, const Lump& other, const Pose& pose) noexcept {
  const Vec3 centre = other.mass > 0 ? other.h * (1 / other.mass) : Vec3();
  const Vec3 r = pose.p + pose.R * centre;
  lump.mass += other.mass;
  lump.h += r * other.mass;
  lump.I += pose.R * central_inertia(other) * transpose(pose.R) + parallel_axes(other.mass, r);
}

Pose pose_of(const Origin& origin) noexcept {
  const auto [roll, pitch, yaw] = origin.rpy;
  Pose pose;
  if (roll != 0 || pitch != 0 || yaw != 0) {
    pose.R = math::rotation_z(yaw) * math::rotation_y(pitch) * math::rotation_x(roll);
  }
  pose.p = Vec3(origin.xyz);
  return pose;
}

Pose operator*(const Pose& a, const Pose& b) noexcept {
  return {a.R * b.R, a.p + a.R * b.p};
}

Pose inverse(const Pose& a) noexcept {
  return {transpose(a.R), -transpose_multiply(a.R, a.p)};
}

Triple without_rounding(const Triple& triple, double scale) noexcept {
  // rounding of a zero after a rotation of frames
  constexpr double kRounding = 1e-15;
  Triple clean = triple;
  for (double& value : clean) value = std::abs(value) <= kRounding * scale ? 0 : value;
  return clean;
}

Triple position_of(const Pose& pose) noexcept {
  return without_rounding(pose.p.array(), norm(pose.p));
}

Triple orientation_of(const Pose& pose) noexcept {
  return without_rounding(math::angles_zxz(pose.R), 1);
}

std::vector<Place> find_places(const Robot& robot, RootMount mount) {
  const std::vector<Group> groups = find_groups(robot);
  // the first body of each group, by its head
  std::vector<int> carrier(robot.links.size(), kOnGround);
  for (const int link : robot.order) {
    int& first = carrier[at(groups[at(link)].head)];
    if (first == kOnGround && robot.links[at(link)].inertial) first = link;
  }
  const bool is_fixed = mount == RootMount::fixed;
  std::vector<Place> places(robot.links.size());
  for (const int link : robot.order) {
    const Group& group = groups[at(link)];
    const bool is_on_ground = is_fixed && group.head == robot.root;
    const int body = carrier[at(group.head)];
    if (robot.links[at(link)].inertial) {
      places[at(link)] = {link, {}};
    } else if (is_on_ground) {
      places[at(link)] = {kOnGround, group.pose};
    } else {
      places[at(link)] = {body, inverse(groups[at(body)].pose) * group.pose};
    }
  }
  return places;
}

Pose start_pose(const Joint& joint) noexcept {
  Pose pose = pose_of(joint.origin);
  const double q = joint.start;
  if (q == 0) return pose;
  const Vec3 axis(joint.axis);
  if (joint.kind == JointKind::prismatic) return pose * Pose{Mat3::identity(), axis * q};
  // Rodrigues: R = 1 + sin q [a]x + (1 - cos q) [a]x [a]x
  const auto [s, c] = math::sin_cos(q);
  const Mat3 a = math::skew(axis);
  return pose * Pose{Mat3::identity() + a * s + a * a * (1 - c), {}};
}

void fix(Joint& joint) noexcept {
  if (joint.start != 0) {
    const Pose pose = start_pose(joint);
    const Mat3& R = pose.R;  // Rz(yaw) Ry(pitch) Rx(roll)
    joint.origin.xyz = pose.p.array();
    joint.origin.rpy = {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
                        std::atan2(R(1, 0), R(0, 0))};
  }
  joint.kind = JointKind::fixed;
  joint.mimic.reset();
  joint.start = joint.turns = 0;
}

std::vector<double> resistance_of_joints(const Robot& robot) {
  std::vector<Lump> lumps(robot.links.size());
  std::vector<double> resistance(robot.joints.size(), 0.0);
  for (auto link = robot.order.rbegin(); link != robot.order.rend(); ++link) {
    Lump& lump = lumps[at(*link)];
    if (robot.links[at(*link)].inertial) add_lump(lump, lump_of(*robot.links[at(*link)].inertial), {});
    const int index = robot.parent_joint[at(*link)];
    if (index < 0) continue;
    const Joint& joint = robot.joints[at(index)];
    const Vec3 axis(joint.axis);
    const double turning = dot(axis, lump.I * axis), all = lump.I(0, 0) + lump.I(1, 1) + lump.I(2, 2);
    resistance[at(index)] = joint.kind == JointKind::prismatic ? lump.mass : turning > kNoInertia * all ? turning : 0;
    if (joint.kind != JointKind::floating) add_lump(lumps[at(joint.parent)], lump, start_pose(joint));
  }
  return resistance;
}

}  // namespace slew::urdf
