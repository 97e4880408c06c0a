// SPDX-License-Identifier: Apache-2.0
// Flushing valve of a closed circuit: a spool, centred by springs, that connects the side of the lower pressure to an
// outlet, through which hot oil leaves the circuit.
//
//   u_1 = clip((p_2 - p_1 - switching_pressure)/opening_pressure_rise, 0, 1)   edge of side 1, by the other's pressure
//   u_2 = clip((p_1 - p_2 - switching_pressure)/opening_pressure_rise, 0, 1)                                       (1)
//   Q_13 = u_1 K root(p_1 - p_3),   Q_23 = u_2 K root(p_2 - p_3),   K = nominal_flow/sqrt(nominal_pressure_drop)   (2)
// 1 and 2 the sides, 3 outlet: a relief valve that keeps the lower side above its setting, or the case. Up to the
// switching pressure both edges are shut, so that the sides are not connected while the circuit changes over. The spool
// follows the pressures at once.
//
// Source: Merritt 1967 for the orifices; (1) is the balance of the spool's areas and springs. Not covered: mass of the
// spool, damping by its pilot orifices, flow forces, leak.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct FlushingValveDef final : ComponentDef {
  std::string port_1, port_2, port_3;  // volumes: sides, outlet
  double nominal_flow = 0;             // m3/s of an open edge ...
  double nominal_pressure_drop = 5e5;  // Pa ... at this drop
  double switching_pressure = 5e5;     // Pa between the sides, from which on an edge opens ...
  double opening_pressure_rise = 5e5;  // Pa ... to fully open

  [[nodiscard]] std::string_view type_name() const noexcept override { return "flushing_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType flushing_valve_type();

}  // namespace slew::hydraulics
