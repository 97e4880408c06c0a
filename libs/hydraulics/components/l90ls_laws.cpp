// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/components/l90ls_laws.h"

#include <algorithm>
#include <cmath>

namespace slew::hydraulics {
namespace {

constexpr double kShockClipWidth = 0.01;  // share of a shock valve's opening, smoothing of its limits
constexpr double kCheckWidth = 1e4;       // Pa over which an anti-cavitation valve lifts off

}  // namespace

SupplyFlow metered(const L90Side& side, double opening, double drop, double load) noexcept {
  // (2) the drop held by the compensator; falls to zero when the load exceeds the LS limit by the compensator's setting
  const ValueSlope over = ramp(load - side.maximum_ls, kLsWidth);
  const ValueSlope held = ramp(side.compensator_pressure - over.value, kLsWidth);
  // (3) the remaining drop with the compensator fully open
  const double K = opening * side.K_supply;
  const double share = side.K_comp_2 / (side.K_comp_2 + K * K);
  const ValueSlope lock = ramp(drop, side.opening_rise);
  const double available = lock.value * share;
  // (4), closed by the compensator as well as by the lock-hold
  const ValueSlopes dp = least(held.value, available, kLsWidth);
  const ValueSlope r = root(dp.value, side.transition);
  const double d_available = K * r.slope * dp.slope_b;
  const double d_load = -K * r.slope * dp.slope_a * held.slope * over.slope;
  const double d_drop = d_available * share * lock.slope;
  const double d_opening = side.K_supply * (r.value - d_available * lock.value * 2 * K * share * share / side.K_comp_2);
  return {K * r.value, d_opening, d_drop, d_load};
}

ValueSlope shock(const L90Side& side, double drop) noexcept {
  if (drop <= side.shock_setting) return {0, 0};
  // (5)
  const ValueSlope u = unit_clip((drop - side.shock_setting) / side.shock_rise, kShockClipWidth);
  const ValueSlope r = root(drop, side.transition);
  return {u.value * side.K_shock * r.value, side.K_shock * (u.slope / side.shock_rise * r.value + u.value * r.slope)};
}

ValueSlope anti_cavitation(const L90Side& side, double drop) noexcept {
  const double over = -drop - side.crack;
  if (over <= 0) return {0, 0};
  // (6)
  const ValueSlope lift = ramp(over, kCheckWidth);
  const ValueSlope r = root(lift.value, side.transition);
  return {-side.K_anti_cavitation * r.value, side.K_anti_cavitation * r.slope * lift.slope};
}

double steeper_return_slope(const L90Side& side, double drop, double margin) noexcept {
  double rise = 0;
  if (std::fabs(-drop - side.crack) <= margin) {
    const double open = anti_cavitation(side, -side.crack - kCheckWidth).slope;
    rise += std::max(0.0, open - anti_cavitation(side, drop).slope);
  }
  if (std::fabs(drop - side.shock_setting) <= margin) {
    const double open = shock(side, side.shock_setting + std::max(margin, kShockClipWidth * side.shock_rise)).slope;
    rise += std::max(0.0, open - shock(side, drop).slope);
  }
  return rise;
}

}  // namespace slew::hydraulics
