// SPDX-License-Identifier: Apache-2.0
// Unloading valve: lets a pump run into the tank while the pressure that it senses is high enough, with hysteresis, as
// in accumulator charging.
//
//   tau u' = clip((p_3 - p_2 - p_open(u))/opening_pressure_rise, 0, 1) - u,   tau = step_response/3               (1)
//   p_open(u) = cut_out_pressure - (cut_out_pressure - cut_in_pressure + opening_pressure_rise) u                  (2)
//   Q_12 = u K root(p_1 - p_2),   K = nominal_flow/sqrt(nominal_pressure_drop)                                     (3)
// 1 pump line, 2 tank, 3 line that is sensed, behind a check valve as a rule. The piston that opens the valve is larger
// than its seat: once it moves, a lower pressure holds it, (2). So it begins to open at cut_out_pressure and snaps
// open, and begins to shut at cut_in_pressure and snaps shut, both above the tank.
//
// Source: the balance of forces on seat and piston, as Merritt 1967, section 8.2. Not covered: mass of the spool, flow
// forces, leakage.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct UnloadingValveDef final : ComponentDef {
  std::string port_1, port_2, port_3;  // volumes: pump line, tank, sensed line
  double cut_out_pressure = 0;         // Pa above port_2, at which the pump is unloaded
  double cut_in_pressure = 0;          // Pa above port_2, at which it charges again
  double opening_pressure_rise = 5e5;  // Pa from shut to open without the hysteresis
  double nominal_flow = 0;             // m3/s, open ...
  double nominal_pressure_drop = 5e5;  // Pa ... at this drop
  double step_response = 0.03;         // s, three time constants

  [[nodiscard]] std::string_view type_name() const noexcept override { return "unloading_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType unloading_valve_type();

}  // namespace slew::hydraulics
