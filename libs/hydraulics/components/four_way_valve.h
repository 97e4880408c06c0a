// SPDX-License-Identifier: Apache-2.0
// Four-way valve with complementary edges: as one pair of edges opens, the other pair closes.
//
//   u = clip(neutral_opening + opening_gain signal, 0, 1)
//   Q_PA = C_d A_0 u       sqrt(2/rho) root(p_P - p_A),   Q_BT = C_d A_0 u       sqrt(2/rho) root(p_B - p_T)
//   Q_PB = C_d A_0 (1 - u) sqrt(2/rho) root(p_P - p_B),   Q_AT = C_d A_0 (1 - u) sqrt(2/rho) root(p_A - p_T)
//
// A positive signal lets oil from P to A and from B to T. At u = 1/2 all edges are half open: an open-centre bridge
// whose pressures meet in the middle. The spool follows the signal at once; edges let oil through both ways. Source:
// Merritt 1967, Hydraulic Control Systems, section 5.2 (four-way critical-centre and open-centre valves); areas as in
// Naya et al. 2011. Not covered: overlap, spool dynamics (see l90ls_valve), flow forces, check valves in P.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct FourWayValveDef final : ComponentDef {
  std::string port_p, port_a, port_b, port_t;  // volumes
  double edge_area = 0;                        // A_0 [m2], one edge fully open
  double discharge_coefficient = 0.67;
  double neutral_opening = 0.5;  // u at signal 0
  double opening_gain = 0.5;     // du/d signal

  [[nodiscard]] std::string_view type_name() const noexcept override { return "four_way_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType four_way_valve_type();

}  // namespace slew::hydraulics
