// SPDX-License-Identifier: Apache-2.0
// Single-acting cylinder or plunger: oil on one side, the other side open to the air or to the tank.
//
//   A = pi/4 D^2,  V_A = A s + V_0,  Q_A = -v A - Q_leak               into the volume; v = ds/dt > 0 extends
//   F = (p_A - p_B) A                                                  pushes the two points apart
//   Q_leak = k (p_A - p_B),  k = leak_flow / leak_pressure             past the piston to the open side
//   s = element length - attachment_length - rod_length                the port coordinate is the stroke
//
// p_B is the pressure around the rod: on the open side of the piston and on the rod's end together it acts on the full
// area A. Port B is a volume with fixed: true (air or tank). A load or a spring of the force element retracts it: p_A
// has no pull beyond the vacuum, where the chamber cavitates. Friction and end stops as for the double-acting cylinder.
// Source: Merritt 1967, section 6.1, with one side at constant pressure. Not covered: mass of piston and oil.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

struct SingleActingCylinderDef final : ComponentDef {
  CylinderParameters common;     // force: translational; port B: fixed volume
  double rod_length = 0;         // m
  double attachment_length = 0;  // m

  [[nodiscard]] std::string_view type_name() const noexcept override { return "single_acting_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ActuatorDef> actuator() const override;
};

[[nodiscard]] ComponentType single_acting_cylinder_type();

}  // namespace slew::hydraulics
