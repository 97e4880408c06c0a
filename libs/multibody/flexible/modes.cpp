// SPDX-License-Identifier: Apache-2.0
// Shape, inertia and energy of a flexible part: equations (1) to (6) of flexible_part.h.
#include <cstddef>

#include "multibody/flexible/flexible_part.h"
#include "multibody/model/state.h"

namespace slew::multibody {

using math::Mat3;
using math::Vec3;

namespace {

// tr W - W
Mat3 inertia_of(const Mat3& W) noexcept {
  const double trace = W(0, 0) + W(1, 1) + W(2, 2);
  return Mat3::diagonal(trace, trace, trace) - W;
}

// sin(x)/x, (1 - cos x)/x^2 and (x - sin x)/x^3 by y = x^2, and the derivatives of the last two by y
struct TurnFactors {
  double sine = 0, a = 0, b = 0, da = 0, db = 0;
};

// (-1)^k/(2k+1)!, /(2k+2)!, /(2k+3)! of the power y^k
struct TurnSeries {
  static constexpr int kTerms = 12;  // to the last bit up to half a turn
  static constexpr int kFew = 6;     // to the last bit up to kSmall
  static constexpr double kSmall = 2e-2;
  double sine[kTerms]{}, a[kTerms]{}, b[kTerms]{};

