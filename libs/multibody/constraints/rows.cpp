// SPDX-License-Identifier: Apache-2.0
#include "multibody/constraints/rows.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/index.h"
#include "core/reductions.h"
#include "multibody/constraints/constraint.h"
#include "multibody/constraints/loops.h"
#include "multibody/forces/coupled_mass.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// unit force of a row on a link of its path: a force at a point, or a torque
struct UnitWrench {
  Vec3 force, torque;  // torque about the link's origin
};

void write_entries(const Model& model, const Workspace& ws, const Link& link, const LinkMotion& m,
                   const UnitWrench& wrench, std::span<double> J) noexcept {
  const std::size_t u = at(link.u);
  switch (link.joint) {
    case LinkJoint::revolute:
      J[u] = dot(m.axis, wrench.torque);
      break;
    case LinkJoint::prismatic:
      J[u] = dot(m.axis, wrench.force);
      break;
    case LinkJoint::spherical:
      for (std::size_t k = 0; k < 3; ++k) J[u + k] = wrench.torque[static_cast<int>(k)];
      break;
    case LinkJoint::floating:
      for (std::size_t k = 0; k < 3; ++k) {
        J[u + k] = wrench.force[static_cast<int>(k)];
        J[u + 3 + k] = wrench.torque[static_cast<int>(k)];
      }
      break;
    case LinkJoint::universal:
    case LinkJoint::cylindrical: {
      const Pair S = directions(link.joint, m);
      for (int k = 0; k < 2; ++k) {
        J[u + at(k)] = dot(S.turn[k], wrench.torque) + dot(S.slide[k], wrench.force);
      }
      break;
    }
    case LinkJoint::node: {
      const FlexiblePart& part = model.parts[at(model.nodes[at(link.node)].part)];
      const NodeMotion& node = ws.nodes[at(link.node)];
      for (std::size_t k = 0; k < part.modes; ++k) {
        J[at(part.u) + k] += dot(node.Psi[k], wrench.torque) + dot(node.Phi[k], wrench.force);
      }
      break;
    }
  }
}

const Constraint& cut_of(const Model& model, const Row& row) noexcept {
  return model.cuts[at(model.joints[at(row.element)].cut)];
}

void write_jacobian(const Model& model, const Workspace& ws, const Row& row, std::span<double> J) noexcept {
  if (row.kind == RowKind::joint && row.link > 0) {
    J[at(model.links[at(row.link)].u + row.place)] = 1;
    return;
  }
  const RowValue cut = row.kind == RowKind::joint  ? coordinate_of_cut(model, row, ws)
                       : row.kind == RowKind::ball ? turn_of_ball(model, row, ws)
                                                   : RowValue{};
  // two nodes of one part on the path
  for_each_mode(model, [&](std::size_t, std::size_t u) { J[u] = 0; });
  for (int i = row.first_path; i < row.path_end; ++i) {
    const PathEntry& entry = model.paths[at(i)];
    const LinkMotion& m = ws.motion[at(entry.link)];
    UnitWrench wrench;
    if (row.kind == RowKind::length) {
      // the unit force pushes P1 along e and P2 against it
      const LineMotion& line = ws.lines[at(row.element)];
      wrench.force = line.e * -entry.sign;
      wrench.torque = cross((entry.sign < 0 ? line.P1 : line.P2) - m.p, wrench.force);
    } else if (row.kind == RowKind::joint) {
      const Constraint& joint = cut_of(model, row);
      const Vec3 arm = ws.motion[at(entry.sign < 0 ? joint.link1 : joint.link2)].p - m.p;
      wrench.force = entry.sign < 0 ? cut.G.v1 : cut.G.v2;
      wrench.torque = (entry.sign < 0 ? cut.G.w1 : cut.G.w2) + cross(arm, wrench.force);
    } else if (row.kind == RowKind::ball) {
      wrench.torque = entry.sign < 0 ? cut.G.w1 : cut.G.w2;
    } else {
      wrench.torque = ws.angles[at(row.element)].n * entry.sign;
    }
    write_entries(model, ws, model.links[at(entry.link)], m, wrench, J);
  }
}

// coordinate, speed, and x'' with u' = 0
struct RowMotion {
  double x = 0, v = 0, bias = 0;
};

