#include "multibody/elements/tyre.h"

#include <algorithm>
#include <cmath>

namespace slew::multibody {
namespace {

using math::Vec3;

constexpr double kFlat = 1e-3;      // a disc that lies flat has no lowest point
constexpr double kNoSlip = 1e-150;  // below it (4) is its limit for G = 0

// (3) and (4)
void add_slip(const Tyre& tyre, const LinkMotion& link, TyreState& state) noexcept {
  const Vec3 arm = state.Q - state.C;
  const double turning = dot(state.axle, link.w);
  const Vec3 v_C = link.v + cross(link.w, state.C - link.p);
  const Vec3 v_P = v_C + cross(link.w - state.axle * turning, arm);
  const double forwards = dot(v_P, state.t);
  const double v_e = std::sqrt(forwards * forwards + tyre.slip_speed * tyre.slip_speed);
  const double N = state.normal_force;
  state.lateral_slip = -dot(v_P, state.l) / v_e;
  if (tyre.rolling == TyreRolling::with_body) {
    const double rim = tyre.radius * turning;
    state.slip = -(forwards - rim) / v_e;
    state.axle_moment =
        -tyre.rolling_resistance * N * tyre.radius * rim / std::sqrt(rim * rim + tyre.slip_speed * tyre.slip_speed);
  }
  const double x = tyre.longitudinal * state.slip, y = tyre.lateral * state.lateral_slip;
  const double G = std::sqrt(x * x + y * y);
  const double share = G > kNoSlip ? tyre.friction * std::tanh(G / tyre.friction) / G : 1.0;
  state.lateral_force = N * share * y;
  state.longitudinal_force =
      tyre.rolling == TyreRolling::with_body ? N * share * x : -tyre.rolling_resistance * N * forwards / v_e;
}

}  // namespace

TyreState state_of(const Tyre& tyre, const LinkMotion& link) noexcept {
  TyreState state;
  const Vec3 n = tyre.normal_W;
  state.C = link.p + link.R * tyre.c_L;
  state.axle = link.R * tyre.axle_L;
  const double b = dot(n, state.axle);
  const double s = std::sqrt(std::max(0.0, 1 - b * b));
  if (s < kFlat) return state;
  state.Q = state.C - (n - state.axle * b) * (tyre.radius / s);
  state.t = cross(state.axle, n) * (1 / s);
  state.l = cross(n, state.t);
  state.depth = tyre.height - dot(n, state.Q);
  if (!(state.depth > 0)) return state;
  // (1), (2)
  const Vec3 v_C = link.v + cross(link.w, state.C - link.p);
  const double rate = -dot(n, v_C) - tyre.radius * b * dot(n, cross(link.w, state.axle)) / s;
  const double spring = tyre.stiffness * state.depth;
  state.normal_force = spring + std::min(spring, std::max(-spring, tyre.damping * rate));
  add_slip(tyre, link, state);
  return state;
}

Wrench wrench_of(const Tyre& tyre, const TyreState& state, const LinkMotion& link) noexcept {
  if (!(state.depth > 0)) return {};
  const Vec3 at_contact = tyre.normal_W * state.normal_force + state.l * state.lateral_force;
  const Vec3 forwards = state.t * state.longitudinal_force;
  if (tyre.rolling == TyreRolling::with_body) {
    return wrench_at(state.Q, link, at_contact + forwards, state.axle * state.axle_moment);
  }
  const Wrench side = wrench_at(state.Q, link, at_contact), hub = wrench_at(state.C, link, forwards);
  return {side.f + hub.f, side.n + hub.n};
}

double stored_energy(const Tyre& tyre, const TyreState& state) noexcept {
  const double depth = std::max(0.0, state.depth);
  return 0.5 * tyre.stiffness * depth * depth;
}

}  // namespace slew::multibody
