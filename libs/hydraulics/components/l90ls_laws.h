// SPDX-License-Identifier: Apache-2.0
// Flow laws of one side (A or B) of the L90LS valve, equations (2) to (6) of l90ls_valve.h, with their slopes.
#pragma once

#include "hydraulics/smooth.h"

namespace slew::hydraulics {

inline constexpr double kLsWidth = 5e4;  // Pa, smoothing of the LS limit and of the compensator's switches

struct L90Side {
  double K_supply = 0, K_return = 0;  // m3/s/sqrt(Pa), fully open edges
  double K_comp_2 = 0;                // square of the compensator's conductance
  double compensator_pressure = 0;    // Pa
  double maximum_ls = 0;              // Pa above tank
  double opening_rise = 0;            // Pa, rise of the lock-hold
  double G_leak = 0;                  // m3/s/Pa
  double shock_setting = 0, shock_rise = 0, K_shock = 0;
  double K_anti_cavitation = 0, crack = 0;
  double transition = 0;  // Pa, transition of the orifices
};

// Flow from P into the port; drop = p_P - p_port, load = p_port - p_T.
struct SupplyFlow {
  double Q, d_opening, d_drop, d_load;
};

// Flow from the port to T; drop = p_port - p_T.
struct ReturnFlow {
  double Q, d_opening, d_drop;
};

// Parts of to_tank() as functions of the drop: shock valve (>= 0), anti-cavitation valve (<= 0: into the port).
[[nodiscard]] ValueSlope shock(const L90Side& side, double drop) noexcept;
[[nodiscard]] ValueSlope anti_cavitation(const L90Side& side, double drop) noexcept;

inline constexpr double kLeakWidth = 1e4;  // Pa, smoothing of the leak behind the lock-hold

// (2) to (4) for an open edge with drop > 0, without the leak.
[[nodiscard]] SupplyFlow metered(const L90Side& side, double opening, double drop, double load) noexcept;

[[nodiscard]] inline SupplyFlow supply(const L90Side& side, double opening, double drop, double load) noexcept {
  // leak past the closed edge, only out of P: the lock-hold is upstream
  const ValueSlope forward = ramp(drop, kLeakWidth);
  const double leak = side.G_leak * forward.value, d_leak = side.G_leak * forward.slope;
  if (opening <= 0 || drop <= 0) return {leak, 0, d_leak, 0};
  const SupplyFlow flow = metered(side, opening, drop, load);
  return {leak + flow.Q, flow.d_opening, d_leak + flow.d_drop, flow.d_load};
}

[[nodiscard]] inline ReturnFlow to_tank(const L90Side& side, double opening, double drop) noexcept {
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

// Growth of the slope of to_tank() on the steeper side of a switch closer than `margin`.
[[nodiscard]] double steeper_return_slope(const L90Side& side, double drop, double margin) noexcept;

}  // namespace slew::hydraulics
