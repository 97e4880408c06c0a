// SPDX-License-Identifier: Apache-2.0
// A robot as given by its URDF file, before conversion.
//
// Frames of URDF: a link's frame is that of the joint that carries it. A joint's origin is the pose of the child's
// frame in the parent's at the coordinate 0, xyz [m] and rpy [rad] with R = Rz(yaw) Ry(pitch) Rx(roll); its axis is in
// the child's frame. An inertial's origin is the centre of mass and the axes of its tensor, in the link's frame; the
// tensor's ixy, ixz, iyz are its elements, minus the integral of x y dm.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/field.h"

namespace slew::urdf {

struct Origin {
  Triple xyz{};  // m
  Triple rpy{};  // rad
};

struct Inertial {
  Origin origin;
  double mass = 0;    // kg
  Triple moments{};   // kg m2, ixx iyy izz
  Triple products{};  // kg m2, ixy ixz iyz
  int line = 0;
};

struct Geometry {
  enum class Use { visual, collision };
  enum class Kind { box, sphere, cylinder, capsule, mesh };
  Use use = Use::visual;
  Kind kind = Kind::box;
  Origin origin;
  Triple size{};          // m, box
  double radius = 0;      // m
  double length = 0;      // m, along z
  std::string file;       // mesh, as written
  Triple scale{1, 1, 1};  // m per unit of the file
  int line = 0;
};

struct Link {
  std::string name;
  std::optional<Inertial> inertial;  // none also if mass and inertia are 0
  std::vector<Geometry> geometries;
  int line = 0;
};

enum class JointKind { revolute, continuous, prismatic, fixed, floating, planar };

// The coordinate follows that of another joint: q = multiplier q_other + offset.
struct Mimic {
  std::string joint;      // name of the leading joint
  int leader = -1;        // leading joint; after find_starts() an independent one
  double multiplier = 1;  // in URDF's units: rad or m over rad or m
  double offset = 0;      // rad or m
  int line = 0;
};

struct Joint {
  std::string name;
  JointKind kind = JointKind::fixed;
  int parent = 0, child = 0;  // links
  Origin origin;
  Triple axis{1, 0, 0};  // unit, child's frame; the normal of a planar joint
  bool is_limited = false;
  double lower = 0;  // rad or m
  double upper = 0;
  double damping = 0;   // N m s/rad or N s/m
  double friction = 0;  // N m or N
  std::optional<Mimic> mimic{};
  int line = 0;
  // filled by find_starts()
  double start = 0;  // rad or m, coordinate at the start; angles within half a turn
  double turns = 0;  // rad, URDF's coordinate less the scene's, a multiple of 2 pi

  [[nodiscard]] bool is_angle() const noexcept { return kind == JointKind::revolute || kind == JointKind::continuous; }
  [[nodiscard]] bool has_coordinate() const noexcept { return is_angle() || kind == JointKind::prismatic; }
};

// A content of the file that the scene does not hold.
struct Note {
  int line = 0;  // 0: the file as a whole
  std::string text;
};

// A tree: every link but the root has one joint that it is the child of.
struct Robot {
  std::string name;
  std::vector<Link> links;
  std::vector<Joint> joints;
  int root = 0;                   // link
  std::vector<int> parent_joint;  // by link; -1 for the root
  std::vector<int> order;         // links, parents before their children, children in the file's order
  std::vector<Note> notes;
};

}  // namespace slew::urdf
