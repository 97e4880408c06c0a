// The modes in the recursion: equation (7) of flexible_part.h.
#include <cstddef>

#include "math/small_cholesky.h"
#include "multibody/flexible/flexible_part.h"
#include "multibody/state.h"

namespace slew::multibody {

using math::Vec3;

namespace {

std::size_t at(int index) noexcept {
  return static_cast<std::size_t>(index);
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
  // what is singular shows as accelerations that are not finite
  if (!math::factorize_cholesky(motion.E.data(), size)) motion.E[0] = 0;
  for (int axis = 0; axis < 6; ++axis) {
    double* x = motion.scratch.data();
    for (std::size_t k = 0; k < n; ++k) x[k] = axis < 3 ? motion.B_ang[k][axis] : motion.B_lin[k][axis - 3];
    math::substitute_forward(motion.E.data(), size, x);
    math::substitute_backward(motion.E.data(), size, x);
    for (std::size_t k = 0; k < n; ++k) (axis < 3 ? motion.X_ang : motion.X_lin)[k].lanes[axis % 3] = x[k];
  }
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t u = at(part.u) + k;
    ws.residual[u] = ws.tau[u] - motion.bias[k];
    I.J -= outer(motion.B_ang[k], motion.X_ang[k]);
    I.K -= outer(motion.B_lin[k], motion.X_ang[k]);
    I.M -= outer(motion.B_lin[k], motion.X_lin[k]);
    I.n += motion.X_ang[k] * ws.residual[u];
    I.f += motion.X_lin[k] * ws.residual[u];
  }
}

void solve_modes(const Model& model, std::size_t index, const Workspace& ws, std::span<const double> residual,
                 std::span<double> udot) noexcept {
  const FlexiblePart& part = model.parts[index];
  const PartMotion& motion = ws.parts[index];
  const Vec3 alpha = ws.delta_alpha[at(part.link)], a = ws.delta_a[at(part.link)];
  const std::span<double> rate = udot.subspan(at(part.u), part.modes);
  solve_mass(motion, residual.subspan(at(part.u), part.modes), rate);
  for (std::size_t k = 0; k < part.modes; ++k) rate[k] -= dot(motion.X_ang[k], alpha) + dot(motion.X_lin[k], a);
}

void solve_mass(const PartMotion& motion, std::span<const double> right, std::span<double> x) noexcept {
  const int size = static_cast<int>(right.size());
  for (std::size_t k = 0; k < right.size(); ++k) x[k] = right[k];
  math::substitute_forward(motion.E.data(), size, x.data());
  math::substitute_backward(motion.E.data(), size, x.data());
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
