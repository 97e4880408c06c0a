// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/start_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "multibody/build/assembly.h"
#include "multibody/build/start_pose.h"
#include "multibody/constraints/constraint.h"
#include "multibody/flexible/node_span.h"
#include "multibody/joints/joint_axes.h"

namespace slew::multibody {
namespace {

using math::Vec3;

// tolerance for a start on a limit, with numbers of six digits
constexpr double kLimitTolerance = 1e-6;  // m, rad

// A dummy's mass couples the links of its two points, which the recursion takes within one body, across one joint, and
// along the modes of one flexible body on either side of it (flexible/node_dummies.h).
class DummyRules {
 public:
  struct Fault {
    const char* what = nullptr;  // none: no fault
    const char* expected = nullptr;
  };

  DummyRules(const MechanicsDef& mechanics, const std::vector<TreeEdge>& tree)
      : merged_(merged_into(mechanics, tree)),
        parent_(merged_.size(), kGround),
        flexible_(merged_.size(), kNoBody),
        is_node_(merged_.size(), 0),
        is_free_(merged_.size(), false),
        across_(merged_.size(), kNoBody) {
    const BodyNumbers number_of(mechanics);
    for (const TreeEdge& edge : tree) {
      const auto child = at(edge.child);
      if (merged_[child] != edge.child) continue;
      parent_[child] = merged_[at(edge.parent)];
      const JointDef* joint = edge.joint == kNoJoint ? nullptr : &mechanics.joints[at(edge.joint)];
      is_free_[child] = joint == nullptr || joint->type == JointType::floating;
      if (joint != nullptr && joint->type == JointType::node) {
        flexible_[child] = number_of(joint->body1);
        is_node_[child] = 1;
      }
    }
  }

  Fault check(int body1, int body2) {
    const int end1 = merged_[at(body1)], end2 = merged_[at(body2)];
    if (end1 == end2) return {};
    const std::optional<NodeSpan> span = node_span(end1, end2, parent_, is_node_);
    if (!span) {
      return {"acts between bodies that more than one joint connects",
              "a force between neighbours; dummies on a force across more than one joint are not in this version"};
    }
    const bool is_joint_between = span->outer == span->child && span->inner == span->carrier;
    if (is_joint_between || span->inner == kGround) return {};
    if (span->child > 0 && is_free_[at(span->child)]) {
      return {"acts between a node of a body on Ground and a body that no joint of the tree holds",
              "a force between bodies that a joint connects, or one without dummies"};
    }
    return check_modes(*span);
  }

 private:
  static std::size_t at(int body) { return static_cast<std::size_t>(body); }

  // all nodes of the ends and of the joint's inner side belong to one body
  Fault check_modes(const NodeSpan& span) {
    int unused = kNoBody;
    int& known = span.child > 0 ? across_[at(span.child)] : unused;
    for (const int link : {span.inner, span.carrier}) {
      if (link == span.frame) continue;
      if (known == kNoBody) known = flexible_[at(link)];
      if (known == flexible_[at(link)]) continue;
      return {
          "couples nodes of two flexible bodies that are fixed to each other",
          "points and joints at nodes of one of them; dummies that couple the modes of both are not in this version"};
    }
    return {};
  }

  std::vector<int> merged_, parent_;  // by body: the body it is merged into; the body that carries its joint
  std::vector<int> flexible_;         // by body: the flexible body of which it is a node
  std::vector<char> is_node_;
  std::vector<bool> is_free_;
  std::vector<int> across_;  // by body: flexible body whose nodes hold ends of dummies across its joint
};

class StartRules {
 public:
  StartRules(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems)
      : m_(mechanics), poses_(poses), problems_(problems) {}

