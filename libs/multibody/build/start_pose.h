// SPDX-License-Identifier: Apache-2.0
// Start pose of a joint's second frame in the tree. Internal to the library.
#pragma once

#include <array>

#include "multibody/model/topology.h"

namespace slew::multibody {

// Frame 2 moved to the nearest pose that the joint allows: the point first, then the smallest turn.
[[nodiscard]] Pose nearest_frame(JointType type, const JointFrames& frames) noexcept;

// Coordinates of a joint at the start, as model.h lists them, unused ones zero: angles in (-pi, pi].
[[nodiscard]] std::array<double, 2> start_coordinates(JointType type, const JointFrames& frames) noexcept;

// The same with the joint's whole turns at the start.
[[nodiscard]] std::array<double, 2> start_coordinates(const JointDef& joint, const JointFrames& frames) noexcept;

// Frame 2 for given coordinates. Pre-condition: the joint has one or two.
[[nodiscard]] Pose frame_at(JointType type, const Pose& frame1, const std::array<double, 2>& q) noexcept;

// Coordinates of a universal joint, and the attitude of frame 2.
struct UniversalStart {
  double q1 = 0, q2 = 0;  // rad
  math::Mat3 R;           // R_W2
};
[[nodiscard]] UniversalStart universal_start(const JointFrames& frames) noexcept;

}  // namespace slew::multibody
