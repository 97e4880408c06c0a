// SPDX-License-Identifier: Apache-2.0
// Legs of a 6-6 platform by inverse kinematics.
//
//   l_i = |p_0 + x + R b_i - a_i|,  R = Rz(psi) Ry(theta) Rx(phi)
//
// a_i: joints on the base, b_i: joints on the platform about its origin, p_0: that origin in neutral, all with x
// forward, y left, z up. Card: docs/models/motion_platform.md. Not covered: forces, speeds and collisions of the legs,
// singular poses. Source: Stewart 1965.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/washout.h"

namespace slew::devices {

inline constexpr std::size_t kLegs = 6;
using LegLengths = std::array<double, kLegs>;  // m

struct HexapodDef {
  std::vector<Triple> base_joints{};      // a_i, m, six
  std::vector<Triple> platform_joints{};  // b_i, m, six, in the order of the legs
  double neutral_height = 0;              // m, z of p_0
  double shortest_leg = 0;                // m
  double longest_leg = 0;                 // m
};

[[nodiscard]] std::span<const Field> hexapod_fields() noexcept;
// Neutral must be within the stroke of all legs.
void validate(std::string_view path, const HexapodDef& def, Problems& problems);

// Pre-condition: six joints each.
[[nodiscard]] LegLengths leg_lengths(const HexapodDef& def, const PlatformPose& pose) noexcept;
[[nodiscard]] bool is_within_stroke(const HexapodDef& def, const LegLengths& legs) noexcept;

// The pose drawn back along its straight line to `home` until all legs are within their stroke; the pose itself where
// they are. Pre-condition: home is within the stroke.
struct ReachablePose {
  PlatformPose pose;
  LegLengths legs{};
  bool was_drawn_back = false;
};
[[nodiscard]] ReachablePose reachable(const HexapodDef& def, const PlatformPose& home,
                                      const PlatformPose& pose) noexcept;

}  // namespace slew::devices