  constexpr TurnSeries() {
    double factorial = 1, sign = 1;
    for (int k = 0; k < kTerms; ++k) {
      const double even = factorial * (2 * k + 2), odd = even * (2 * k + 3);
      sine[k] = sign / factorial;
      a[k] = sign / even;
      b[k] = sign / odd;
      factorial = odd;
      sign = -sign;
    }
  }
};

template <int Terms>
TurnFactors sum_of(const TurnSeries& series, double y) noexcept {
  TurnFactors f{series.sine[Terms - 1], series.a[Terms - 1], series.b[Terms - 1], 0, 0};
  for (int k = Terms - 2; k >= 0; --k) {
    f.da = f.da * y + f.a;
    f.db = f.db * y + f.b;
    f.sine = f.sine * y + series.sine[k];
    f.a = f.a * y + series.a[k];
    f.b = f.b * y + series.b[k];
  }
  return f;
}

TurnFactors turn_factors(double y) noexcept {
  constexpr TurnSeries kSeries;
  return y < TurnSeries::kSmall ? sum_of<TurnSeries::kFew>(kSeries, y) : sum_of<TurnSeries::kTerms>(kSeries, y);
}

}  // namespace

PartMotion::PartMotion(std::size_t modes)
    : q(modes),
      u(modes),
      b(modes),
      c(modes),
      W_q(modes),
      bias(modes),
      B_lin(modes),
      B_ang(modes),
      E(modes * modes),
      X_lin(modes),
      X_ang(modes) {}

void see_part(const FlexiblePart& part, std::span<const double> q, std::span<const double> u, const LinkMotion& frame,
              PartMotion& motion) noexcept {
  const std::size_t n = part.modes;
  Vec3 s;
  Mat3 half;  // half of W less W_0, without its transpose
  for (std::size_t k = 0; k < n; ++k) {
    motion.q[k] = q[k];
    motion.u[k] = u[k];
  }
  for (std::size_t k = 0; k < n; ++k) {
    Vec3 b = part.C[k];
    Mat3 moment = part.Z[k];
    for (std::size_t l = 0; l < n; ++l) moment += part.Y[l * n + k] * q[l];
    for (std::size_t l = 0; l < n && part.is_shortening(); ++l) {
      b += part.G[k * n + l] * q[l];
      moment += part.H[k * n + l] * q[l];
    }
    motion.b[k] = frame.R * b;
    motion.c[k] = frame.R * axial(moment);
    motion.W_q[k] = moment + transpose(moment);
    s += (part.C[k] + b) * (0.5 * q[k]);
    half += (part.Z[k] + moment) * (0.5 * q[k]);
  }
  motion.s_L = s;
  motion.J_L = inertia_of(half + transpose(half));
}

void move_node(const FlexibleNode& node, const LinkMotion& frame, const PartMotion& part, NodeMotion& motion,
               LinkMotion& m) noexcept {
  const std::size_t n = part.q.size();
  Vec3 x = node.x, theta, theta_dot, v, curl;  // curl: (g u) u
  for (std::size_t k = 0; k < n; ++k) {
    Vec3 shift = node.shift[k];
    for (std::size_t l = 0; l < n && !node.shortening.empty(); ++l) {
      const Vec3 g = node.shortening[k * n + l];
      shift += g * part.q[l];
      curl += g * (part.u[k] * part.u[l]);
    }
    x += (node.shift[k] + shift) * (0.5 * part.q[k]);
    v += shift * part.u[k];
    motion.Phi[k] = frame.R * shift;
    theta += node.turn[k] * part.q[k];
    theta_dot += node.turn[k] * part.u[k];
  }
  const double y = dot(theta, theta);
  const TurnFactors f = turn_factors(y);
  const Mat3 turn = math::skew(theta), turn_2 = outer(theta, theta) - Mat3::diagonal(y, y, y);
  const Mat3 tangent = frame.R * (Mat3::identity() + turn * f.a + turn_2 * f.b);
  for (std::size_t k = 0; k < n; ++k) motion.Psi[k] = tangent * node.turn[k];
  const Vec3 across = cross(theta, theta_dot);
  const double y_dot = 2 * dot(theta, theta_dot);
  const Vec3 tangent_dot =
      across * (f.da * y_dot) + cross(theta, across) * (f.db * y_dot) + cross(theta_dot, across) * f.b;

  m.R = frame.R * (Mat3::identity() + turn * f.sine + turn_2 * f.a) * node.R;
  m.axis = m.R.c[2];
  m.r = frame.R * x;
  m.p = frame.p + m.r;
  const Vec3 slide = frame.R * v, spin = tangent * theta_dot, v_rel = cross(frame.w, m.r);
  m.w = frame.w + spin;
  m.v = frame.v + v_rel + slide;
  m.alpha = frame.alpha + cross(frame.w, spin) + frame.R * tangent_dot;
  m.a = frame.a + cross(frame.alpha, m.r) + cross(frame.w, v_rel) + cross(frame.w, slide) * 2 + frame.R * curl;
}

void add_part(const FlexiblePart& part, const LinkMotion& frame, PartMotion& motion,
              ArticulatedInertia& inertia) noexcept {
  const std::size_t n = part.modes;
  if (n == 0) return;  // no modes: nothing beyond the undeformed body
  const Vec3 w = transpose_multiply(frame.R, frame.w);
  Vec3 flow, spin, curl_lin, curl_ang;  // b u, c u in Ground; (G u) u, ax(H u u) in the link's axes
  Mat3 W_dot;
  for (std::size_t k = 0; k < n; ++k) {
    const double u = motion.u[k];
    flow += motion.b[k] * u;
    spin += motion.c[k] * u;
    const Mat3& W_k = motion.W_q[k];
    Vec3 coriolis;
    double force = part.stiffness[k * n + k] * motion.q[k] + part.damping[k * n + k] * u - part.preload[k];
    for (std::size_t l = 0; l < n; ++l) coriolis += part.Y_cross[l * n + k] * motion.u[l];
    for (std::size_t l = 0; l < n && !part.is_diagonal; ++l) {
      if (l != k) force += part.stiffness[k * n + l] * motion.q[l] + part.damping[k * n + l] * motion.u[l];
    }
    for (std::size_t l = 0; l < n && part.is_shortening(); ++l) {
      curl_lin += part.G[k * n + l] * (u * motion.u[l]);
      curl_ang += part.H_cross[k * n + l] * (u * motion.u[l]);
    }
    W_dot += W_k * u;
    const double trace = W_k(0, 0) + W_k(1, 1) + W_k(2, 2);
    const double centrifugal = 0.5 * (trace * dot(w, w) - dot(w, W_k * w));
    motion.bias[k] =
        dot(motion.b[k], frame.a) + dot(motion.c[k], frame.alpha) + 2 * dot(w, coriolis) - centrifugal + force;
    motion.B_lin[k] = motion.b[k];
    motion.B_ang[k] = motion.c[k];
  }
  motion.E = part.mass_matrix;

  motion.s = frame.R * motion.s_L;
  motion.J = frame.R * motion.J_L * transpose(frame.R);
  motion.f = cross(frame.w, cross(frame.w, motion.s)) + cross(frame.w, flow) * 2 + frame.R * curl_lin;
  motion.n = cross(frame.w, motion.J * frame.w + spin) + frame.R * (inertia_of(W_dot) * w + curl_ang);
  inertia.J += motion.J;
  inertia.K -= math::skew(motion.s);
  const PartWrench bias = wrench_of(motion, {}, frame.alpha, frame.a);
  inertia.f += bias.f;
  inertia.n += bias.n;
}

void add_shares(const FlexiblePart& part, const ModalShares& shares, PartMotion& motion) noexcept {
  const std::size_t n = part.modes;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t first = part.is_diagonal ? k : 0, end = part.is_diagonal ? k + 1 : n;
    for (std::size_t l = first; l < end; ++l) {
      const double K = part.stiffness[k * n + l];
      motion.E[k * n + l] += shares.position * K + shares.rate * part.damping[k * n + l];
      motion.bias[k] += shares.strain * K * motion.u[l];
    }
  }
}

