// SPDX-License-Identifier: Apache-2.0
// Pump of fixed or variable displacement at a given speed or on the shaft of an engine (pump_drive.h), with limits of
// pressure and power, and with negative or positive control by a pressure.
//
//   Q = alpha D n eta_v - G_leak (p_a - p_b)       from port b into port a                                      (1)
//   alpha' = sat((min(alpha_c, alpha_p, alpha_n, alpha_P) - alpha) / tau, swash_rate_limit)    displacement_servo.h (2)
//   alpha_c = clip(swash + swash_per_signal signal, minimum_swash, 1)     command                               (3)
//   alpha_p = clip(controller_gain (maximum_pressure - (p_a - p_b)), 0, 1)          pressure cut-off            (4)
//   alpha_P = eta_m maximum_power / (D n (p_a - p_b))                               power limit                 (5)
//   alpha_n = clip((p_0 - (p_k - p_b)) / (p_0 - p_1), 0, 1)                         control pressure            (6)
//   T = alpha D (p_a - p_b) / eta_m,   P = T n                                      torque and power of the drive
//   Q_ac = G_case (p_a - p_c),   Q_bc = G_case (p_b - p_c)                          into the case, with a port_c
// D displacement, n speed, eta_v volumetric_coefficient, eta_m mechanical_coefficient. maximum_pressure and
// maximum_power of 0 are no limits; a torque limit T is a power limit T n. Without limits and signal the pump is fixed.
// p_k pressure of the control_port, p_1 full_swash_pressure, p_0 zero_swash_pressure: p_0 > p_1 is negative control (a
// high pressure behind an open centre's bypass takes the swash back), p_0 < p_1 positive control (by a pilot pressure).
//
// A pump over centre (minimum_swash < 0) delivers out of port b at a negative swash. Its limits then hold for both
// directions of delivery: (2) bounds -alpha by (4), (5) at the rise p_b - p_a and (6) as well. Oil that drives it
// gives the torque alpha D (p_a - p_b) eta_m back to the drive, and its flow is alpha D n / eta_v (pump_drive.h).
//
// Source: Merritt 1967, section 4.2, for flow and torque; the limits are those of pump regulators in practice. Not
// covered: ripple, losses that follow pressure or speed, force of the swash plate's drive.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/pump_drive.h"

namespace slew::hydraulics {

struct PumpDef final : ComponentDef {
  std::string port_a, port_b;  // volumes, outlet and tank
  std::string port_c;          // volume of the case drain; empty: no leak to the case
  std::string control_port;    // volume of the control pressure; empty: none
  double speed = 0;            // n [rad/s], without an engine
  PumpDriveParameters drive;
  double displacement = 0;            // D [m3/rad], at full swash
  double mechanical_coefficient = 1;  // eta_m
  double volumetric_coefficient = 1;  // eta_v
  double swash = 1;                   // share of the displacement
  double minimum_swash = 0;           // least share; below 0: over centre
  double swash_per_signal = 0;        // per unit of the control signal
  double time_constant = 0.1;         // tau [s]
  double swash_rate_limit = 0;        // 1/s, greatest rate of the swash; 0: none
  double maximum_pressure = 0;        // Pa above tank; 0: none
  double controller_gain = 3.5e-7;    // 1/Pa, of the cut-off
  double maximum_power = 0;           // W of the drive; 0: none
  double full_swash_pressure = 0;     // p_1 [Pa] above port b
  double zero_swash_pressure = 0;     // p_0 [Pa] above port b
  double leak_flow = 0;               // m3/s from outlet to tank ...
  double case_leak_flow = 0;          // m3/s from either port to the case ...
  double leak_pressure = 100e5;       // Pa ... at this difference

  [[nodiscard]] std::string_view type_name() const noexcept override { return "pump"; }
  [[nodiscard]] bool raises_pressure() const override { return true; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType pump_type();

}  // namespace slew::hydraulics
