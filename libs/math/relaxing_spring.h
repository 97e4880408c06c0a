// SPDX-License-Identifier: Apache-2.0
// Springs that relax (Maxwell elements), and the one that stands for several of them over a step.
//
// A force with z' = F_dot - K (v - v_ref) - lambda (z - F_n) is a spring K whose change decays with lambda. Under a
// speed that differs from v_ref by u for a time H its change at the end, and the integral of the change over H, are
//   dz(H) = -K u H a(x),   int dz dt = -K u H^2 b(x),   x = lambda H,
//   a(x) = (1 - e^-x) / x,   b(x) = (1 - a(x)) / x                                                                (1)
// Several springs in parallel have the sums of both. The one that stands for them has the same two values: b/a grows
// from 1/2 to 1 with x alone, 2 b/a - 1 = coth(x/2) - 2/x is Langevin's function of x/2, so that x follows from the
// sums, and K after it. A mean of lambda weighted with K, its limit for H -> 0, would let a fast spring (a chamber
// that is drained within H) relax a slow one (a closed chamber) with it.
// F_dot keeps the integral of its own change, sum F_dot_i b(x_i) H^2: the impulse of the step.
//
// A force whose change ends at R, as that of a chamber which empties, arrives there at t_0 = r H < H and stays. Its
// change at the end and the integral of it, about linear until t_0, are
//   R,   R H (1 - r + r c),   c = (b/a)(lambda t_0),   2 b/a - 1 = 1 - 2 r (1 - c)                                (2)
// which a spring has whose x is the inverse of Langevin's function of (2). Its K has the same integral of the change by
// u, -K u t_0^2 b(lambda t_0); the end does not depend on u.
#pragma once

#include <cmath>
#include <span>

namespace slew::math {

struct RelaxingSpring {
  double K = 0;       // N/m
  double lambda = 0;  // 1/s, >= 0
  double F_dot = 0;   // N/s
};

// a(x) of (1), x >= 0.
[[nodiscard]] double remaining_share(double x) noexcept;

// phi_1 = (1 - e^-x)/x, phi_k+1 = (1/k! - phi_k)/x for x >= 0: a signal t^k/k! that decays with lambda has the integral
// h^(k+1) phi_k+1(lambda h) after h.
struct DecayedIntegrals {
  double phi_1, phi_2, phi_3, phi_4, phi_5;  // 1/k! for x = 0
};
[[nodiscard]] DecayedIntegrals decayed_integrals(double x) noexcept;

// Of a force over H seconds: its change at the end over -u H, the integral of its change over -u H^2 [N/m], and the
// integral at v_ref over H^2 [N/s].
struct SpringResponse {
  double end = 0, integral = 0, impulse = 0;
};
[[nodiscard]] SpringResponse response_of(const RelaxingSpring& spring, double H) noexcept;
// The spring with this response; with K at `most` [N/m] at most, for its end and impulse alone. Pre-condition: end > 0
// or end = integral = 0.
[[nodiscard]] RelaxingSpring spring_with(const SpringResponse& response, double H, double most = INFINITY) noexcept;

// The one that stands for all of them over H seconds, H > 0. With one lambda for all it is the sum.
[[nodiscard]] RelaxingSpring one_for_all(std::span<const RelaxingSpring> springs, double H) noexcept;

// (2): the one that stands over H seconds for a spring whose change of force ends at `change` [N], which it reaches
// after t_0, 0 < t_0 <= H.
[[nodiscard]] RelaxingSpring ended_at(const RelaxingSpring& spring, double change, double t_0, double H) noexcept;

}  // namespace slew::math
