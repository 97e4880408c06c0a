// SPDX-License-Identifier: Apache-2.0
// Combustion engine with a full-load torque curve, a governor with droop, inertia and stall; drives the pumps that name
// it as their `engine`.
//
//   J w' = u T_full(w) g(w) - T_f w / sqrt(w^2 + w_f^2) - c w + T_h - sum r_i T_i                              (1)
//   tau u' = u_c - u,   u_c = clip((w_0 - w) / (w_0 - w_s), 0, 1)                                              (2)
//   w_s = max(speed + speed_per_signal signal, minimum_speed, stall_speed),   w_0 = (1 + droop) w_s            (3)
//   g = clip((w - stall_speed) / (0.1 stall_speed), 0, 1)                                                      (4)
//   T_h = J/tau_h ramp(-w, w_h)                                                                                (5)
// w speed of the engine [rad/s], u fuel as a share of the full load, T_full torque_curve [Nm] over w, T_f
// friction_torque and c viscous_friction (the engine's own losses and auxiliaries), T_i the torque of a pump at its own
// shaft, r_i its speed_ratio. w_s is the governed speed at full load, w_0 that without any: droop = (w_0 - w_s) / w_s.
// Below stall_speed there is no combustion: an engine that is lugged down to it stops and does not start by itself. The
// compression holds it against oil that would turn it backwards: (5) is a one-way damper (tau_h = 1 ms, w_h = 0.01
// rad/s; ramp of smooth.h), on which a torque T creeps backwards at T tau_h/J.
//
// The state is w / speed, of the speed at the start. Oil that drives a pump (pump_drive.h) drives the engine.
// Source: Isermann 2014, Engine Modeling and Control (mean-value torque, speed governor of a
// diesel with proportional degree). Not covered: torque by cylinder, starter, smoke limit and boost of the turbocharger
// (tau holds their lag), engine brake, fuel maps.
#pragma once

#include "hydraulics/component_def.h"

namespace slew::hydraulics {

struct EngineDef final : ComponentDef {
  std::string torque_curve;         // Nm over rad/s, at full load
  double inertia = 0;               // J [kg m2], with flywheel and what turns with it
  double speed = 0;                 // rad/s, governed speed at full load without a signal
  double speed_per_signal = 0;      // rad/s per unit of the control signal
  double minimum_speed = 0;         // rad/s, least governed speed
  double droop = 0.05;              // (w_0 - w_s) / w_s
  double fuel_time_constant = 0.1;  // tau [s]
  double stall_speed = 0;           // rad/s
  double friction_torque = 0;       // T_f [Nm]
  double viscous_friction = 0;      // c [N m s/rad]

  [[nodiscard]] std::string_view type_name() const noexcept override { return "engine"; }
  [[nodiscard]] void* address() noexcept override { return this; }
  [[nodiscard]] std::optional<ShaftDef> shaft() const override { return ShaftDef{speed, inertia}; }
};

[[nodiscard]] ComponentType engine_type();

}  // namespace slew::hydraulics
