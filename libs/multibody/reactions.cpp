#include <algorithm>
#include <cstddef>

#include "multibody/coupled_mass.h"
#include "multibody/dynamics.h"
#include "multibody/element_law.h"
#include "multibody/observe.h"
#include "multibody/passes.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

// Gathers, body by body, the wrench that only the joints can supply: inertia forces less known forces.
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
  }

  // actuators; a joint row's force is part of what its joint transmits
  void subtract_rows(std::span<const double> row_forces) noexcept {
    for (std::size_t k = 0; k < row_forces.size(); ++k) {
      const Row& row = model_.rows[k];
      const std::size_t element = at(row.element);
      if (row.kind == RowKind::length) subtract_line(element, row_forces[k]);
      if (row.kind == RowKind::angle) subtract_angle(model_.angles[element], ws_.angles[element].n * row_forces[k]);
    }
  }

  // from the tips towards Ground: a body's joint supplies what the body and its children need
  void pass_on(std::span<JointReaction> reactions) noexcept {
    for (std::size_t k = model_.body_order.size(); k-- > 0;) {
      const auto child = at(model_.body_order[k]);
      const Body& body = model_.bodies[child];
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

}  // namespace

void joint_reactions(const Model& model, const State& state, Workspace& ws, std::span<const double> row_forces,
                     std::span<JointReaction> reactions) noexcept {
  forward_dynamics(model, state.q, state.u, row_forces, ws);
  if (!model.welded.empty())
    update_elements(model, state.q, Elements::all, ws);  // their lines need no motion in a step
  std::fill(reactions.begin(), reactions.end(), JointReaction{});
  ReactionSum sum(model, ws);
  for (const LumpedMass& part : model.lumped) {
    if (part.owner >= 0) sum.add_inertia(part);
  }
  for (const CoupledMass& mass : model.coupled) sum.add_coupled(mass);
  for (const CoupledMass& mass : model.welded) sum.add_coupled(mass);
  sum.subtract_elements();
  sum.subtract_rows(row_forces);
  sum.pass_on(reactions);
}

}  // namespace slew::multibody
