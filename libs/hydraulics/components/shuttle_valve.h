// SPDX-License-Identifier: Apache-2.0
// Shuttle valve: its outlet is connected to the inlet of the higher pressure.
//
//   a = clip((1 + (p_1 - p_2)/switching_pressure)/2, 0, 1)                                                      (1)
//   Q_i3 = a_i K (F(p_i - p_3) - s(p_3 - p_j) F(p_3 - p_i)),   a_1 = a,   a_2 = 1 - a                            (2)
//   F(d) = s(d) root(d) for d > 0, else 0                                                                       (3)
//   s(d) = t^3 (10 - 15 t + 6 t^2),   t = clip(d/d_t, 0, 1)                                                   (4)
// 1 and 2 inlets, 3 outlet, j the inlet other than i, K = nominal_flow/sqrt(nominal_pressure_drop), d_t the transition
// of the orifices. The ball shuts the inlet of the lower pressure, and lets the outlet's oil back to the higher one. a
// is the ball's place, which follows the pressures at once. s in (2): no oil flows from one inlet through the outlet
// into the other one while the ball is on its way. Such a flow would bring the inlets together and hold the ball
// between the seats. For the pressure alone, without oil, use ls_shuttle.
//
// Source: Merritt 1967 for the orifices. Not covered: mass of the ball, leak of the shut seat.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct ShuttleValveDef final : ComponentDef {
  std::string port_1, port_2, port_3;  // volumes: inlets, outlet
  double nominal_flow = 0;             // m3/s of the open seat ...
  double nominal_pressure_drop = 5e5;  // Pa ... at this drop
  double switching_pressure = 0.2e5;   // Pa between the inlets, that holds the ball on a seat

  [[nodiscard]] std::string_view type_name() const noexcept override { return "shuttle_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType shuttle_valve_type();

}  // namespace slew::hydraulics
