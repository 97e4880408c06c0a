// SPDX-License-Identifier: Apache-2.0
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
  CylinderParameters common;  // force: rotational; p_A pushes +phi; piston length: that of the double piston
  double pinion_radius = 0;   // m
  double stroke_offset = 0;   // m, piston position at phi = 0

  [[nodiscard]] std::string_view type_name() const noexcept override { return "slew_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ActuatorDef> actuator() const override;
};

[[nodiscard]] ComponentType slew_cylinder_type();

}  // namespace slew::hydraulics
