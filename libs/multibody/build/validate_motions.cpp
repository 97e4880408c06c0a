// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/validate_motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "multibody/build/assembly.h"
#include "multibody/build/start_pose.h"
#include "multibody/forces/validate_elements.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/field_tables.h"
#include "multibody/motions/build_drives.h"

namespace slew::multibody {
namespace {

// speeds of a scene have six digits and more
constexpr double kSpeedTolerance = 1e-6;

const JointDef* joint_of(const MechanicsDef& m, const MotionDef& motion) {
  const auto found = std::find_if(m.joints.begin(), m.joints.end(),
                                  [&motion](const JointDef& joint) { return joint.name == motion.joint; });
  return found == m.joints.end() ? nullptr : &*found;
}

class MotionRules {
 public:
  MotionRules(const MechanicsDef& mechanics, Problems& problems) : m_(mechanics), problems_(problems) {}

  bool check(std::size_t index) {
    const MotionDef& motion = m_.motions[index];
    const std::size_t known = problems_.size();
    check_points(motion);
    if (problems_.size() > known) return false;
    const JointDef* joint = joint_of(m_, motion);
    if (joint == nullptr) {
      add(motion.name + ".joint", fmt::format("there is no joint '{}'", motion.joint), "the name of a joint");
      return false;
    }
    const int number = driven_coordinate(motion, joint->type);
    if (number < 0) {
      report_coordinate(motion, *joint);
      return false;
    }
    for (std::size_t other = 0; other < index; ++other) {
      const MotionDef& before = m_.motions[other];
      if (before.joint != motion.joint || driven_coordinate(before, joint->type) != number) continue;
      add(motion.name + ".joint",
          fmt::format("the motion '{}' drives this coordinate of '{}' already", before.name, motion.joint),
          "one motion for a coordinate");
    }
    return true;
  }

  void check_start(const MotionDef& motion, std::span<const Pose> poses) {
    const JointDef& joint = *joint_of(m_, motion);
    const auto number = static_cast<std::size_t>(driven_coordinate(motion, joint.type));
    const Pose& body1 = poses[static_cast<std::size_t>(number_of_(joint.body1))];
    const Pose& body2 = poses[static_cast<std::size_t>(number_of_(joint.body2))];
    const double pose = start_coordinates(joint, joint_frames(joint, body1, body2))[number];
    const MotionValue begin = evaluate(motion_law(motion, pose), 0);
    const bool is_angle = motion.kind == MotionKind::rotation;
    // without stated turns the poses alone are compared
    const bool has_turns = axis_of(joint, static_cast<int>(number)).start_turns != 0;
    double gap = begin.position - pose;
    if (is_angle && !has_turns) gap = std::remainder(gap, 2 * std::numbers::pi);
    const double tolerance = std::max(m_.assembly_tolerance, kFrameTolerance);
    const char* unit = is_angle ? "rad" : "m";
    if (!(std::fabs(gap) <= tolerance)) {
      add(motion.name,
          fmt::format("the motion starts at {:.6g} {}, the poses have '{}' at {:.6g} {}", begin.position, unit,
                      motion.joint, pose, unit),
          fmt::format("a motion that fits the poses within {} {} (mechanics.assembly_tolerance)", tolerance, unit));
    }
    const double given = number == 0 ? joint.initial_velocity : joint.initial_velocity_2;
    if (is_given(given) && std::fabs(given - begin.speed) > kSpeedTolerance * std::max(1.0, std::fabs(given))) {
      add(motion.name,
          fmt::format("the motion starts with {:.6g} {}/s, the initial velocity of '{}' is {:.6g} {}/s", begin.speed,
                      unit, motion.joint, given, unit),
          "no initial velocity: the motion has its own");
    }
  }

 private:
  void add(std::string path, std::string what, std::string expected) {
    problems_.push_back({std::move(path), std::move(what), std::move(expected), {}});
  }

  void check_points(const MotionDef& motion) {
    const std::string path = motion.name + ".points";
    if (motion.shape == MotionShape::table && motion.points.empty()) {
      add(path, "the table has no points", "two points or more");
    }
    check_table(path, motion.points, TableUse::any, problems_);
    const bool has_table = motion.shape == MotionShape::table || motion.shape == MotionShape::speed;
    if (!has_table || motion.ends != TableEnds::refused || motion.points.empty() || motion.points[0][0] <= 0) return;
    add(path,
        fmt::format("the table begins at {} s and refuses to be left, but a session begins at 0", motion.points[0][0]),
        "a first time of at most 0, or other ends");
  }

  void report_coordinate(const MotionDef& motion, const JointDef& joint) {
    const std::string type(sections()[1].types[static_cast<std::size_t>(joint.type)].name);
    const bool is_rotation = motion.kind == MotionKind::rotation;
    const bool has_angle = joint.type == JointType::revolute || joint.type == JointType::cylindrical;
    if (is_rotation && has_angle) {
      add(motion.name + ".axis", fmt::format("the {} joint '{}' has one angle", type, joint.name), "axis 1, or none");
      return;
    }
    add(motion.name + ".joint",
        fmt::format("the {} joint '{}' has no {} to drive", type, joint.name, is_rotation ? "angle" : "displacement"),
        is_rotation ? "a revolute, cylindrical or universal joint" : "a prismatic or cylindrical joint");
  }

  const MechanicsDef& m_;
  BodyNumbers number_of_{m_};
  Problems& problems_;
};

}  // namespace

bool check_motions(const MechanicsDef& mechanics, Problems& problems) {
  MotionRules rules(mechanics, problems);
  bool is_sound = true;
  for (std::size_t i = 0; i < mechanics.motions.size(); ++i) is_sound = rules.check(i) && is_sound;
  return is_sound;
}

void check_motion_starts(const MechanicsDef& mechanics, std::span<const Pose> poses, Problems& problems) {
  MotionRules rules(mechanics, problems);
  for (const MotionDef& motion : mechanics.motions) rules.check_start(motion, poses);
}

}  // namespace slew::multibody
