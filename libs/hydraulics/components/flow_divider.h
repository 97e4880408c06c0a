// SPDX-License-Identifier: Apache-2.0
// Flow divider and combiner: two branches share a flow in a fixed ratio whatever their pressures.
//
// Spool type. Each branch has a metering orifice and an edge of the spool in series:
//   Q_i = K_i w_i/sqrt(w_i^2 + k^2) root(p_1 - p_i),   k^2 = spool_pressure_drop/metering_pressure_drop            (1)
//   K_2 = share K,  K_3 = (1 - share) K,   K = nominal_flow/sqrt(metering_pressure_drop)
//   w_2 = 1 - (1 - least_opening) max(y, 0),   w_3 = 1 - (1 - least_opening) max(-y, 0)                            (2)
//   tau y' = clip(s (d_2 - d_3)/regulation_pressure, -1, 1) - y,   tau = step_response/3                         (3)
//   d_i = w_i^2/(w_i^2 + k^2) (p_1 - p_i),   s = T/sqrt(T^2 + T_s^2),   T = Q_2 + Q_3,   T_s = nominal_flow/50
// 1 common port, 2 and 3 branches, d_i drop over the metering orifice. The spool throttles the branch that has more
// than its share. s is the sign of the flow at the common port: from the branches to it the same law combines, as a
// pair of hooked spools does. least_opening lets a branch go on while the other one stands still.
//
// Gear type. Two gear units on one shaft:
//   Q_i = D_i w + G (p_1 - p_i)                                                                                    (4)
//   J w' = sum D_i (p_1 - p_i) - T_f w/sqrt(w^2 + w_f^2),   T_f = (D_2 + D_3) friction_pressure                    (5)
// D_i displacement, G = leak_flow/leak_pressure of each unit, J inertia. A branch without load drives the other one:
// its pressure may rise above that of the common port (intensification); give each branch a relief.
//
// Sources: Merritt 1967 for the orifices; (3) and (5) are balances of forces and torques. Not covered: flow forces and
// mass of the spool, the stroke of hooked spools between dividing and combining, efficiency of the gears over speed.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct FlowDividerDef final : ComponentDef {
  std::string port_1, port_2, port_3;   // volumes: common port, branches
  double nominal_flow = 0;              // m3/s at the common port, spool in its middle ...
  double metering_pressure_drop = 5e5;  // Pa ... with this drop over the metering orifices ...
  double spool_pressure_drop = 2e5;     // Pa ... and this one over the open edges of the spool
  double share = 0.5;                   // of branch 2
  double regulation_pressure = 0.5e5;   // Pa, difference of the metering drops at which an edge is least open
  double least_opening = 0.02;          // share of an edge that stays open
  double step_response = 0.03;          // s, three time constants

  [[nodiscard]] std::string_view type_name() const noexcept override { return "flow_divider"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct GearFlowDividerDef final : ComponentDef {
  std::string port_1, port_2, port_3;  // volumes: common port, branches
  double displacement_2 = 0;           // m3/rad of branch 2
  double displacement_3 = 0;           // m3/rad of branch 3
  double inertia = 1e-3;               // kg m2
  double friction_pressure = 3e5;      // Pa, drop at which it turns without load
  double friction_speed = 1;           // rad/s, w_f, speed at which the friction is seven tenths of its full size
  double leak_flow = 0;                // m3/s of each unit ...
  double leak_pressure = 100e5;        // Pa ... at this difference

  [[nodiscard]] std::string_view type_name() const noexcept override { return "gear_flow_divider"; }
  [[nodiscard]] bool raises_pressure() const override { return true; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType flow_divider_type();
[[nodiscard]] ComponentType gear_flow_divider_type();

}  // namespace slew::hydraulics
