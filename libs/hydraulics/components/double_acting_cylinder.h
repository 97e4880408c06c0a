// Double-acting cylinder: two chambers, a piston, a leak between them.
//
//   A_A = pi/4 D^2,  A_B = pi/4 (D^2 - d^2)
//   V_A = A_A s + V_0,  V_B = A_B (L_chamber - L_piston - s) + V_0     chamber volumes, wall modulus B_cylinder
//   Q_A = -v A_A - Q_leak,  Q_B = v A_B + Q_leak                       into the volumes; v = ds/dt > 0 extends
//   Q_leak = k (p_A - p_B),  k = leak_flow / leak_pressure
//   F = p_A A_A - p_B A_B                                              pushes the two points apart
//   s = element length - attachment_length - rod_length                the port coordinate is the stroke
//
// Friction and end stops belong to the line force (see LineForceParameters): the coupling evaluates them in port space.
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 2, tables 16 to 18. Deviation: friction has a
// modulus and the sign of the speed; as printed it would create energy. Not covered: mass of piston and oil (the
// mechanics' dummies carry it), cushioning orifices.
#pragma once

#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

struct DoubleActingCylinderDef final : ComponentDef {
  std::string force;                  // translational force element it drives
  std::string friction_curve;         // curve; empty: no friction proportional to the force
  std::string port_a;                 // volume, piston side
  std::string port_b;                 // volume, rod side
  double piston_diameter = 0;         // m
  double rod_diameter = 0;            // m
  double piston_length = 0;           // m
  double chamber_length = 0;          // m
  double rod_length = 0;              // m
  double attachment_length = 0;       // m
  double minimum_stroke = 0;          // m, lower end damper
  double maximum_stroke = 0;          // m, upper end damper
  double bulk_modulus = 1e10;         // Pa, of the barrel
  double cylinder_coefficient = 0.9;  // eta, 1 = no friction
  double seal_friction = 0;           // N
  double leak_flow = 0;               // m3/s across the piston ...
  double leak_pressure = 100e5;       // Pa ... at this difference
  double end_stiffness = 5e7;         // N/m
  double end_damping = 5e5;           // N s/m
  double dead_volume = 0;             // m3 in each chamber

  [[nodiscard]] std::string_view type_name() const noexcept override { return "double_acting_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType double_acting_cylinder_type();

}  // namespace slew::hydraulics
