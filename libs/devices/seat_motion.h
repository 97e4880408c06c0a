// SPDX-License-Identifier: Apache-2.0
// Motion of a seat from the published motion of its body.
//
//   v_WP = v_WB + w_WB x (R_WB p_BP),   f_P = R_BP^T R_WB^T ((v_WP(t) - v_WP(t'))/(t - t') - g_W),   w_P = R_BP^T
//   R_WB^T w_WB
//
// W: Ground, B: axes of the body, P: axes of the seat (washout.h). A session publishes velocities and no accelerations:
// f_P has the mean acceleration over the time from the sample before, t', and so no change of velocity is lost between
// two samples. Card: docs/models/motion_platform.md. Not covered: deflection of a flexible body at the point.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"
#include "devices/washout.h"
#include "math/rotation.h"

namespace slew::devices {

// All in axes of the body.
struct SeatDef {
  Triple point{};    // p_BP, m
  Triple forward{};  // of any length
  Triple up{};       // of any length, square to forward
};

[[nodiscard]] std::span<const Field> seat_fields() noexcept;
void validate(std::string_view path, const SeatDef& def, Problems& problems);

// Immutable. Pre-condition of build_seat(): no problem.
struct Seat {
  math::Vec3 point_B;  // m
  math::Mat3 R_BP;
  math::Vec3 gravity_W;  // m/s2
};
[[nodiscard]] Seat build_seat(const SeatDef& def, const Triple& gravity_W) noexcept;

// Published motion of the body at one instant.
struct BodyMotion {
  double time = 0;  // of the session, s
  math::Quaternion q_WB{};
  math::Vec3 v_WB{};  // of the body's origin, m/s
  math::Vec3 w_WB{};  // rad/s
};

// Motion of the seat in its own axes P.
struct SeatMotion {
  Triple f_P{0, 0, kStandardGravity};  // specific force, m/s2
  Triple w_P{};                        // angular velocity, rad/s
  double time = 0;                     // of the session, s
};

struct SeatState {
  bool has_sample = false;
  double time = 0;  // s
  math::Vec3 v_WP;  // m/s
};

// No value: the sample is the first one, or not later than the one before, as after a reset; the next one gives a
// motion. No allocation.
[[nodiscard]] std::optional<SeatMotion> seat_motion(const Seat& seat, const BodyMotion& body,
                                                    SeatState& state) noexcept;

}  // namespace slew::devices
