// SPDX-License-Identifier: Apache-2.0
// Hose-burst valve (velocity fuse) at a cylinder's port: shuts when the flow out of the load exceeds its closing flow.
//
//   d = p_2 - p_1,   d_close = (closing_flow / K)^2,   K = nominal_flow / sqrt(nominal_pressure_drop)           (1)
//   tau u' = 1 - clip((d - d_close) / closing_pressure_rise, 0, 1) - u,   tau = step_response / 3               (2)
//   Q_21 = u K root(d) + G d,   G = leak_flow / leak_pressure                                                   (3)
// Port 1 is on the side of the hose, port 2 on that of the load, u the opening. A spring holds the plate open against
// the drop of the flow; once shut, the load's pressure holds it shut until the pressures meet again. Oil passes freely
// towards the load.
//
// Source: Merritt 1967, section 8.2, for a plate on a spring under the drop of an orifice. Not covered: mass of the
// plate, closing shock of the oil column in the line.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct HoseBurstValveDef final : ComponentDef {
  std::string port_1, port_2;          // volumes: hose, load
  double nominal_flow = 0;             // m3/s of the open valve ...
  double nominal_pressure_drop = 5e5;  // Pa ... at this drop
  double closing_flow = 0;             // m3/s from port 2 to 1 that begins to shut it
  double closing_pressure_rise = 1e5;  // Pa from the drop of closing_flow to shut
  double step_response = 0.02;         // s, three time constants
  double leak_flow = 0;                // m3/s ...
  double leak_pressure = 100e5;        // Pa ... at this difference

  [[nodiscard]] std::string_view type_name() const noexcept override { return "hose_burst_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType hose_burst_valve_type();

}  // namespace slew::hydraulics
