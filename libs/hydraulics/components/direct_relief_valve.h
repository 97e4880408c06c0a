// SPDX-License-Identifier: Apache-2.0
// Direct-acting poppet relief valve, quasi-static; with `proportional` its crack pressure follows a control signal.
//
//   p = p_1 - p_2,  A_p = pi/4 d^2,  w = pi d sin(alpha)
//   p A_p = F_0 + k_s y + F_flow,   F_flow = 2 C_d w y p cos(alpha) when included,   F_0 = p_s A_p,
//   p_s = crack_pressure, or of proportional_setting.h
//   y = clip((p A_p - F_0) / (k_s + 2 C_d w p cos(alpha)), 0, maximum_lift)
//   Q = C_d w y root(2 p / rho)
//
// Source: textbook poppet valve (Merritt 1967, Hydraulic Control Systems, section 8.2). Not covered: poppet mass and
// damping.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/proportional_setting.h"

namespace slew::hydraulics {

enum class FlowForce : int { neglected, included };
inline constexpr std::string_view kFlowForceChoices[] = {"neglected", "included"};

struct DirectReliefValveDef final : ComponentDef {
  std::string port_1, port_2;              // volumes, inlet and outlet
  double seat_diameter = 0;                // m
  double half_angle = 0.7853981633974483;  // rad, of the poppet's cone
  double crack_pressure = 0;               // Pa above the outlet
  double spring_constant = 0;              // N/m
  double discharge_coefficient = 0.62;
  double maximum_lift = 5e-3;  // m
  FlowForce flow_force = FlowForce::neglected;
  bool is_proportional = false;
  ProportionalParameters solenoid;

  [[nodiscard]] std::string_view type_name() const noexcept override { return "direct_relief_valve"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] bool takes_signal() const override { return is_proportional; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType direct_relief_valve_type();

}  // namespace slew::hydraulics
