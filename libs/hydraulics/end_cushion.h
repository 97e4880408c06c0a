// SPDX-License-Identifier: Apache-2.0
// The law of an end cushion with the circuit's oil: K = C_d A sqrt(2/rho) of math/cushion.h. Density and transition are
// those of the definition; they do not follow the oil's temperature, since the mechanics evaluate the same law.
#pragma once

#include "hydraulics/actuator_def.h"
#include "hydraulics/hydraulics_def.h"
#include "math/cushion.h"

namespace slew::hydraulics {

[[nodiscard]] math::CushionDef cushion_law(const EndCushion& cushion, const HydraulicsDef& circuit);

}  // namespace slew::hydraulics
