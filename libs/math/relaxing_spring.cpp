// SPDX-License-Identifier: Apache-2.0
#include "math/relaxing_spring.h"

#include <algorithm>
#include <cmath>

namespace slew::math {
namespace {

// of 2 b/a - 1, where double can still distinguish it from 1: lambda H of 2e9
constexpr double kFastest = 1 - 1e-9;

constexpr int kLastTerm = 28;  // 5! 2^23/28! is below the rounding

// a(x) and b(x) of (1)
struct Response {
  double end, integral;
};

inline Response response(double x) noexcept {
  // below, the difference 1 - a(x) loses digits; the series is exact to 2e-16
  if (x < 0.01) {
    return {1 - x / 2 * (1 - x / 3 * (1 - x / 4 * (1 - x / 5 * (1 - x / 6)))),
            0.5 - x / 6 * (1 - x / 4 * (1 - x / 5 * (1 - x / 6 * (1 - x / 7))))};
  }
  const double a = -std::expm1(-x) / x;
  return {a, (1 - a) / x};
}

// y with coth(y) - 1/y = s, 0 <= s < 1: from the approximation of Cohen (1991), Rheologica Acta 30, 270, 5 % at most,
// by two steps of Newton's method
double inverse_langevin(double s) noexcept {
  double y = s * (3 - s * s) / (1 - s * s);
  for (int i = 0; i < 2; ++i) {
    const auto [a, b] = response(2 * y);
    const double slope = y < 0.005 ? 1.0 / 3 : 1 / (y * y) - 1 / (std::sinh(y) * std::sinh(y));
    y -= (2 * b / a - 1 - s) / slope;
  }
  return std::max(y, 0.0);
}

// x with a(x) = share, by Newton's method from a rational that is right at both ends; 0 for a share of 1 and above
double rate_of_share(double share) noexcept {
  if (share >= 1) return 0;
  double x = (1 / share - 1) * (1 + share);
  for (int i = 0; i < 6; ++i) {
    const double a = response(x).end;
    x += x * (a - share) / (a - std::exp(-x));
  }
  return x;
}

}  // namespace

double remaining_share(double x) noexcept {
  return response(x).end;
}

DecayedIntegrals decayed_integrals(double x) noexcept {
  if (x > 2) {
    const double phi_1 = -std::expm1(-x) / x, phi_2 = (1 - phi_1) / x, phi_3 = (0.5 - phi_2) / x;
    const double phi_4 = (1.0 / 6 - phi_3) / x;
    return {phi_1, phi_2, phi_3, phi_4, (1.0 / 24 - phi_4) / x};
  }
  // below, the differences lose digits: 5! phi_5 by its series
  double sum = 1;
  for (int k = kLastTerm; k > 5; --k) sum = 1 - x / k * sum;
  const double phi_5 = sum / 120, phi_4 = 1.0 / 24 - x * phi_5, phi_3 = 1.0 / 6 - x * phi_4, phi_2 = 0.5 - x * phi_3;
  return {1 - x * phi_2, phi_2, phi_3, phi_4, phi_5};
}

RelaxingSpring one_for_all(std::span<const RelaxingSpring> springs, double H) noexcept {
  RelaxingSpring sum;
  double least = INFINITY, most = 0;
  for (const RelaxingSpring& spring : springs) {
    sum.K += spring.K;
    sum.F_dot += spring.F_dot;
    if (spring.K == 0 && spring.F_dot == 0) continue;
    least = std::min(least, spring.lambda);
    most = std::max(most, spring.lambda);
  }
  if (least >= most) {
    sum.lambda = most;
    return sum;
  }
  SpringResponse all;
  for (const RelaxingSpring& spring : springs) {
    if (spring.K == 0 && spring.F_dot == 0) continue;
    const SpringResponse part = response_of(spring, H);
    all.end += part.end, all.integral += part.integral, all.impulse += part.impulse;
  }
  return spring_with(all, H);
}

SpringResponse response_of(const RelaxingSpring& spring, double H) noexcept {
  const auto [a, b] = response(spring.lambda * H);
  return {spring.K * a, spring.K * b, spring.F_dot * b};
}

RelaxingSpring spring_with(const SpringResponse& all, double H, double most) noexcept {
  const auto [end, integral, impulse] = all;
  RelaxingSpring one;
  if (end > 0) {
    double x = 2 * inverse_langevin(std::clamp(2 * integral / end - 1, 0.0, kFastest));
    if (end > most * response(x).end) x = rate_of_share(end / most);
    const Response at_x = response(x);
    one.lambda = x / H;
    one.K = end / at_x.end;
    // mostly x again, but for the rounding of lambda
    const double rounded = one.lambda * H;
    one.F_dot = impulse / (rounded == x ? at_x : response(rounded)).integral;
  } else {
    one.F_dot = impulse / response(0).integral;
  }
  return one;
}

RelaxingSpring ended_at(const RelaxingSpring& spring, double change, double t_0, double H) noexcept {
  const auto [a_0, b_0] = response(spring.lambda * t_0);
  const double x = 2 * inverse_langevin(std::clamp(1 - 2 * t_0 / H * (1 - b_0 / a_0), 0.0, kFastest));
  const auto [a, b] = response(x);
  return {spring.K * t_0 * t_0 * b_0 / (H * H * b), x / H, change / (H * a)};
}

}  // namespace slew::math
