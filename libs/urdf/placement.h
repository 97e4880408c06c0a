// SPDX-License-Identifier: Apache-2.0
// Placement of a robot's links: the links that become bodies, and every link's frame in its body.
//
// Links that fixed joints hold together move as one. A link with mass becomes a body; one without rides on a body of
// its group, or on Ground when the group is the root's and the root is fixed.
#pragma once

#include <vector>

#include "multibody/model/topology.h"
#include "urdf/robot.h"

namespace slew::urdf {

using multibody::Pose;

enum class RootMount { fixed, floating };

inline constexpr int kOnGround = -1;

// A link's frame in the body that it rides on.
struct Place {
  int body = kOnGround;  // link that is the body
  Pose pose;             // link's frame in that body's
};

[[nodiscard]] Pose pose_of(const Origin& origin) noexcept;
[[nodiscard]] Pose operator*(const Pose& a, const Pose& b) noexcept;  // C in A from B in A and C in B
[[nodiscard]] Pose inverse(const Pose& a) noexcept;

// Values of a pose for a scene, with rounded zeros as 0.
[[nodiscard]] Triple without_rounding(const Triple& triple, double scale) noexcept;
[[nodiscard]] Triple position_of(const Pose& pose) noexcept;     // m
[[nodiscard]] Triple orientation_of(const Pose& pose) noexcept;  // rad, Euler z-x'-z''

// Links that move as one: by link, the one nearest to the root, and the link's frame in that one's.
struct Group {
  int head = 0;
  Pose pose;
};
[[nodiscard]] std::vector<Group> find_groups(const Robot& robot);

// Mass, first moment and inertia of rigid bodies together, about the origin of a link's frame, in its axes.
struct Lump {
  double mass = 0;  // kg
  math::Vec3 h;     // kg m
  math::Mat3 I;     // kg m2
};
void add_lump(Lump& lump, const Lump& other, const Pose& pose) noexcept;  // adds a lump of another frame with the given
                                                                          // pose
[[nodiscard]] Lump lump_of(const Inertial& inertial) noexcept;
[[nodiscard]] math::Mat3 tensor_of(const Inertial& inertial) noexcept;  // about its centre, in its own axes
[[nodiscard]] math::Mat3 central_inertia(const Lump& lump) noexcept;    // about the centre of mass

// Placements by link. Pre-condition: every group that moves has mass (mass_properties.h).
[[nodiscard]] std::vector<Place> find_places(const Robot& robot, RootMount mount);

// Child's frame in the parent's at the start.
[[nodiscard]] Pose start_pose(const Joint& joint) noexcept;

// True if the joint stays at its start.
void fix(Joint& joint) noexcept;

// Load of a joint: its inertia about the axis [kg m2], or its mass [kg] along it, at the start. Links behind floating
// joints do not count. 0 if the value is rounding only.
[[nodiscard]] std::vector<double> resistance_of_joints(const Robot& robot);

}  // namespace slew::urdf
