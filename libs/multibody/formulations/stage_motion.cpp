// SPDX-License-Identifier: Apache-2.0
// From speeds to coordinates, motion and accelerations in an implicit stage, and back from body coordinates to joints.
#include <algorithm>

#include "core/index.h"
#include "multibody/constraints/loops.h"
#include "multibody/constraints/rows.h"
#include "multibody/contacts/contact_passes.h"
#include "multibody/contacts/contact_stiffness.h"
#include "multibody/formulations/passes.h"
#include "multibody/formulations/stage_passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Vec3;

namespace {

void place_bodies(const StageContext& at, double sigma) noexcept {
  BodyState& state = *at.moving.bodies;
  const StageWorkspace& s = at.stages;
  for (std::size_t link = 1; link < at.model.links.size(); ++link) {
    const std::size_t q = 7 * (link - 1), u = 6 * (link - 1);
    for (std::size_t k = 0; k < 3; ++k) state.q[q + k] = s.q_0[q + k] + s.base[u + k] + sigma * state.u[u + k];
    const int w = static_cast<int>(u) + 3;
    const Vec3 turn = load(s.base, w) + load(state.u, w) * sigma;
    const math::Quaternion start{s.q_0[q + 3], s.q_0[q + 4], s.q_0[q + 5], s.q_0[q + 6]};
    const math::Quaternion turned = math::normalized(math::turn_by(turn) * start);
    state.q[q + 3] = turned.w;
    state.q[q + 4] = turned.x;
    state.q[q + 5] = turned.y;
    state.q[q + 6] = turned.z;
  }
  const std::size_t links = at.model.links.size() - 1;
  for (std::size_t k = 0; k < state.u.size() - 6 * links; ++k) {
    const std::size_t q = 7 * links + k, u = 6 * links + k;
    state.q[q] = s.q_0[q] + s.base[u] + sigma * state.u[u];
  }
  update_body_motion(at.model, state, at.ws);
  find_joint_coordinates(at.model, at.ws, at.moving.joints);
}

void add_joint_accelerations(const Model& model, std::span<const double> rate, Workspace& ws) noexcept {
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    LinkMotion& m = ws.motion[i];
    Vec3 alpha = ws.delta_alpha[slew::at(link.parent)];
    Vec3 a = ws.delta_a[slew::at(link.parent)] + cross(alpha, m.r);
    switch (link.joint) {
      case LinkJoint::revolute:
        alpha += m.axis * rate[slew::at(link.u)];
        break;
      case LinkJoint::prismatic:
        a += m.axis * rate[slew::at(link.u)];
        break;
      case LinkJoint::spherical:
        alpha += load(rate, link.u);
        break;
      case LinkJoint::floating:
        a = load(rate, link.u);
        alpha = load(rate, link.u + 3);
        break;
      case LinkJoint::universal:
      case LinkJoint::cylindrical: {
        const Pair S = directions(link.joint, m);
        const double first = rate[slew::at(link.u)], second = rate[slew::at(link.u) + 1];
        alpha += S.turn[0] * first + S.turn[1] * second;
        a += S.slide[0] * first + S.slide[1] * second;
        break;
      }
      case LinkJoint::node: {
        const auto node = slew::at(link.node);
        const auto first = slew::at(model.parts[slew::at(model.nodes[node].part)].u);
        for (std::size_t k = 0; k < ws.nodes[node].Phi.size(); ++k) {
          alpha += ws.nodes[node].Psi[k] * rate[first + k];
          a += ws.nodes[node].Phi[k] * rate[first + k];
        }
        break;
      }
    }
    ws.delta_alpha[i] = alpha;
    ws.delta_a[i] = a;
    m.alpha += alpha;
    m.a += a;
  }
}

void add_body_accelerations(std::span<const double> rate, Workspace& ws) noexcept {
  for (std::size_t i = 1; i < ws.motion.size(); ++i) {
    const int u = 6 * (static_cast<int>(i) - 1);
    ws.motion[i].a += load(rate, u);
    ws.motion[i].alpha += load(rate, u + 3);
  }
}

}  // namespace

void place(const StageContext& at, double sigma) noexcept {
  if (at.moving.bodies != nullptr) return place_bodies(at, sigma);
  const StageWorkspace& s = at.stages;
  impose_speeds(at.model, at.ws, at.moving.joints.u);
  move_from(at.model, s.q_0, {sigma, s.base, s.turn}, at.moving.joints.u, at.moving.joints.q, at.ws);
}

void add_accelerations(const StageContext& at, std::span<const double> rate) noexcept {
  if (at.moving.bodies != nullptr) return add_body_accelerations(rate, at.ws);
  add_joint_accelerations(at.model, rate, at.ws);
}

