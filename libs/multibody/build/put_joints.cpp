// SPDX-License-Identifier: Apache-2.0
#include "multibody/build/put_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "math/euler_angles.h"
#include "multibody/build/assembly.h"
#include "multibody/build/start_pose.h"
#include "multibody/build/validate.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/joints/joint_axes.h"
#include "multibody/model/topology.h"
#include "multibody/results/observe.h"

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

// m, rad: poses read from a drawing; the largest assembly_tolerance that a scene may have
constexpr double kRoughTolerance = 0.1;
// steps of a loop: small against the distance between its two branches
constexpr double kTurnOfStep = 0.05;   // rad
constexpr double kSlideOfStep = 0.05;  // m
constexpr int kMostStartSteps = 200;
constexpr int kMostGearedSteps = 2000;  // of gears, which whole turns move too
constexpr double kTurn = 2 * std::numbers::pi;
// change of a pose that is rounding [m, rad]
constexpr double kSamePose = 1e-12;

const JointDef& joint_named(const MechanicsDef& mechanics, const std::string& name) {
  return *std::find_if(mechanics.joints.begin(), mechanics.joints.end(),
                       [&](const JointDef& joint) { return joint.name == name; });
}

JointAxisDef& axis_of(JointDef& joint, int number) {
  return number == 1 ? joint.second : joint.first;
}

// Bodies, joints and gears alone; limits and speeds belong to the start that is looked for.
MechanicsDef without_laws(const MechanicsDef& mechanics) {
  MechanicsDef def;
  def.gravity = mechanics.gravity;
  def.assembly_tolerance = std::max(mechanics.assembly_tolerance, kRoughTolerance);
  def.bodies = mechanics.bodies;
  def.joints = mechanics.joints;
  def.gears = mechanics.gears;
  for (JointDef& joint : def.joints) {
    joint.first = {.start_turns = joint.first.start_turns};
    joint.second = {.start_turns = joint.second.start_turns};
    joint.initial_velocity = joint.initial_velocity_2 = kNotGiven;
    joint.initial_translation = joint.initial_rotation = kNoneGiven;
  }
  return def;
}

// a prescribed motion that stays at a value
MotionDef held_at(const MechanicsDef& mechanics, const StartCoordinate& coordinate, double value) {
  const JointType type = joint_named(mechanics, coordinate.joint).type;
  const bool turns = is_angle(type, coordinate.number);
  MotionDef motion;
  motion.name = "start." + coordinate.joint;
  motion.kind = turns ? MotionKind::rotation : MotionKind::translation;
  motion.shape = MotionShape::ramp;
  motion.joint = coordinate.joint;
  motion.axis = type == JointType::universal ? coordinate.number + 1 : 1;
  motion.from = motion.to = value;
  return motion;
}

Pose operator*(const Pose& a, const Pose& b) {
  return {a.R * b.R, a.p + a.R * b.p};
}

Pose inverse(const Pose& pose) {
  const Mat3 R = math::transpose(pose.R);
  return {R, -(R * pose.p)};
}

class StartPlacement {
 public:
  StartPlacement(const MechanicsDef& mechanics, std::span<const StartCoordinate> coordinates, Problems& problems)
      : def_(without_laws(mechanics)), coordinates_(coordinates), problems_(problems) {}

  // Poses of the bodies in Ground by number; empty after a problem.
  std::vector<Pose> place() {
    const std::size_t known = problems_.size();
    validate(def_, problems_);
    if (problems_.size() > known) return {};
    std::vector<Pose> poses = start_poses(def_, problems_);
    tree_ = find_tree(def_, problems_);
    if (std::any_of(def_.gears.begin(), def_.gears.end(), fits_poses)) keep_gears(poses = assembled(false));
    std::vector<double> from, travel;
    double steps = 1;
    for (const StartCoordinate& coordinate : coordinates_) {
      const bool turns = is_angle(joint_named(def_, coordinate.joint).type, coordinate.number);
      from.push_back(coordinates_of(joint_named(def_, coordinate.joint), poses)[at(coordinate.number)]);
      const double gap = coordinate.value - from.back();
      // a pose has no whole turns, but a gear moves its other joint by them
      travel.push_back(turns && def_.gears.empty() ? std::remainder(gap, kTurn) : gap);
      steps = std::max(steps, std::ceil(std::fabs(travel.back()) / (turns ? kTurnOfStep : kSlideOfStep)));
    }
    const int most = def_.gears.empty() ? kMostStartSteps : kMostGearedSteps;
    const int count = has_loops() ? static_cast<int>(std::min<double>(steps, most)) : 1;
    for (int step = 1; step <= count && problems_.size() == known; ++step) {
      std::vector<double> values;
      for (std::size_t k = 0; k < from.size(); ++k) {
        values.push_back(step == count ? from[k] + travel[k] : from[k] + travel[k] * step / count);
      }
      take(moved(poses, values));
      def_.motions.clear();
      for (std::size_t k = 0; k < values.size(); ++k) {
        def_.motions.push_back(held_at(def_, coordinates_[k], values[k]));
      }
      poses = assembled(step == count);
    }
    return problems_.size() > known ? std::vector<Pose>() : poses;
  }

