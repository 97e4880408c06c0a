// SPDX-License-Identifier: Apache-2.0
// Variable-displacement pump with load-sensing controller, driven at a given speed or by an engine
// (pump_drive.h).
//
//   p_set = max(p_standby, min(p_LS, p_LSmax) + p_margin)                     relative to port B (tank)
//   T alpha' = min(clip(K (p_set - (p_A - p_B)), 0, 1), alpha_T) - alpha      swash 0..1
//   alpha_T = eta_m maximum_torque / (V_rad (p_A - p_B))                      torque limiter, 0: none
//   Q_A = V_rad omega alpha eta_v - G (p_A - p_B),  Q_B = -Q_A                into the volumes
//   torque = V_rad alpha (p_A - p_B) / eta_m,  power = torque omega
// for p_A > p_B; a pump that the tank's oil drives divides by eta_v and multiplies by eta_m (pump_drive.h).
// Steady droop: a flow Q lowers the outlet by alpha / K = Q / (V_rad omega eta_v K) below p_set.
//
// Source: the flexible-body tutorial thesis (Saimaa UAS 2017), table 21. Deviations: its controller gain 3.5e-5 is read
// as % per Pa; the torque is not divided by the volumetric coefficient. The limiter is the hyperbola that a regulator
// with a lever or two springs holds; not covered: its springs' broken line, its change by the engine's speed.
#pragma once

#include "hydraulics/component_def.h"
#include "hydraulics/components/pump_drive.h"

namespace slew::hydraulics {

struct LsPumpDef final : ComponentDef {
  std::string port_a;   // volume, outlet
  std::string port_b;   // volume, tank
  std::string ls_port;  // component with an LS port; empty: stand-by only
  double speed = 0;     // rad/s, without an engine
  PumpDriveParameters drive;
  double displacement = 0;             // m3/rad, full swash
  double mechanical_coefficient = 1;   // eta_m
  double volumetric_coefficient = 1;   // eta_v
  double controller_gain = 3.5e-7;     // 1/Pa
  double time_constant = 0.085;        // s
  double set_pressure = 25e5;          // Pa, LS margin
  double standby_pressure = 25e5;      // Pa above tank
  double maximum_ls_pressure = 230e5;  // Pa above tank
  double maximum_torque = 0;           // Nm at the shaft; 0: none
  double leak_flow = 0;                // m3/s ...
  double leak_pressure = 100e5;        // Pa ... at this difference

  [[nodiscard]] std::string_view type_name() const noexcept override { return "ls_pump"; }
  [[nodiscard]] bool raises_pressure() const override { return true; }
  [[nodiscard]] void* address() noexcept override { return this; }
  void add_lines(PumpLines& lines) const override;
};

[[nodiscard]] ComponentType ls_pump_type();

}  // namespace slew::hydraulics
