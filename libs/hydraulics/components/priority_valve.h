// SPDX-License-Identifier: Apache-2.0
// Priority valve: the priority line gets what it demands first, the other line the rest of the pump's flow.
//
//   tau u' = clip((p_2 - p_T - p_LS - spring_pressure) / regulation_pressure, 0, 1) - u,  tau = step_response / 3  (1)
//   Q_12 = (1 - u) K root(p_1 - p_2)      priority line                                                        (2)
//   Q_13 = u K root(p_1 - p_3)            the rest                                                             (3)
// 1 pump, 2 priority line (steering, brakes), 3 other line, T tank; p_LS load-sensing pressure of the priority line
// above the tank (ls_port; 0 without), K = nominal_flow / sqrt(nominal_pressure_drop). The valve holds the priority
// line at p_LS + spring_pressure, within regulation_pressure: below it all oil goes there, above it into the other
// line.
//
// Source: Merritt 1967 for the orifices; (1) is the balance of forces on the spool. Not covered: flow forces, inertia,
// damping orifices of the pilot lines other than tau.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct PriorityValveDef final : ComponentDef {
  std::string port_1, port_2, port_3, port_t;  // volumes: pump, priority line, other line, tank
  std::string ls_port;                         // component with the priority line's load-sensing pressure; empty: none
  double spring_pressure = 7e5;                // Pa
  double regulation_pressure = 2e5;            // Pa from priority alone to the other line alone
  double nominal_flow = 0;                     // m3/s, either edge fully open ...
  double nominal_pressure_drop = 5e5;          // Pa ... at this drop
  double step_response = 0.03;                 // s, three time constants

  [[nodiscard]] std::string_view type_name() const noexcept override { return "priority_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType priority_valve_type();

}  // namespace slew::hydraulics
