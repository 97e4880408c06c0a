// SPDX-License-Identifier: Apache-2.0
// Why a cylinder did not move although its valve was fully open: a sentence for the summary of a run.
//
// A stall is a time of at least half a second, from one second after the full-opening command to the valve, in which a
// double-acting cylinder does not move against its load. The pressure that would move it,
//   p = (F + p_other A_other) / A,   F = (F_static + F_seal) / eta                                        (1)
// (F_static: force that holds the load, eta: the cylinder's efficiency) is compared with the pressure at which an L90LS
// valve stops feeding, p_LSmax + p_comp above tank. The load that could be moved follows from F_static, which is linear
// in the load's mass; the mechanics states its slope (`Cyl_Lift.static_force_per_kg`).
//
// Not covered: other valves and cylinders, several cylinders on one load, a pump that another section has saturated.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "session/curves.h"

namespace slew::analysis {

// One sentence for each cylinder that stalled. Empty also when the curves lack the variables it needs.
[[nodiscard]] std::vector<std::string> explain_stalls(const session::Curves& curves, const scene::Scene& scene);
// The variables that this looks at.
[[nodiscard]] std::vector<std::string> stall_variables(const scene::Scene& scene);

}  // namespace slew::analysis
