// SPDX-License-Identifier: Apache-2.0
#include "urdf/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/index.h"
#include "math/euler_angles.h"
#include "math/rotation.h"
#include "urdf/names.h"

namespace slew::urdf {

using math::Mat3;
using math::Vec3;
using multibody::BodyDef;
using multibody::JointDef;
using multibody::JointType;

namespace {

// the turn about x, then y', that takes z to the axis
Triple axis_angles(const Triple& a) {
  const double across = std::hypot(a[1], a[2]);
  return without_rounding({across == 0 ? 0 : std::atan2(-a[1], a[2]), std::atan2(a[0], across), 0}, 1);
}

JointType type_of(JointKind kind) {
  switch (kind) {
    case JointKind::revolute:
    case JointKind::continuous:
      return JointType::revolute;
    case JointKind::prismatic:
      return JointType::prismatic;
    case JointKind::floating:
      return JointType::floating;
    case JointKind::planar:
      return JointType::in_plane;
    case JointKind::fixed:
      break;
  }
  return JointType::fixed;
}

std::string triple_text(const Triple& t) {
  return fmt::format("[{}, {}, {}]", t[0], t[1], t[2]);
}

std::string shape_text(const Geometry& shape) {
  switch (shape.kind) {
    case Geometry::Kind::box:
      return fmt::format("box {} m", triple_text(shape.size));
    case Geometry::Kind::sphere:
      return fmt::format("sphere of radius {} m", shape.radius);
    case Geometry::Kind::cylinder:
    case Geometry::Kind::capsule:
      return fmt::format("{} along z, radius {} m, length {} m",
                         shape.kind == Geometry::Kind::cylinder ? "cylinder" : "capsule", shape.radius, shape.length);
    case Geometry::Kind::mesh:
      break;
  }
  const auto [x, y, z] = shape.scale;
  const std::string unit = x == y && y == z
                               ? fmt::format("unit {} m", x)
                               : fmt::format("scale {}, which no unit can express", triple_text(shape.scale));
  return fmt::format("mesh {}, {}", shape.file, unit);
}

class Converter {
 public:
  Converter(const Robot& robot, RootMount mount, const Folders& folders)
      : robot_(robot), mount_(mount), folders_(folders) {}

  Conversion convert() {
    out_.notes = robot_.notes;
    out_.mechanics.gravity = {0, 0, -9.81};
    places_ = find_places(robot_, mount_);
    name_all();
    resistance_ = resistance_of_joints(robot_);
    for (const int link : robot_.order) add_link(link);
    for (const int link : robot_.order) add_joint_of(link);
    for (const int link : robot_.order) add_gear_of(link);
    std::stable_sort(out_.notes.begin(), out_.notes.end(),
                     [](const Note& a, const Note& b) { return a.line < b.line; });
    return std::move(out_);
  }

 private:
  void name_all() {
    body_names_.resize(robot_.links.size());
    joint_names_.resize(robot_.joints.size());
    for (const int link : robot_.order) {
      if (places_[at(link)].body != link) continue;
      body_names_[at(link)] = given(robot_.links[at(link)].name, "_link", "link", robot_.links[at(link)].line);
    }
    for (const int link : robot_.order) {
      const int joint = robot_.parent_joint[at(link)];
      if (joint < 0 || !is_made(robot_.joints[at(joint)])) continue;
      joint_names_[at(joint)] = given(robot_.joints[at(joint)].name, "_joint", "joint", robot_.joints[at(joint)].line);
    }
  }

  std::string given(const std::string& name, const std::string& suffix, const char* kind, int line) {
    std::string taken = names_.take(name, suffix);
    if (taken != name) out_.notes.push_back({line, fmt::format("{} '{}' is {} in the scene", kind, name, taken)});
    out_.lines.emplace(taken, line);
    return taken;
  }

  // the places include a fixed joint to a link that rides on a body
  [[nodiscard]] bool is_made(const Joint& joint) const {
    if (joint.kind == JointKind::fixed && places_[at(joint.child)].body != joint.child) return false;
    return places_[at(joint.parent)].body != places_[at(joint.child)].body;
  }

  [[nodiscard]] std::string body_name(int body) const {
    return body == kOnGround ? std::string(multibody::kGroundName) : body_names_[at(body)];
  }

  void add_link(int index) {
    const Link& link = robot_.links[at(index)];
    if (places_[at(index)].body != index) {
      note_rider(link, places_[at(index)]);
      return;
    }
    BodyDef body;
    body.name = body_names_[at(index)];
    const Place start = place_at_start(index);
    body.relative_to = body_name(start.body);
    body.position = position_of(start.pose);
    body.orientation = orientation_of(start.pose);
    put_inertial(*link.inertial, body);
    out_.mechanics.bodies.push_back(body);
    add_shapes(link, body.name, {});
    if (index == robot_.root) mount_root(body.name);
  }