namespace {

// accelerations of all modes in the stage
std::span<const double> modal_rate(const StageContext& at) noexcept {
  const std::size_t first =
      at.moving.bodies != nullptr ? 6 * at.moving.bodies->links() : slew::at(at.model.parts.front().u);
  return std::span<const double>(at.stages.rate).subspan(first);
}

// forces of all active rows onto bws.solution
void push_by_rows(const StageContext& at, std::span<const double> forces) noexcept {
  for (std::size_t k = 0; k < at.model.rows.size(); ++k) {
    if (at.ws.row_is_active[k] == 0) continue;
    add_row(body_row(at.model, at.body, at.moving.joints, at.model.rows[k], at.ws), forces[k], at.bws.ldl,
            at.bws.solution);
  }
}

// wrenches M a - Q of all links and modes, without those of rows
void find_wrenches(const StageContext& at, const Stage& stage) noexcept {
  StageWorkspace& s = at.stages;
  const std::span<const double> u = at.u();
  for (std::size_t j = 0; j < u.size(); ++j) s.rate[j] = (u[j] - s.fixed[j]) / stage.tau;
  // the motion holds the accelerations of these links
  if (at.moving.bodies == nullptr) clear_prescribed(at.model, s.rate);
  update_elements(at.model, at.moving.joints.q, Elements::used, at.ws);
  update_contacts(at.model, at.ws);
  add_accelerations(at, s.rate);
  update_inertia(at.model, at.ws);
  if (!at.model.parts.empty()) add_modal_accelerations(at.model, modal_rate(at), at.ws);
  update_coupled(at.model, at.ws);
  apply_elements(at.model, at.ws);
  apply_contacts(at.model, at.ws);
}

// G^T lambda of all joints and gears, of the multipliers found so far, off bws.solution
void subtract_joints(const StageContext& at) noexcept {
  const math::BlockLdl& ldl = at.bws.ldl;
  const std::vector<double>& multipliers = at.stages.multipliers;
  const auto push = [&](int link, Vec3 v, Vec3 w, double lambda) {
    if (link == 0) return;
    double* x = at.bws.solution.data() + ldl.first_row(link - 1);
    subtract(v * lambda, x);
    subtract(w * lambda, x + 3);
  };
  for (std::size_t i = 1; i < at.body.joints.size(); ++i) {
    const Constraint& joint = at.body.joints[i];
    const double* lambda = multipliers.data() + ldl.first_row(static_cast<int>(i) - 1) + at.body.row_offset(i);
    for (std::size_t k = 0; k < joint.rows.size(); ++k) {
      const RowGradient& G = at.bws.rows[slew::at(at.bws.first_row[i]) + k].G;
      push(joint.link1, G.v1, G.w1, lambda[k]);
      push(joint.link2, G.v2, G.w2, lambda[k]);
    }
    if (joint.node < 0) continue;
    const auto part = slew::at(at.model.nodes[slew::at(joint.node)].part);
    const std::size_t modes = at.model.parts[part].modes;
    for (const ModalBlock& block : at.body.modal) {
      if (block.part != part) continue;
      double* x = at.bws.solution.data() + ldl.first_row(block.node);
      for (std::size_t k = 0; k < joint.rows.size(); ++k) {
        const double* m = at.bws.modal.data() + slew::at(at.bws.first_modal[i]) + k * modes + block.first;
        for (std::size_t j = 0; j < block.count; ++j) x[j] -= m[j] * lambda[k];
      }
    }
  }
  for (std::size_t k = 0; k < at.bws.gears.size(); ++k) {
    const double lambda = multipliers[slew::at(ldl.first_row(at.body.first_gear + static_cast<int>(k)))];
    for_each_end(at.bws.gears[k], [&](int link, Vec3 v, Vec3 w) { push(link, v, w, lambda); });
  }
}

}  // namespace

void find_residual(const StageContext& at, const Stage& stage) noexcept {
  find_wrenches(at, stage);
  evaluate_joints(at.model, at.body, at.moving.joints, at.ws, at.bws);
  put_bias(at.model, at.body, at.ws, at.bws);
  // rows of joints with the accelerations, where put_bias() left them out
  for (std::size_t i = 1; i < at.body.joints.size(); ++i) {
    const Constraint& joint = at.body.joints[i];
    double* x = at.bws.solution.data() + at.bws.ldl.first_row(static_cast<int>(i) - 1) + at.body.row_offset(i);
    for (std::size_t k = 0; k < joint.rows.size(); ++k) {
      const RowValue& row = at.bws.rows[slew::at(at.bws.first_row[i]) + k];
      x[k] = -acceleration_of(row, at.ws.motion[slew::at(joint.link1)], at.ws.motion[slew::at(joint.link2)]);
      if (joint.node < 0) continue;
      const auto part = slew::at(at.model.nodes[slew::at(joint.node)].part);
      const std::size_t modes = at.model.parts[part].modes;
      const double* m = at.bws.modal.data() + slew::at(at.bws.first_modal[i]) + k * modes;
      const double* rate = modal_rate(at).data() + modal_place(at.model, part);
      for (std::size_t j = 0; j < modes; ++j) x[k] -= m[j] * rate[j];
    }
  }
  for (std::size_t k = 0; k < at.bws.gears.size(); ++k) {
    const GearRow& gear = at.bws.gears[k];
    double g = gear.bias;
    for_each_end(gear, [&](int link, Vec3 v, Vec3 w) {
      g += dot(v, at.ws.motion[slew::at(link)].a) + dot(w, at.ws.motion[slew::at(link)].alpha);
    });
    at.bws.solution[slew::at(at.bws.ldl.first_row(at.body.first_gear + static_cast<int>(k)))] = -g;
  }
  push_by_rows(at, at.stages.row_force);
  subtract_joints(at);
  for (double& x : at.bws.solution) x *= stage.tau;
}

