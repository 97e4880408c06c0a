// SPDX-License-Identifier: Apache-2.0
// Classical washout: specific force and rates at a seat to the pose of a platform that stays near neutral.
//
//   translation  X/U = s/((s^2 + 2 zeta w_n s + w_n^2)(s + w_b))       u = k_f (f - (0, 0, g)), held
//   tilt         v = w_t^2/(s^2 + 2 zeta_t w_t s + w_t^2) u, theta* = -asin(v_x/g), phi* = asin(v_y/(g cos theta*)),
//                followed at no more than tilt_rate
//   rotation     B/R = s/(s^2 + 2 zeta w_n s + w_n^2)                  r = k_w w, held
//
// P: axes of the seat, x forward, y left, z up; R_P = Rz(psi) Ry(theta) Rx(phi). Filters are exact for inputs that are
// constant over the step. Card, signs and deviations: docs/models/motion_platform.md. Not covered: adaptive washout.
// Source: Reid and Nahon 1985.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"
#include "devices/linear_filter.h"

namespace slew::devices {

inline constexpr double kStandardGravity = 9.80665;  // m/s2

struct WashoutDef {
  Triple force_scale = {0.5, 0.5, 0.5};            // k_f, of forward, left and up
  Triple rate_scale = {0.5, 0.5, 0.5};             // k_w, about them
  Triple max_acceleration = {5, 5, 5};             // m/s2, bound of the scaled input
  Triple max_rate = {1, 1, 1};                     // rad/s
  Triple translation_frequency = {2.5, 2.5, 3.5};  // w_n, rad/s
  Triple translation_damping = {1, 1, 1};          // zeta
  Triple return_frequency = {0.25, 0.25, 0.25};    // w_b, rad/s; 0: second order, which keeps an offset
  double tilt_frequency = 5;                       // w_t, rad/s
  double tilt_damping = 1;                         // zeta_t
  double tilt_rate = 0.05235987755982988;          // rad/s: 3 deg/s
  double max_tilt = 0.2617993877991494;            // rad: 15 deg
  Triple rotation_frequency = {1, 1, 1};           // rad/s
  Triple rotation_damping = {1, 1, 1};
};

[[nodiscard]] std::span<const Field> washout_fields() noexcept;
void validate(std::string_view path, const WashoutDef& def, Problems& problems);

// Immutable. Pre-condition of build_washout(): no problem, step above 0 [s].
struct Washout {
  WashoutDef def;
  double step = 0;  // s
  std::array<LinearFilter, 3> translation, rotation;
  LinearFilter tilt;
};
[[nodiscard]] Washout build_washout(const WashoutDef& def, double step);

struct WashoutState {
  std::array<FilterState, 3> translation, rotation;
  std::array<FilterState, 2> tilt;     // of u_x, u_y
  std::array<double, 2> tilt_angle{};  // phi, theta [rad]
};

// Pose of the platform about neutral.
struct PlatformPose {
  Triple position{};  // m; forward, left, up
  Triple angles{};    // rad; roll phi, pitch theta, yaw psi
};

// One step: the inputs hold over it, the pose is that at its end. No allocation. Pre-condition: finite inputs.
// f_P: specific force [m/s2], w_P: angular velocity [rad/s], both in the seat's axes.
[[nodiscard]] PlatformPose step(const Washout& washout, const Triple& f_P, const Triple& w_P,
                                WashoutState& state) noexcept;

}  // namespace slew::devices
