// SPDX-License-Identifier: Apache-2.0
#include "contact/normal_law.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace slew::contact {
namespace {

// (3) / a^2, whose only root in (0, 1/e) is the wanted one: positive below, negative above. Near a = 0 both sides of
// (3) cancel, so the series is summed there.
double equation_over_a2(double a, double e) noexcept {
  constexpr double kSeriesLimit = 0.1;  // 0.1^16 is below the last bit
  constexpr int kTerms = 18;
  if (a >= kSeriesLimit) return (a * (1 + e) - std::log1p(a) + std::log1p(-a * e)) / (a * a);
  // ln(1+a) - ln(1-ae) = sum over k of ((-1)^(k+1) + e^k) a^k / k; k = 1 cancels a (1 + e)
  double sum = (1 - e) * (1 + e) / 2;
  double e_k = e * e, a_k = 1, sign = -1;
  for (int k = 3; k < kTerms; ++k) {
    e_k *= e;
    a_k *= a;
    sign = -sign;
    sum -= (sign + e_k) * a_k / k;
  }
  return sum;
}

// k d_ref (d/d_ref)^n and its slope over d
struct Spring {
  double force, slope;
};

Spring spring_at(const NormalLaw& law, double depth) noexcept {
  if (law.exponent == 1) return {law.stiffness * depth, law.stiffness};
  const double stiffness = law.stiffness * std::pow(depth / law.reference_depth, law.exponent - 1);
  return {stiffness * depth, law.exponent * stiffness};
}

}  // namespace

double damping_number(double restitution) noexcept {
  const double e = restitution;
  SLEW_ASSERT(e > 0 && e <= 1);
  if (e >= 1) return 0;
  // bisection: the root for e near 1 is small, so more rounds than a double has bits
  constexpr int kRounds = 120;
  double low = 0, high = 1 / e;
  for (int i = 0; i < kRounds; ++i) {
    const double middle = low + (high - low) / 2;
    (equation_over_a2(middle, e) > 0 ? low : high) = middle;
  }
  return low;
}

NormalLaw build(const NormalLawDef& def) {
  return {.stiffness = def.stiffness,
          .exponent = def.exponent,
          .reference_depth = def.reference_depth,
          .smallest_impact_speed = def.smallest_impact_speed,
          .damping_number = damping_number(def.restitution)};
}

void observe(const NormalLaw& law, double depth, double depth_rate, NormalState& state) noexcept {
  const double remembered = depth > 0 ? state.impact_speed : 0.0;
  state.impact_speed = std::max({remembered, depth_rate, law.smallest_impact_speed});
}

NormalForce evaluate(const NormalLaw& law, double share, double depth, double depth_rate,
                     const NormalState& state) noexcept {
  SLEW_ASSERT(state.impact_speed > 0);
  if (!(depth > 0)) return {};
  const Spring spring = spring_at(law, depth);
  // (2), and the bound of the header for an approach that is faster than the last observed one
  const double chi = law.damping_number / std::max(state.impact_speed, depth_rate);
  const double factor = 1 + chi * depth_rate;
  if (!(factor > 0)) return {};
  const double d_rate = depth_rate > state.impact_speed ? 0.0 : share * spring.force * chi;
  return {.force = share * spring.force * factor, .d_depth = share * spring.slope * factor, .d_depth_rate = d_rate};
}

NormalForce slopes_of_impact(const NormalLaw& law, double share, double depth, double depth_rate,
                             const NormalState& state, double mass) noexcept {
  const double v0 = std::max({state.impact_speed, depth_rate, law.smallest_impact_speed});
  const double d = std::max(depth, 0.0), n = law.exponent;
  const NormalState met{v0};
  if (!(depth_rate > 0 && share > 0)) return evaluate(law, share, d, depth_rate, met);
  const double K = share * law.stiffness * std::pow(law.reference_depth, 1 - n);
  double taken = 0.5 * depth_rate;
  if (law.damping_number > 0) taken = std::min(taken, v0 / law.damping_number);
  const double power = std::pow(d, n + 1) + (n + 1) * mass * depth_rate * taken / K;
  const double deepest = std::pow(power, 1 / (n + 1));
  NormalForce steepest = evaluate(law, share, deepest, 0, met);
  steepest.d_depth *= 1 + law.damping_number * depth_rate / v0;
  return steepest;
}

double stored_energy(const NormalLaw& law, double share, double depth) noexcept {
  if (!(depth > 0)) return 0;
  return share * spring_at(law, depth).force * depth / (law.exponent + 1);
}

void share_stiffness(std::span<const double> depths, std::span<const double> areas, std::span<double> shares) noexcept {
  SLEW_ASSERT(depths.size() == shares.size() && areas.size() == shares.size());
  double sum = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i] = areas[i] * std::max(depths[i], 0.0);
    sum += shares[i];
  }
  for (double& share : shares) share = sum > 0 ? share / sum : 0.0;
}

}  // namespace slew::contact
