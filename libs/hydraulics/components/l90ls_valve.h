// SPDX-License-Identifier: Apache-2.0
// L90LS section: a proportional 4/3 directional spool with pressure compensator, lock-hold, load sensing, shock and
// anti-cavitation valves. Closed centre; ports P, A, B, T.
//
// Spool, first order, s = control signal limited to +-maximum_control_signal:
//   tau xs' = s / s_nominal - xs,   tau = step_response / 3
//   x_A = ramp((xs - overlap) / (1 - overlap)),  x_B = ramp((-xs - overlap) / (1 - overlap))                   (1)
// Metering edge P-A (P-B alike), pressures relative to T, load p = p_A:
//   dp_1 = max(0, min(p, p_LSmax) + p_comp - p)                 held by the compensator                        (2)
//   dp_2 = max(0, p_P - p) K_c^2 / (K_c^2 + (x K_v)^2)          compensator fully open, lock-hold              (3)
//   Q    = x K_v root(min(dp_1, dp_2))                                                                         (4)
//   K_v = Q_nom / sqrt(dp_nom),  K_c = Q_comp / sqrt(dp_comp),  root(d) = d / (d^2 + d_t^2)^(1/4)
// The lock-hold check opens over opening_pressure_rise. Return edge: Q = x K root(p - p_T) both ways.
// Leaks: G = leak_flow / leak_pressure; A-T, B-T linear; P-A, P-B linear, only out of P (behind the lock-hold).
// Shock valve A-T, B-T:  u = clip((p - p_set) / rise, 0, 1),  Q = u K_s root(p),  K_s = Q_s / sqrt(p_set + rise)   (5)
// Anti-cavitation T-A, T-B:  Q = K_ac root(max(0, p_T - p - p_crack)),  K_ac = Q_ac / sqrt(dp_ac - p_crack)        (6)
// Load sensing: p_LS = w(x_A) min(p_A, p_LSmax,A) + w(x_B) min(p_B, p_LSmax,B); w rises from 0 to 1 over the first
// per cents of opening, so the line is bled to tank when the spool is centred.                                    (7)
//
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 15, and fluid-power practice where the table is
// incomplete. Not covered: flow forces, spool mass, back pressure in the pilot, mass of the compensator.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct L90lsValveDef final : ComponentDef {
  std::string port_p, port_a, port_b, port_t;
  double overlap = 0.32;                  // fraction of the spool's travel, positive
  double maximum_control_signal = 500;    // V or mA, as the maker states it
  double nominal_control_signal = 500;    // signal at nominal flow
  double nominal_flow_pa = 70.0 / 60000;  // m3/s ...
  double nominal_flow_at = 70.0 / 60000;
  double nominal_flow_pb = 70.0 / 60000;
  double nominal_flow_bt = 70.0 / 60000;
  double nominal_pressure_drop = 35e5;                                  // Pa ... at this drop
  double leak_flow = 0;                                                 // m3/s on each edge ...
  double leak_pressure = 100e5;                                         // Pa ... at this drop
  double opening_pressure_rise = 1e5;                                   // Pa over which the lock-hold opens fully
  double step_response = 0.1;                                           // s, three time constants of the spool
  double compensator_pressure = 8e5;                                    // Pa held across the metering edge
  double compensator_flow = 150.0 / 60000;                              // m3/s through the open compensator ...
  double compensator_pressure_drop = 8e5;                               // Pa ... at this drop
  double shock_pressure_a = 250e5, shock_pressure_b = 250e5;            // Pa above tank
  double shock_flow = 70.0 / 60000;                                     // m3/s, fully open ...
  double shock_pressure_rise = 10e5;                                    // Pa ... at this rise above the setting
  double anti_cavitation_flow = 100.0 / 60000;                          // m3/s ...
  double anti_cavitation_pressure_drop = 5e5;                           // Pa ... at this drop
  double anti_cavitation_crack_pressure = 0.2e5;                        // Pa
  double maximum_ls_pressure_a = 180e5, maximum_ls_pressure_b = 180e5;  // Pa above tank

  [[nodiscard]] std::string_view type_name() const noexcept override { return "l90ls_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType l90ls_valve_type();

}  // namespace slew::hydraulics
