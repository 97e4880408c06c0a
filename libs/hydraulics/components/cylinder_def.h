// Parameters common to all cylinders, and the parameters for both sides of the power port.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

// Parameters of the line force, evaluated in port space by both sides of the coupling:
//   F_line = F - F_mu + F_stop,  F = p_A A_A - p_B A_B
//   F_mu   = (|F| (1 - cylinder_coefficient) f(|v|) + seal_friction f_0(v)) sgn v + viscous_friction v
//   F_stop = max(0, end_stiffness d + end_damping d') at either end, pushing only
struct LineForceParameters {
  std::string friction_curve;       // coefficient f over piston speed, m/s
  double cylinder_coefficient = 1;  // eta
  double seal_friction = 0;         // N
  double viscous_friction = 0;      // N s/m
  double end_stiffness = 0;         // N/m
  double end_damping = 0;           // N s/m
  double minimum_stroke = 0;        // m
  double maximum_stroke = 0;        // m
};

// Coupling level of the cylinder's power port: a level of its own or the session's. coupling/level.h defines the
// levels.
enum class PortCoupling : int { session, hold, linear, two, tlm };

// x = offset + ratio * (coordinate of the force element): distance of its points [m] or angle [rad].
struct PortCoordinate {
  double offset = 0;  // m
  double ratio = 1;   // 1, or m/rad
};

// Common part of every cylinder's Def.
struct CylinderParameters {
  std::string force;                  // force element it drives
  std::string friction_curve;         // curve; empty: no friction proportional to the force
  std::string port_a;                 // volume; its pressure pushes x to grow
  std::string port_b;                 // volume
  double piston_diameter = 0;         // m
  double piston_length = 0;           // m
  double chamber_length = 0;          // m
  double minimum_stroke = 0;          // m, lower end damper
  double maximum_stroke = 0;          // m, upper end damper
  double bulk_modulus = 1e10;         // Pa, of the barrel
  double cylinder_coefficient = 0.9;  // eta, 1 = no friction
  double seal_friction = 0;           // N
  double viscous_friction = 0;        // N s/m
  double leak_flow = 0;               // m3/s across the piston ...
  double leak_pressure = 100e5;       // Pa ... at this difference
  double end_stiffness = 5e7;         // N/m
  double end_damping = 5e5;           // N s/m
  double dead_volume = 0;             // m3 in each chamber
  PortCoupling coupling = PortCoupling::session;

  // L_chamber - L_piston, the piston's free travel [m].
  [[nodiscard]] double piston_travel() const noexcept { return chamber_length - piston_length; }
};

}  // namespace slew::hydraulics
