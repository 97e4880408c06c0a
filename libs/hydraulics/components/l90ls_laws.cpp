#include "hydraulics/components/l90ls_laws.h"

#include <algorithm>
#include <cmath>

namespace slew::hydraulics {
namespace {

constexpr double kClipWidth = 0.01;  // of a shock valve's opening, smoothing of its limits
constexpr double kCheckWidth = 1e4;  // Pa over which an anti-cavitation valve lifts off
constexpr double kLeakWidth = 1e4;   // Pa, smoothing of the leak behind the lock-hold

}  // namespace

SupplyFlow supply(const L90Side& side, double opening, double drop, double load) noexcept {
  // leak past the closed edge, out of P only: the lock-hold lies before it
  const ValueSlope forward = ramp(drop, kLeakWidth);
  SupplyFlow flow{side.G_leak * forward.value, 0, side.G_leak * forward.slope, 0};
  if (opening <= 0 || drop <= 0) return flow;

  // (2) what the compensator holds; falls to zero as the load passes the LS limit by the compensator's setting
  const ValueSlope over = ramp(load - side.maximum_ls, kLsWidth);
  const ValueSlope held = ramp(side.compensator_pressure - over.value, kLsWidth);
  // (3) what is left of the drop when the compensator is fully open
  const double K = opening * side.K_supply;
  const double share = side.K_comp_2 / (side.K_comp_2 + K * K);
  const ValueSlope lock = ramp(drop, side.opening_rise);
  const double available = lock.value * share;
  // (4), closed by the compensator as well as by the lock-hold
  const ValueSlopes dp = least(held.value, available, kLsWidth);
  const ValueSlope r = root(dp.value, side.transition);
  const double d_available = K * r.slope * dp.slope_b;
  flow.Q += K * r.value;
  flow.d_load = -K * r.slope * dp.slope_a * held.slope * over.slope;
  flow.d_drop += d_available * share * lock.slope;
  flow.d_opening = side.K_supply * (r.value - d_available * lock.value * 2 * K * share * share / side.K_comp_2);
  return flow;
}

ValueSlope shock(const L90Side& side, double drop) noexcept {
  if (drop <= side.shock_setting) return {0, 0};
  // (5)
  const ValueSlope u = unit_clip((drop - side.shock_setting) / side.shock_rise, kClipWidth);
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

ReturnFlow to_tank(const L90Side& side, double opening, double drop) noexcept {
  ReturnFlow flow{side.G_leak * drop, 0, side.G_leak};
  if (drop > side.shock_setting || drop < -side.crack) {
    const ValueSlope valve = drop > 0 ? shock(side, drop) : anti_cavitation(side, drop);
    flow.Q += valve.value;
    flow.d_drop += valve.slope;
  }
  if (opening > 0) {
    const ValueSlope r = root(drop, side.transition);
    flow.Q += opening * side.K_return * r.value;
    flow.d_opening = side.K_return * r.value;
    flow.d_drop += opening * side.K_return * r.slope;
  }
  return flow;
}

double steeper_return_slope(const L90Side& side, double drop, double margin) noexcept {
  double rise = 0;
  if (std::fabs(-drop - side.crack) <= margin) {
    const double open = anti_cavitation(side, -side.crack - kCheckWidth).slope;
    rise += std::max(0.0, open - anti_cavitation(side, drop).slope);
  }
  if (std::fabs(drop - side.shock_setting) <= margin) {
    const double open = shock(side, side.shock_setting + std::max(margin, kClipWidth * side.shock_rise)).slope;
    rise += std::max(0.0, open - shock(side, drop).slope);
  }
  return rise;
}

}  // namespace slew::hydraulics
