// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/validate_gears.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include "multibody/build/assembly.h"
#include "multibody/build/start_pose.h"
#include "multibody/constraints/gear.h"
#include "multibody/model/field_tables.h"

namespace slew::multibody {
namespace {

// Joints that gears hold to each other: a forest in which every coordinate is a multiple of its root's.
class GearedJoints {
 public:
  explicit GearedJoints(std::size_t joints) : root_(joints), factor_(joints, 1.0) {
    std::iota(root_.begin(), root_.end(), std::size_t{0});
  }
  // q_2 = ratio q_1. The ratio that earlier gears hold already, and none if they leave it free.
  [[nodiscard]] std::optional<double> join(std::size_t joint1, std::size_t joint2, double ratio) {
    const std::size_t root1 = settle(joint1), root2 = settle(joint2);
    if (root1 == root2) return factor_[joint2] / factor_[joint1];
    root_[root2] = root1;
    factor_[root2] = ratio * factor_[joint1] / factor_[joint2];
    return std::nullopt;
  }

 private:
  // the root, to which the joint then is a neighbour
  std::size_t settle(std::size_t joint) {
    std::size_t root = joint;
    double factor = 1;
    while (root_[root] != root) {
      factor *= factor_[root];
      root = root_[root];
    }
    root_[joint] = root;
    factor_[joint] = factor;
    return root;
  }

  std::vector<std::size_t> root_;
  std::vector<double> factor_;
};

class GearRules {
 public:
  GearRules(const MechanicsDef& mechanics, Problems& problems) : m_(mechanics), problems_(problems) {}

  bool check(const GearDef& gear) {
    const bool is_first_right = check_joint(gear, "joint1", gear.joint1, 0);
    const bool both = check_joint(gear, "joint2", gear.joint2, 1) && is_first_right;
    if (!both || gear.joint1 != gear.joint2) return both;
    add(gear.name + ".joint2", fmt::format("both joints are '{}'", gear.joint2), "two different joints");
    return false;
  }

  // Ratios that contradict each other would hold all their joints. A ratio of 0 does so on purpose.
  void check_circles() {
    constexpr double kEqual = 1e-4;  // the root of what the assembly takes as dependent
    GearedJoints geared(m_.joints.size());
    for (const GearDef& gear : m_.gears) {
      if (gear.ratio == 0) continue;
      const auto joint1 = static_cast<std::size_t>(joint_of(gear.joint1) - m_.joints.data());
      const auto joint2 = static_cast<std::size_t>(joint_of(gear.joint2) - m_.joints.data());
      const std::optional<double> held = geared.join(joint1, joint2, gear.ratio);
      if (!held || std::fabs(gear.ratio - *held) <= kEqual * std::fabs(*held)) continue;
      const char* key = gear.kind == GearKind::rack_and_pinion ? "radius" : "ratio";
      add(fmt::format("{}.{}", gear.name, key),
          fmt::format("{:.6g} contradicts the gears before it, which hold '{}' to '{}' with {:.6g}: neither could move",
                      gear.ratio, gear.joint2, gear.joint1, *held),
          "ratios that agree round every circle of gears, or one gear less");
    }
  }

  void check_start(const GearDef& gear, std::span<const Pose> poses, const std::vector<TreeEdge>& tree) {
    bool is_in_tree = true;
    for (const auto& [key, name] : {std::pair("joint1", &gear.joint1), {"joint2", &gear.joint2}}) {
      const auto index = static_cast<int>(joint_of(*name) - m_.joints.data());
      const bool is_there = std::any_of(tree.begin(), tree.end(), [&](const TreeEdge& e) { return e.joint == index; });
      is_in_tree = is_in_tree && is_there;
      if (is_there) continue;
      add(fmt::format("{}.{}", gear.name, key), fmt::format("'{}' closes a loop of geared and fixed joints", *name),
          "one joint of every loop without a gear");
    }
    if (!is_in_tree || !is_given(gear.offset)) return;
    const double q1 = start_of(gear.joint1, poses), q2 = start_of(gear.joint2, poses);
    double gap = q2 - gear.ratio * q1 - gear.offset;
    if (gear.kind == GearKind::gear) gap = std::remainder(gap, 2 * std::numbers::pi);
    const double tolerance = std::max(m_.assembly_tolerance, kFrameTolerance);
    if (std::fabs(gap) <= tolerance) return;
    const char* unit = is_angle(gear.kind, 1) ? "rad" : "m";
    add(gear.name + ".offset",
        fmt::format("the poses have '{}' at {:.6g} {}, the gear at {:.6g} {}", gear.joint2, q2, unit, q2 - gap, unit),
        fmt::format("poses that fit the gear within {} {} (mechanics.assembly_tolerance), or no offset", tolerance,
                    unit));
  }

 private:
  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }

  [[nodiscard]] const JointDef* joint_of(const std::string& name) const {
    const auto found =
        std::find_if(m_.joints.begin(), m_.joints.end(), [&](const JointDef& joint) { return joint.name == name; });
    return found == m_.joints.end() ? nullptr : &*found;
  }

  bool check_joint(const GearDef& gear, const char* key, const std::string& name, std::size_t end) {
    const JointDef* joint = joint_of(name);
    const std::string path = fmt::format("{}.{}", gear.name, key);
    if (joint == nullptr) {
      add(path, fmt::format("there is no joint '{}'", name), "the name of a joint");
      return false;
    }
    const bool needs_angle = is_angle(gear.kind, end);
    if (joint->type == (needs_angle ? JointType::revolute : JointType::prismatic)) return true;
    const std::string type(sections()[1].types[static_cast<std::size_t>(joint->type)].name);
    add(path, fmt::format("the joint '{}' is {}", name, type),
        needs_angle ? "a revolute joint, which has an angle and nothing else"
                    : "a prismatic joint, which has a displacement and nothing else");
    return false;
  }

  [[nodiscard]] double start_of(const std::string& name, std::span<const Pose> poses) const {
    const JointDef& joint = *joint_of(name);
    const Pose& body1 = poses[static_cast<std::size_t>(find_body(m_, joint.body1))];
    const Pose& body2 = poses[static_cast<std::size_t>(find_body(m_, joint.body2))];
    return start_coordinates(joint, joint_frames(joint, body1, body2))[0];
  }

  const MechanicsDef& m_;
  Problems& problems_;
};

}  // namespace

bool check_gears(const MechanicsDef& mechanics, Problems& problems) {
  GearRules rules(mechanics, problems);
  bool is_sound = true;
  for (const GearDef& gear : mechanics.gears) is_sound = rules.check(gear) && is_sound;
  if (is_sound) rules.check_circles();
  return is_sound;
}

void check_gear_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, const std::vector<TreeEdge>& tree,
                       Problems& problems) {
  GearRules rules(mechanics, problems);
  for (const GearDef& gear : mechanics.gears) rules.check_start(gear, poses, tree);
}

}  // namespace slew::multibody
