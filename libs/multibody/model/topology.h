// SPDX-License-Identifier: Apache-2.0
// Topology of the bodies: a tree of joints rooted in Ground, the cut joints, and the start poses.
//
// Joints with coordinates (fixed, revolute, prismatic, spherical, universal, cylindrical, floating) span the tree. In a
// loop the joint that the scene lists last is cut and closed by constraints, with three exceptions. A fixed joint is
// cut only if the loop has no other joint. A joint with limits, friction, prescribed motion or an initial velocity is
// cut only if there is no joint without them. With five loops or more the joint farthest from Ground is cut, if that
// makes the paths from Ground to the cut joints half as long. The other joints have no coordinates and are always cut.
// A body that only cut joints connect to the rest is free in the tree.
//
// Bodies are numbered 0 for Ground, i + 1 for MechanicsDef::bodies[i].
#pragma once

#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/problem.h"
#include "math/rotation.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

inline constexpr int kGround = 0;
inline constexpr int kNoBody = -1;
inline constexpr int kNoJoint = -1;

struct Pose {
  math::Mat3 R = math::Mat3::identity();  // R_WB: columns are the body's axes in Ground
  math::Vec3 p;                           // p_WB [m]
};

// A joint in the direction of the tree, from Ground outwards.
struct TreeEdge {
  int joint = 0;             // index in MechanicsDef::joints; kNoJoint: the child is free
  int parent = 0;            // body
  int child = 0;             // body
  bool is_reversed = false;  // the child is the joint's body 1
};

// Index of a body by name, kNoBody when there is none. Linear in the bodies.
[[nodiscard]] int find_body(const MechanicsDef& mechanics, std::string_view name) noexcept;

// The same for many names: the mechanics outlives it and does not change.
class BodyNumbers {
 public:
  explicit BodyNumbers(const MechanicsDef& mechanics);
  [[nodiscard]] int operator()(std::string_view name) const noexcept;

 private:
  std::unordered_map<std::string_view, int> numbers_;  // for look-up, never iterated
};
[[nodiscard]] std::string_view body_name(const MechanicsDef& mechanics, int body) noexcept;

// Joints in an order in which every parent comes before its children. Appends a problem for every body without a path
// to Ground and every floating joint that does not start from Ground.
[[nodiscard]] std::vector<TreeEdge> find_tree(const MechanicsDef& mechanics, Problems& problems);

// Joints outside of the tree, in the order of the scene: indices in MechanicsDef::joints. Floating joints of bodies
// held by others are not included: they constrain no motion.
[[nodiscard]] std::vector<int> cut_joints(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree);

// True if a joint merges two bodies: fixed joints, and nodes of bodies without modes.
[[nodiscard]] bool merges(const MechanicsDef& mechanics, const JointDef& joint) noexcept;

// True if a joint's motion can be described by coordinates of its own.
[[nodiscard]] bool has_coordinates(JointType type) noexcept;

// Poses in Ground of all bodies by number. Appends a problem for a cycle of `relative_to`; names must exist.
[[nodiscard]] std::vector<Pose> start_poses(const MechanicsDef& mechanics, Problems& problems);

// Poses in Ground of a joint's two frames.
struct JointFrames {
  Pose frame1, frame2;
};
[[nodiscard]] JointFrames joint_frames(const JointDef& joint, const Pose& body1, const Pose& body2) noexcept;

// Start coordinate of a revolute joint, in (-pi, pi] [rad], or of a prismatic one [m].
[[nodiscard]] double start_coordinate(JointType type, const JointFrames& frames) noexcept;

// For every body, the number of the body nearest to Ground that fixed joints merge it with (itself when there is none).
[[nodiscard]] std::vector<int> merged_into(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree);

}  // namespace slew::multibody
