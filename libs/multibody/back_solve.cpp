// Solutions with the factors of articulated.cpp: forward for accelerations, backward for generalised forces.
#include <cstddef>

#include "multibody/joint_directions.h"
#include "multibody/passes.h"

namespace slew::multibody {

using math::Vec3;

namespace {

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
}

}  // namespace

void solve_forward(const Model& model, Workspace& ws, std::span<const double> residual,
                   std::span<double> udot) noexcept {
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
    }
    ws.delta_alpha[i] = alpha;
    ws.delta_a[i] = a;
  }
}

namespace {

// ws.pass_n, ws.pass_f hold minus the wrenches on the links
void pass_back(const Model& model, Workspace& ws, std::span<const int> supports, std::span<const double> tau,
               std::span<double> residual, std::span<double> rate) noexcept {
  for (const int i : supports) {
    const Link& link = model.links[at(i)];
    const JointFactor& factor = ws.factor[at(i)];
    Vec3 n = ws.pass_n[at(i)], f = ws.pass_f[at(i)];
    switch (link.joint) {
      case LinkJoint::revolute:
      case LinkJoint::prismatic: {
        const Vec3 carried = link.joint == LinkJoint::revolute ? n : f;
        const double rest = tau[at(link.u)] - dot(ws.motion[at(i)].axis, carried);
        residual[at(link.u)] = rest;
        rate[at(link.u)] = factor.d_inv * rest;
        n += factor.U_ang.c[0] * rate[at(link.u)];
        f += factor.U_lin.c[0] * rate[at(link.u)];
        break;
      }
      case LinkJoint::spherical: {
        const Vec3 rest = load(tau, link.u) - n;
        const Vec3 turn = factor.D_inv * rest;
        store(residual, link.u, rest);
        store(rate, link.u, turn);
        n += factor.U_ang * turn;
        f += factor.U_lin * turn;
        break;
      }
      case LinkJoint::floating: {
        const Vec3 push = load(tau, link.u) - f;
        const Vec3 turn = load(tau, link.u + 3) - n - factor.U_ang * push;
        store(residual, link.u, push);
        store(residual, link.u + 3, turn);
        store(rate, link.u, factor.U_lin * push);
        store(rate, link.u + 3, factor.D_inv * turn);
        continue;
      }
      case LinkJoint::universal:
      case LinkJoint::cylindrical: {
        const Pair S = directions(link.joint, ws.motion[at(i)]);
        const Vec3 carried(dot(S.turn[0], n) + dot(S.slide[0], f), dot(S.turn[1], n) + dot(S.slide[1], f), 0);
        const Vec3 rest = load_pair(tau, link.u) - carried;
        const Vec3 turn = factor.D_inv * rest;
        store_pair(residual, link.u, rest);
        store_pair(rate, link.u, turn);
        n += factor.U_ang * turn;
        f += factor.U_lin * turn;
        break;
      }
    }
    if (link.parent == 0) continue;
    ws.pass_n[at(link.parent)] += n + cross(ws.motion[at(i)].r, f);
    ws.pass_f[at(link.parent)] += f;
  }
}

}  // namespace

void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, std::span<const double> tau,
                    std::span<double> residual, std::span<double> rate) noexcept {
  for (const int i : supports) ws.pass_n[at(i)] = ws.pass_f[at(i)] = Vec3();
  pass_back(model, ws, supports, tau, residual, rate);
}

void solve_backward(const Model& model, Workspace& ws, std::span<const int> supports, int link1, int link2,
                    const RowGradient& G, std::span<double> residual, std::span<double> rate) noexcept {
  for (const int i : supports) ws.pass_n[at(i)] = ws.pass_f[at(i)] = Vec3();
  ws.pass_n[at(link1)] -= G.w1;
  ws.pass_f[at(link1)] -= G.v1;
  ws.pass_n[at(link2)] -= G.w2;
  ws.pass_f[at(link2)] -= G.v2;
  pass_back(model, ws, supports, ws.loops.no_tau, residual, rate);
}

}  // namespace slew::multibody
