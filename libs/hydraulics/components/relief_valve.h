// SPDX-License-Identifier: Apache-2.0
// Pilot-operated relief valve, closed without piloting; with `proportional` its setting follows a control signal.
//
//   tau u' = clip((p_pilot - p_2 - p_s) / opening_pressure_rise, 0, 1) - u,   tau = step_response / 3
//   Q_12 = u K root(p_1 - p_2),  K = nominal_flow / sqrt(nominal_pressure_drop), the drop from port 1 to port 2
//   p_s: proportional_setting.h
//
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 20; root(d) = d / (d^2 + d_t^2)^(1/4).
// Not covered: flow forces, hysteresis.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/proportional_setting.h"

namespace slew::hydraulics {

struct ReliefValveDef final : ComponentDef {
  std::string port_1;                   // volume, inlet
  std::string port_2;                   // volume, outlet: the setting is relative to it
  std::string port_3;                   // volume that pilots it; empty: port_1
  double nominal_flow = 0;              // m3/s, fully open ...
  double nominal_pressure_drop = 10e5;  // Pa ... at this drop
  double setting_pressure = 0;          // Pa above the outlet
  double opening_pressure_rise = 7e5;   // Pa from crack to fully open
  double step_response = 0.1;           // s, three time constants
  bool is_proportional = false;
  ProportionalParameters solenoid;

  [[nodiscard]] std::string_view type_name() const noexcept override { return "relief_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] bool takes_signal() const override { return is_proportional; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType relief_valve_type();

}  // namespace slew::hydraulics
