// SPDX-License-Identifier: Apache-2.0
// Hydraulic motor of fixed or variable displacement that turns a joint through a gear, in both directions and as a pump
// too; with a holding brake where it has a brake_port.
//
//   x = i phi,  v = i phi'                     shaft angle [rad] and speed; phi angle of the rotational force, i ratio
//   F = (p_A - p_B) D + T                      torque at the shaft [Nm]; p_A pushes +phi, T of the brake           (1)
//   F_line = F - F_mu                          the joint gets the torque i F_line                              (2)
//   F_mu = (|F| (1 - eta) f(|v|) + torque_loss min(|v|/v_rest, 1)) sgn v + viscous_loss v                      (3)
//   Q_A = D v + G (p_A - p_B) + G_C (p_A - p_C)                  out of volume A                               (4)
//   Q_B = -D v - G (p_A - p_B) + G_C (p_B - p_C)                 out of volume B
//   Q_C = G_C (p_A + p_B - 2 p_C)                                into the case drain
// G = leak_flow / leak_pressure, G_C = case_leak_flow / leak_pressure.
//
// With `variable: true` D = e displacement, and the setting e follows its command by a servo:
//   e' = sat((e_c - e) / time_constant, setting_rate_limit)                          displacement_servo.h      (5)
//   e_c = clip(setting + setting_per_signal signal, minimum_setting, 1)                                        (6)
// The brake (shaft_brake.h) stands on the shaft before the gear: the gear's losses (3) count its torque too.
//
// D displacement [m3/rad], eta mechanical_coefficient, f friction_curve over the shaft's speed (without one f = 1 from
// v_rest on). Efficiencies at the difference p and the speed v: mechanical 1 - F_mu/(D p) as a motor, volumetric
// D v/(D v + G p + G_C p) with port B and case at the same pressure.
//
// The power port's coordinate is the shaft's angle: x [rad], v [rad/s], F [Nm] stand where a cylinder has m, m/s and N,
// and the mechanics' mobility is that of the joint times i^2. There are no end stops. The oil of either side
// (dead_volume) does not change with the angle. Each exchange sets the pressures to the oil that the true angle moved,
// C_A dp_A = -D dx, C_B dp_B = D dx.
//
// Source: Merritt 1967, Hydraulic Control Systems, sections 4.2 and 4.3 (piston motors: leaks, torque losses). Not
// covered: ripple of flow and torque, inertia of the rotor (add i^2 J to the driven body, or a shaft body with a gear),
// settings of zero and below, losses that follow the setting, elasticity of the gear, stiction without a brake (the
// shaft creeps below v_rest), level tlm.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/shaft_brake.h"

namespace slew::hydraulics {

struct HydraulicMotorDef final : ComponentDef {
  std::string force;                  // rotational force element that it drives
  std::string friction_curve;         // f over the shaft's speed [rad/s]; empty: 1
  std::string port_a, port_b;         // volumes; p_A pushes +phi
  std::string port_c;                 // volume of the case drain; empty: no leak to the case
  double displacement = 0;            // D at a setting of 1 [m3/rad]
  double gear_ratio = 1;              // i, turns of the shaft per turn of the joint
  double mechanical_coefficient = 1;  // eta, 1 = no loss that follows the pressure
  double torque_loss = 0;             // Nm at the shaft
  double viscous_loss = 0;            // Nm s/rad at the shaft
  double leak_flow = 0;               // m3/s from port to port ...
  double case_leak_flow = 0;          // m3/s from either port to the case ...
  double leak_pressure = 100e5;       // Pa ... at this difference
  double dead_volume = 1e-4;          // m3 of oil on either side
  PortCoupling coupling = PortCoupling::session;

  bool is_variable = false;       // the displacement follows setting and signal
  double setting = 1;             // share of the displacement
  double setting_per_signal = 0;  // per unit of the control signal
  double minimum_setting = 0.2;   // least share
  double time_constant = 0.1;     // s, of the servo
  double setting_rate_limit = 0;  // 1/s, greatest rate of the setting; 0: none

  std::string brake_port;  // volume that releases the brake; empty: no brake
  ShaftBrakeParameters brake;

  [[nodiscard]] std::string_view type_name() const noexcept override { return "hydraulic_motor"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ActuatorDef> actuator() const override;
  [[nodiscard]] bool takes_signal() const override { return is_variable; }
};

[[nodiscard]] ComponentType hydraulic_motor_type();

}  // namespace slew::hydraulics