  // Whole turns of the named joints and of geared ones, after place(), into the joints of the definition.
  void keep_turns(const std::vector<Pose>& poses, std::vector<JointDef>& joints) {
    for (const StartCoordinate& coordinate : coordinates_) {
      JointDef& joint = def_.joints[at(index_of(coordinate.joint))];
      if (!is_angle(joint.type, coordinate.number)) continue;
      const double shown = start_coordinates(joint.type, frames_of(joint, poses))[at(coordinate.number)];
      const auto turns = static_cast<std::int64_t>(std::round((coordinate.value - shown) / kTurn));
      if (is_in_tree(coordinate.joint)) {
        axis_of(joint, coordinate.number).start_turns = turns;
      } else if (turns != 0 && has_limits(axis_of(joints[at(index_of(coordinate.joint))], coordinate.number))) {
        problems_.push_back(
            {"start." + coordinate.joint,
             fmt::format("{:.6g} rad is beyond half a turn, and the limits of a joint that closes a loop "
                         "are compared with an angle between -pi and pi",
                         coordinate.value),
             "no limits at this joint, or a coordinate of another joint of the loop", ""});
      }
    }
    for (std::size_t j = 0; j < joints.size(); ++j) {
      joints[j].first.start_turns = def_.joints[j].first.start_turns;
      joints[j].second.start_turns = def_.joints[j].second.start_turns;
    }
  }

 private:
  static std::size_t at(int number) { return static_cast<std::size_t>(number); }

  [[nodiscard]] JointFrames frames_of(const JointDef& joint, const std::vector<Pose>& poses) const {
    return joint_frames(joint, poses[at(number_of_(joint.body1))], poses[at(number_of_(joint.body2))]);
  }

  [[nodiscard]] std::array<double, 2> coordinates_of(const JointDef& joint, const std::vector<Pose>& poses) const {
    return start_coordinates(joint, frames_of(joint, poses));
  }

  [[nodiscard]] int index_of(const std::string& joint) const {
    return static_cast<int>(&joint_named(def_, joint) - def_.joints.data());
  }

  [[nodiscard]] bool is_in_tree(const std::string& joint) const {
    const int index = index_of(joint);
    return std::any_of(tree_.begin(), tree_.end(), [index](const TreeEdge& edge) { return edge.joint == index; });
  }

  // ratio 0 holds its joint where the start puts it
  static bool fits_poses(const GearDef& gear) { return !is_given(gear.offset) && gear.ratio != 0; }

  // gears without offset get the one of the given poses, with loops closed
  void keep_gears(const std::vector<Pose>& poses) {
    for (GearDef& gear : def_.gears) {
      if (!fits_poses(gear)) continue;
      const double q1 = coordinates_of(joint_named(def_, gear.joint1), poses)[0];
      gear.offset = coordinates_of(joint_named(def_, gear.joint2), poses)[0] - gear.ratio * q1;
    }
  }

  // the tree's coordinates of geared joints count whole turns
  void follow_turns(const Model& model, const State& state, const std::vector<Pose>& poses) {
    for (const GearDef& gear : def_.gears) {
      for (const std::string& name : {gear.joint1, gear.joint2}) {
        JointDef& joint = def_.joints[at(index_of(name))];
        if (joint.type != JointType::revolute) continue;
        const Link& link = model.links[at(model.joints[at(index_of(name))].link)];
        const double shown = start_coordinates(joint.type, frames_of(joint, poses))[0];
        joint.first.start_turns = static_cast<std::int64_t>(std::round((state.q[at(link.q)] - shown) / kTurn));
      }
    }
  }

