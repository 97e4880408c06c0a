// SPDX-License-Identifier: Apache-2.0
#include "contact/friction_law.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "math/rotation.h"

namespace slew::contact {
namespace {

using math::Mat3;
using math::Vec3;

// level below which a contact's force is negligible and the quotients of (2) would overflow
constexpr double kSmallestLevel = 1e-9;  // N

// The law of one point at one speed: (1) and the constants times the share.
struct Level {
  double sigma_0, sigma_1, sigma_2;
  double N;      // F_n + F_0 [N]
  double s;      // |v| [m/s]
  double g;      // (1) [N]
  double g_s;    // dg/ds [N s/m]
  double z_max;  // mu_s N / sigma_0 [m]
  Vec3 v, u;     // tangential velocity and its direction; u = 0 at s = 0
};

// speed below which the direction has no meaning; counts as rest
constexpr double kSmallestSpeed = 1e-200;  // m/s

Level level_of(const FrictionLaw& law, const SlidingContact& contact) noexcept {
  const FrictionLawDef& def = law.def;
  Level level{};
  level.sigma_0 = contact.share * def.stiffness;
  level.sigma_1 = contact.share * def.damping;
  level.sigma_2 = contact.share * def.viscosity;
  level.N = contact.normal_force > 0 ? contact.normal_force + contact.share * def.pressing_force : 0;
  level.v = contact.v_W - contact.n_W * dot(contact.n_W, contact.v_W);
  level.s = norm(level.v);
  if (level.s > kSmallestSpeed) level.u = level.v * (1 / level.s);
  // (1) and its slope
  const double ratio = level.s / def.stribeck_speed;
  const double power = def.exponent == 2 ? ratio * ratio : std::pow(ratio, def.exponent);
  const double peak = (def.static_coefficient - def.dynamic_coefficient) * std::exp(-power);
  level.g = level.N * (def.dynamic_coefficient + peak);
  const double first = def.exponent == 1 ? 1.0 : ratio > 0 ? power / ratio : 0.0;  // ratio^(p-1)
  level.g_s = -level.N * peak * def.exponent * first / def.stribeck_speed;
  level.z_max = def.static_coefficient * level.N / level.sigma_0;
  return level;
}

bool carries(const Level& level) noexcept {
  return level.N > kSmallestLevel && level.sigma_0 > 0;
}

// Bristles at the start of the sub-step: in the plane, limited to the bending that the present normal force can hold.
struct Start {
  Vec3 z;
  Vec3 d_N;  // dz/dN [m/N]: along z where it is limited, else 0
};

Start start_of(const Level& level, Vec3 n_W, Vec3 z_W) noexcept {
  const Vec3 z = z_W - n_W * dot(n_W, z_W);
  const double length = norm(z);
  if (length <= level.z_max) return {z, {}};
  const Vec3 cut = z * (level.z_max / length);
  return {cut, cut * (1 / level.N)};
}

// (4) and its derivatives along the direction of v, in N, and by v itself
struct Bending {
  Vec3 z, d_s, d_N;
  double d_v;  // derivative of the part along v
};

Bending bending_after(const Level& l, const Start& start, double h) noexcept {
  constexpr double kSeriesLimit = 1e-4;  // its cube is below the last bits that matter
  const double rate = l.sigma_0 / l.g;
  const double x = rate * l.s * h;
  const double x_s = h * rate * (1 - l.s * l.g_s / l.g);
  const double E = std::exp(-x);
  // phi = (1 - E)/x and its slope
  const bool is_small = x < kSeriesLimit;
  const double phi = is_small ? 1 - x / 2 + x * x / 6 : (1 - E) / x;
  const double phi_x = is_small ? -0.5 + x / 3 - x * x / 8 : (E - phi) / x;
  Bending b{};
  b.z = start.z * E + l.v * (h * phi);
  b.d_v = h * phi;
  b.d_s = start.z * (-E * x_s) + l.v * (h * phi_x * x_s);
  b.d_N = (start.z * (E * x) - l.v * (h * phi_x * x)) * (1 / l.N) + start.d_N * E;
  return b;
}

// sigma_1e of (3), beta, and their slopes over s; both follow from s and g alone
struct Damping {
  double sigma_1e, beta, sigma_s, beta_s;
  bool is_limited;
};

Damping damping_at(const Level& l) noexcept {
  if (l.sigma_1 * l.s <= l.g) {
    return {l.sigma_1, l.sigma_1 * l.s / l.g, 0, l.sigma_1 / l.g * (1 - l.s * l.g_s / l.g), false};
  }
  return {l.g / l.s, 1, (l.g_s - l.g / l.s) / l.s, 0, true};
}

// a column of the derivative: a e_i (in the plane) + p u_i
Mat3 tangential(double a, Vec3 p, Vec3 u, Vec3 n) noexcept {
  Mat3 m = Mat3::diagonal(a, a, a);
  m -= outer(n, n) * a;
  m += outer(p, u);
  return m;
}

}  // namespace

FrictionLaw build(const FrictionLawDef& def) {
  return {def};
}

FrictionForce evaluate(const FrictionLaw& law, const SlidingContact& contact, double h,
                       const FrictionState& state) noexcept {
  SLEW_ASSERT(h >= 0);
  const Level l = level_of(law, contact);
  if (!carries(l)) return {};
  const Start start = start_of(l, contact.n_W, state.z_W);
  const Bending b = bending_after(l, start, h);
  const Damping c = damping_at(l);

  // (3) with z' written out: (1 - beta) sigma_0 z + (sigma_1e + sigma_2) v
  const double elastic = (1 - c.beta) * l.sigma_0;
  const double viscous = c.sigma_1e + l.sigma_2;
  FrictionForce out;
  out.z_W = b.z;
  out.f_W = b.z * elastic + l.v * viscous;
  const Vec3 along_u = b.d_s * elastic - b.z * (l.sigma_0 * c.beta_s) + l.v * c.sigma_s;
  out.d_velocity = tangential(elastic * b.d_v + viscous, along_u, l.u, contact.n_W);
  // beta ~ 1/N while it is not limited, sigma_1e ~ N while it is
  const double beta_N = c.is_limited ? 0.0 : -c.beta / l.N;
  const double sigma_N = c.is_limited ? c.sigma_1e / l.N : 0.0;
  out.d_normal = b.d_N * elastic - b.z * (l.sigma_0 * beta_N) + l.v * sigma_N;
  return out;
}

Vec3 bristle_rate(const FrictionLaw& law, const SlidingContact& contact, Vec3 z_W) noexcept {
  const Level l = level_of(law, contact);
  return l.v - z_W * (l.sigma_0 * l.s / l.g);
}

double stored_energy(const FrictionLaw& law, double share, const FrictionState& state) noexcept {
  return share * law.def.stiffness * dot(state.z_W, state.z_W) / 2;
}

void turn_bristle(Vec3 from, Vec3 to, double spin, FrictionState& state) noexcept {
  constexpr double kOpposite = 1e-6;  // 1 + cos of an angle within 0.0015 rad of pi
  const double closeness = 1 + dot(from, to);
  if (!(closeness > kOpposite)) {
    state.z_W = {};
    return;
  }
  // the rotation that takes `from` to `to` along the great circle, on a vector at a right angle to `from`
  const Vec3 z = state.z_W - (from + to) * (dot(to, state.z_W) / closeness);
  const math::SinCos turn = math::sin_cos(spin);
  state.z_W = spin == 0 ? z : z * turn.cos + cross(to, z) * turn.sin;
}

}  // namespace slew::contact
