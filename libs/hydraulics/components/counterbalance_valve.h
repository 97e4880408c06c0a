// SPDX-License-Identifier: Apache-2.0
// Counterbalance valve (over-centre, load-holding and lowering valve) with its check valve.
//
//   p_e = p_2 - p_s + pilot_ratio (p_x - p_s) - setting_pressure                                                (1)
//   tau u' = clip(p_e / opening_pressure_rise, 0, 1) - u,   tau = step_response / 3                             (2)
//   Q_21 = u K root(p_2 - p_1),   K = nominal_flow / sqrt(nominal_pressure_drop)                                (3)
//   Q_12 = the check valve's free flow from the directional valve to the load, (2) and (3) of check_valves.h
// Port 1 is on the side of the directional valve, port 2 on that of the load, p_x the pilot pressure at port 3, in the
// opposite line as a rule. p_s is the pressure in the spring's chamber: that of port 1, so that a back pressure b
// raises the setting by (1 + pilot_ratio) b, or of port 4 in a vented valve, which a back pressure leaves alone.
// u is the spool's opening. Damping outweighs the spool's mass: d x' + k x = A p_e with tau = d/k gives (2).
//
// A stiff load that this valve lowers can oscillate: docs/models/hydraulics_counterbalance_valve.md has the limit.
// Sources: Merritt 1967, section 8.2, for the spool with a spring; (1) is the balance of forces on its areas. Not
// covered: mass of the spool, flow forces, hysteresis of the seals, leakage.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/check_valves.h"

namespace slew::hydraulics {

struct CounterbalanceValveDef final : ComponentDef {
  std::string port_1;                   // volume on the side of the directional valve
  std::string port_2;                   // volume on the side of the load
  std::string port_3;                   // volume that pilots it
  std::string port_4;                   // volume of the spring's chamber; empty: port_1
  double setting_pressure = 0;          // Pa above p_s, at which it opens without a pilot pressure
  double pilot_ratio = 4;               // area of the pilot over that of the relief
  double nominal_flow = 0;              // m3/s from load to valve, fully open ...
  double nominal_pressure_drop = 10e5;  // Pa ... at this drop
  double opening_pressure_rise = 30e5;  // Pa from crack to fully open
  double step_response = 0.03;          // s, three time constants
  CheckParameters check;                // free flow from valve to load

  [[nodiscard]] std::string_view type_name() const noexcept override { return "counterbalance_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType counterbalance_valve_type();

}  // namespace slew::hydraulics
