// SPDX-License-Identifier: Apache-2.0
// Check valves: spring-loaded, with a throttle beside the poppet, pilot-operated, and two that pilot each other.
//
//   p_e = p_1 - p_2 - crack_pressure + pilot_ratio ramp(p_x - p_y)                                              (1)
//   u   = clip(p_e / opening_pressure_rise, 0, 1)                                                               (2)
//   Q   = (u + t) K root(p_1 - p_2),  K = nominal_flow / sqrt(nominal_pressure_drop)                            (3)
//   t   = throttle_opening throttle_flow / nominal_flow, 0 without a throttle
// Q from port 1 to port 2 [m3/s]; u lift of the poppet [1]. p_x pilot pressure on the pilot piston, of pilot_ratio seat
// areas, p_y pressure behind it: that of port 1, or of a drain. The piston pushes and never pulls; once the poppet is
// lifted, oil flows in both directions. root(d) = d / (d^2 + d_t^2)^(1/4) with the transition d_t.
// In the double valve each poppet is piloted by the other line's valve side: p_x = p_b1, p_y = p_a1, and vice versa.
//
// Source: Merritt 1967 for the orifice; (1) is the balance of forces on poppet and pilot piston over the seat area.
// Not covered: mass of the poppet (it follows (2) at once), flow forces, leakage of the seat.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

// Poppet and seat, part of every check valve's Def.
struct CheckParameters {
  double nominal_flow = 0;               // m3/s, poppet fully lifted ...
  double nominal_pressure_drop = 5e5;    // Pa ... at this drop
  double crack_pressure = 0.2e5;         // Pa, drop that lifts the poppet off its seat
  double opening_pressure_rise = 0.5e5;  // Pa from crack to fully lifted
};

struct CheckValveDef final : ComponentDef {
  std::string port_1, port_2;  // volumes; flow from 1 to 2 only
  CheckParameters common;

  [[nodiscard]] std::string_view type_name() const noexcept override { return "check_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct ThrottleCheckValveDef final : ComponentDef {
  std::string port_1, port_2;  // volumes; free from 1 to 2, throttled from 2 to 1
  CheckParameters common;
  double throttle_flow = 0;     // m3/s through the throttle alone at nominal_pressure_drop
  double throttle_opening = 1;  // fraction of the throttle's area

  [[nodiscard]] std::string_view type_name() const noexcept override { return "throttle_check_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct PilotCheckValveDef final : ComponentDef {
  std::string port_1, port_2;  // volumes; free from 1 to 2, from 2 to 1 when piloted
  std::string port_3;          // volume that pilots it
  std::string port_4;          // volume behind the pilot piston; empty: port_1
  double pilot_ratio = 4;      // area of the pilot piston / area of the seat
  CheckParameters common;

  [[nodiscard]] std::string_view type_name() const noexcept override { return "pilot_check_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct DoublePilotCheckValveDef final : ComponentDef {
  std::string port_a1, port_a2;  // volumes of line A: valve side, load side
  std::string port_b1, port_b2;  // volumes of line B
  double pilot_ratio = 4;        // area of the pilot piston / area of the seat
  CheckParameters common;

  [[nodiscard]] std::string_view type_name() const noexcept override { return "double_pilot_check_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType check_valve_type();
[[nodiscard]] ComponentType throttle_check_valve_type();
[[nodiscard]] ComponentType pilot_check_valve_type();
[[nodiscard]] ComponentType double_pilot_check_valve_type();

}  // namespace slew::hydraulics
