#include "multibody/forces/tyre.h"

#include <algorithm>
#include <cmath>

namespace slew::multibody {
namespace {

using math::Vec3;

constexpr double kFlat = 1e-3;      // a disc that lies flat has no lowest point
constexpr double kNoSlip = 1e-150;  // below it (4) is its limit for G = 0

// Speeds of the wheel over the ground, and what slip is divided by.
struct Rolling {
  Vec3 v_P;
  double forwards = 0, rim = 0;
  double v_e = 0, r_e = 0;
};

Rolling rolling_of(const Tyre& tyre, const LinkMotion& link, const TyreState& state) noexcept {
  Rolling rolling;
  const Vec3 arm = state.Q - state.C;
  const double turning = dot(state.axle, link.w);
  const Vec3 v_C = link.v + cross(link.w, state.C - link.p);
  rolling.v_P = v_C + cross(link.w - state.axle * turning, arm);
  rolling.forwards = dot(rolling.v_P, state.t);
  rolling.rim = tyre.radius * turning;
  rolling.v_e = std::sqrt(rolling.forwards * rolling.forwards + tyre.slip_speed * tyre.slip_speed);
  rolling.r_e = std::sqrt(rolling.rim * rolling.rim + tyre.slip_speed * tyre.slip_speed);
  return rolling;
}

// mu tanh(G/mu)/G of (4)
double slip_share(const Tyre& tyre, const TyreState& state) noexcept {
  const double x = tyre.longitudinal * state.slip, y = tyre.lateral * state.lateral_slip;
  const double G = std::sqrt(x * x + y * y);
  return G > kNoSlip ? tyre.friction * std::tanh(G / tyre.friction) / G : 1.0;
}

// (3) and (4)
void add_slip(const Tyre& tyre, const LinkMotion& link, TyreState& state) noexcept {
  const Rolling rolling = rolling_of(tyre, link, state);
  const double N = state.normal_force;
  state.lateral_slip = -dot(rolling.v_P, state.l) / rolling.v_e;
  if (tyre.rolling == TyreRolling::with_body) {
    state.slip = -(rolling.forwards - rolling.rim) / rolling.v_e;
    state.axle_moment = -tyre.rolling_resistance * N * tyre.radius * rolling.rim / rolling.r_e;
  }
  const double share = slip_share(tyre, state);
  const double x = tyre.longitudinal * state.slip, y = tyre.lateral * state.lateral_slip;
  state.lateral_force = N * share * y;
  state.longitudinal_force = tyre.rolling == TyreRolling::with_body
                                 ? N * share * x
                                 : -tyre.rolling_resistance * N * rolling.forwards / rolling.v_e;
}

// delta' of (1)
double depth_rate(const Tyre& tyre, const TyreState& state, const LinkMotion& link) noexcept {
  const Vec3 n = tyre.normal_W;
  const double b = dot(n, state.axle);
  const double s = std::sqrt(std::max(0.0, 1 - b * b));
  const Vec3 v_C = link.v + cross(link.w, state.C - link.p);
  return -dot(n, v_C) - tyre.radius * b * dot(n, cross(link.w, state.axle)) / s;
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
  // (2)
  const LimitedForce limited =
      limited_force(tyre.stiffness * state.depth, tyre.damping * depth_rate(tyre, state, link));
  state.normal_force = limited.force;
  state.springs = limited.springs;
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

TyreSlopes slopes_of(const Tyre& tyre, const TyreState& state, const LinkMotion& link, ChangeWeights weights) noexcept {
  TyreSlopes slopes;
  if (!(state.depth > 0)) return slopes;
  slopes.normal =
      state.springs * weights.position * tyre.stiffness + (state.springs == 1 ? weights.rate * tyre.damping : 0.0);
  const Rolling rolling = rolling_of(tyre, link, state);
  const double grip = weights.rate * state.normal_force * slip_share(tyre, state) / rolling.v_e;
  const double resistance = weights.rate * tyre.rolling_resistance * state.normal_force;
  slopes.lateral = grip * tyre.lateral;
  if (tyre.rolling == TyreRolling::with_body) {
    slopes.longitudinal = grip * tyre.longitudinal;
    slopes.axle = resistance * tyre.radius * tyre.radius / rolling.r_e;
  } else {
    slopes.longitudinal = resistance / rolling.v_e;
  }
  return slopes;
}

double stored_energy(const Tyre& tyre, const TyreState& state) noexcept {
  const double depth = std::max(0.0, state.depth);
  return 0.5 * tyre.stiffness * depth * depth;
}

}  // namespace slew::multibody