  // directions held by the joint must agree at the start within the tolerance
  void check_frames(const JointDef& joint) {
    if (joint.type == JointType::floating || joint.type == JointType::node) return;
    const JointFrames frames = joint_frames(joint, pose_of(joint.body1), pose_of(joint.body2));
    check_link(joint, math::norm(frames.frame2.p - frames.frame1.p));
    check_limits(joint, frames);
    const Pose held = nearest_frame(joint.type, frames);
    const double gap = math::norm(held.p - frames.frame2.p);
    const double tilt = math::rotation_angle(held.R * math::transpose(frames.frame2.R));
    const double tolerance = std::max(m_.assembly_tolerance, kFrameTolerance);
    if (gap > tolerance) {
      const bool has_axis = joint.type == JointType::prismatic || joint.type == JointType::cylindrical;
      add(joint.name + ".point2",
          fmt::format("the joint's points are {:.6g} m apart at the start{}", gap, has_axis ? " across the axis" : ""),
          fmt::format("points that agree within {} m (mechanics.assembly_tolerance)", tolerance));
    }
    if (tilt > tolerance) {
      const bool has_one_axis = joint.type == JointType::revolute || joint.type == JointType::cylindrical;
      add(joint.name + ".orientation2",
          fmt::format("the joint's {} {:.6g} rad apart at the start", has_one_axis ? "axes are" : "frames are turned",
                      tilt),
          fmt::format("joint frames that agree within {} rad (mechanics.assembly_tolerance)", tolerance));
    }
  }

  void check_link(const JointDef& joint, double distance) {
    if (joint.type < JointType::spherical_spherical) return;
    if (joint.length == 0 && distance < kShortestLink) {
      add(joint.name + ".point2", "the link's points coincide at the start", "two points apart, or a length");
    } else if (joint.length > 0 && std::abs(distance - joint.length) > m_.assembly_tolerance) {
      add(joint.name + ".length",
          fmt::format("the link's points are {:.6g} m apart at the start, its length is {:.6g} m", distance,
                      joint.length),
          fmt::format("points that fit the length within {} m (mechanics.assembly_tolerance)", m_.assembly_tolerance));
    }
  }

  // a start beyond a limit would throw the machine
  void check_limits(const JointDef& joint, const JointFrames& frames) {
    for (int number = 0; number < coordinate_count(joint.type); ++number) {
      check_limits(joint, number, start_coordinates(joint, frames)[static_cast<std::size_t>(number)]);
    }
  }

  void check_limits(const JointDef& joint, int number, double start) {
    const JointAxisDef axis = axis_of(joint, number);
    if (axis.limit_min >= axis.limit_max) return;
    const bool is_below = start < axis.limit_min - kLimitTolerance;
    if (!is_below && start <= axis.limit_max + kLimitTolerance) return;
    const char* unit = is_angle(joint.type, number) ? "rad" : "m";
    add(fmt::format("{}.{}{}", joint.name, is_below ? "limit_min" : "limit_max", suffix_of(joint.type, number)),
        fmt::format("the joint starts at {:.4g} {}, outside of its limits", start, unit),
        fmt::format("limits that hold {0:.4g} {2}, or poses that start between {1:.4g} and {3:.4g} {2}", start,
                    axis.limit_min, unit, axis.limit_max));
  }

  void check_start_length(const TranslationalForceDef& force) {
    const Pose& body1 = pose_of(force.body1);
    const Pose& body2 = pose_of(force.body2);
    const Vec3 gap = body1.p + body1.R * Vec3(force.point1) - body2.p - body2.R * Vec3(force.point2);
    if (math::norm(gap) > kFrameTolerance) return;
    add(force.name + ".point2", "the force's points coincide at the start", "two points that stay apart");
  }

  void check_dummies(const std::vector<TreeEdge>& tree) {
    DummyRules rules(m_, tree);
    for (const ForceDummyDef& dummy : m_.force_dummies) {
      for (const TranslationalForceDef& force : m_.translational_forces) {
        if (force.name != dummy.relative_to) continue;
        const DummyRules::Fault fault = rules.check(number_of_(force.body1), number_of_(force.body2));
        if (fault.what == nullptr) continue;
        add(dummy.name + ".relative_to", fmt::format("'{}' {}", force.name, fault.what), fault.expected);
      }
    }
  }

 private:
  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }

  [[nodiscard]] const Pose& pose_of(const std::string& body) const {
    return poses_[static_cast<std::size_t>(number_of_(body))];
  }

  const MechanicsDef& m_;
  BodyNumbers number_of_{m_};
  std::span<const Pose> poses_;
  Problems& problems_;
};

}  // namespace

void check_start(const MechanicsDef& mechanics, std::span<const Pose> poses, const std::vector<TreeEdge>& tree,
                 Problems& problems) {
  StartRules rules(mechanics, poses, problems);
  for (const JointDef& joint : mechanics.joints) rules.check_frames(joint);
  for (const TranslationalForceDef& force : mechanics.translational_forces) rules.check_start_length(force);
  rules.check_dummies(tree);
}

}  // namespace slew::multibody
