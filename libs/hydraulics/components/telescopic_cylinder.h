// SPDX-License-Identifier: Apache-2.0
// Telescopic cylinder, single-acting: tubes in each other, of which the one with the largest area extends first and
// retracts last (staged_area.h).
//
//   A(x), V(x) of the stages;  V_A = V(x) + V_0,  Q_A = -v A(x) - Q_leak     into the volume; v = dx/dt > 0 extends
//   F = (p_A - p_B) A(x)                                                     pushes the two points apart
//   Q_leak = k (p_A - p_B),  k = leak_flow / leak_pressure                   past the seals to the open side
//   x = element length - closed_length                                       the port coordinate is the stroke
//
// p_B is the pressure around the cylinder, on a volume with fixed: true (air or tank). A load or a spring of the force
// element retracts it. At the end of a stage the pressure rises from F/A_i to F/A_(i+1) over stage_transition. Friction
// and end stops as for the double-acting cylinder. Source: balances of force and oil over the stages. Not covered: mass
// of tubes and oil, friction by stage, a double-acting last stage, loads that pull.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

struct TelescopicCylinderDef final : ComponentDef {
  CylinderParameters common;       // connections, stroke limits, friction, leak, stops; port B: fixed volume
  Table stages;                    // stroke at the end of each stage [m], diameter of its area [m]
  double stage_transition = 2e-3;  // m, elastic way about the end of a stage
  double closed_length = 0;        // m, between the points at stroke 0

  [[nodiscard]] std::string_view type_name() const noexcept override { return "telescopic_cylinder"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ActuatorDef> actuator() const override;
};

[[nodiscard]] ComponentType telescopic_cylinder_type();

}  // namespace slew::hydraulics
