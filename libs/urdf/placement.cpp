#include "urdf/placement.h"

#include <fmt/format.h>

#include <cmath>

#include "core/index.h"
#include "math/euler_angles.h"
#include "math/rotation.h"

namespace slew::urdf {

using math::Mat3;
using math::Vec3;

namespace {

// rad, how near to half a turn rounding may take a start to the other side
constexpr double kHalfTurn = 1e-9;

// Links that move as one: by link, the one nearest to the root, and the link's frame in that one's.
struct Group {
  int head = 0;
  Pose pose;
};

std::vector<Group> find_groups(const Robot& robot) {
  std::vector<Group> groups(robot.links.size());
  for (const int link : robot.order) {
    const int joint = robot.parent_joint[at(link)];
    if (joint < 0 || robot.joints[at(joint)].kind != JointKind::fixed) {
      groups[at(link)] = {link, {}};
    } else {
      const Group& parent = groups[at(robot.joints[at(joint)].parent)];
      groups[at(link)] = {parent.head, parent.pose * pose_of(robot.joints[at(joint)].origin)};
    }
  }
  return groups;
}

// Mass, first moment and inertia of rigid bodies together, about the origin of a link's frame, in its axes.
struct Lump {
  double mass = 0;  // kg
  Vec3 h;           // kg m
  Mat3 I;           // kg m2
};

Mat3 parallel_axes(double mass, Vec3 r) {
  const double square = dot(r, r);
  return (Mat3::diagonal(square, square, square) - outer(r, r)) * mass;
}

void add_inertial(Lump& lump, const Inertial& inertial) {
  const Pose pose = pose_of(inertial.origin);
  const auto [xx, yy, zz] = inertial.moments;
  const auto [xy, xz, yz] = inertial.products;
  const Mat3 tensor{Vec3(xx, xy, xz), Vec3(xy, yy, yz), Vec3(xz, yz, zz)};
  lump.mass += inertial.mass;
  lump.h += pose.p * inertial.mass;
  lump.I += pose.R * tensor * transpose(pose.R) + parallel_axes(inertial.mass, pose.p);
}

// a lump of another frame, whose pose in this one is given
void add_lump(Lump& lump, const Lump& other, const Pose& pose) {
  if (other.mass == 0) return;
  const Vec3 centre = other.h * (1 / other.mass);
  const Mat3 central = other.I - parallel_axes(other.mass, centre);
  const Vec3 r = pose.p + pose.R * centre;
  lump.mass += other.mass;
  lump.h += r * other.mass;
  lump.I += pose.R * central * transpose(pose.R) + parallel_axes(other.mass, r);
}

}  // namespace

Pose pose_of(const Origin& origin) noexcept {
  const auto [roll, pitch, yaw] = origin.rpy;
  Pose pose;
  if (roll != 0 || pitch != 0 || yaw != 0) {
    pose.R = math::rotation_z(yaw) * math::rotation_y(pitch) * math::rotation_x(roll);
  }
  pose.p = Vec3(origin.xyz);
  return pose;
}

Pose operator*(const Pose& a, const Pose& b) noexcept {
  return {a.R * b.R, a.p + a.R * b.p};
}

Pose inverse(const Pose& a) noexcept {
  return {transpose(a.R), -transpose_multiply(a.R, a.p)};
}

Triple without_rounding(const Triple& triple, double scale) noexcept {
  // what rounding leaves of a zero when frames are turned
  constexpr double kRounding = 1e-15;
  Triple clean = triple;
  for (double& value : clean) value = std::abs(value) <= kRounding * scale ? 0 : value;
  return clean;
}

Triple position_of(const Pose& pose) noexcept {
  return without_rounding(pose.p.array(), norm(pose.p));
}

Triple orientation_of(const Pose& pose) noexcept {
  return without_rounding(math::angles_zxz(pose.R), 1);
}

std::vector<Place> find_places(const Robot& robot, RootMount mount, const Complain& complain) {
  const std::vector<Group> groups = find_groups(robot);
  // the first body of each group, by its head
  std::vector<int> carrier(robot.links.size(), kOnGround);
  for (const int link : robot.order) {
    int& first = carrier[at(groups[at(link)].head)];
    if (first == kOnGround && robot.links[at(link)].inertial) first = link;
  }
  const bool is_fixed = mount == RootMount::fixed;
  std::vector<Place> places(robot.links.size());
  for (const int link : robot.order) {
    const Group& group = groups[at(link)];
    const bool is_on_ground = is_fixed && group.head == robot.root;
    const int body = carrier[at(group.head)];
    if (robot.links[at(link)].inertial) {
      places[at(link)] = {link, {}};
    } else if (is_on_ground) {
      places[at(link)] = {kOnGround, group.pose};
    } else if (body == kOnGround) {
      if (group.head != link) continue;
      complain(robot.links[at(link)].line, fmt::format("link '{}' moves and has no mass", robot.links[at(link)].name),
               "an <inertial> in it or in a link fixed to it; 1e-9 kg where the mass should not matter");
    } else {
      places[at(link)] = {body, inverse(groups[at(body)].pose) * group.pose};
    }
  }
  return places;
}

double whole_turns(const Joint& joint) noexcept {
  if (joint.kind != JointKind::revolute || (joint.lower <= 0 && joint.upper >= 0)) return 0;
  return 2 * M_PI * std::round((joint.lower + joint.upper) / 2 / (2 * M_PI));
}

double start_coordinate(const Joint& joint) noexcept {
  if (joint.kind != JointKind::revolute && joint.kind != JointKind::prismatic) return 0;
  if (joint.lower <= 0 && joint.upper >= 0) return 0;
  const double middle = (joint.lower + joint.upper) / 2 - whole_turns(joint);
  // half a turn is one way round as much as the other
  const bool is_half_turn = joint.kind == JointKind::revolute && std::abs(middle) > M_PI - kHalfTurn;
  return is_half_turn ? middle - std::copysign((joint.upper - joint.lower) / 4, middle) : middle;
}

Pose start_pose(const Joint& joint) noexcept {
  Pose pose = pose_of(joint.origin);
  const double q = start_coordinate(joint);
  if (q == 0) return pose;
  const Vec3 axis(joint.axis);
  if (joint.kind == JointKind::prismatic) return pose * Pose{Mat3::identity(), axis * q};
  // Rodrigues: R = 1 + sin q [a]x + (1 - cos q) [a]x [a]x
  const auto [s, c] = math::sin_cos(q);
  const Mat3 a = math::skew(axis);
  return pose * Pose{Mat3::identity() + a * s + a * a * (1 - c), {}};
}

std::vector<double> resistance_of_joints(const Robot& robot) {
  std::vector<Lump> lumps(robot.links.size());
  std::vector<double> resistance(robot.joints.size(), 0.0);
  for (auto link = robot.order.rbegin(); link != robot.order.rend(); ++link) {
    Lump& lump = lumps[at(*link)];
    if (robot.links[at(*link)].inertial) add_inertial(lump, *robot.links[at(*link)].inertial);
    const int index = robot.parent_joint[at(*link)];
    if (index < 0) continue;
    const Joint& joint = robot.joints[at(index)];
    const Vec3 axis(joint.axis);
    resistance[at(index)] = joint.kind == JointKind::prismatic ? lump.mass : dot(axis, lump.I * axis);
    if (joint.kind != JointKind::floating) add_lump(lumps[at(joint.parent)], lump, start_pose(joint));
  }
  return resistance;
}

}  // namespace slew::urdf
