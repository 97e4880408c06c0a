// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/check.h"
#include "core/index.h"
#include "multibody/build/assembly.h"
#include "multibody/build/build_forces.h"
#include "multibody/build/build_rows.h"
#include "multibody/build/loop_rest.h"
#include "multibody/build/start_groups.h"
#include "multibody/build/start_pose.h"
#include "multibody/build/welded_start.h"
#include "multibody/constraints/constraint.h"
#include "multibody/flexible/build_parts.h"
#include "multibody/flexible/expand_nodes.h"
#include "multibody/flexible/start_modes.h"
#include "multibody/forces/build_elements.h"
#include "multibody/model/body_inertia.h"
#include "multibody/model/model.h"
#include "multibody/model/topology.h"
#include "multibody/motions/build_drives.h"

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

// half a turn about x: reverses a joint's axis, so that q keeps its sign when the tree walks the joint backwards
const Mat3 kReverse = Mat3::diagonal(1, -1, -1);
// the same for a universal joint, which then has its coordinates in the other order
const Mat3 kReverseCross = {Vec3(0, -1, 0), Vec3(-1, 0, 0), Vec3(0, 0, -1)};

class Builder {
 public:
  explicit Builder(const MechanicsDef& def)
      : expanded_(has_parts(def) ? with_nodes(def) : MechanicsDef()), def_(has_parts(def) ? expanded_ : def) {}
  struct Expanded {
    const MechanicsDef& def;
  };
  explicit Builder(Expanded expanded) : def_(expanded.def) {}

  Model run(std::span<const std::string> rows, AssemblyReport& report) {
    Problems problems;
    poses_ = start_poses(def_, problems);
    tree_ = find_tree(def_, problems);
    SLEW_CHECK(problems.empty());
    const std::optional<WeldedStart> welded = welded_start(def_, tree_);
    if (welded) poses_ = welded->poses;
    model_.gravity = Vec3(def_.gravity);
    model_.max_substep = def_.max_substep;
    model_.penalty = {def_.penalty_factor, def_.penalty_damping, def_.penalty_frequency};
    add_bodies();
    model_.drives = declared_drives(def_);
    add_joints();
    add_parts(def_, model_);
    for (const int joint : cut_joints(def_, tree_)) add_cut(joint);
    add_gears(def_, model_);
    add_forces(def_, link_pose_, model_);
    add_dummies(def_, model_);
    add_elements(def_, poses_, model_);
    add_segments(def_, model_);
    for (const std::string& row : rows) add_row(def_, row, model_);
    mark_used_elements(model_);
    model_.contact = build_contacts(def_, model_);
    lump_links(model_);
    for (Cut& cut : model_.cuts) add_supports(model_, cut);
    // sagging bodies would leave loops open, and so would those in the poses of the mechanism in which they are rigid:
    // beside such ones the others settle once these have closed
    const bool has_loops = model_.has_closing_rows(), all_settle = !has_loops && !welded;
    if (has_loops || !welded) straighten_segments(model_, model_.start_q, model_.start_u);
    bool is_settled = !all_settle || settle();
    report = assemble(model_);
    if (has_loops) rest_in_loops(def_, model_, report);
    if (welded) take_over(*welded, model_, report);
    if (!all_settle && !model_.rests_in_loops) is_settled = settle();
    report.is_settled = is_settled;
    return std::move(model_);
  }

 private:
  [[nodiscard]] int body_index(const std::string& name) const { return number_of_(name); }

  // bodies whose group has a static equilibrium that is computed
  bool settle() {
    const StartGroups groups = find_start_groups(model_);
    const auto selected = [](const std::vector<StartRest>& rests) {
      std::vector<bool> found;
      for (const StartRest rest : rests) found.push_back(rest == StartRest::computed);
      return found;
    };
    return settle_segments(model_, selected(groups.segmented)) && settle_modes(model_, selected(groups.parts));
  }

