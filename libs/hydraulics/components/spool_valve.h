// SPDX-License-Identifier: Apache-2.0
// Directional spool valve whose metering edges each have an area of their own, closed or open centre.
//
//   tau s' = clip(signal / maximum_control_signal, -1, 1) - s,   tau = step_response / 3                        (1)
//   Q = x(s) A_0 C_d sqrt(2/rho) root(drop) + G_leak drop        P-A, B-T, P-B, A-T; both ways                  (2)
//   x = ramp((+s - overlap) / (1 - overlap))    P-A and B-T, which a positive signal opens                      (3)
//   x = ramp((-s - overlap) / (1 - overlap))    P-B and A-T
//   Q = x(s) A_0 C_d sqrt(2/rho) root(p_C - p_D),  x = clip((s_1 - |s|) / (s_1 - s_0), 0, 1)       bypass C-D   (4)
// s spool position, A_0 the edge's area, G_leak = leak_flow / leak_pressure, s_0 bypass_closing, s_1 bypass_closed. A
// negative overlap is an underlap: the edge is open at rest by x = -overlap / (1 - overlap). A curve over s in place of
// (3) or (4) gives x as the maker states it, in any multiple of A_0. An edge without area is blocked.
//
// The bypass C-D makes the centre open: it carries the pump's flow at rest and closes as the spool moves. C is P and D
// is T unless named. A 4/3 valve has C = P; in a block of 6/3 valves C is D of the valve before, D of the last one the
// tank, and P is either a gallery that all valves share (parallel circuit) or C itself (tandem).
//
// Source: Merritt 1967, Hydraulic Control Systems, sections 5.1 to 5.4 (areas over the spool, under- and overlap,
// open centre). Not covered: flow forces, mass of the spool, load check valves in P (check_valve), load sensing and
// compensators (l90ls_valve).
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct MeteringEdge {
  std::string curve;   // x over s; empty: (3)
  double area = 0;     // A_0 [m2]; 0: blocked
  double overlap = 0;  // share of the spool's travel
};

struct SpoolValveDef final : ComponentDef {
  std::string port_p, port_a, port_b, port_t;  // volumes
  std::string port_c, port_d;                  // volumes at the bypass; empty: P, T
  double maximum_control_signal = 1;           // signal of the full travel, as the maker states it
  double step_response = 0.1;                  // s, three time constants of the spool
  double discharge_coefficient = 0.67;
  MeteringEdge pa, bt, pb, at;
  double leak_flow = 0;          // m3/s on each of the four edges ...
  double leak_pressure = 100e5;  // Pa ... at this drop
  std::string bypass_curve;      // x over s; empty: (4)
  double bypass_area = 0;        // A_0 of the bypass [m2]
  double bypass_closing = 0.1;   // s_0, share of the spool's travel
  double bypass_closed = 0.9;    // s_1

  [[nodiscard]] std::string_view type_name() const noexcept override { return "spool_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType spool_valve_type();

}  // namespace slew::hydraulics