  // Change of the first coordinate of each joint by these values of the named ones, also of slides that gears move;
  // angles, which have turns, are left to the gear's row.
  [[nodiscard]] std::vector<double> changes_of_joints(const std::vector<Pose>& poses,
                                                      const std::vector<double>& values) const {
    std::vector<double> change(def_.joints.size());
    std::vector<char> is_set(def_.joints.size());
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (coordinates_[k].number != 0) continue;
      const JointDef& joint = joint_named(def_, coordinates_[k].joint);
      const double gap = values[k] - coordinates_of(joint, poses)[0];
      const std::size_t index = at(index_of(joint.name));
      change[index] = is_angle(joint.type, 0) ? std::remainder(gap, kTurn) : gap;
      is_set[index] = 1;
    }
    // a gear behind another one is reached in a later round
    for (std::size_t round = 0; round < def_.gears.size(); ++round) {
      for (const GearDef& gear : def_.gears) {
        const std::size_t first = at(index_of(gear.joint1)), second = at(index_of(gear.joint2));
        if (!is_given(gear.offset) || gear.ratio == 0 || is_set[first] == is_set[second]) continue;
        const std::size_t follower = is_set[first] != 0 ? second : first;
        if (is_angle(def_.joints[follower].type, 0)) continue;
        change[follower] = follower == second ? gear.ratio * change[first] : change[second] / gear.ratio;
        is_set[follower] = 1;
      }
    }
    return change;
  }

  // The tree with the named coordinates at these values, slides geared to them moved along, all others as they are.
  // What loops and gears then still lack is closed in the metric of the masses, where a load behind a hinge swings.
  [[nodiscard]] std::vector<Pose> moved(const std::vector<Pose>& poses, const std::vector<double>& values) const {
    std::vector<Pose> result = poses;
    const std::vector<double> changes = changes_of_joints(poses, values);
    for (const TreeEdge& edge : tree_) {
      const Pose& parent = result[at(edge.parent)];
      Pose& child = result[at(edge.child)];
      child = parent * (inverse(poses[at(edge.parent)]) * poses[at(edge.child)]);
      if (edge.joint == kNoJoint) continue;
      const JointDef& joint = def_.joints[at(edge.joint)];
      std::array<double, 2> q = coordinates_of(joint, poses);
      bool is_moved = changes[at(edge.joint)] != 0;
      q[0] += changes[at(edge.joint)];
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (coordinates_[k].joint != joint.name) continue;
        q[at(coordinates_[k].number)] = values[k];
        is_moved = true;
      }
      if (!is_moved) continue;
      const Pose frame1{math::rotation_xyz(joint.orientation1), Vec3(joint.point1)};
      const Pose frame2{math::rotation_xyz(joint.orientation2), Vec3(joint.point2)};
      const Pose between = frame_at(joint.type, Pose(), q);
      child = edge.is_reversed ? parent * frame2 * inverse(between) * inverse(frame1)
                               : parent * frame1 * between * inverse(frame2);
    }
    return result;
  }

  // makes these the poses of the definition
  void take(const std::vector<Pose>& poses) {
    for (std::size_t i = 1; i < poses.size(); ++i) {
      BodyDef& body = def_.bodies[i - 1];
      body.relative_to = kGroundName;
      body.position = poses[i].p.array();
      body.orientation = math::angles_zxz(poses[i].R);
    }
  }

  [[nodiscard]] bool has_loops() const {
    Problems none;
    return !cut_joints(def_, find_tree(def_, none)).empty() || !def_.gears.empty();
  }

  // closes the loops from the present poses, and takes the result as present poses
  std::vector<Pose> assembled(bool is_last) {
    AssemblyReport report;
    const Model model = build_model(def_, {}, report);
    const State state = start_state(model);
    Workspace ws(model);
    observe(model, state, ws);
    std::vector<Pose> poses(def_.bodies.size() + 1);
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const BodyPose found = body_pose(model, ws, static_cast<int>(i));
      const auto& [w, x, y, z] = found.orientation;
      poses[i] = {math::rotation_of({w, x, y, z}), Vec3(found.position)};
    }
    take(poses);
    follow_turns(model, state, poses);
    // rows may be open before the last step, where the machine passes a dead centre
    if (is_last) report_open(model, report);
    return poses;
  }

  void report_open(const Model& model, const AssemblyReport& report) {
    if (report.open.empty()) return;
    const AssemblyReport::Row& worst = *std::max_element(
        report.open.begin(), report.open.end(), [](const auto& a, const auto& b) { return a.violation < b.violation; });
    const std::string name = worst.gear.empty() ? model.joints[static_cast<std::size_t>(worst.joint)].name : worst.gear;
    problems_.push_back({"start",
                         fmt::format("the mechanism cannot be closed with these coordinates: '{}' stays open by {:.3g}",
                                     name, worst.violation),
                         "coordinates that the loops allow, or fewer of them: the others follow", ""});
  }

  MechanicsDef def_;
  BodyNumbers number_of_{def_};
  std::vector<TreeEdge> tree_;
  std::span<const StartCoordinate> coordinates_;
  Problems& problems_;
};

bool is_same(const Pose& a, const Pose& b) {
  return math::norm(a.p - b.p) <= kSamePose && math::rotation_angle(a.R * math::transpose(b.R)) <= kSamePose;
}

}  // namespace

void put_joints(MechanicsDef& mechanics, std::span<const StartCoordinate> coordinates, Problems& problems) {
  if (coordinates.empty()) return;
  if (has_parts(mechanics)) {
    problems.push_back({"start", "a scene with flexible or segmented bodies has no start by joint coordinates",
                        "poses of the bodies", ""});
    return;
  }
  StartPlacement placement(mechanics, coordinates, problems);
  const std::vector<Pose> poses = placement.place();
  if (poses.empty()) return;
  placement.keep_turns(poses, mechanics.joints);
  const BodyNumbers number_of(mechanics);
  for (std::size_t i = 0; i < mechanics.bodies.size(); ++i) {
    BodyDef& body = mechanics.bodies[i];
    const Pose& base = poses[static_cast<std::size_t>(number_of(body.relative_to))];
    const Pose moved = inverse(base) * poses[i + 1];
    const Pose stated{math::rotation_zxz(body.orientation), Vec3(body.position)};
    if (is_same(moved, stated)) continue;
    body.position = moved.p.array();
    body.orientation = math::angles_zxz(moved.R);
  }
}

}  // namespace slew::multibody
