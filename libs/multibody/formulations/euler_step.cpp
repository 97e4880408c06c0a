// SPDX-License-Identifier: Apache-2.0
// Semi-implicit Euler in joint coordinates, (1) of integrators.h: the cheapest step, with the minimum of passes.
#include <cstddef>

#include "multibody/constraints/loops.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/formulations/dynamics.h"
#include "multibody/formulations/integrators.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Vec3;

namespace {

void add_turn(std::span<double> q, std::size_t first, Vec3 turn) noexcept {
  const math::Quaternion start{q[first], q[first + 1], q[first + 2], q[first + 3]};
  const math::Quaternion turned = math::normalized(math::turn_by(turn) * start);
  q[first] = turned.w;
  q[first + 1] = turned.x;
  q[first + 2] = turned.y;
  q[first + 3] = turned.z;
}

// q_1 from the new speeds about the axes at the start, link by link; ws.delta_alpha takes their angular velocities
void move_on(const Model& model, double h, std::span<const double> u, std::span<double> q, Workspace& ws) noexcept {
  const std::span<Vec3> w = ws.delta_alpha;
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const LinkMotion& m = ws.motion[i];
    const auto qi = static_cast<std::size_t>(link.q), ui = static_cast<std::size_t>(link.u);
    const Vec3 w_parent = w[static_cast<std::size_t>(link.parent)];
    switch (link.joint) {
      case LinkJoint::revolute:
        q[qi] += h * u[ui];
        w[i] = w_parent + m.axis * u[ui];
        break;
      case LinkJoint::prismatic:
        q[qi] += h * u[ui];
        w[i] = w_parent;
        break;
      case LinkJoint::universal:
      case LinkJoint::cylindrical: {
        const Pair S = directions(link.joint, m);
        q[qi] += h * u[ui];
        q[qi + 1] += h * u[ui + 1];
        w[i] = w_parent + S.turn[0] * u[ui] + S.turn[1] * u[ui + 1];
        break;
      }
      case LinkJoint::spherical:
        w[i] = w_parent + load(u, link.u);
        add_turn(q, qi, w[i] * h);
        break;
      case LinkJoint::floating:
        for (std::size_t k = 0; k < 3; ++k) q[qi + k] += h * u[ui + k];
        w[i] = load(u, link.u + 3);
        add_turn(q, qi + 3, w[i] * h);
        break;
      case LinkJoint::node: {
        const FlexibleNode& node = model.nodes[static_cast<std::size_t>(link.node)];
        const std::size_t first = static_cast<std::size_t>(model.parts[static_cast<std::size_t>(node.part)].u);
        w[i] = w_parent;
        for (std::size_t k = 0; k < node.turn.size(); ++k) {
          w[i] += ws.nodes[static_cast<std::size_t>(link.node)].Psi[k] * u[first + k];
        }
        break;
      }
    }
  }
  for_each_mode(model, [&](std::size_t q_k, std::size_t u_k) { q[q_k] += h * u[u_k]; });
}

}  // namespace

bool advance_by_euler(const Model& model, State& state, Workspace& ws, double h,
                      std::span<const double> row_forces) noexcept {
  // without rows the accelerations are those of evaluate()
  if (!row_forces.empty()) accelerations(model, ws, row_forces, ws.udot);
  const std::vector<double>& udot = row_forces.empty() ? ws.udot_free : ws.udot;
  for (std::size_t j = 0; j < state.u.size(); ++j) state.u[j] += h * udot[j];
  if (model.has_closing_rows() && !is_near_singular(ws)) aim(model, h, state.u, ws);
  set_stage_time(model, state, h, ws);
  impose_speeds(model, ws, state.u);
  move_on(model, h, state.u, state.q, ws);
  impose_positions(model, ws, state.q);
  const bool is_closed = !model.has_closing_rows() || project_step(model, h, state.q, state.u, ws);
  state.time += h;
  if (ws.contact != nullptr) {
    if (!are_shown(model, state.q, state.u, ws)) show(model, state.q, state.u, ws);
    accept_contacts(model, h, state, ws);
  }
  return is_closed;
}

}  // namespace slew::multibody
