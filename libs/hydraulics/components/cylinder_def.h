// SPDX-License-Identifier: Apache-2.0
// Parameters common to all cylinders, and the parameters for both sides of the power port.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

// Way of the oil back into a cushion when the piston leaves the end: freely through a check valve, or the throttle.
enum class CushionReturn { check_valve, throttle };

// Cushion of one chamber (math/cushion.h): a plunger on the piston shuts the port before the end of the stroke.
struct CushionParameters {
  double length = 0;                    // m, before the end of the stroke; 0: no cushion
  double entry_length = 1e-3;           // m, way on which the plunger shuts the port
  double plunger_diameter = 0;          // m; 0: the whole chamber is enclosed
  double orifice_diameter = 0;          // m, of a throttle of constant area; 0: areas
  Table areas;                          // remaining stroke [m], area of the throttle [m2]
  double discharge_coefficient = 0.67;  // of the throttle
  CushionReturn flow_back = CushionReturn::check_valve;
};

// Part of every cylinder's Def.
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
  double breakaway_friction = 0;      // N, of the seals at rest beside seal_friction
  double stribeck_speed = 0.01;       // m/s, at which 1/e of it is left
  double leak_flow = 0;               // m3/s across the piston ...
  double leak_pressure = 100e5;       // Pa ... at this difference
  double end_stiffness = 5e7;         // N/m
  double end_damping = 5e5;           // N s/m
  double dead_volume = 0;             // m3 in each chamber
  double dead_volume_a = 0;           // m3 in chamber A beside it: its port and lines
  double dead_volume_b = 0;           // m3 in chamber B beside it
  PortCoupling coupling = PortCoupling::session;
  CushionParameters cushion_a = {}, cushion_b = {};  // at the minimum stroke, at the maximum stroke

  // L_chamber - L_piston, the piston's free travel [m].
  [[nodiscard]] double piston_travel() const noexcept { return chamber_length - piston_length; }
};

}  // namespace slew::hydraulics