// of every row but those of a joint of the tree, which are coordinates of the state
RowMotion motion_between(const Model& model, const Row& row, const Workspace& ws) noexcept {
  switch (row.kind) {
    case RowKind::length: {
      const LineMotion& line = ws.lines[at(row.element)];
      return {line.length, line.rate, bias_of_length(model.lines[at(row.element)], line, ws)};
    }
    case RowKind::angle: {
      const AngleMotion& angle = ws.angles[at(row.element)];
      return {angle.angle, angle.rate, bias_of_angle(model.angles[at(row.element)], angle, ws)};
    }
    case RowKind::ball: {
      const RowValue turn = turn_of_ball(model, row, ws);
      const Joint& joint = model.joints[at(row.element)];
      return {0, turn.rate,
              acceleration_of(turn, ws.motion[at(model.bodies[at(joint.body1)].link)],
                              ws.motion[at(model.bodies[at(joint.body2)].link)])};
    }
    case RowKind::joint: {
      const RowValue cut = coordinate_of_cut(model, row, ws);
      const Constraint& joint = cut_of(model, row);
      return {cut.g, cut.rate, acceleration_of(cut, ws.motion[at(joint.link1)], ws.motion[at(joint.link2)])};
    }
  }
  return {};
}

bool is_in_tree(const Row& row) noexcept {
  return row.kind == RowKind::joint && row.link > 0;
}

double bias_in_tree(const Link& link, const Row& row, const Workspace& ws) noexcept {
  const int drive = link.drive[at(row.place)];
  return drive >= 0 ? ws.drives[at(drive)].acceleration : 0.0;
}

// gradient of a row and, by the present factors, its residual and rate
void pass_row_back(const Model& model, std::size_t k, Workspace& ws) noexcept {
  const Row& row = model.rows[k];
  const std::size_t dof = ws.udot.size();
  const std::span<double> J(ws.row_J.data() + k * dof, dof);
  write_jacobian(model, ws, row, J);
  const std::span<const int> supports(model.supports.data() + row.first_support,
                                      model.supports.data() + row.support_end);
  const std::span<double> residual(ws.row_residual.data() + k * dof, dof), rate(ws.row_rate.data() + k * dof, dof);
  if (!model.has_closing_rows()) return solve_backward(model, ws, supports, J, residual, rate);
  // loops reach links outside of the row's supports
  std::fill(residual.begin(), residual.end(), 0.0);
  std::fill(rate.begin(), rate.end(), 0.0);
  solve_backward(model, ws, supports, J, residual, rate);
  reduce_row(k, ws, residual, rate);
}

void evaluate_row(const Model& model, const State& state, std::size_t k, Workspace& ws) noexcept {
  const Row& row = model.rows[k];
  const std::size_t dof = ws.udot.size();
  RowMotion motion;
  if (is_in_tree(row)) {
    const Link& link = model.links[at(row.link)];
    motion = {state.q[at(link.q + row.place)], state.u[at(link.u + row.place)], bias_in_tree(link, row, ws)};
  } else {
    motion = motion_between(model, row, ws);
  }
  ws.row_x[k] = motion.x;
  ws.row_v[k] = motion.v;
  if (ws.row_is_active[k] == 0) {
    ws.row_a_free[k] = 0;
    return;
  }
  pass_row_back(model, k, ws);
  ws.row_a_free[k] = motion.bias + fixed_dot({ws.row_J.data() + k * dof, dof}, ws.udot_free);
}

}  // namespace

void respond(const Model& model, std::span<const double> forces, Workspace& ws, std::span<double> udot) noexcept {
  std::fill(ws.residual.begin(), ws.residual.end(), 0.0);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (ws.row_is_active[k] == 0 || forces[k] == 0) continue;
    pass_row_back(model, k, ws);
    const double* residual = ws.row_residual.data() + k * udot.size();
    for (std::size_t j = 0; j < udot.size(); ++j) ws.residual[j] += residual[j] * forces[k];
  }
  solve_forward(model, ws, ws.residual, udot);
}

double row_acceleration(const Model& model, const Workspace& ws, std::size_t row, std::span<const double> udot,
                        std::span<double> J) noexcept {
  const Row& own = model.rows[row];
  const double bias =
      is_in_tree(own) ? bias_in_tree(model.links[at(own.link)], own, ws) : motion_between(model, own, ws).bias;
  write_jacobian(model, ws, own, J);
  return bias + fixed_dot(J, udot);
}

const JointLaw& law_of(const Model& model, std::size_t row) noexcept {
  const Row& own = model.rows[row];
  return model.rows[own.kind == RowKind::ball ? row - at(own.number) : row].law;
}

double ball_speed(const Model& model, std::size_t row, std::span<const double> v) noexcept {
  const double* parts = v.data() + row - at(model.rows[row].number);
  return std::sqrt(parts[0] * parts[0] + parts[1] * parts[1] + parts[2] * parts[2]);
}

JointForce joint_force(const Model& model, std::size_t row, std::span<const double> x, std::span<const double> v,
                       double h, double z) noexcept {
  const JointLaw& law = law_of(model, row);
  if (model.rows[row].kind == RowKind::ball) return evaluate_part(law, v[row], ball_speed(model, row, v), h, z);
  return evaluate(law, x[row], v[row], h, z);
}

