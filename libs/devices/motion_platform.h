// SPDX-License-Identifier: Apache-2.0
// A motion platform by steps of time: washout, soft limits, legs, and the way from parked to active and back.
//
//   parked -> rising -> ramping_in -> active -> washing_back -> lowering -> parked
//   without a sample for freeze_after: frozen for hold_time, then washing_back; with new samples it ramps in again
//
// Each of the six coordinates is held below its limit L: linear to soft_from L, tanh beyond. Legs stay within their
// stroke (hexapod.h). Every limit that acts is counted. Card: docs/models/motion_platform.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "devices/hexapod.h"
#include "devices/seat_motion.h"
#include "devices/washout.h"

namespace slew::devices {

struct MotionPlatformDef {
  std::string name;
  WashoutDef washout{};
  HexapodDef hexapod{};
  Triple position_limit = {0.2, 0.2, 0.15};  // m; surge, sway, heave
  Triple angle_limit = {0.3, 0.3, 0.3};      // rad; roll, pitch, yaw
  double soft_from = 0.8;                    // share of a limit from which the motion is drawn back
  double park_height = 0.1;                  // m that the platform is lowered when parked
  double rise_time = 4;                      // s
  double ramp_time = 2;                      // s
  double freeze_after = 0.05;                // s without a sample
  double hold_time = 0.5;                    // s
};

[[nodiscard]] std::span<const Field> motion_platform_fields() noexcept;  // without washout and hexapod
void validate(const MotionPlatformDef& def, Problems& problems);

enum class PlatformPhase : std::uint8_t { parked, rising, ramping_in, active, frozen, washing_back, lowering };
[[nodiscard]] std::string_view text_of(PlatformPhase phase) noexcept;

enum class PlatformCommand : std::uint8_t { park, run };

// Immutable. Throws Failure (bad_input) when the definition has a problem. step: s, above 0.
struct MotionPlatform {
  MotionPlatformDef def;
  Washout washout;
  double step = 0;
};
[[nodiscard]] MotionPlatform build_platform(const MotionPlatformDef& def, double step);

struct MotionPlatformState {
  PlatformPhase phase = PlatformPhase::parked;
  double phase_time = 0;  // s in the phase
  double silence = 0;     // s since the last sample
  WashoutState washout;
  SeatMotion motion;             // last sample, held until the next one
  PlatformPose pose;             // about neutral, as sent
  PlatformPose held_pose;        // washout's pose with its gain when it froze
  LegLengths legs{};             // m, as sent
  std::uint64_t saturated = 0;   // steps with a coordinate beyond its linear share
  std::uint64_t drawn_back = 0;  // steps with a leg at an end of its stroke
  std::uint64_t not_finite = 0;  // samples
  std::uint64_t freezes = 0;
};
[[nodiscard]] MotionPlatformState initial_state(const MotionPlatform& platform) noexcept;

// One step. motion: the new sample; no value when none came: the last one holds. No allocation.
void step(const MotionPlatform& platform, PlatformCommand command, const std::optional<SeatMotion>& motion,
          MotionPlatformState& state) noexcept;

// q held below limit: see above. Pre-condition: limit above 0, 0 <= soft_from < 1.
[[nodiscard]] double soft_limited(double q, double limit, double soft_from) noexcept;

}  // namespace slew::devices