  void add_bodies() {
    model_.bodies.resize(def_.bodies.size() + 1);
    model_.bodies[0].name = kGroundName;
    model_.bodies[0].R_LB = Mat3::identity();
    for (std::size_t i = 0; i < def_.bodies.size(); ++i) {
      Body& body = model_.bodies[i + 1];
      body.name = def_.bodies[i].name;
      body.c_B = Vec3(def_.bodies[i].center_of_mass);
      body.I_B = inertia_about_center(def_.bodies[i]);
    }
    model_.links.resize(1);
    link_pose_.resize(1);
  }

  void add_joints() {
    model_.joints.resize(def_.joints.size());
    for (std::size_t j = 0; j < def_.joints.size(); ++j) {
      const JointDef& def = def_.joints[j];
      model_.joints[j] = {.name = def.name,
                          .type = def.type,
                          .body1 = body_index(def.body1),
                          .body2 = body_index(def.body2),
                          .R_B1 = math::rotation_xyz(def.orientation1),
                          .R_B2 = math::rotation_xyz(def.orientation2),
                          .p_B1 = Vec3(def.point1),
                          .p_B2 = Vec3(def.point2)};
    }
    const JointDef free{.type = JointType::floating};
    for (TreeEdge edge : tree_) {
      const JointDef& def = edge.joint == kNoJoint ? free : def_.joints[at(edge.joint)];
      settle(def, edge);
      Body& child = model_.bodies[at(edge.child)];
      child.parent = edge.parent;
      child.joint = edge.joint;
      if (edge.joint != kNoJoint) model_.joints[at(edge.joint)].is_reversed = edge.is_reversed;
      if (merges(def_, def)) {
        child.link = model_.bodies[at(edge.parent)].link;
      } else {
        child.link = add_link(def, edge);
        if (edge.joint != kNoJoint) model_.joints[at(edge.joint)].link = child.link;
      }
      place(child, poses_[at(edge.child)]);
      add_mass(edge.child);
      model_.body_order.push_back(edge.child);
    }
  }

  // the body's pose in its link; for merged bodies from the start poses
  void place(Body& body, const Pose& pose) {
    const Pose& link = link_pose_[at(body.link)];
    body.R_LB = math::transpose(link.R) * pose.R;
    body.p_LB = math::transpose(link.R) * (pose.p - link.p);
  }

  void add_mass(int body) {
    Body& moved = model_.bodies[at(body)];
    const double mass = def_.bodies[at(body) - 1].mass;
    moved.lumped = static_cast<int>(model_.lumped.size());
    model_.lumped.push_back({.c_L = moved.p_LB + moved.R_LB * moved.c_B,
                             .I_c = rotated(moved.R_LB, moved.I_B),
                             .mass = mass,
                             .reference_mass = mass,
                             .link = moved.link,
                             .owner = body});
  }

  [[nodiscard]] JointFrames frames_of(const JointDef& def, const TreeEdge& edge) const {
    const Pose &parent = poses_[at(edge.parent)], &child = poses_[at(edge.child)];
    if (edge.joint == kNoJoint) return {Pose{}, child};
    if (!edge.is_reversed) return joint_frames(def, parent, child);
    JointFrames frames = joint_frames(def, child, parent);
    std::swap(frames.frame1, frames.frame2);
    if (def.type == JointType::spherical) return frames;
    const Mat3& reverse = def.type == JointType::universal ? kReverseCross : kReverse;
    frames.frame1.R = frames.frame1.R * reverse;
    frames.frame2.R = frames.frame2.R * reverse;
    return frames;
  }

  // moves a body onto the joint; keeps the scene's pose within its tolerance
  void settle(const JointDef& def, const TreeEdge& edge) {
    const auto [frame1, frame2] = frames_of(def, edge);
    const bool is_driven = edge.joint != kNoJoint && begin_drives(edge.joint);
    const Pose held = is_driven ? frame_at(def.type, frame1, coordinates_of(def, edge, {frame1, frame2}))
                                : nearest_frame(def.type, {frame1, frame2});
    const Mat3 turn = held.R * math::transpose(frame2.R);
    if (math::norm(held.p - frame2.p) <= kFrameTolerance && math::rotation_angle(turn) <= kFrameTolerance) return;
    Pose& child = poses_[at(edge.child)];
    child = {turn * child.R, held.p + turn * (child.p - frame2.p)};
  }