  // (1)
  static void put_inertial(const Inertial& inertial, BodyDef& body) {
    body.mass = inertial.mass;
    body.center_of_mass = inertial.origin.xyz;
    body.inertia = inertial.moments;
    body.products = inertial.products;
    const Mat3 R = pose_of(inertial.origin).R;
    if (inertial.origin.rpy == Triple{}) return;
    const auto [xx, yy, zz] = inertial.moments;
    const auto [xy, xz, yz] = inertial.products;
    const Mat3 I = R * Mat3{Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)} * transpose(R);
    const double scale = xx + yy + zz;
    body.inertia = without_rounding({I(0, 0), I(1, 1), I(2, 2)}, scale);
    body.products = without_rounding({I(0, 1), I(0, 2), I(1, 2)}, scale);
  }

  // The body or Ground that a body's pose refers to, and the pose, at the start.
  [[nodiscard]] Place place_at_start(int index) const {
    Pose pose;
    int link = index;
    while (robot_.parent_joint[at(link)] >= 0) {
      const Joint& joint = robot_.joints[at(robot_.parent_joint[at(link)])];
      pose = start_pose(joint) * pose;
      link = joint.parent;
      const Place& place = places_[at(link)];
      if (place.body != index) return {place.body, place.pose * pose};
    }
    return {kOnGround, pose};
  }

  void mount_root(const std::string& body) {
    JointDef joint;
    joint.name = names_.take(body + "_mount", "_joint");
    joint.type = mount_ == RootMount::fixed ? JointType::fixed : JointType::floating;
    joint.body2 = body;
    out_.lines.emplace(joint.name, robot_.links[at(robot_.root)].line);
    out_.mechanics.joints.push_back(joint);
  }

  // a link without mass: its frame, for forces attached later
  void note_rider(const Link& link, const Place& place) {
    const std::string where = fmt::format("on {} at {} m, orientation (x, y', z'') {} rad", body_name(place.body),
                                          triple_text(position_of(place.pose)),
                                          triple_text(without_rounding(math::angles_xyz(place.pose.R), 1)));
    out_.notes.push_back({link.line, fmt::format("link '{}' has no mass of its own: a frame {}", link.name, where)});
    add_shapes(link, body_name(place.body), place.pose);
  }

  // collision geometry becomes a shape; visual geometry and unsupported meshes give a note
  void add_shapes(const Link& link, const std::string& body, const Pose& place) {
    for (const Geometry& geometry : link.geometries) {
      if (geometry.use == Geometry::Use::visual) {
        comment_on(body, "visual", geometry, place);
        continue;
      }
      CollisionShape shape = collision_shape(geometry, place, body == multibody::kGroundName, folders_);
      if (!shape.refusal.empty()) {
        comment_on(body, "collision", geometry, place);
        out_.notes.push_back(
            {geometry.line, fmt::format("link '{}': the collision mesh {} is no shape of the scene: {}", link.name,
                                        geometry.file, shape.refusal)});
        continue;
      }
      shape.def.name = names_.take(link.name + "_collision", "_shape");
      shape.def.body = body;
      out_.lines.emplace(shape.def.name, geometry.line);
      if (!shape.mesh.triangles.empty()) out_.meshes.emplace(shape.def.name, std::move(shape.mesh));
      out_.mechanics.shapes.push_back(std::move(shape.def));
    }
  }

  void comment_on(const std::string& body, const char* use, const Geometry& geometry, const Pose& place) {
    const Pose pose = place * pose_of(geometry.origin);
    const Triple angles = orientation_of(pose);
    std::string text = fmt::format("{}: {}, position {} m", use, shape_text(geometry), triple_text(position_of(pose)));
    if (angles != Triple{}) text += fmt::format(", orientation {} rad", triple_text(angles));
    out_.comments[body].push_back(text);
  }

  void add_joint_of(int link) {
    const int index = robot_.parent_joint[at(link)];
    if (index < 0 || joint_names_[at(index)].empty()) return;
    const Joint& joint = robot_.joints[at(index)];
    JointDef def;
    def.name = joint_names_[at(index)];
    def.type = type_of(joint.kind);
    const Place &parent = places_[at(joint.parent)], &child = places_[at(joint.child)];
    def.body1 = body_name(parent.body);
    def.body2 = body_name(child.body);
    if (joint.kind == JointKind::floating) {
      def.body1 = multibody::kGroundName;
      def.point2 = position_of(child.pose);
    } else {
      put_frames(joint, parent.pose, child.pose, def);
      put_laws(joint, resistance_[at(index)], def);
    }
    out_.mechanics.joints.push_back(def);
    if (joint.kind == JointKind::planar) add_parallel(joint, def);
  }

