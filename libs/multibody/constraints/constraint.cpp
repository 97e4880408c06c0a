// SPDX-License-Identifier: Apache-2.0
#include "multibody/constraints/constraint.h"

#include <cmath>

#include "core/check.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

constexpr int kX = 0, kY = 1, kZ = 2;
// sine of the angle below which the hinges of a massless link are taken as parallel
constexpr double kParallel = 1e-6;

ConstraintRow in_plane(int axis, double offset = 0) noexcept {
  return {.form = RowForm::in_plane, .axis1 = axis, .offset = offset};
}

ConstraintRow perpendicular(int axis1, int axis2, double offset = 0) {
  return {.form = RowForm::perpendicular, .axis1 = axis1, .axis2 = axis2, .offset = offset};
}

// a frame's point and axes in Ground, and their motion
struct Side {
  Vec3 s, P, w, v;   // from the link's origin [m], m, rad/s, m/s
  Vec3 centripetal;  // w x (w x s) [m/s2]
  std::array<Vec3, 3> axes;
};

Side side_of(const LinkMotion& link, const Mat3& R_L, Vec3 p_L) noexcept {
  Side side;
  side.s = link.R * p_L;
  side.P = link.p + side.s;
  side.w = link.w;
  const Vec3 turn = cross(link.w, side.s);
  side.v = link.v + turn;
  side.centripetal = cross(link.w, turn);
  for (int k = 0; k < 3; ++k) side.axes[static_cast<std::size_t>(k)] = link.R * R_L.c[k];
  return side;
}

RowValue in_plane(const Side& one, const Side& two, Vec3 a, double offset) noexcept {
  const Vec3 d = two.P - one.P, d_rate = two.v - one.v;
  const Vec3 a_rate = cross(one.w, a);
  RowValue row;
  row.g = dot(a, d) - offset;
  row.rate = dot(a, d_rate) + dot(a_rate, d);
  row.bias = dot(a, two.centripetal - one.centripetal) + 2 * dot(a_rate, d_rate) + dot(cross(one.w, a_rate), d);
  row.G = {-a, cross(a, one.s + d), a, cross(two.s, a)};
  return row;
}

RowValue exchanged(const RowValue& row) noexcept {
  return {row.g, row.rate, row.bias, {row.G.v2, row.G.w2, row.G.v1, row.G.w1}};
}

RowValue perpendicular(const Side& one, const Side& two, Vec3 a, Vec3 b, double offset) noexcept {
  const Vec3 a_rate = cross(one.w, a), b_rate = cross(two.w, b), normal = cross(a, b);
  RowValue row;
  row.g = dot(a, b) - offset;
  row.rate = dot(one.w - two.w, normal);
  row.bias = dot(cross(one.w, a_rate), b) + 2 * dot(a_rate, b_rate) + dot(a, cross(two.w, b_rate));
  row.G = {Vec3(), normal, Vec3(), -normal};
  return row;
}

RowValue distance(const Side& one, const Side& two, double length) noexcept {
  const Vec3 d = two.P - one.P, d_rate = two.v - one.v;
  const Vec3 e = d * (1 / length);
  RowValue row;
  row.g = 0.5 * (dot(d, e) - length);
  row.rate = dot(e, d_rate);
  row.bias = dot(e, two.centripetal - one.centripetal) + dot(d_rate, d_rate) / length;
  row.G = {-e, cross(e, one.s), e, cross(two.s, e)};
  return row;
}

// angle of a direction of side 2 in the plane of p and q, both at a right angle to `axis`, which belongs to `holder`
RowValue angle_about(Vec3 axis, Vec3 p, Vec3 q, Vec3 direction, const Side& holder, const Side& one, const Side& two) {
  const Vec3 w = two.w - one.w;
  RowValue row;
  row.g = std::atan2(dot(direction, q), dot(direction, p));
  row.rate = dot(axis, w);
  row.bias = dot(cross(holder.w, axis), w);
  row.G = {Vec3(), -axis, Vec3(), axis};
  return row;
}

RowValue evaluate(const ConstraintRow& row, const Side& one, const Side& two) noexcept {
  const Vec3 a = one.axes[static_cast<std::size_t>(row.axis1)], b = two.axes[static_cast<std::size_t>(row.axis2)];
  switch (row.form) {
    case RowForm::in_plane:
      return in_plane(one, two, a, row.offset);
    case RowForm::in_plane_of_2:
      return exchanged(in_plane(two, one, b, row.offset));
    case RowForm::perpendicular:
      return perpendicular(one, two, a, b, row.offset);
    case RowForm::distance:
      return distance(one, two, row.offset);
    case RowForm::turn:
      return angle_about(one.axes[kZ], one.axes[kX], one.axes[kY], two.axes[kX], one, one, two);
    case RowForm::first_turn:
      return angle_about(one.axes[kZ], one.axes[kX], one.axes[kY], two.axes[kZ], one, one, two);
    case RowForm::second_turn:
      return angle_about(two.axes[kZ], cross(one.axes[kZ], two.axes[kZ]), one.axes[kZ], two.axes[kX], two, one, two);
  }
  return {};
}

// subtract the value of its law
RowValue evaluate(const ConstraintRow& row, const Side& one, const Side& two,
                  std::span<const MotionValue> drives) noexcept {
  constexpr double kTurn = 2 * 3.14159265358979323846;
  RowValue value = evaluate(row, one, two);
  if (row.drive < 0) return value;
  const MotionValue& law = drives[static_cast<std::size_t>(row.drive)];
  value.g -= law.position;
  if (is_angle(row.form)) value.g = std::remainder(value.g, kTurn);
  value.rate -= law.speed;
  value.bias -= law.acceleration;
  return value;
}

}  // namespace

