// SPDX-License-Identifier: Apache-2.0
#include "core/index.h"
#include "multibody/constraints/rows.h"
#include "multibody/formulations/body_passes.h"
#include "multibody/formulations/row_hold.h"

namespace slew::multibody {

using math::Vec3;

namespace {

void add(Vec3 a, double* x) noexcept {
  for (int k = 0; k < 3; ++k) x[k] += a[k];
}

BodyRow joint_row(const Model& model, const BodyModel& body, const State& joints, const Row& row,
                  const Workspace& ws) noexcept {
  BodyRow result;
  if (row.link == 0) {
    const Constraint& cut = model.cuts[at(model.joints[at(row.element)].cut)];
    const RowValue value = coordinate_of_cut(model, row, ws);
    return {cut.link1, cut.link2, value.G, value.g, value.rate, value.bias};
  }
  const Link& link = model.links[at(row.link)];
  result.link1 = link.parent;
  result.link2 = row.link;
  result.x = joints.q[at(link.q + row.place)];
  result.v = joints.u[at(link.u + row.place)];
  const LinkMotion& parent = ws.motion[at(link.parent)];
  const LinkMotion& child = ws.motion[at(row.link)];
  if (link.joint == LinkJoint::universal) {
    const ConstraintRow turn = coordinate_row(JointType::universal, row.place);
    const RowValue value = evaluate(turn, body.joints[at(row.link)], parent, child, {});
    result.J = value.G;
    result.bias = value.bias;
    return result;
  }
  if (link.joint == LinkJoint::revolute || (link.joint == LinkJoint::cylindrical && row.place == 0)) {
    result.J.w1 = -child.axis;
    result.J.w2 = child.axis;
    result.bias = dot(cross(child.w, child.axis), child.w - parent.w);
    return result;
  }
  // displacement: minus the position of the parent's point along z of the child
  const Constraint& joint = body.joints[at(row.link)];
  const RowValue slide = evaluate(ConstraintRow{.form = RowForm::in_plane_of_2, .axis2 = 2}, joint, parent, child, {});
  result.J = {-slide.G.v1, -slide.G.w1, -slide.G.v2, -slide.G.w2};
  result.bias = -slide.bias;
  return result;
}

}  // namespace

BodyRow body_row(const Model& model, const BodyModel& body, const State& joints, const Row& row,
                 const Workspace& ws) noexcept {
  BodyRow result;
  switch (row.kind) {
    case RowKind::length: {
      const LineElement& element = model.lines[at(row.element)];
      const LineMotion& line = ws.lines[at(row.element)];
      result.link1 = element.link1;
      result.link2 = element.link2;
      const Vec3 s1 = line.P1 - ws.motion[at(element.link1)].p, s2 = line.P2 - ws.motion[at(element.link2)].p;
      result.J = {line.e, cross(s1, line.e), -line.e, cross(line.e, s2)};
      result.x = line.length;
      result.v = line.rate;
      result.bias = bias_of_length(element, line, ws);
      return result;
    }
    case RowKind::angle: {
      const AngleElement& element = model.angles[at(row.element)];
      const AngleMotion& angle = ws.angles[at(row.element)];
      result.link1 = element.link1;
      result.link2 = element.link2;
      result.J.w1 = -angle.n;
      result.J.w2 = angle.n;
      result.x = angle.angle;
      result.v = angle.rate;
      result.bias = bias_of_angle(element, angle, ws);
      return result;
    }
    case RowKind::ball: {
      const Joint& joint = model.joints[at(row.element)];
      const RowValue turn = turn_of_ball(model, row, ws);
      return {model.bodies[at(joint.body1)].link, model.bodies[at(joint.body2)].link, turn.G, 0, turn.rate, turn.bias};
    }
    case RowKind::joint:
      return joint_row(model, body, joints, row, ws);
  }
  return result;
}

void add_row(const BodyRow& row, double force, const math::BlockLdl& ldl, std::span<double> x) noexcept {
  const auto push = [&](int link, Vec3 v, Vec3 w) {
    if (link == 0) return;
    double* a = x.data() + ldl.first_row(link - 1);
    add(v * force, a);
    add(w * force, a + 3);
  };
  push(row.link1, row.J.v1, row.J.w1);
  push(row.link2, row.J.v2, row.J.w2);
}

double along(const BodyRow& row, const math::BlockLdl& ldl, std::span<const double> x) noexcept {
  double sum = 0;
  const auto add = [&](int link, Vec3 v, Vec3 w) {
    if (link == 0) return;
    const double* a = x.data() + ldl.first_row(link - 1);
    sum += dot(v, Vec3(a[0], a[1], a[2])) + dot(w, Vec3(a[3], a[4], a[5]));
  };
  add(row.link1, row.J.v1, row.J.w1);
  add(row.link2, row.J.v2, row.J.w2);
  return sum;
}

void answer_rows(const Model& model, const BodyModel& body, const State& joints, const math::BlockLdl& ldl,
                 std::span<const double> responses, Workspace& ws, std::span<double> accelerations) noexcept {
  RowHold& hold = *ws.hold;
  const std::size_t size = accelerations.size();
  for (std::size_t k = 0; k < model.rows.size(); ++k) {
    double excess = 0;
    if (ws.row_is_active[k] != 0) {
      const BodyRow row = body_row(model, body, joints, model.rows[k], ws);
      excess = row.bias + along(row, ldl, accelerations) - hold.expected(k, ws.time);
    }
    hold.set_excess(k, excess);
  }
  const std::span<const double> forces = hold.answer();
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (ws.row_is_active[k] == 0 || forces[k] == 0) continue;
    const double* response = responses.data() + k * size;
    for (std::size_t i = 0; i < size; ++i) accelerations[i] += response[i] * forces[k];
  }
}

}  // namespace slew::multibody
