// SPDX-License-Identifier: Apache-2.0
#include "tests/peers/multibody/simbody_mechanism.h"

#include <cmath>
#include <stdexcept>

#include "tests/peers/multibody/def_laws.h"

namespace slew::multibody::testing {
namespace {

using math::Mat3;
using math::Vec3;

constexpr double kRightAngle = M_PI / 2;

// Axes of a joint's frame for Simbody's mobilizer: a slider moves along x, a joint's coordinate is along z; a universal
// joint turns about x of its inner, then about y of its outer frame, ours about z of frame 1 and of frame 2, which is x
// of frame 1 at zero.
struct Axes {
  Mat3 inner = Mat3::identity(), outer = Mat3::identity();
};

Axes axes_of(JointType type, bool is_reversed) {
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  if (type == JointType::prismatic) return {Mat3{z, x, y}, Mat3{z, x, y}};
  if (type != JointType::universal) return {};
  if (is_reversed) return {Mat3{z, y, -x}, Mat3{x, z, -y}};
  return {Mat3{z, x, y}, Mat3{y, z, x}};
}

// Constraints between the two frames of a joint.
class Rows {
 public:
  Rows(const JointDef& joint, const JointFrames& start, SimTK::MobilizedBody& body1, SimTK::MobilizedBody& body2)
      : b1_(body1),
        b2_(body2),
        f1_(frame1(joint)),
        f2_(frame2(joint)),
        d_(transpose_multiply(start.frame1.R, start.frame2.p - start.frame1.p)),
        hinge2_(transpose_multiply(start.frame1.R, start.frame2.R.c[2])),
        length_(joint.length > 0 ? joint.length : norm(d_)) {}

  void add(JointType type) {
    switch (type) {
      case JointType::spherical:
        return add_ball();
      case JointType::fixed:
        return keep(Constraint::Weld(b1_, to_peer(f1_.R, f1_.p), b2_, to_peer(f2_.R, f2_.p)));
      case JointType::universal:
        add_ball();
        return add_angle(2, kRightAngle);
      case JointType::revolute:
        add_ball();
        return add_parallel();
      case JointType::cylindrical:
        add_line();
        return add_parallel();
      case JointType::prismatic:
        add_line();
        return keep(Constraint::ConstantOrientation(b1_, to_peer(f1_.R), b2_, to_peer(f2_.R)));
      case JointType::in_plane:
        return add_plane(0);
      case JointType::in_line:
        return add_line();
      case JointType::perpendicular:
        return add_angle(2, kRightAngle);
      case JointType::spherical_spherical:
        return add_rod();
      case JointType::revolute_spherical:
        add_rod();
        return add_plane(d_[2]);
      case JointType::revolute_revolute:
        add_rod();
        add_plane(d_[2]);
        return add_second_hinge();
      case JointType::floating:
      case JointType::node:
        break;
    }
  }

  std::vector<SimTK::ConstraintIndex> constraints;

 private:
  using Constraint = SimTK::Constraint;

  void keep(const Constraint& constraint) { constraints.push_back(constraint.getConstraintIndex()); }
  [[nodiscard]] static SimTK::UnitVec3 axis(const Frame& frame, int k) {
    return SimTK::UnitVec3(to_peer(frame.R.c[k]));
  }

  void add_ball() { keep(Constraint::Ball(b1_, to_peer(f1_.p), b2_, to_peer(f2_.p))); }
  void add_line() { keep(Constraint::PointOnLine(b1_, axis(f1_, 2), to_peer(f1_.p), b2_, to_peer(f2_.p))); }
  void add_rod() { keep(Constraint::Rod(b1_, to_peer(f1_.p), b2_, to_peer(f2_.p), length_)); }
  // between an axis of frame 1 and z of frame 2
  void add_angle(int k, double angle) { keep(Constraint::ConstantAngle(b1_, axis(f1_, k), b2_, axis(f2_, 2), angle)); }
  void add_parallel() {
    add_angle(0, kRightAngle);
    add_angle(1, kRightAngle);
  }
  // point 2 in a plane of frame 1
  void add_plane(double offset) {
    keep(Constraint::PointInPlane(b1_, axis(f1_, 2), dot(f1_.R.c[2], f1_.p) + offset, b2_, to_peer(f2_.p)));
  }
  void add_second_hinge() {
    if (std::hypot(hinge2_[0], hinge2_[1]) < 1e-6) return add_parallel();
    const double height = dot(f2_.R.c[2], f2_.p) - dot(hinge2_, d_);
    keep(Constraint::PointInPlane(b2_, axis(f2_, 2), height, b1_, to_peer(f1_.p)));
    add_angle(2, std::acos(hinge2_[2]));
  }

