// SPDX-License-Identifier: Apache-2.0
// Whether rk4 stays stable beside rows that friction holds, when modes or springs answer behind them.
//
// The port problem finds the force of a row from its mobility at the start of a sub-step h (port_problem.h), while the
// mechanism answers that force with all its modes during h. A row that friction holds then pushes against the modes
// with a force that is late by up to h, and this gives them energy: what grows so is no motion of the mechanism, and
// the row creeps under it. The map of one sub-step, linear about the start at rest,
//   a  = C z,  f = port problem of (v, a, trend of a, W) with f_i = -c_i v_i                                       (1)
//   z' = R(h A) z + G_1 f_mean + G_2 f_slope,   z = (x, v)                                                         (2)
// with A as in multibody/formulations/element_speeds.h under the forces that hold the ports, C the accelerations of the
// rows, c the slope of each row's friction at rest under that force, R and G the rule's own, is taken 4000 times, from
// a blow at the rows. The limiter of the trend makes (1) no matrix, but leaves it proportional, so that growth by a
// sub-step is defined. Too long is a sub-step whose accelerations grow by more than 1.001 each, and by more than the
// motion itself does (the eigenvalues of A with the friction).
//
// semi_implicit_euler takes the accelerations of the start as the port problem does, and implicit rules have rows over
// the sub-step (row_mobility.h): neither is checked. Left out: the oil's springs, contacts, stops, mechanisms of more
// than kMostSpeeds speeds. An instant, not a bound for all poses.
#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"

namespace slew::mechanics_node {

struct UnstableRow {
  std::string row{};        // that pushes most
  std::string body{};       // flexible, whose modes move most; empty: none moves
  double growth = 0;        // factor in one sub-step
  double substep = 0;       // s
  double longest_step = 0;  // s, from which on down to a half none grows; 0: not found
};

// None: another rule, no rows or no springs behind them, or stable. Pre-condition: a validated scene. Allocates.
[[nodiscard]] std::optional<UnstableRow> find_unstable_row(const scene::Scene& scene);

// The sentence for it.
[[nodiscard]] std::string warning_of(const UnstableRow& found);

}  // namespace slew::mechanics_node
