// SPDX-License-Identifier: Apache-2.0
// Warns about accumulators that no line can fill, and about volumes in which nothing moves.
//
// The limit of a volume is the highest pressure that its oil can have: of a fixed volume its pressure; elsewhere the
// highest limit of the volumes that a component joins to it, in either direction and at any control signal, without a
// limit where a pump, a source, a gear divider, a cylinder or a motor feeds it; and nowhere above the setting of a
// relief valve on it and the limit of the valve's outlet. The rise of a relief valve above its setting is left out: the
// accumulator takes oil then only while the valve passes more. Limits of pumps and unloading valves do not count.
#pragma once

#include "core/problem.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// A warning for each accumulator whose precharge is above the setting of the relief valve that limits its line.
// Pre-condition, here and below: validate() found no error so far.
void find_unfilled_accumulators(const HydraulicsDef& def, Problems& warnings);

// A warning for each hose on a fixed volume, and for each volume that only fixed volumes of its own start pressure, or
// volumes like it, are joined to.
void find_idle_volumes(const HydraulicsDef& def, Problems& warnings);

}  // namespace slew::hydraulics