  // completes the laws of a joint from the poses; true if it has some
  bool begin_drives(int joint) {
    const JointDef& def = def_.joints[at(joint)];
    const Pose &body1 = poses_[at(body_index(def.body1))], &body2 = poses_[at(body_index(def.body2))];
    return multibody::begin_drives(def_, joint, start_coordinates(def, joint_frames(def, body1, body2)), model_);
  }

  // coordinates at the start as the tree walks the joint: from the poses, and from the laws of those that have one
  [[nodiscard]] std::array<double, 2> coordinates_of(const JointDef& def, const TreeEdge& edge,
                                                     const JointFrames& frames) const {
    // in the order of the tree, but with the turns of a joint that it walks backwards
    JointDef walked = def;
    if (edge.is_reversed && def.type == JointType::universal) std::swap(walked.first, walked.second);
    std::array<double, 2> q = start_coordinates(walked, frames);
    for (const Drive& drive : model_.drives) {
      if (drive.joint == edge.joint) q[at(place_of(drive, edge))] = evaluate(drive.law, 0).position;
    }
    return q;
  }

  // a universal joint that the tree walks backwards has its coordinates in the other order
  [[nodiscard]] int place_of(const Drive& drive, const TreeEdge& edge) const {
    const bool is_swapped = edge.is_reversed && def_.joints[at(drive.joint)].type == JointType::universal;
    return is_swapped ? 1 - drive.number : drive.number;
  }

  void add_cut(int index) {
    const JointDef& def = def_.joints[at(index)];
    Joint& joint = model_.joints[at(index)];
    joint.cut = static_cast<int>(model_.cuts.size());
    Cut cut;
    static_cast<Constraint&>(cut) = constraint_between(model_, index);
    const auto [frame1, frame2] = joint_frames(def, poses_[at(joint.body1)], poses_[at(joint.body2)]);
    const Mat3 R_1W = math::transpose(frame1.R);
    cut.rows = rows_of(def.type, R_1W * frame2.R, R_1W * (frame2.p - frame1.p));
    for (ConstraintRow& row : cut.rows) {
      if (row.form == RowForm::distance && def.length > 0) row.offset = def.length;
    }
    begin_drives(index);
    add_drive_rows(model_, index, cut);
    cut.first_row = model_.cut_row_count();
    for (std::size_t k = 0; k < cut.rows.size(); ++k) cut.kept.push_back(static_cast<int>(k));
    model_.cuts.push_back(cut);
    add_given_speeds(def, joint.cut);
  }

  void add_given_speeds(const JointDef& def, int cut) {
    if (is_given(def.initial_velocity)) model_.given_speeds.push_back({cut, 0, def.initial_velocity});
    if (is_given(def.initial_velocity_2)) model_.given_speeds.push_back({cut, 1, def.initial_velocity_2});
    if (!is_given(def.initial_rotation)) return;
    for (int axis = 0; axis < 3; ++axis) model_.given_speeds.push_back({cut, axis, def.initial_rotation[at(axis)]});
  }

  static LinkJoint link_joint(JointType type) {
    return type == JointType::revolute    ? LinkJoint::revolute
           : type == JointType::prismatic ? LinkJoint::prismatic
           : type == JointType::universal ? LinkJoint::universal
                                          : LinkJoint::cylindrical;
  }

  // for a link whose coordinates are the last ones so far
  void add_drives(const TreeEdge& edge, Link& link) {
    for (std::size_t k = 0; k < model_.drives.size(); ++k) {
      Drive& drive = model_.drives[k];
      if (drive.joint != edge.joint) continue;
      drive.place = place_of(drive, edge);
      drive.link = static_cast<int>(model_.links.size());
      drive.q = link.q + drive.place;
      drive.u = link.u + drive.place;
      link.is_driven = true;
      link.drive[at(drive.place)] = static_cast<int>(k);
      model_.start_u[at(drive.u)] = evaluate(drive.law, 0).speed;
    }
  }

