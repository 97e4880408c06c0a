// SPDX-License-Identifier: Apache-2.0
#include "tests/properties/multibody/random_loops.h"

#include <cmath>
#include <iterator>

#include "multibody/model/topology.h"
#include "tests/validation/multibody/angles.h"

namespace slew::multibody::testing {
namespace {

using math::Mat3;
using math::Vec3;

constexpr JointType kTypes[] = {JointType::revolute,
                                JointType::prismatic,
                                JointType::spherical,
                                JointType::universal,
                                JointType::cylindrical,
                                JointType::in_plane,
                                JointType::in_line,
                                JointType::perpendicular,
                                JointType::spherical_spherical,
                                JointType::revolute_spherical,
                                JointType::revolute_revolute,
                                JointType::fixed};

class Closing {
 public:
  Closing(unsigned seed, const TreeOptions& options)
      : tree(random_tree(seed, options)), random_(seed + 77), first_(options.floating_root ? 1 : 0) {
    Problems problems;
    poses_ = start_poses(tree.def, problems);
    add(kTypes[seed % std::size(kTypes)]);
    if (seed % 3 == 0) add(kTypes[(seed / 3) % std::size(kTypes)]);
  }

  RandomTree tree;

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Vec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Mat3 rotation() { return math::rotation_xyz({number(-3, 3), number(-1.5, 1.5), number(-3, 3)}); }

  void add(JointType type) {
    const int bodies = static_cast<int>(poses_.size());
    const int others = bodies - first_;
    const int i = std::uniform_int_distribution<int>(0, others - 1)(random_);
    const int a = first_ + i;
    const int b = first_ + (i + std::uniform_int_distribution<int>(1, others - 1)(random_)) % others;
    const Mat3 R1 = rotation();
    const Vec3 P1 = poses_[static_cast<std::size_t>(a)].p + vector(0.5);
    Mat3 R2 = R1;
    Vec3 P2 = P1;
    switch (type) {
      case JointType::revolute:
        R2 = R1 * math::rotation_z(number(-3, 3));
        break;
      case JointType::prismatic:
        P2 = P1 + R1.c[2] * number(-1, 1);
        break;
      case JointType::cylindrical:
        R2 = R1 * math::rotation_z(number(-3, 3));
        [[fallthrough]];
      case JointType::in_line:
        P2 = P1 + R1.c[2] * number(-1, 1);
        break;
      case JointType::in_plane:
        P2 = P1 + R1.c[0] * number(-1, 1) + R1.c[1] * number(-1, 1);
        break;
      case JointType::universal:
      case JointType::perpendicular:
        R2 = R1 * math::rotation_z(number(-3, 3)) * math::rotation_xyz({0, M_PI / 2, 0}) * math::rotation_z(1);
        break;
      case JointType::fixed:
      case JointType::spherical:
        break;
      default:
        P2 = P1 + vector(1);
        R2 = rotation();
    }
    const auto into = [&](int body, const Mat3& R, Vec3 P, Triple& point, Triple& orientation, std::string& name) {
      const Pose& pose = poses_[static_cast<std::size_t>(body)];
      point = (transpose(pose.R) * (P - pose.p)).array();
      orientation = angles_xyz(transpose(pose.R) * R);
      name = body_name(tree.def, body);
    };
    JointDef joint{.name = "C" + std::to_string(tree.def.joints.size()), .type = type};
    into(a, R1, P1, joint.point1, joint.orientation1, joint.body1);
    into(b, R2, P2, joint.point2, joint.orientation2, joint.body2);
    tree.def.joints.push_back(joint);
  }

  std::mt19937 random_;
  int first_;  // body that the joints may hold
  std::vector<Pose> poses_;
};

TreeOptions options_of(unsigned seed) {
  return {.bodies = 3 + static_cast<int>(seed) % 6, .with_dummies = false, .two_coordinates = true};
}

}  // namespace

RandomTree random_loops(unsigned seed) {
  return Closing(seed, options_of(seed)).tree;
}

RandomTree random_floating_loops(unsigned seed) {
  TreeOptions options = options_of(seed);
  options.with_gravity = options.lines_to_ground = false;
  options.floating_root = true;
  return Closing(seed, options).tree;
}

}  // namespace slew::multibody::testing
