// SPDX-License-Identifier: Apache-2.0
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
// modulus and the sign of the speed; as printed it would create energy. Cushions: math/cushion.h. Not covered: mass of
// piston and oil (the mechanics' dummies carry it).
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

struct DoubleActingCylinderDef final : ComponentDef {
  CylinderParameters common;     // force: translational; port A: piston side, port B: rod side
  double rod_diameter = 0;       // m
  double rod_length = 0;         // m
  double attachment_length = 0;  // m

  [[nodiscard]] std::string_view type_name() const noexcept override { return "double_acting_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ActuatorDef> actuator() const override;
};

[[nodiscard]] ComponentType double_acting_cylinder_type();

}  // namespace slew::hydraulics
