// SPDX-License-Identifier: Apache-2.0
// Double-rod cylinder: a rod through both ends, the same annulus on either side of the piston.
//
//   A = pi/4 (D^2 - d^2) on both sides
//   V_A = A s + V_0,  V_B = A (L_chamber - L_piston - s) + V_0         chamber volumes, wall modulus B_cylinder
//   Q_A = -v A - Q_leak,  Q_B = v A + Q_leak                           into the volumes; v = ds/dt > 0 extends
//   F = (p_A - p_B) A                                                  pushes the two points apart
//   s = element length - attachment_length - rod_length                the port coordinate is the stroke
//
// Leak, friction and end stops as for the double-acting cylinder; an equilibrium start holds the load around the mean
// start_slew_pressure, as for the slew cylinder: neither side is a return side. Source: Merritt 1967, Hydraulic Control
// Systems, section 6.1 (valve-piston combination). Not covered: mass of piston and oil, cushioning orifices.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

struct DoubleRodCylinderDef final : ComponentDef {
  CylinderParameters common;     // force: translational; p_A pushes it longer
  double rod_diameter = 0;       // m
  double rod_length = 0;         // m
  double attachment_length = 0;  // m

  [[nodiscard]] std::string_view type_name() const noexcept override { return "double_rod_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ActuatorDef> actuator() const override;
};

[[nodiscard]] ComponentType double_rod_cylinder_type();

}  // namespace slew::hydraulics