bool find_step_in_tree(const StageContext& at, const Stage& stage) noexcept {
  StageWorkspace& s = at.stages;
  Workspace& ws = at.ws;
  TreeMatrix& stiffness = *s.tree;
  const ChangeWeights weights{.position = stage.tau * stage.sigma, .rate = stage.tau};
  ws.shares = {.position = weights.position, .rate = weights.rate};
  find_wrenches(at, stage);
  ws.shares = {};
  std::copy(s.row_force.begin(), s.row_force.end(), ws.row_force.begin());
  std::fill(ws.tau.begin(), ws.tau.end(), 0.0);
  apply_row_forces(at.model, ws);
  stiffness.clear();
  add_stiffness(at.model, ws, weights, stiffness);
  add_contact_stiffness(at.model, ws, weights, stiffness);
  if (!stiffness.put(ws)) return false;
  ws.across = &stiffness;
  factorize(at.model, ws);
  ws.across = nullptr;
  if (at.model.has_closing_rows()) {
    evaluate_cuts(at.model, at.moving.joints.q, at.moving.joints.u, ws);
    factorize_cuts(at.model, ws);
    if (is_near_singular(ws)) return false;
    close_loops(at.model, ws);
  }
  solve_forward(at.model, ws, ws.residual, s.step);
  for (double& x : s.step) x *= stage.tau;
  return true;
}

void add_displacement(const StageContext& at, std::span<const double> moments) noexcept {
  StageWorkspace& s = at.stages;
  if (s.is_in_tree) {
    respond(at.model, moments, at.ws, s.step);
    for (std::size_t j = 0; j < s.base.size(); ++j) s.base[j] += s.step[j];
    for (std::size_t i = 1; i < s.turn.size(); ++i) s.turn[i] += at.ws.delta_alpha[i];
    return;
  }
  std::fill(at.bws.solution.begin(), at.bws.solution.end(), 0.0);
  push_by_rows(at, moments);
  at.bws.ldl.solve(at.bws.solution);
  read_step(at, s.step);
  for (std::size_t j = 0; j < s.base.size(); ++j) s.base[j] += s.step[j];
  for (std::size_t i = 1; i < s.turn.size(); ++i) {
    s.turn[i] += load(at.bws.solution, at.bws.ldl.first_row(static_cast<int>(i) - 1) + 3);
  }
}

void read_step(const StageContext& at, std::span<double> step) noexcept {
  if (at.moving.bodies != nullptr) return read_bodies(at.body, at.bws.ldl, at.bws.solution, step);
  const auto velocity = [&at](int link) {
    return link == 0 ? Vec3() : load(at.bws.solution, at.bws.ldl.first_row(link - 1));
  };
  const auto turning = [&at](int link) {
    return link == 0 ? Vec3() : load(at.bws.solution, at.bws.ldl.first_row(link - 1) + 3);
  };
  for (std::size_t i = 1; i < at.model.links.size(); ++i) {
    const Link& link = at.model.links[i];
    const LinkMotion& m = at.ws.motion[i];
    const int self = static_cast<int>(i);
    const Vec3 w = turning(self) - turning(link.parent);
    const Vec3 v = velocity(self) - velocity(link.parent) - cross(turning(link.parent), m.r);
    double* x = step.data() + link.u;
    switch (link.joint) {
      case LinkJoint::revolute:
        *x = dot(m.axis, w);
        break;
      case LinkJoint::prismatic:
        *x = dot(m.axis, v);
        break;
      case LinkJoint::spherical:
        store(step, link.u, w);
        break;
      case LinkJoint::floating:
        store(step, link.u, velocity(self));
        store(step, link.u + 3, turning(self));
        break;
      case LinkJoint::universal:
        x[0] = dot(m.axis1, w);
        x[1] = dot(m.axis, w);
        break;
      case LinkJoint::cylindrical:
        x[0] = dot(m.axis, w);
        x[1] = dot(m.axis, v);
        break;
      case LinkJoint::node:
        break;
    }
  }
  for (const ModalBlock& block : at.body.modal) {
    std::copy_n(at.bws.solution.data() + at.bws.ldl.first_row(block.node), block.count,
                step.data() + at.model.parts.front().u + block.place);
  }
}

}  // namespace slew::multibody
