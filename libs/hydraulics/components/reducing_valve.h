// SPDX-License-Identifier: Apache-2.0
// Pressure-reducing valve of three ways: holds its outlet at a setting below the supply, and relieves it above.
//
//   tau y' = clip((p_set - (p_2 - p_3)) / regulation_pressure, -1, 1) - y,   tau = step_response / 3            (1)
//   p_set = max(setting_pressure + pressure_per_signal signal, 0)                                              (2)
//   Q_12 = e(y) K root(p_1 - p_2),   Q_23 = e(-y) K root(p_2 - p_3)                                             (3)
//   e(y) = underlap(y, w_u) of smooth.h: y beyond the middle, 0 before it, w_u/4 in it; w_u = 1e-3              (4)
// y spool position, 1 supply, 2 reduced outlet, 3 drain, which the setting is relative to; K = nominal_flow /
// sqrt(nominal_pressure_drop). The outlet falls below p_set by regulation_pressure at the flow of the full opening.
// With a signal it is the pilot valve of a lever or a solenoid. Oil goes through an open edge both ways: an outlet
// below p_set runs back into a supply that falls. Shut lands would hold an outlet at p_set whatever the supply does; by
// (4) they leak in the middle, so that it falls, the spool opens and the outlet follows the supply.
//
// Source: Merritt 1967 for the orifices; (1) is the balance of forces on the spool, without its inertia. Not
// covered: flow forces, hysteresis, pilot stage.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct ReducingValveDef final : ComponentDef {
  std::string port_1, port_2, port_3;   // volumes: supply, reduced outlet, drain
  double setting_pressure = 0;          // Pa above the drain, without a signal
  double pressure_per_signal = 0;       // Pa per unit of the control signal
  double regulation_pressure = 2e5;     // Pa from closed to fully open
  double nominal_flow = 0;              // m3/s, fully open ...
  double nominal_pressure_drop = 10e5;  // Pa ... at this drop
  double step_response = 0.03;          // s, three time constants of the spool

  [[nodiscard]] std::string_view type_name() const noexcept override { return "reducing_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType reducing_valve_type();

}  // namespace slew::hydraulics