std::vector<ConstraintRow> rows_of(JointType type, const Mat3& R_12, Vec3 p_12) {
  const std::vector<ConstraintRow> point = {in_plane(kX), in_plane(kY), in_plane(kZ)};
  const std::vector<ConstraintRow> parallel = {perpendicular(kX, kZ), perpendicular(kY, kZ)};
  const auto joined = [](std::vector<ConstraintRow> rows, std::initializer_list<ConstraintRow> more) {
    rows.insert(rows.end(), more);
    return rows;
  };
  const double length = norm(p_12);
  switch (type) {
    case JointType::floating:
      return {};
    case JointType::spherical:
      return point;
    case JointType::universal:
      return joined(point, {perpendicular(kZ, kZ)});
    case JointType::revolute:
      return joined(point, {parallel[0], parallel[1]});
    case JointType::fixed:
    case JointType::node:
      return joined(point, {parallel[0], parallel[1], perpendicular(kX, kY)});
    case JointType::cylindrical:
      return joined(parallel, {in_plane(kX), in_plane(kY)});
    case JointType::prismatic:
      return joined(parallel, {in_plane(kX), in_plane(kY), perpendicular(kX, kY)});
    case JointType::in_plane:
      return {in_plane(kZ)};
    case JointType::in_line:
      return {in_plane(kX), in_plane(kY)};
    case JointType::perpendicular:
      return {perpendicular(kZ, kZ)};
    case JointType::spherical_spherical:
      return {{.form = RowForm::distance, .offset = length}};
    case JointType::revolute_spherical:
      return {{.form = RowForm::distance, .offset = length}, in_plane(kZ, p_12.z())};
    case JointType::revolute_revolute: {
      const std::vector<ConstraintRow> hinged = {{.form = RowForm::distance, .offset = length}, in_plane(kZ, p_12.z())};
      const Vec3 z2 = R_12.c[kZ];
      // parallel hinges: their angle is at an extreme, its gradient zero
      if (std::hypot(z2.x(), z2.y()) < kParallel) return joined(hinged, {parallel[0], parallel[1]});
      return joined(hinged, {{.form = RowForm::in_plane_of_2, .axis2 = kZ, .offset = -dot(z2, p_12)},
                             perpendicular(kZ, kZ, z2.z())});
    }
  }
  SLEW_CHECK(false);
  return {};
}

ConstraintRow coordinate_row(JointType type, int number) noexcept {
  if (type == JointType::universal) return {.form = number == 0 ? RowForm::first_turn : RowForm::second_turn};
  if (type == JointType::prismatic || number == 1) return in_plane(kZ);
  return {.form = RowForm::turn};
}

Constraint constraint_between(const Model& model, int index) {
  const Joint& joint = model.joints[static_cast<std::size_t>(index)];
  const Body& body1 = model.bodies[static_cast<std::size_t>(joint.body1)];
  const Body& body2 = model.bodies[static_cast<std::size_t>(joint.body2)];
  Constraint constraint;
  constraint.joint = index;
  constraint.link1 = body1.link;
  constraint.link2 = body2.link;
  constraint.R_L1 = body1.R_LB * joint.R_B1;
  constraint.p_L1 = body1.p_LB + body1.R_LB * joint.p_B1;
  constraint.R_L2 = body2.R_LB * joint.R_B2;
  constraint.p_L2 = body2.p_LB + body2.R_LB * joint.p_B2;
  return constraint;
}

std::string describe(const ConstraintRow& row) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  switch (row.form) {
    case RowForm::in_plane:
      return std::string("position along ") + kAxes[row.axis1];
    case RowForm::in_plane_of_2:
      return std::string("position along ") + kAxes[row.axis2] + " of body 2";
    case RowForm::perpendicular:
      return std::string("angle between ") + kAxes[row.axis1] + " and " + kAxes[row.axis2] + " of body 2";
    case RowForm::distance:
      return "distance";
    case RowForm::turn:
    case RowForm::first_turn:
      return "angle about z";
    case RowForm::second_turn:
      return "angle about z of body 2";
  }
  return "";
}

void evaluate(const Constraint& constraint, const LinkMotion& link1, const LinkMotion& link2,
              std::span<const MotionValue> drives, std::span<RowValue> values) noexcept {
  const Side one = side_of(link1, constraint.R_L1, constraint.p_L1);
  const Side two = side_of(link2, constraint.R_L2, constraint.p_L2);
  for (std::size_t i = 0; i < constraint.rows.size(); ++i) values[i] = evaluate(constraint.rows[i], one, two, drives);
}

RowValue evaluate(const ConstraintRow& row, const Constraint& constraint, const LinkMotion& link1,
                  const LinkMotion& link2, std::span<const MotionValue> drives) noexcept {
  return evaluate(row, side_of(link1, constraint.R_L1, constraint.p_L1),
                  side_of(link2, constraint.R_L2, constraint.p_L2), drives);
}

RowValue coordinate(JointType type, int number, const Constraint& constraint, const LinkMotion& link1,
                    const LinkMotion& link2) noexcept {
  const Side one = side_of(link1, constraint.R_L1, constraint.p_L1);
  const Side two = side_of(link2, constraint.R_L2, constraint.p_L2);
  return evaluate(coordinate_row(type, number), one, two);
}

}  // namespace slew::multibody
