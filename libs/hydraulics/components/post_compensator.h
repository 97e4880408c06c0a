// SPDX-License-Identifier: Apache-2.0
// Pressure compensator behind the metering edge of a load-sensing section: flow sharing (post-compensated).
//
//   tau u' = clip((p_1 - p_T - p_LS - spring_pressure) / regulation_pressure, 0, 1) - u,  tau = step_response / 3  (1)
//   Q = u K root(ramp(p_1 - p_2)),  K = nominal_flow / sqrt(nominal_pressure_drop)                                  (2)
//   p_LS,own = p_2 - p_T (3)
// Port 1 is behind the metering edge, port 2 before the load; p_LS is the highest load-sensing pressure of all sections
// above the tank T (component `shared_ls`, their last shuttle), p_LS,own what the section adds to it. Every compensator
// holds its own port 1 at the same pressure p_LS + spring_pressure, so that the drops over all metering edges are the
// same. Where the pump cannot deliver the sum, all flows fall by the same factor, while pre-compensated sections
// (l90ls_valve) would let the highest load stop.
//
// The compensator closes against a flow back from the load (load check). Build a section from a spool_valve whose
// bypass is the metering edge (C the pump, D port 1) and whose P is port 2; a bleed from port 2 to the tank ends
// p_LS,own when the spool rests. Source: Backe 1992, Grundlagen der Oelhydraulik (load-independent flow division). Not
// covered: flow forces, leak of the load check.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct PostCompensatorDef final : ComponentDef {
  std::string port_1, port_2, port_t;  // volumes: behind the metering edge, before the load, tank
  std::string shared_ls;               // component with the highest load-sensing pressure
  double spring_pressure = 1e5;        // Pa above the shared pressure, at which it begins to open
  double regulation_pressure = 3e5;    // Pa from closed to fully open
  double nominal_flow = 0;             // m3/s, fully open ...
  double nominal_pressure_drop = 5e5;  // Pa ... at this drop
  double step_response = 0.03;         // s, three time constants

  [[nodiscard]] std::string_view type_name() const noexcept override { return "post_compensator"; }
  [[nodiscard]] void* address() noexcept override { return this; }
};

[[nodiscard]] ComponentType post_compensator_type();

}  // namespace slew::hydraulics
