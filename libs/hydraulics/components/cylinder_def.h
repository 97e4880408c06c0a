// What the linear and the slew cylinder have in common, as the two sides of the power port need it.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

// Parameters of the line force, evaluated in port space by both sides of the coupling:
//   F_line = F - F_mu + F_stop,  F = p_A A_A - p_B A_B
//   F_mu   = (|F| (1 - cylinder_coefficient) f(|v|) + seal_friction f_0(v)) sgn v
//   F_stop = max(0, end_stiffness d + end_damping d') at either end, pushing only
struct LineForceParameters {
  std::string friction_curve;       // coefficient f over piston speed, m/s
  double cylinder_coefficient = 1;  // eta
  double seal_friction = 0;         // N
  double end_stiffness = 0;         // N/m
  double end_damping = 0;           // N s/m
  double minimum_stroke = 0;        // m
  double maximum_stroke = 0;        // m
};

// x = offset + ratio * (coordinate of the force element): distance of its points [m] or angle [rad].
struct PortCoordinate {
  double offset = 0;  // m
  double ratio = 1;   // 1, or m/rad
};

}  // namespace slew::hydraulics