  // (4), in the scene's coordinates
  void add_gear_of(int link) {
    const int index = robot_.parent_joint[at(link)];
    if (index < 0 || !robot_.joints[at(index)].mimic) return;
    const Joint& joint = robot_.joints[at(index)];
    const Mimic& mimic = *joint.mimic;
    const Joint& leader = robot_.joints[at(mimic.leader)];
    const double offset = mimic.offset + mimic.multiplier * leader.turns - joint.turns;
    multibody::GearDef def;
    def.name = names_.take(joint.name + "_gear", "_mimic");
    def.joint1 = joint_names_[at(mimic.leader)];
    def.joint2 = joint_names_[at(index)];
    def.ratio = mimic.multiplier;
    def.offset = offset;
    if (!leader.is_angle() && joint.is_angle()) {
      // a rack turns its pinion
      std::swap(def.joint1, def.joint2);
      def.ratio = 1 / mimic.multiplier;
      def.offset = -offset / mimic.multiplier;
    }
    def.kind = !leader.is_angle() && !joint.is_angle() ? multibody::GearKind::slides
               : leader.is_angle() && joint.is_angle() ? multibody::GearKind::gear
                                                       : multibody::GearKind::rack_and_pinion;
    out_.lines.emplace(def.name, mimic.line);
    out_.mechanics.gears.push_back(def);
  }

  // (3): the normal of the body at a right angle to two directions of the plane
  void add_parallel(const Joint& joint, const JointDef& in_plane) {
    const Mat3 R_1A = math::rotation_xyz(in_plane.orientation1);
    const Mat3 to_x = R_1A * math::rotation_y(M_PI / 2), to_y = R_1A * math::rotation_x(-M_PI / 2);
    for (const auto& [R, end] : {std::pair(to_x, "_tilt_1"), {to_y, "_tilt_2"}}) {
      JointDef def;
      def.name = given(in_plane.name + end, "_joint", "a part of joint", joint.line);
      def.type = JointType::perpendicular;
      def.body1 = in_plane.body1;
      def.orientation1 = without_rounding(math::angles_xyz(R), 1);
      def.body2 = in_plane.body2;
      def.orientation2 = in_plane.orientation2;
      out_.mechanics.joints.push_back(def);
    }
  }

  static void put_frames(const Joint& joint, const Pose& parent, const Pose& child, JointDef& def) {
    const bool is_fixed = joint.kind == JointKind::fixed;
    const Triple axis = is_fixed ? Triple{} : axis_angles(joint.axis);
    const Mat3 R_CA = math::rotation_xyz(axis);
    const Pose origin = pose_of(joint.origin);
    const Pose frame1 = parent * Pose{origin.R * R_CA, origin.p};
    def.point1 = position_of(frame1);
    def.orientation1 = without_rounding(math::angles_xyz(frame1.R), 1);
    def.point2 = position_of(child);
    def.orientation2 = without_rounding(math::angles_xyz(child.R * R_CA), 1);
  }

  void put_laws(const Joint& joint, double resistance, JointDef& def) {
    if (joint.kind == JointKind::fixed || joint.kind == JointKind::planar) return;
    def.first.viscous_friction = joint.damping;
    def.first.coulomb_friction = joint.friction;
    if (joint.is_limited) {
      def.first.limit_min = joint.lower;
      def.first.limit_max = joint.upper;
      // (2)
      def.first.limit_stiffness = kStopFrequency * kStopFrequency * resistance;
      def.first.limit_damping = 2 * kStopFrequency * resistance;
    }
    if (joint.start == 0) return;
    const char* unit = joint.kind == JointKind::prismatic ? "m" : "rad";
    out_.notes.push_back({joint.line, fmt::format("joint '{}' starts at {} {}: {}", joint.name, joint.start, unit,
                                                  joint.mimic ? "it follows another" : "the limits exclude 0")});
  }

  const Robot& robot_;
  RootMount mount_;
  const Folders& folders_;
  Conversion out_;
  SceneNames names_;
  std::vector<Place> places_;
  std::vector<double> resistance_;
  std::vector<std::string> body_names_, joint_names_;
};

}  // namespace

Conversion convert(const Robot& robot, RootMount mount, const Folders& folders) {
  return Converter(robot, mount, folders).convert();
}

}  // namespace slew::urdf