PartWrench wrench_of(const PartMotion& motion, std::span<const double> udot, Vec3 alpha, Vec3 a) noexcept {
  PartWrench wrench{motion.f + cross(alpha, motion.s), motion.n + motion.J * alpha + cross(motion.s, a)};
  for (std::size_t k = 0; k < udot.size(); ++k) {
    wrench.f += motion.b[k] * udot[k];
    wrench.n += motion.c[k] * udot[k];
  }
  return wrench;
}

PartMomentum momentum_of(const PartMotion& motion, const LinkMotion& frame) noexcept {
  const Vec3 s = frame.R * motion.s_L;
  PartMomentum sum{cross(frame.w, s),
                   cross(s, frame.v) + frame.R * (motion.J_L * transpose_multiply(frame.R, frame.w))};
  for (std::size_t k = 0; k < motion.u.size(); ++k) {
    sum.linear += motion.b[k] * motion.u[k];
    sum.angular += motion.c[k] * motion.u[k];
  }
  return sum;
}

PartEnergy energy_of(const FlexiblePart& part, const PartMotion& motion, const LinkMotion& frame,
                     Vec3 gravity) noexcept {
  const std::size_t n = part.modes;
  const Vec3 s = frame.R * motion.s_L, w = transpose_multiply(frame.R, frame.w);
  PartEnergy energy;
  energy.kinetic = dot(frame.v, cross(frame.w, s)) + 0.5 * dot(w, motion.J_L * w);
  energy.potential = -dot(gravity, s);
  for (std::size_t k = 0; k < n; ++k) {
    energy.kinetic += motion.u[k] * (dot(frame.v, motion.b[k]) + dot(frame.w, motion.c[k]));
    for (std::size_t l = 0; l < n; ++l) {
      energy.kinetic += 0.5 * part.mass_matrix[k * n + l] * motion.u[k] * motion.u[l];
      energy.potential += 0.5 * part.stiffness[k * n + l] * motion.q[k] * motion.q[l];
    }
    energy.potential -= part.preload[k] * motion.q[k];
  }
  return energy;
}

}  // namespace slew::multibody
