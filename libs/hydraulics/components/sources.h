// SPDX-License-Identifier: Apache-2.0
// Ideal sources of flow and pressure. A control signal moves them over time, by a script or a controller.
//
//   flow_source      Q_12 = flow + flow_per_signal signal                     from port 1 to port 2, at any pressure
//   pressure_source  p_s = max(set_pressure + pressure_per_signal signal, 0)
//                    Q = G (p_s - p),  G = nominal_flow / nominal_pressure_drop          into the volume at port 1
//
// A flow source holds its flow whatever stands in its way: its line needs a relief valve, its inlet a tank. A pressure
// source takes or gives oil without limit through a laminar resistance; a volume with fixed: true is the same without
// the resistance and constant in time. Neither has dynamics. Source: Merritt 1967, section 3.1 (ideal sources). Not
// covered: leak, efficiency and drive of a pump.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct FlowSourceDef final : ComponentDef {
  std::string port_1, port_2;  // volumes, inlet and outlet
  double flow = 0;             // m3/s
  double flow_per_signal = 0;  // m3/s per unit of the control signal

  [[nodiscard]] std::string_view type_name() const noexcept override { return "flow_source"; }
  [[nodiscard]] bool raises_pressure() const override { return true; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

struct PressureSourceDef final : ComponentDef {
  std::string port_1;                  // volume
  double set_pressure = 0;             // Pa absolute
  double pressure_per_signal = 0;      // Pa per unit of the control signal
  double nominal_flow = 0;             // m3/s ...
  double nominal_pressure_drop = 1e5;  // Pa ... at this difference

  [[nodiscard]] std::string_view type_name() const noexcept override { return "pressure_source"; }
  [[nodiscard]] bool raises_pressure() const override { return true; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType flow_source_type();
[[nodiscard]] ComponentType pressure_source_type();

}  // namespace slew::hydraulics
