// SPDX-License-Identifier: Apache-2.0
// Shuttle valve: its outlet is connected to the inlet of the higher pressure.
//
//   a = clip((1 + (p_1 - p_2)/switching_pressure)/2, 0, 1)                                                      (1)
//   Q_13 = a K root(p_1 - p_3),   Q_23 = (1 - a) K root(p_2 - p_3),   K = nominal_flow/sqrt(nominal_pressure_drop) (2)
// 1 and 2 inlets, 3 outlet; the ball shuts the inlet of the lower pressure, and lets the outlet's oil back to the
// higher one. a is the ball's place, which follows the pressures at once. For the pressure alone, without oil, use
// ls_shuttle.
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
};

[[nodiscard]] ComponentType shuttle_valve_type();

}  // namespace slew::hydraulics
