// Where the links of a robot go: which links become bodies, and where every link's frame lies in its body.
//
// Links that fixed joints hold together move as one. A link with mass becomes a body; one without rides on a body of
// its group, or on Ground when the group is the root's and the root is fixed.
#pragma once

#include <vector>

#include "multibody/topology.h"
#include "urdf/robot.h"
#include "urdf/tree.h"

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

// Values of a pose as a scene writes them, without what rounding leaves of a zero.
[[nodiscard]] Triple without_rounding(const Triple& triple, double scale) noexcept;
[[nodiscard]] Triple position_of(const Pose& pose) noexcept;     // m
[[nodiscard]] Triple orientation_of(const Pose& pose) noexcept;  // rad, Euler z-x'-z''

// By link. Complains about moving groups without mass.
[[nodiscard]] std::vector<Place> find_places(const Robot& robot, RootMount mount, const Complain& complain);

// Coordinate of a joint at the start [rad or m]: 0 where the limits allow it, else the middle between them (a
// quarter of their distance off where that is half a turn).
[[nodiscard]] double start_coordinate(const Joint& joint) noexcept;

// Child's frame in the parent's at the start, limits moved by whole turns so that the start lies within half a turn.
[[nodiscard]] Pose start_pose(const Joint& joint) noexcept;
[[nodiscard]] double whole_turns(const Joint& joint) noexcept;  // rad, a multiple of 2 pi

// What hangs on a joint resists: its inertia about the axis [kg m2], or its mass [kg] along it, at the start. What
// floating joints leave free does not count.
[[nodiscard]] std::vector<double> resistance_of_joints(const Robot& robot);

}  // namespace slew::urdf
