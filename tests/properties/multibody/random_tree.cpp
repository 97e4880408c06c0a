// SPDX-License-Identifier: Apache-2.0
#include "tests/properties/multibody/random_tree.h"

#include <cmath>

#include "math/rotation.h"
#include "multibody/build/validate.h"
#include "multibody/model/topology.h"

namespace slew::multibody::testing {
namespace {

using math::Mat3;
using math::Vec3;

class Generator {
 public:
  Generator(unsigned seed, const TreeOptions& options) : random_(seed), options_(options) {}

  RandomTree run() {
    if (!options_.with_gravity) tree_.def.gravity = {};
    if (options_.with_gravity) tree_.def.gravity = triple(10);
    poses_.resize(1);
    for (int i = 0; i < options_.bodies; ++i) add_body(i);
    if (options_.with_forces) add_dampers();
    if (tree_.rows.size() > 10) tree_.rows.resize(10);
    if (options_.with_modes && options_.with_dummies) drop_refused_dummies();
    return tree_;
  }

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int pick(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  Triple triple(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }

  static Triple zxz_angles(const Mat3& R) {
    return {std::atan2(R(0, 2), -R(1, 2)), std::acos(std::fmin(1, std::fmax(-1, R(2, 2)))),
            std::atan2(R(2, 0), R(2, 1))};
  }

  JointType joint_type(bool is_first) {
    if (options_.floating_root && is_first) return JointType::floating;
    constexpr JointType kAll[] = {JointType::revolute,  JointType::revolute, JointType::prismatic,
                                  JointType::spherical, JointType::fixed,    JointType::floating};
    if (options_.only_one_coordinate) return kAll[pick(3)];
    if (options_.two_coordinates && pick(3) == 0) return pick(2) == 0 ? JointType::universal : JointType::cylindrical;
    return kAll[pick(options_.floating_root ? 5 : 6)];
  }

  void add_body(int i) {
    JointDef joint{.name = "J" + std::to_string(i), .type = joint_type(i == 0)};
    const int lowest = options_.floating_root && i > 0 ? 1 : 0;
    // mostly chains, some branches
    const int parent = joint.type == JointType::floating ? 0
                       : i == lowest                     ? lowest
                                                         : (pick(3) == 0 ? lowest + pick(i + 1 - lowest) : i);
    const Triple p_P = triple(1), p_C = triple(0.5);
    const Triple turn_P = triple(3), turn_C = triple(3);
    const double q = number(-1, 1);
    // pose of the child from the joint's frames
    const Pose& base = poses_[static_cast<std::size_t>(parent)];
    Pose frame = {base.R * math::rotation_xyz(turn_P), base.p + base.R * Vec3(p_P)};
    const bool is_reversed = joint.type != JointType::floating && pick(3) == 0;
    if (joint.type == JointType::revolute) frame.R = frame.R * math::rotation_z(q);
    if (joint.type == JointType::prismatic || joint.type == JointType::cylindrical) frame.p += frame.R.c[2] * q;
    if (joint.type == JointType::cylindrical) frame.R = frame.R * math::rotation_z(number(-3, 3));
    if (joint.type == JointType::universal) {
      const Mat3 between = frame.R * math::rotation_z(q);
      frame.R = Mat3{between.c[1], between.c[2], between.c[0]} * math::rotation_z(number(-3, 3));
    }
    if (joint.type == JointType::spherical || joint.type == JointType::floating) {
      frame.R = frame.R * math::rotation_xyz(triple(3));
    }
    Pose child;
    child.R = frame.R * math::transpose(math::rotation_xyz(turn_C));
    child.p = frame.p - child.R * Vec3(p_C);
    if (joint.type == JointType::floating) child.p += Vec3(triple(1));
    poses_.push_back(child);
    const std::string name = "B" + std::to_string(i),
                      parent_name = parent == 0 ? "Ground" : "B" + std::to_string(parent - 1);
    joint.body1 = is_reversed ? name : parent_name;
    joint.body2 = is_reversed ? parent_name : name;
    joint.point1 = is_reversed ? p_C : p_P;
    joint.point2 = is_reversed ? p_P : p_C;
    joint.orientation1 = is_reversed ? turn_C : turn_P;
    joint.orientation2 = is_reversed ? turn_P : turn_C;
    tree_.def.joints.push_back(joint);
    if (joint.type == JointType::revolute || joint.type == JointType::prismatic) tree_.rows.push_back(joint.name);
    add_mass(name, child);
    if (options_.with_modes && pick(2) == 0) {
      FlexibleBodyDef flexible{.body = name};
      ModalBody modes = random_modes(random_, Vec3(p_C), tree_.points[name]);
      if (options_.with_shortening) shorten(random_, tree_.points[name], modes);
      flexible.modes = std::make_shared<ModalBody>(modes);
      flexible.start.assign(modes.modes(), 0.0);
      tree_.def.bodies.back().type = BodyType::flexible;
      flexible.relative_damping = {options_.with_forces ? number(0, 0.1) : 0};
      tree_.def.flexible_bodies.push_back(flexible);
    }
    add_line(std::to_string(i), name, parent_name, joint.type);
    if (!options_.with_modes || !options_.with_dummies) return;
    // a second one across the same joint, and one within the body
    if (pick(2) == 0) add_line(std::to_string(i) + "_2", name, parent_name, joint.type);
    if (pick(3) == 0 && tree_.def.bodies.back().type == BodyType::flexible) {
      add_line(std::to_string(i) + "_3", name + ".Node7", name + (pick(3) == 0 ? ".Node1" : ".Node3"),
               JointType::fixed);
    }
  }

  void add_mass(const std::string& name, const Pose& pose) {
    const double a = number(0.2, 1), b = number(0.2, 1), mass = number(0.5, 5);
    const Mat3 principal = Mat3::diagonal(mass * a, mass * b, mass * number(std::abs(a - b) + 0.05, a + b));
    const Mat3 turn = math::rotation_xyz(triple(3));
    const Mat3 I = turn * principal * math::transpose(turn);
    tree_.def.bodies.push_back({.name = name,
                                .position = pose.p.array(),
                                .orientation = zxz_angles(pose.R),
                                .mass = mass,
                                .center_of_mass = triple(0.5),
                                .inertia = {I(0, 0), I(1, 1), I(2, 2)},
                                .products = {I(0, 1), I(0, 2), I(1, 2)}});
    if (pick(4) == 0) {
      tree_.def.static_dummies.push_back({.name = name + "_Load",
                                          .relative_to = name,
                                          .position = triple(0.5),
                                          .orientation = triple(3),
                                          .mass = number(0.1, 2),
                                          .center_of_mass = triple(0.3),
                                          .inertia = {0.1, 0.12, 0.15}});
    }
  }

  // a force between neighbours, with or without dummies; sometimes the body comes first
  void add_line(const std::string& number_of, const std::string& body, const std::string& parent, JointType type) {
    if (pick(3) == 0 || (parent == kGroundName && !options_.lines_to_ground)) return;
    const std::string name = "F" + number_of;
    const bool is_swapped = pick(2) == 0;
    const Triple far = {number(1, 2), number(-2, -1), number(1, 2)};
    tree_.def.translational_forces.push_back({.name = name,
                                              .body1 = is_swapped ? body : parent,
                                              .point1 = is_swapped ? triple(0.4) : far,
                                              .body2 = is_swapped ? parent : body,
                                              .point2 = is_swapped ? far : triple(0.4)});
    if (options_.with_forces) {
      TranslationalForceDef& force = tree_.def.translational_forces.back();
      force.spring_constant = number(0, 100);
      force.damping_constant = number(0, 20);
      force.free_length = number(0.5, 2);
      force.max_length = 1.5;
      force.end_spring_constant = 300;
      force.end_damping_constant = 3;
    }
    if (type != JointType::fixed) tree_.rows.push_back(name);
    if (!options_.with_dummies) return;
    const double c1 = number(-1, -0.2), c2 = number(0.2, 1), I1 = number(0.1, 1), I2 = number(0.1, 1);
    tree_.def.force_dummies.push_back({name + "_Cylinder", name, 1, number(0.5, 4), {c1, 0, 0}, {0.05, I1, I1}});
    if (pick(4) != 0)
      tree_.def.force_dummies.push_back({name + "_Piston", name, 2, number(0.5, 4), {c2, 0, 0}, {0, I2, I2}});
    if (pick(6) == 0) tree_.def.force_dummies.push_back({name + "_Valve", name, 1, number(0.1, 1), {-0.1, 0, 0}, {}});
  }

  // modes of two bodies that a fixed joint makes one
  void drop_refused_dummies() {
    Problems problems;
    validate(tree_.def, problems);
    for (const Problem& problem : problems) {
      std::erase_if(tree_.def.force_dummies,
                    [&](const ForceDummyDef& dummy) { return problem.path.starts_with(dummy.name + "."); });
    }
  }

  // dampers between any two bodies and about any axis, springs about some
  void add_dampers() {
    const int count = options_.bodies;
    for (int i = 0; i < 2; ++i) {
      const int a = pick(count), b = pick(count);
      if (a == b) continue;
      const std::string name = "R" + std::to_string(i);
      const Mat3 triad = math::rotation_xyz(triple(3));
      tree_.def.rotational_forces.push_back({.name = name,
                                             .body1 = "B" + std::to_string(a),
                                             .f1 = triad.c[0].array(),
                                             .g1 = triad.c[1].array(),
                                             .body2 = "B" + std::to_string(b),
                                             .f2 = triple(1),
                                             .spring_constant = number(0, 10),
                                             .damping_constant = number(0, 5),
                                             .free_angle = number(-1, 1)});
    }
  }

  std::mt19937 random_;
  TreeOptions options_;
  RandomTree tree_;
  std::vector<Pose> poses_;
};

}  // namespace

RandomTree random_tree(unsigned seed, const TreeOptions& options) {
  return Generator(seed, options).run();
}

State random_state(unsigned seed, const Model& model) {
  std::mt19937 random(seed + 1000);
  std::uniform_real_distribution<double> number(-1, 1);
  State state = start_state(model);
  for (const Link& link : model.links) {
    if (&link == &model.links[0]) continue;
    const auto i = static_cast<std::size_t>(link.q);
    if (link.joint != LinkJoint::spherical && link.joint != LinkJoint::floating) {
      for (int k = 0; k < speed_count(link.joint); ++k) state.q[i + static_cast<std::size_t>(k)] += number(random);
    } else {
      const math::Quaternion q = math::normalized({number(random), number(random), number(random), number(random)});
      const std::size_t k = i + (link.joint == LinkJoint::floating ? 3 : 0);
      for (std::size_t j = i; j < k; ++j) state.q[j] += number(random);
      state.q[k] = q.w;
      state.q[k + 1] = q.x;
      state.q[k + 2] = q.y;
      state.q[k + 3] = q.z;
    }
  }
  for_each_mode(model, [&](std::size_t q, std::size_t) { state.q[q] = 0.5 * number(random); });
  for (double& u : state.u) u = 2 * number(random);
  return state;
}

}  // namespace slew::multibody::testing
