// SPDX-License-Identifier: Apache-2.0
// Solutions with the factors of articulated.cpp: forward for accelerations, backward for generalised forces.
#include <cstddef>

#include "core/index.h"
#include "multibody/formulations/passes.h"
#include "multibody/joints/joint_directions.h"

namespace slew::multibody {

using math::Vec3;

void solve_forward(const Model& model, Workspace& ws, std::span<const double> residual,
                   std::span<double> udot) noexcept {
  const bool has_modes = !model.parts.empty();
  for (int k = 0; k < model.links[0].part_end; ++k) solve_modes(model, at(k), ws, residual, udot);
  for (std::size_t i = 1; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const JointFactor& factor = ws.factor[i];
    const auto parent = at(link.parent);
    Vec3 alpha = ws.delta_alpha[parent];
    Vec3 a = ws.delta_a[parent] + cross(alpha, ws.motion[i].r);
    const Vec3 axis = ws.motion[i].axis;
    switch (link.joint) {
      case LinkJoint::revolute:
      case LinkJoint::prismatic: {
        const double carried = dot(factor.U_ang.c[0], alpha) + dot(factor.U_lin.c[0], a);
        const double rate = factor.d_inv * (residual[at(link.u)] - carried);
        udot[at(link.u)] = rate;
        (link.joint == LinkJoint::revolute ? alpha : a) += axis * rate;
        break;
      }
      case LinkJoint::spherical: {
        const Vec3 carried = transpose_multiply(factor.U_ang, alpha) + transpose_multiply(factor.U_lin, a);
        const Vec3 rate = factor.D_inv * (load(residual, link.u) - carried);
        store(udot, link.u, rate);
        alpha += rate;
        break;
      }
      case LinkJoint::floating: {
        alpha = factor.D_inv * load(residual, link.u + 3);
        a = factor.U_lin * load(residual, link.u) - transpose_multiply(factor.U_ang, alpha);
        store(udot, link.u, a);
        store(udot, link.u + 3, alpha);
        break;
      }
      case LinkJoint::universal:
      case LinkJoint::cylindrical: {
        const Pair S = directions(link.joint, ws.motion[i]);
        const Vec3 carried = transpose_multiply(factor.U_ang, alpha) + transpose_multiply(factor.U_lin, a);
        const Vec3 rate = factor.D_inv * (load_pair(residual, link.u) - carried);
        store_pair(udot, link.u, rate);
        alpha += S.turn[0] * rate[0] + S.turn[1] * rate[1];
        a += S.slide[0] * rate[0] + S.slide[1] * rate[1];
        break;
      }
      case LinkJoint::node:
        break;
    }
    ws.delta_alpha[i] = alpha;
    ws.delta_a[i] = a;
    if (!has_modes) continue;
    if (link.joint == LinkJoint::node) follow_node(model, i, udot, ws);
    if (link.has_node_dummies()) pull_joint(model, i, udot, ws);
    for (int k = link.first_part; k < link.part_end; ++k) solve_modes(model, at(k), ws, residual, udot);
    if (link.has_node_dummies()) pull_modes(model, i, udot, ws);
  }
}

namespace {

// Rows passed back together: wrenches of row k at k * links, its results at k * speeds.
struct Rows {
  std::size_t count = 0;
  const double* tau = nullptr;  // generalised forces of one row; none: zeros
  double* residual = nullptr;
  double* rate = nullptr;
};

// one row through one link: n, f hold minus the sum of the wrenches further out, then the wrench passed to the parent
inline void pass_link(const Link& link, const LinkMotion& m, const JointFactor& factor, const double* tau,
                      double* residual, double* rate, Vec3& n, Vec3& f) noexcept {
  const auto given = [tau](int k) { return tau == nullptr ? 0.0 : tau[k]; };
  switch (link.joint) {
    case LinkJoint::revolute:
    case LinkJoint::prismatic: {
      const double rest = given(0) - dot(m.axis, link.joint == LinkJoint::revolute ? n : f);
      residual[0] = rest;
      rate[0] = factor.d_inv * rest;
      n += factor.U_ang.c[0] * rate[0];
      f += factor.U_lin.c[0] * rate[0];
      break;
    }
    case LinkJoint::spherical: {
      const Vec3 rest = Vec3(given(0), given(1), given(2)) - n;
      const Vec3 turn = factor.D_inv * rest;
      put(rest, residual);
      put(turn, rate);
      n += factor.U_ang * turn;
      f += factor.U_lin * turn;
      break;
    }
    case LinkJoint::floating: {
      const Vec3 push = Vec3(given(0), given(1), given(2)) - f;
      const Vec3 turn = Vec3(given(3), given(4), given(5)) - n - factor.U_ang * push;
      put(push, residual);
      put(turn, residual + 3);
      put(factor.U_lin * push, rate);
      put(factor.D_inv * turn, rate + 3);
      break;
    }
    case LinkJoint::universal:
    case LinkJoint::cylindrical: {
      const Pair S = directions(link.joint, m);
      const Vec3 rest(given(0) - dot(S.turn[0], n) - dot(S.slide[0], f),
                      given(1) - dot(S.turn[1], n) - dot(S.slide[1], f), 0);
      const Vec3 turn = factor.D_inv * rest;
      for (int k = 0; k < 2; ++k) {
        residual[k] = rest[k];
        rate[k] = turn[k];
      }
      n += factor.U_ang * turn;
      f += factor.U_lin * turn;
      break;
    }
    case LinkJoint::node:
      break;
  }
}

// One row through the modes of a link: residual holds minus the contributions of the nodes.
[[gnu::noinline]] void pass_parts(const Model& model, const Workspace& ws, const Link& link, const double* tau,
                                  double* residual, double* rate, Vec3& n, Vec3& f) noexcept {
  for (int k = link.first_part; k < link.part_end; ++k) {
    const FlexiblePart& part = model.parts[at(k)];
    const PartMotion& motion = ws.parts[at(k)];
    const std::size_t u = at(part.u);
    bool is_pushed = false;
    for (std::size_t j = 0; j < part.modes; ++j) {
      if (tau != nullptr) residual[u + j] += tau[u + j];
      is_pushed = is_pushed || residual[u + j] != 0;
    }
    // most rows end on this side of the modes
    if (!is_pushed) {
      for (std::size_t j = 0; j < part.modes; ++j) rate[u + j] = 0;
      continue;
    }
    pass_modes(motion, {residual + u, part.modes});
    for (std::size_t j = 0; j < part.modes; ++j) {
      rate[u + j] = residual[u + j];
      n += motion.X_ang[j] * residual[u + j];
      f += motion.X_lin[j] * residual[u + j];
    }
  }
}

[[gnu::noinline]] void pass_node(const Model& model, const Workspace& ws, const Link& link, double* residual, Vec3 n,
                                 Vec3 f) noexcept {
  const NodeMotion& motion = ws.nodes[at(link.node)];
  const FlexiblePart& part = model.parts[at(model.nodes[at(link.node)].part)];
  for (std::size_t j = 0; j < part.modes; ++j) {
    residual[at(part.u) + j] -= dot(motion.Psi[j], n) + dot(motion.Phi[j], f);
  }
}

[[gnu::noinline]] void push_to_dummies(const Model& model, Workspace& ws, std::size_t link, const Rows& rows) noexcept {
  const std::size_t links = model.links.size(), speeds = ws.udot.size();
  for (std::size_t k = 0; k < rows.count; ++k) {
    back_substitute(model, link, ws, {rows.residual + k * speeds, speeds}, {rows.rate + k * speeds, speeds},
                    std::span(ws.pass_n).subspan(k * links, links), std::span(ws.pass_f).subspan(k * links, links));
  }
}

// ws.pass_n, ws.pass_f hold minus the wrenches on the links
void pass_back(const Model& model, Workspace& ws, std::span<const int> supports, const Rows& rows) noexcept {
  const std::size_t links = model.links.size(), speeds = ws.udot.size();
  const bool has_modes = !model.parts.empty();
  for (const int i : supports) {
    const Link& link = model.links[at(i)];
    const LinkMotion& m = ws.motion[at(i)];
    const JointFactor& factor = ws.factor[at(i)];
    const std::size_t u = at(link.u);
    for (std::size_t k = 0; k < rows.count; ++k) {
      Vec3 n = ws.pass_n[k * links + at(i)], f = ws.pass_f[k * links + at(i)];
      if (link.has_parts()) {
        pass_parts(model, ws, link, rows.tau, rows.residual + k * speeds, rows.rate + k * speeds, n, f);
      }
      if (has_modes && link.joint == LinkJoint::node) pass_node(model, ws, link, rows.residual + k * speeds, n, f);
      pass_link(link, m, factor, rows.tau == nullptr ? nullptr : rows.tau + u, rows.residual + k * speeds + u,
                rows.rate + k * speeds + u, n, f);
      if (link.parent == 0) continue;
      ws.pass_n[k * links + at(link.parent)] += n + cross(m.r, f);
      ws.pass_f[k * links + at(link.parent)] += f;
    }
    if (link.has_node_dummies()) push_to_dummies(model, ws, at(i), rows);
  }
  if (model.links[0].part_end == 0) return;
  for (std::size_t k = 0; k < rows.count; ++k) {
    Vec3 n, f;
    pass_parts(model, ws, model.links[0], rows.tau, rows.residual + k * speeds, rows.rate + k * speeds, n, f);
  }
}

void clear_passes(const Model& model, Workspace& ws, std::span<const int> supports, std::size_t rows,
                  double* residual) noexcept {
  const std::size_t links = model.links.size(), speeds = ws.udot.size();
  for (std::size_t k = 0; k < rows; ++k) {
    for (const int i : supports) ws.pass_n[k * links + at(i)] = ws.pass_f[k * links + at(i)] = Vec3();
    for_each_mode(model, [&](std::size_t, std::size_t u) { residual[k * speeds + u] = 0; });
  }
}

}  // namespace

void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, std::span<const double> tau,
                    std::span<double> residual, std::span<double> rate) noexcept {
  clear_passes(model, ws, supports, 1, residual.data());
  pass_back(model, ws, supports, {1, tau.data(), residual.data(), rate.data()});
}

void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, int link1, int link2,
                    std::span<const RowValue> rows, std::span<double> residual, std::span<double> rate) noexcept {
  const std::size_t links = model.links.size();
  clear_passes(model, ws, supports, rows.size(), residual.data());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const RowGradient& G = rows[k].G;
    ws.pass_n[k * links + at(link1)] -= G.w1;
    ws.pass_f[k * links + at(link1)] -= G.v1;
    ws.pass_n[k * links + at(link2)] -= G.w2;
    ws.pass_f[k * links + at(link2)] -= G.v2;
  }
  pass_back(model, ws, supports, {rows.size(), nullptr, residual.data(), rate.data()});
}

}  // namespace slew::multibody
