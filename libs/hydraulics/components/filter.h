// SPDX-License-Identifier: Apache-2.0
// Filter with a bypass valve, and clogging as a live parameter.
//
//   Q = (1 - clogging) G (p_1 - p_2) + Q_bypass,   G = nominal_flow / nominal_pressure_drop                     (1)
// from port 1 to port 2. The element is laminar (pores), its clean drop stated at the working viscosity; a share
// `clogging` of its area is blocked, at 1 all of it. Q_bypass is that of a check valve from 1 to 2 (check_valves.h, (1)
// to (3)) with bypass_flow at bypass_pressure_drop, which opens at bypass_crack_pressure; without bypass_flow there is
// none, and a blocked filter stops the flow. Oil flows backwards through the element too.
//
// Source: ISO 3968 states the drop of a clean element over the flow, nearly linear; Merritt 1967 for the bypass. Not
// covered: drop of the housing (add an orifice), growth of clogging with the dirt, burst of the element.
#pragma once

#include "hydraulics/components/check_valves.h"

namespace slew::hydraulics {

struct FilterDef final : ComponentDef {
  std::string port_1, port_2;            // volumes; flow from 1 to 2
  double nominal_flow = 0;               // m3/s through the clean element ...
  double nominal_pressure_drop = 0.5e5;  // Pa ... at this drop
  double clogging = 0;                   // share of the element that is blocked
  CheckParameters bypass{.nominal_pressure_drop = 5e5, .crack_pressure = 2.5e5};

  [[nodiscard]] std::string_view type_name() const noexcept override { return "filter"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType filter_type();

}  // namespace slew::hydraulics
