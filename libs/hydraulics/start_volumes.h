// SPDX-License-Identifier: Apache-2.0
// Volumes that an equilibrium start sets although no actuator is on them.
//
// Oil at rest has one pressure on both sides of an open passage. Volumes that open passages join, with no fixed volume,
// pressure source or pump's outlet among them, therefore begin at the pressure of the actuator's volume that is
// nearest, by the number of passages: a hose behind a throttle, the line to a shut valve, an accumulator behind its
// orifice. A volume with an initial_pressure of its own, other than the default, keeps it. Where a pump or a tank is
// joined, no rest is known, and every volume begins at its initial pressure.
//
// Open: what pump_lines.h calls open in both directions, a hose-burst valve, and flow dividers.
#pragma once

#include <vector>

#include "core/problem.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// By volume: index of the actuator's volume whose start pressure it takes, -1: none. Pre-condition: a validated def.
[[nodiscard]] std::vector<int> joined_to_actuators(const HydraulicsDef& def);

// A warning for each initial_pressure that an equilibrium start replaces: of a volume with an actuator or at a pump's
// outlet, where it is neither the default nor what is taken in its place. Pre-condition: validate() found no error.
void find_replaced_pressures(const HydraulicsDef& def, Problems& warnings);

}  // namespace slew::hydraulics
