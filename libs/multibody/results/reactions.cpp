// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>

#include "core/index.h"
#include "multibody/constraints/constraint.h"
#include "multibody/constraints/loops.h"
#include "multibody/constraints/rows.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/forces/coupled_mass.h"
#include "multibody/forces/element_law.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/passes.h"
#include "multibody/results/observe.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// Sums, body by body, the wrench required from the joints: inertia forces less known forces.
class ReactionSum {
 public:
  ReactionSum(const Model& model, Workspace& ws) : model_(model), ws_(ws) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) ws.body_n[i] = ws.body_f[i] = Vec3();
  }

  void add(int body, Vec3 point, Vec3 force, Vec3 moment = Vec3()) noexcept {
    const Vec3 arm = point - ws_.motion[at(model_.bodies[at(body)].link)].p;
    ws_.body_f[at(body)] += force;
    ws_.body_n[at(body)] += moment + cross(arm, force);
  }

  // acceleration of a point of a link, less gravity, with the u' of the last forward dynamics
  [[nodiscard]] Vec3 acceleration(int link, Vec3 point) const noexcept {
    const LinkMotion& m = ws_.motion[at(link)];
    return acceleration_at(m, point) + ws_.delta_a[at(link)] + cross(ws_.delta_alpha[at(link)], point - m.p);
  }

  void add_inertia(const LumpedMass& part) noexcept {
    const LinkMotion& m = ws_.motion[at(part.link)];
    const Vec3 center = m.p + m.R * part.c_L;
    const double share = part.reference_mass > 0 ? part.mass / part.reference_mass : 0;
    const Mat3 I = m.R * part.I_c * transpose(m.R) * share;
    const Vec3 alpha = m.alpha + ws_.delta_alpha[at(part.link)];
    add(part.owner, center, acceleration(part.link, center) * part.mass, I * alpha + cross(m.w, I * m.w));
  }

  void add_modes(std::size_t index) noexcept {
    const FlexiblePart& part = model_.parts[index];
    const LinkMotion& m = ws_.motion[at(part.link)];
    const std::span<const double> udot(ws_.udot.data() + part.u, part.modes);
    const PartWrench wrench =
        wrench_of(ws_.parts[index], udot, m.alpha + ws_.delta_alpha[at(part.link)], m.a + ws_.delta_a[at(part.link)]);
    add(part.body, m.p, wrench.f, wrench.n);
  }

  void add_coupled(const CoupledMass& mass) noexcept {
    const LineElement& element = model_.lines[at(mass.line)];
    const LineMotion& line = ws_.lines[at(mass.line)];
    const PointForces forces =
        point_forces(mass, line, acceleration(element.link1, line.P1), acceleration(element.link2, line.P2));
    add(element.body1, line.P1, forces.F1);
    add(element.body2, line.P2, forces.F2);
  }

  void subtract_line(std::size_t index, double force) noexcept {
    const LineElement& element = model_.lines[index];
    const LineMotion& line = ws_.lines[index];
    add(element.body1, line.P1, line.e * -force);
    add(element.body2, line.P2, line.e * force);
  }

  void subtract_angle(const AngleElement& element, Vec3 torque) noexcept {
    ws_.body_n[at(element.body2)] -= torque;
    ws_.body_n[at(element.body1)] += torque;
  }

  void subtract_elements() noexcept {
    for (std::size_t i = 0; i < model_.lines.size(); ++i) {
      const LineMotion& line = ws_.lines[i];
      const ElementLaw& law = model_.lines[i].law;
      if (law.is_active) subtract_line(i, force_of(law, line.length, line.rate, line.rate));
    }
    for (std::size_t i = 0; i < model_.angles.size(); ++i) {
      const AngleElement& element = model_.angles[i];
      if (element.law.is_active) subtract_angle(element, torque_of(element, ws_.angles[i], ws_));
    }
    for_each_wrench(model_.elements, ws_.motion, ws_.time, [this](int, int body, const Wrench& wrench) {
      ws_.body_f[at(body)] -= wrench.f;
      ws_.body_n[at(body)] -= wrench.n;
    });
  }

  void subtract_contacts() noexcept {
    if (ws_.contact == nullptr) return;
    for (std::size_t i = 0; i < ws_.contact->force_count; ++i) {
      const ContactForce& force = ws_.contact->forces[i];
      const Vec3 F = force.normal_W + force.friction_W;
      add(model_.contact->frames[at(force.frame_a)].body, force.p_W, -F);
      add(model_.contact->frames[at(force.frame_b)].body, force.p_W, F);
    }
  }

  // actuators; a joint row's force is part of what its joint transmits
  void subtract_rows(std::span<const double> row_forces, std::span<JointReaction> reactions) noexcept {
    for (std::size_t k = 0; k < row_forces.size(); ++k) {
      const Row& row = model_.rows[k];
      if ((row.kind == RowKind::joint || row.kind == RowKind::ball) && row.link == 0) {
        RowGradient wrench;
        add(row.kind == RowKind::ball ? turn_of_ball(model_, row, ws_).G : coordinate_of_cut(model_, row, ws_).G,
            row_forces[k], wrench);
        transmit(model_.cuts[at(model_.joints[at(row.element)].cut)], wrench, reactions);
        continue;
      }
      const std::size_t element = at(row.element);
      if (row.kind == RowKind::length) subtract_line(element, row_forces[k]);
      if (row.kind == RowKind::angle) subtract_angle(model_.angles[element], ws_.angles[element].n * row_forces[k]);
    }
  }

  // forces of the rows of cut joints on their bodies, which are the reactions of these joints
  void subtract_cuts(std::span<const double> forces, std::span<JointReaction> reactions) noexcept {
    for (const Cut& cut : model_.cuts) {
      RowGradient sum;
      for (std::size_t k = 0; k < cut.rows.size(); ++k) {
        add(ws_.loops.rows[at(cut.first_row) + k].G, forces[at(cut.first_row) + k], sum);
      }
      transmit(cut, sum, reactions);
    }
  }

  void transmit(const Cut& cut, const RowGradient& wrench, std::span<JointReaction> reactions) noexcept {
    const Joint& joint = model_.joints[at(cut.joint)];
    ws_.body_f[at(joint.body1)] -= wrench.v1;
    ws_.body_n[at(joint.body1)] -= wrench.w1;
    ws_.body_f[at(joint.body2)] -= wrench.v2;
    ws_.body_n[at(joint.body2)] -= wrench.w2;
    const Vec3 point = ws_.motion[at(cut.link2)].p + ws_.motion[at(cut.link2)].R * cut.p_L2;
    const Vec3 moment = wrench.w1 - cross(point - ws_.motion[at(cut.link1)].p, wrench.v1);
    JointReaction& reaction = reactions[at(cut.joint)];
    reaction.force = (Vec3(reaction.force) + wrench.v1).array();
    reaction.moment = (Vec3(reaction.moment) + moment).array();
  }

  static void add(const RowGradient& G, double force, RowGradient& sum) noexcept {
    sum.v1 += G.v1 * force;
    sum.w1 += G.w1 * force;
    sum.v2 += G.v2 * force;
    sum.w2 += G.w2 * force;
  }

  // from the tips towards Ground: a body's joint supplies the wrench of the body and its children
  void pass_on(std::span<JointReaction> reactions) noexcept {
    for (std::size_t k = model_.body_order.size(); k-- > 0;) {
      const auto child = at(model_.body_order[k]);
      const Body& body = model_.bodies[child];
      if (body.joint < 0) continue;  // free in the tree
      const Joint& joint = model_.joints[at(body.joint)];
      const Vec3 origin = ws_.motion[at(body.link)].p;
      const Vec3 f = ws_.body_f[child], n = ws_.body_n[child];
      add(body.parent, origin, f, n);
      const Body& second = model_.bodies[at(joint.body2)];
      const LinkMotion& m = ws_.motion[at(second.link)];
      const Vec3 point = m.p + m.R * (second.p_LB + second.R_LB * joint.p_B2);
      // the wrench on the child, turned to act on body 1
      const double sign = joint.is_reversed ? 1 : -1;
      reactions[at(body.joint)] = {(f * sign).array(), ((n + cross(origin - point, f)) * sign).array()};
    }
  }

 private:
  const Model& model_;
  Workspace& ws_;
};

