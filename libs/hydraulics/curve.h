// SPDX-License-Identifier: Apache-2.0
// Curves of a scene as tables of straight lines.
#pragma once

#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

// The points of a linear curve; for pchip the monotone cubic (Fritsch and Carlson 1980) sampled at 16 equal parts of
// every interval. Oddness is not expanded: the table holds the points of the scene.
// Pre-condition: at least two points, arguments strictly increasing.
[[nodiscard]] Table straight_lines(const CurveDef& curve);

// Null if the circuit lacks the curve.
[[nodiscard]] const CurveDef* find_curve(const HydraulicsDef& circuit, std::string_view name);

}  // namespace slew::hydraulics
