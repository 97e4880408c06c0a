// SPDX-License-Identifier: Apache-2.0
// The modes in the recursion: equations (7) and (8) of flexible_part.h.
#include <cstddef>

#include "core/index.h"
#include "math/small_cholesky.h"
#include "multibody/flexible/flexible_part.h"
#include "multibody/model/state.h"

namespace slew::multibody {

using math::Vec3;

namespace {

// X = C^-1 B for all components of B at once
void substitute(const std::vector<double>& C, const std::vector<Vec3>& B, std::vector<Vec3>& X) noexcept {
  const std::size_t n = B.size();
  for (std::size_t r = 0; r < n; ++r) {
    Vec3 sum = B[r];
    for (std::size_t k = 0; k < r; ++k) sum -= X[k] * C[r * n + k];
    X[r] = Vec3(sum.lanes / C[r * n + r]);
  }
}

}  // namespace

void add_node(const Model& model, std::size_t link, Workspace& ws) noexcept {
  const auto node = at(model.links[link].node);
  const ArticulatedInertia& I = ws.inertia[link];
  const Vec3 r = ws.motion[link].r;
  const NodeMotion& motion = ws.nodes[node];
  PartMotion& part = ws.parts[at(model.nodes[node].part)];
  const std::size_t n = part.q.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 moment = I.J * motion.Psi[k] + transpose_multiply(I.K, motion.Phi[k]);
    const Vec3 force = I.K * motion.Psi[k] + I.M * motion.Phi[k];
    part.B_lin[k] += force;
    part.B_ang[k] += moment + cross(r, force);
    part.bias[k] += dot(motion.Psi[k], I.n) + dot(motion.Phi[k], I.f);
    for (std::size_t l = 0; l <= k; ++l) {
      part.E[k * n + l] += dot(motion.Psi[l], moment) + dot(motion.Phi[l], force);
    }
  }
}

void eliminate_modes(const Model& model, std::size_t index, Workspace& ws) noexcept {
  const FlexiblePart& part = model.parts[index];
  PartMotion& motion = ws.parts[index];
  ArticulatedInertia& I = ws.inertia[at(part.link)];
  const std::size_t n = part.modes;
  const int size = static_cast<int>(n);
  // a singular matrix gives accelerations that are not finite
  if (!math::factorize_cholesky(motion.E.data(), size)) motion.E[0] = 0;
  substitute(motion.E, motion.B_ang, motion.X_ang);
  substitute(motion.E, motion.B_lin, motion.X_lin);
  const std::span<double> residual = std::span(ws.residual).subspan(at(part.u), n);
  for (std::size_t k = 0; k < n; ++k) residual[k] = ws.tau[at(part.u) + k] - motion.bias[k];
  pass_modes(motion, residual);
  for (std::size_t k = 0; k < n; ++k) {
    I.J -= outer(motion.X_ang[k], motion.X_ang[k]);
    I.K -= outer(motion.X_lin[k], motion.X_ang[k]);
    I.M -= outer(motion.X_lin[k], motion.X_lin[k]);
    I.n += motion.X_ang[k] * residual[k];
    I.f += motion.X_lin[k] * residual[k];
  }
}

void solve_modes(const Model& model, std::size_t index, const Workspace& ws, std::span<const double> residual,
                 std::span<double> udot) noexcept {
  const FlexiblePart& part = model.parts[index];
  const PartMotion& motion = ws.parts[index];
  const Vec3 alpha = ws.delta_alpha[at(part.link)], a = ws.delta_a[at(part.link)];
  const std::span<double> rate = udot.subspan(at(part.u), part.modes);
  for (std::size_t k = 0; k < part.modes; ++k) {
    rate[k] = residual[at(part.u) + k] - dot(motion.X_ang[k], alpha) - dot(motion.X_lin[k], a);
  }
  return_modes(motion, rate);
}

void pass_modes(const PartMotion& motion, std::span<double> x) noexcept {
  math::substitute_forward(motion.E.data(), static_cast<int>(x.size()), x.data());
}

void pass_modes(const PartMotion& motion, const std::vector<Vec3>& B, std::vector<Vec3>& X) noexcept {
  substitute(motion.E, B, X);
}

void return_modes(const PartMotion& motion, std::span<double> x) noexcept {
  math::substitute_backward(motion.E.data(), static_cast<int>(x.size()), x.data());
}

void follow_node(const Model& model, std::size_t link, std::span<const double> udot, Workspace& ws) noexcept {
  const auto node = at(model.links[link].node);
  const FlexiblePart& part = model.parts[at(model.nodes[node].part)];
  const NodeMotion& motion = ws.nodes[node];
  for (std::size_t k = 0; k < part.modes; ++k) {
    const double rate = udot[at(part.u) + k];
    ws.delta_alpha[link] += motion.Psi[k] * rate;
    ws.delta_a[link] += motion.Phi[k] * rate;
  }
}

}  // namespace slew::multibody
