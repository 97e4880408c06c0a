// Slew cylinder: a double piston with a rack that turns a pinion.
//
//   x = stroke_offset + r phi                           piston position from the pinion's angle phi
//   A = pi/4 D^2 on both sides
//   V_A = A x + V_0,  V_B = A (L_chamber - L_piston - x) + V_0
//   Q_A = -v A - Q_leak,  Q_B = v A + Q_leak,  F = (p_A - p_B) A,  torque = r F    p_A pushes +phi
//
// Friction and end stops as for the linear cylinder. Source: the flexible-body tutorial thesis (Saimaa UAS 2017),
// table 16. Not covered: backlash and elasticity of the rack.
#pragma once

#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

struct SlewCylinderDef final : ComponentDef {
  std::string force;                  // rotational force element it drives
  std::string friction_curve;         // curve; empty: no friction proportional to the force
  std::string port_a;                 // volume; its pressure pushes +phi
  std::string port_b;                 // volume
  double piston_diameter = 0;         // m
  double piston_length = 0;           // m
  double chamber_length = 0;          // m
  double pinion_radius = 0;           // m
  double stroke_offset = 0;           // m, piston position at phi = 0
  double minimum_stroke = 0;          // m
  double maximum_stroke = 0;          // m
  double bulk_modulus = 1e10;         // Pa, of the barrel
  double cylinder_coefficient = 0.9;  // eta, 1 = no friction
  double seal_friction = 0;           // N
  double leak_flow = 0;               // m3/s across the piston ...
  double leak_pressure = 100e5;       // Pa ... at this difference
  double end_stiffness = 5e7;         // N/m
  double end_damping = 5e5;           // N s/m
  double dead_volume = 0;             // m3 in each chamber

  [[nodiscard]] std::string_view type_name() const noexcept override { return "slew_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType slew_cylinder_type();

}  // namespace slew::hydraulics