// Reactions of a unit force in a redundant row, which the independent rows and the tree balance without any motion:
// W_kk f_k = -W_kd.
void find_unit_reactions(const Model& model, const Cut& cut, const ConstraintRow& row, Workspace& ws,
                         std::span<JointReaction> reactions) noexcept {
  LoopWorkspace& loops = ws.loops;
  const std::size_t speeds = ws.udot.size();
  const RowValue value = evaluate(row, cut, ws.motion[at(cut.link1)], ws.motion[at(cut.link2)], ws.drives);
  const std::span<const int> supports(model.supports.data() + cut.first_support,
                                      model.supports.data() + cut.support_end);
  std::fill(ws.unit_rate.begin(), ws.unit_rate.end(), 0.0);
  solve_backward(model, ws, supports, cut.link1, cut.link2, {&value, 1}, ws.unit_residual, ws.unit_rate);
  for (std::size_t k = 0; k < loops.rows.size(); ++k) {
    double w = 0;
    for (std::size_t j = 0; j < speeds; ++j) w += loops.residual[k * speeds + j] * ws.unit_rate[j];
    loops.multipliers[k] = -w;
  }
  loops.factor.solve(loops.multipliers);
  ReactionSum sum(model, ws);
  std::fill(reactions.begin(), reactions.end(), JointReaction{});
  sum.transmit(cut, value.G, reactions);
  sum.subtract_cuts(loops.multipliers, reactions);
  sum.pass_on(reactions);
}