double joint_bristle_rate(const Model& model, std::size_t row, std::span<const double> v, double z) noexcept {
  const JointLaw& law = law_of(model, row);
  if (model.rows[row].kind == RowKind::ball) return bristle_rate_part(law, v[row], ball_speed(model, row, v), z);
  return bristle_rate(law, v[row], z);
}

RowValue turn_of_ball(const Model& model, const Row& row, const Workspace& ws) noexcept {
  const Joint& joint = model.joints[at(row.element)];
  const Body &body1 = model.bodies[at(joint.body1)], &body2 = model.bodies[at(joint.body2)];
  const LinkMotion &link1 = ws.motion[at(body1.link)], &link2 = ws.motion[at(body2.link)];
  const Vec3 axis = link1.R * (body1.R_LB * joint.R_B1.c[row.number]);
  const Vec3 w = link2.w - link1.w;
  RowValue turn;
  turn.rate = dot(axis, w);
  turn.bias = dot(cross(link1.w, axis), w);
  turn.G.w1 = -axis;
  turn.G.w2 = axis;
  return turn;
}

RowValue coordinate_of_cut(const Model& model, const Row& row, const Workspace& ws) noexcept {
  const Constraint& joint = cut_of(model, row);
  return coordinate(model.joints[at(row.element)].type, row.number, joint, ws.motion[at(joint.link1)],
                    ws.motion[at(joint.link2)]);
}

double bias_of_length(const LineElement& element, const LineMotion& line, const Workspace& ws) noexcept {
  const Vec3 a =
      acceleration_at(ws.motion[at(element.link1)], line.P1) - acceleration_at(ws.motion[at(element.link2)], line.P2);
  return dot(line.e, a) + (dot(line.w, line.w) - line.rate * line.rate) / line.length;
}

double bias_of_angle(const AngleElement& element, const AngleMotion& angle, const Workspace& ws) noexcept {
  const LinkMotion& link1 = ws.motion[at(element.link1)];
  const LinkMotion& link2 = ws.motion[at(element.link2)];
  // as seen from body 1
  const Vec3 w = link2.w - link1.w;
  const Vec3 alpha = link2.alpha - link1.alpha - cross(link1.w, w);
  if (element.is_coaxial) return dot(angle.n, alpha);
  const Vec3 f1 = link1.R * element.f1, g1 = link1.R * element.g1, f2 = link2.R * element.f2;
  const Vec3 rate = cross(w, f2);
  const Vec3 second = cross(alpha, f2) + cross(w, rate);
  const double c = dot(f2, f1), s = dot(f2, g1);
  const double c1 = dot(rate, f1), s1 = dot(rate, g1), c2 = dot(second, f1), s2 = dot(second, g1);
  const double rho = c * c + s * s;
  return (c * s2 - s * c2) / rho - 2 * (c * s1 - s * c1) * (c * c1 + s * s1) / (rho * rho);
}

namespace {

// Speeds of a row outside of which its residual is zero, as rows of other trees are: their products add nothing.
std::pair<std::size_t, std::size_t> range_of(std::span<const double> residual) noexcept {
  std::size_t begin = 0, end = residual.size();
  while (begin < end && residual[begin] == 0) ++begin;
  while (end > begin && residual[end - 1] == 0) --end;
  return {begin, end};
}

}  // namespace

void evaluate_rows(const Model& model, const State& state, Workspace& ws) noexcept {
  const std::size_t rows = model.rows.size(), dof = ws.udot.size();
  for (std::size_t k = 0; k < rows; ++k) evaluate_row(model, state, k, ws);
  for (std::size_t k = 0; k < rows; ++k) {
    const double* residual = ws.row_residual.data() + k * dof;
    const auto [begin, end] = range_of({residual, dof});
    for (std::size_t l = 0; l <= k; ++l) {
      const double* rate = ws.row_rate.data() + l * dof;
      double w = 0;
      const bool is_carried = ws.loops.pattern.ports.empty() || ws.loops.pattern.are_coupled(k, l);
      if (is_carried && ws.row_is_active[k] != 0 && ws.row_is_active[l] != 0) {
        for (std::size_t j = begin; j < end; ++j) w += residual[j] * rate[j];
      }
      ws.row_W[k * rows + l] = ws.row_W[l * rows + k] = w;
    }
  }
}

void activate_row(Workspace& ws, int row) noexcept {
  ws.row_is_active[at(row)] = 1;
}

void deactivate_row(Workspace& ws, int row) noexcept {
  ws.row_is_active[at(row)] = 0;
}

}  // namespace slew::multibody