  SimTK::MobilizedBody &b1_, &b2_;
  Frame f1_, f2_;
  // frame 2 seen from frame 1 at the start, which massless links keep: its point and its z
  Vec3 d_, hinge2_;
  double length_;
};

}  // namespace

SimbodyMechanism::SimbodyMechanism(const MechanicsDef& mechanics) : def(mechanics), matter(system), forces(system) {
  SimTK::Force::UniformGravity(forces, matter, to_peer(Vec3(def.gravity)));
  bodies.resize(def.bodies.size() + 1);
  bodies[0] = matter.Ground().getMobilizedBodyIndex();
  Problems problems;
  edges = find_tree(def, problems);
  for (const TreeEdge& edge : edges) add_body(edge);
  const std::vector<Pose> poses = start_poses(def, problems);
  for (const int number : cut_joints(def, edges)) {
    const auto joint = static_cast<std::size_t>(number);
    add_cut(joint, joint_frames(def.joints[joint], poses[body_number(def, def.joints[joint].body1)],
                                poses[body_number(def, def.joints[joint].body2)]));
  }
}

void SimbodyMechanism::add_body(const TreeEdge& edge) {
  const auto child = static_cast<std::size_t>(edge.child);
  const BodyDef& body = def.bodies[child - 1];
  const SimTK::Body::Rigid rigid = rigid_body(body.mass, Vec3(body.center_of_mass), central_inertia(body));
  SimTK::MobilizedBody& parent = mobilized(static_cast<std::size_t>(edge.parent));
  const auto add = [&](const SimTK::MobilizedBody& mobilizer) { bodies[child] = mobilizer.getMobilizedBodyIndex(); };
  if (edge.joint == kNoJoint) return add(SimTK::MobilizedBody::Free(parent, rigid));
  const JointDef& joint = def.joints[static_cast<std::size_t>(edge.joint)];
  const Axes axes = axes_of(joint.type, edge.is_reversed);
  const Frame inner = edge.is_reversed ? frame2(joint) : frame1(joint);
  const Frame outer = edge.is_reversed ? frame1(joint) : frame2(joint);
  const SimTK::Transform F = to_peer(inner.R * axes.inner, inner.p), M = to_peer(outer.R * axes.outer, outer.p);
  switch (joint.type) {
    case JointType::revolute:
      return add(SimTK::MobilizedBody::Pin(parent, F, rigid, M));
    case JointType::prismatic:
      return add(SimTK::MobilizedBody::Slider(parent, F, rigid, M));
    case JointType::spherical:
      return add(SimTK::MobilizedBody::Ball(parent, F, rigid, M));
    case JointType::fixed:
      return add(SimTK::MobilizedBody::Weld(parent, F, rigid, M));
    case JointType::floating:
      return add(SimTK::MobilizedBody::Free(parent, F, rigid, M));
    case JointType::universal:
      return add(SimTK::MobilizedBody::Universal(parent, F, rigid, M));
    case JointType::cylindrical:
      return add(SimTK::MobilizedBody::Cylinder(parent, F, rigid, M));
    default:
      throw std::logic_error("the tree has no such joint");
  }
}

void SimbodyMechanism::add_cut(std::size_t number, const JointFrames& start) {
  const JointDef& joint = def.joints[number];
  Rows rows(joint, start, mobilized(body_number(def, joint.body1)), mobilized(body_number(def, joint.body2)));
  rows.add(joint.type);
  cuts.push_back({number, rows.constraints});
}

}  // namespace slew::multibody::testing