// The reactions to this motion with the smallest sum of squares of forces [N] and moments [N m].
void take_smallest(const Model& model, Workspace& ws, std::span<JointReaction> reactions) noexcept {
  const std::size_t joints = model.joints.size(), units = ws.unit_shares.size();
  std::copy(reactions.begin(), reactions.end(), ws.found_reactions.begin());
  std::size_t unit = 0;
  for (const Cut& cut : model.cuts) {
    for (const ConstraintRow& row : cut.redundant) {
      find_unit_reactions(model, cut, row, ws, reactions);
      for (std::size_t j = 0; j < joints; ++j) {
        ws.unit_force[unit * joints + j] = Vec3(reactions[j].force);
        ws.unit_moment[unit * joints + j] = Vec3(reactions[j].moment);
      }
      ++unit;
    }
  }
  for (std::size_t k = 0; k < units; ++k) {
    for (std::size_t l = 0; l <= k; ++l) {
      double sum = 0;
      for (std::size_t j = 0; j < joints; ++j) {
        sum += dot(ws.unit_force[k * joints + j], ws.unit_force[l * joints + j]) +
               dot(ws.unit_moment[k * joints + j], ws.unit_moment[l * joints + j]);
      }
      ws.unit_products[k * units + l] = sum;
    }
    ws.unit_shares[k] = 0;
    for (std::size_t j = 0; j < joints; ++j) {
      ws.unit_shares[k] += dot(ws.unit_force[k * joints + j], Vec3(ws.found_reactions[j].force)) +
                           dot(ws.unit_moment[k * joints + j], Vec3(ws.found_reactions[j].moment));
    }
  }
  ws.unit_factor.factorize(ws.unit_products, {}, kDependent);
  ws.unit_factor.solve(ws.unit_shares);
  for (std::size_t j = 0; j < joints; ++j) {
    Vec3 force(ws.found_reactions[j].force), moment(ws.found_reactions[j].moment);
    for (std::size_t k = 0; k < units; ++k) {
      force -= ws.unit_force[k * joints + j] * ws.unit_shares[k];
      moment -= ws.unit_moment[k * joints + j] * ws.unit_shares[k];
    }
    reactions[j] = {force.array(), moment.array()};
  }
}

}  // namespace

void joint_reactions(const Model& model, const State& state, Workspace& ws, std::span<const double> row_forces,
                     std::span<JointReaction> reactions) noexcept {
  begin_contacts(model, state, ws);
  set_time(model, state.time, ws);
  forward_dynamics(model, state.q, state.u, row_forces, ws);
  if (!model.welded.empty())
    update_elements(model, state.q, Elements::all, ws);  // their lines need no motion in a step
  std::fill(reactions.begin(), reactions.end(), JointReaction{});
  ReactionSum sum(model, ws);
  for (const LumpedMass& part : model.lumped) {
    if (part.owner >= 0) sum.add_inertia(part);
  }
  for (std::size_t k = 0; k < model.parts.size(); ++k) sum.add_modes(k);
  for (const CoupledMass& mass : model.coupled) sum.add_coupled(mass);
  for (const CoupledMass& mass : model.welded) sum.add_coupled(mass);
  sum.subtract_elements();
  sum.subtract_contacts();
  sum.subtract_rows(row_forces, reactions);
  sum.subtract_cuts(ws.loops.multipliers, reactions);
  sum.pass_on(reactions);
  std::copy_n(ws.loops.multipliers.begin() + model.cut_row_count(), model.gears.size(), ws.gear_force.begin());
  if (!ws.unit_shares.empty()) take_smallest(model, ws, reactions);
}

}  // namespace slew::multibody
