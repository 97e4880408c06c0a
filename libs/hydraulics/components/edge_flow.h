// SPDX-License-Identifier: Apache-2.0
// Flow through one edge of a valve that opens it by a position:
//
//   Q = u K root(d),   K = nominal_flow / sqrt(nominal_pressure_drop)                                           (1)
// u opening [1], d drop [Pa]. Source: Merritt 1967, orifices.
#pragma once

#include "hydraulics/smooth.h"

namespace slew::hydraulics {

// Flow through an edge [m3/s] with its slopes over the drop [m3/s/Pa] and over the position [m3/s].
struct EdgeFlow {
  double value = 0, over_drop = 0, over_position = 0;
};

// (1) at an opening with its slope over the position; K [m3/s/sqrt(Pa)], transition: d_t of root() [Pa].
[[nodiscard]] inline EdgeFlow edge_flow(const ValueSlope& opening, double K, double drop, double transition) noexcept {
  const ValueSlope r = root(drop, transition);
  return {opening.value * K * r.value, opening.value * K * r.slope, opening.slope * K * r.value};
}

}  // namespace slew::hydraulics
