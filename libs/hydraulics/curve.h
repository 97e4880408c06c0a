// SPDX-License-Identifier: Apache-2.0
// Curves of a scene: as functions of components, and as tables of straight lines.
#pragma once

#include "hydraulics/hydraulics_def.h"
#include "hydraulics/smooth.h"
#include "math/monotone_cubic.h"

namespace slew::hydraulics {

// A curve with its slope: straight lines, or with pchip the monotone cubic itself (math/monotone_cubic.h), whose slope
// is continuous. Beyond the ends the last value is held.
class CurveFunction {
 public:
  CurveFunction() = default;  // no curve
  // Pre-condition: at least two points, arguments strictly increasing; not odd.
  explicit CurveFunction(const CurveDef& curve);

  [[nodiscard]] bool empty() const noexcept { return lines_.empty() && cubic_.empty(); }
  // Pre-condition: not empty. Real-time safe.
  [[nodiscard]] ValueSlope at(double x) const noexcept;

 private:
  Table lines_;                // empty with pchip
  math::MonotoneCubic cubic_;  // empty with straight lines
};

// For laws that need a table: the points of a linear curve; for pchip the monotone cubic (Fritsch and Carlson 1980)
// sampled at 16 equal parts of every interval. Oddness is not expanded: the table holds the points of the scene.
// Pre-condition: at least two points, arguments strictly increasing.
[[nodiscard]] Table straight_lines(const CurveDef& curve);

// Null if the circuit lacks the curve.
[[nodiscard]] const CurveDef* find_curve(const HydraulicsDef& circuit, std::string_view name);

}  // namespace slew::hydraulics