  int add_link(const JointDef& def, const TreeEdge& edge) {
    const JointFrames frames = frames_of(def, edge);
    const int parent = model_.bodies[at(edge.parent)].link;
    const Pose& parent_pose = link_pose_[at(parent)];
    Link link;
    link.parent = parent;
    link.R_PJ = math::transpose(parent_pose.R) * frames.frame1.R;
    link.p_PJ = math::transpose(parent_pose.R) * (frames.frame1.p - parent_pose.p);
    link.q = model_.coordinate_count();
    link.u = model_.speed_count();
    add_coordinates(def, edge, frames, link);
    model_.links.push_back(link);
    return static_cast<int>(model_.links.size()) - 1;
  }

  // start values; the child link's frame is set by these coordinates
  void add_coordinates(const JointDef& def, const TreeEdge& edge, const JointFrames& frames, Link& link) {
    std::vector<double>& q = model_.start_q;
    std::vector<double>& u = model_.start_u;
    const auto& [frame1, frame2] = frames;
    Pose child = {frame2.R, frame1.p};
    if (def.type == JointType::node) {
      link.joint = LinkJoint::node;
      link.node = static_cast<int>(model_.nodes.size());
      model_.nodes.push_back(build_node(def_, def, model_.bodies[at(edge.parent)]));
    } else if (const int count = coordinate_count(def.type); count > 0) {
      link.joint = link_joint(def.type);
      const std::array<double, 2> start = coordinates_of(def, edge, frames);
      q.insert(q.end(), start.begin(), start.begin() + count);
      std::array<double, 2> rate = {def.initial_velocity, def.initial_velocity_2};
      if (edge.is_reversed && def.type == JointType::universal) std::swap(rate[0], rate[1]);
      for (int k = 0; k < count; ++k) {
        u.push_back(given_or(rate[at(k)], 0));
        model_.start_is_given.push_back(is_given(rate[at(k)]) ? 1 : 0);
      }
      child = frame_at(def.type, frame1, start);
      add_drives(edge, link);
    } else {
      link.joint = def.type == JointType::spherical ? LinkJoint::spherical : LinkJoint::floating;
      const Mat3& R_body1 = poses_[at(edge.joint == kNoJoint ? kGround : body_index(def.body1))].R;
      if (link.joint == LinkJoint::floating) {
        child.p = frame2.p;
        for (const double x : frame2.p.array()) q.push_back(x);
        for (const double v : (R_body1 * Vec3(given_or(def.initial_translation, {}))).array()) u.push_back(v);
        model_.start_is_given.insert(model_.start_is_given.end(), 3, is_given(def.initial_translation) ? 1 : 0);
      }
      const math::Quaternion attitude = math::quaternion_of(frame2.R);
      child.R = math::rotation_of(attitude);
      q.insert(q.end(), {attitude.w, attitude.x, attitude.y, attitude.z});
      const Vec3 w = R_body1 * Vec3(given_or(def.initial_rotation, {})) * (edge.is_reversed ? -1.0 : 1.0);
      for (const double x : w.array()) u.push_back(x);
      model_.start_is_given.insert(model_.start_is_given.end(), 3, is_given(def.initial_rotation) ? 1 : 0);
    }
    link_pose_.push_back(child);
  }

  const MechanicsDef expanded_;
  const MechanicsDef& def_;
  BodyNumbers number_of_{def_};
  Model model_;
  std::vector<Pose> poses_;
  std::vector<TreeEdge> tree_;
  std::vector<Pose> link_pose_;  // at the start, by link
};

}  // namespace

Model build_model(const MechanicsDef& mechanics, std::span<const std::string> rows) {
  AssemblyReport ignored;
  return build_model(mechanics, rows, ignored);
}

Model build_model(const MechanicsDef& mechanics, std::span<const std::string> rows, AssemblyReport& report) {
  return Builder(mechanics).run(rows, report);
}

Model build_expanded_model(const MechanicsDef& expanded, AssemblyReport& report) {
  return Builder(Builder::Expanded{expanded}).run({}, report);
}

}  // namespace slew::multibody
