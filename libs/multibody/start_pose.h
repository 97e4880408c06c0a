// Where a joint of the tree wants the frame of its second body at the start. Internal to the library.
#pragma once

#include "multibody/topology.h"

namespace slew::multibody {

// Frame 2 moved to the nearest pose that the joint allows: the point first, then the smallest turn.
[[nodiscard]] Pose nearest_frame(JointType type, const JointFrames& frames) noexcept;

// Coordinates of a universal joint, and where they have frame 2.
struct UniversalStart {
  double q1 = 0, q2 = 0;  // rad
  math::Mat3 R;           // R_W2
};
[[nodiscard]] UniversalStart universal_start(const JointFrames& frames) noexcept;

}  // namespace slew::multibody
