// SPDX-License-Identifier: Apache-2.0
// Force elements and the masses that they and bodies carry: parts of build_model().
#include "multibody/build/build_forces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/index.h"
#include "multibody/build/build_rows.h"
#include "multibody/model/body_inertia.h"

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

template <typename Def>
ElementLaw law_of(const Def& def, double free, double min, double max) {
  return {.spring = def.spring_constant,
          .damping = def.damping_constant,
          .free = free,
          .min = min,
          .max = max,
          .end_spring = def.end_spring_constant,
          .end_damping = def.end_damping_constant,
          .is_active = false,
          .spring_curve = math::monotone_cubic(def.spring_table, math::Ends::continued),
          .damper_curve = math::monotone_cubic(def.damper_table, math::Ends::not_falling)};
}

class ForceBuilder {
 public:
  ForceBuilder(const MechanicsDef& def, std::span<const Pose> link_poses, Model& model)
      : def_(def), link_pose_(link_poses), model_(model) {}

  void add_line(const TranslationalForceDef& def) {
    const Body& body1 = body_of(def.body1);
    const Body& body2 = body_of(def.body2);
    model_.lines.push_back({.name = def.name,
                            .p1 = body1.p_LB + body1.R_LB * Vec3(def.point1),
                            .p2 = body2.p_LB + body2.R_LB * Vec3(def.point2),
                            .link1 = body1.link,
                            .link2 = body2.link,
                            .body1 = body_index(def.body1),
                            .body2 = body_index(def.body2),
                            .law = law_of(def, def.free_length, def.min_length, def.max_length)});
  }

  void add_angle(const RotationalForceDef& def) {
    const Body& body1 = body_of(def.body1);
    const Body& body2 = body_of(def.body2);
    // right-handed triad of unit vectors from the two directions given
    const Vec3 f1 = Vec3(def.f1) * (1 / math::norm(Vec3(def.f1)));
    const Vec3 normal = math::cross(f1, Vec3(def.g1));
    const Vec3 axis = normal * (1 / math::norm(normal));
    AngleElement element{.name = def.name,
                         .f1 = body1.R_LB * f1,
                         .g1 = body1.R_LB * math::cross(axis, f1),
                         .axis = body1.R_LB * axis,
                         .f2 = body2.R_LB * (Vec3(def.f2) * (1 / math::norm(Vec3(def.f2)))),
                         .link1 = body1.link,
                         .link2 = body2.link,
                         .body1 = body_index(def.body1),
                         .body2 = body_index(def.body2),
                         .law = law_of(def, def.free_angle, def.min_angle, def.max_angle)};
    element.first_path = static_cast<int>(model_.paths.size());
    add_path(model_, element.link1, element.link2);
    element.path_end = static_cast<int>(model_.paths.size());
    find_coaxial(element);
    model_.angles.push_back(element);
  }

 private:
  [[nodiscard]] int body_index(const std::string& name) const { return number_of_(name); }
  [[nodiscard]] const Body& body_of(const std::string& name) const { return model_.bodies[at(body_index(name))]; }

  // if all joints on the path turn about one axis, the angle is a sum of joint angles, for any number of turns
  void find_coaxial(AngleElement& element) {
    constexpr double kParallel = 1e-9;
    const Pose& pose1 = link_pose_[at(element.link1)];
    const Vec3 axis = pose1.R * element.axis;
    const Vec3 f2 = link_pose_[at(element.link2)].R * element.f2;
    const double angle = std::atan2(math::dot(f2, pose1.R * element.g1), math::dot(f2, pose1.R * element.f1));
    element.is_coaxial = element.first_path < element.path_end;  // a weld has no axis
    element.offset = angle;
    for (int i = element.first_path; i < element.path_end; ++i) {
      PathEntry& entry = model_.paths[at(i)];
      const Link& link = model_.links[at(entry.link)];
      const Vec3 joint_axis = link_pose_[at(entry.link)].R.c[2];
      if (link.joint != LinkJoint::revolute || math::norm(math::cross(joint_axis, axis)) > kParallel) {
        element.is_coaxial = false;
        return;
      }
      entry.turn = entry.sign * (math::dot(joint_axis, axis) > 0 ? 1.0 : -1.0);
      element.offset -= entry.turn * model_.start_q[at(link.q)];
      const std::int64_t turns = start_turns_of(entry.link);
      if (turns != 0) element.offset += entry.turn * 2 * std::numbers::pi * static_cast<double>(turns);
    }
  }

  // of a link that a revolute joint moves
  [[nodiscard]] std::int64_t start_turns_of(int link) const {
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      if (model_.joints[j].link == link) return def_.joints[j].first.start_turns;
    }
    return 0;
  }

  const MechanicsDef& def_;
  BodyNumbers number_of_{def_};
  std::span<const Pose> link_pose_;
  Model& model_;
};

class DummyBuilder {
 public:
  DummyBuilder(const MechanicsDef& def, Model& model) : def_(def), model_(model) {}

  void add_static_dummies() {
    for (const StaticDummyDef& def : def_.static_dummies) {
      const int carrier = number_of_(def.relative_to);
      const Body& body = model_.bodies[at(carrier)];
      const Mat3 R_LD = body.R_LB * math::rotation_zxz(def.orientation);
      const Vec3 p_LD = body.p_LB + body.R_LB * Vec3(def.position);
      const Mat3 I = Mat3::diagonal(def.inertia[0], def.inertia[1], def.inertia[2]);
      model_.lumped.push_back({.c_L = p_LD + R_LD * Vec3(def.center_of_mass),
                               .I_c = rotated(R_LD, I),
                               .mass = def.mass,
                               .reference_mass = def.mass,
                               .link = body.link,
                               .owner = carrier});
    }
  }

  void add_force_dummies() {
    for (std::size_t i = 0; i < model_.lines.size(); ++i) add_dummies_of(static_cast<int>(i));
    std::stable_sort(model_.coupled.begin(), model_.coupled.end(),
                     [](const CoupledMass& a, const CoupledMass& b) { return a.child < b.child; });
    for (std::size_t i = 0; i < model_.coupled.size(); ++i) {
      Link& child = model_.links[at(model_.coupled[i].child)];
      if (child.coupled_end == child.first_coupled) child.first_coupled = static_cast<int>(i);
      child.coupled_end = static_cast<int>(i) + 1;
    }
    const std::size_t first = model_.coupled.size();
    model_.coupled.insert(model_.coupled.end(), at_nodes_.begin(), at_nodes_.end());
    add_node_dummies(model_, first);
  }

 private:
  // all dummies of one force as one cylinder and one piston
  void add_dummies_of(int index) {
    const LineElement& line = model_.lines[at(index)];
    double mass[2] = {0, 0}, moment[2] = {0, 0}, second[2] = {0, 0}, transverse = 0;
    for (const ForceDummyDef& dummy : def_.force_dummies) {
      if (dummy.relative_to != line.name) continue;
      const std::size_t end = dummy.index == 1 ? 0 : 1;
      mass[end] += dummy.mass;
      moment[end] += dummy.mass * dummy.center_of_mass[0];
      second[end] += dummy.mass * dummy.center_of_mass[0] * dummy.center_of_mass[0];
      transverse += 0.5 * (dummy.inertia[1] + dummy.inertia[2]);
    }
    if (mass[0] + mass[1] == 0) return;
    CoupledMass coupled{.line = index, .m1 = mass[0], .m2 = mass[1]};
    if (mass[0] > 0) coupled.c1 = moment[0] / mass[0];
    if (mass[1] > 0) coupled.c2 = moment[1] / mass[1];
    // several dummies at one end: their spread about the common centre is transverse inertia
    coupled.transverse = transverse + (second[0] - moment[0] * coupled.c1) + (second[1] - moment[1] * coupled.c2);
    if (line.link1 == line.link2) {
      lump_dummies(line, coupled);
      return;
    }
    coupled.is_point1_on_child = line.link1 > line.link2;
    coupled.child = coupled.is_point1_on_child ? line.link1 : line.link2;
    const Link& child = model_.links[at(coupled.child)];
    const bool is_joint_between = child.joint != LinkJoint::node && child.parent == std::min(line.link1, line.link2);
    (is_joint_between ? model_.coupled : at_nodes_).push_back(coupled);
  }

  // both points on one link: the dummies are part of it
  void lump_dummies(const LineElement& line, const CoupledMass& coupled) {
    model_.welded.push_back(coupled);
    if (line.link1 == kGround) return;
    const Vec3 d = line.p1 - line.p2;
    const Vec3 e = d * (1 / math::norm(d));
    const Mat3 across = Mat3::identity() - math::outer(e, e);
    const auto add = [&](Vec3 center, double mass, double transverse) {
      model_.lumped.push_back({.c_L = center,
                               .I_c = across * transverse,
                               .mass = mass,
                               .reference_mass = mass,
                               .link = line.link1,
                               .owner = kNoBody});
    };
    // assign to the end with mass, since inertia scales with it
    const bool has_cylinder = coupled.m1 > 0;
    add(line.p1 + e * coupled.c1, coupled.m1, has_cylinder ? coupled.transverse : 0);
    add(line.p2 + e * coupled.c2, coupled.m2, has_cylinder ? 0 : coupled.transverse);
  }

  const MechanicsDef& def_;
  BodyNumbers number_of_{def_};
  Model& model_;
  std::vector<CoupledMass> at_nodes_;
};

}  // namespace

void add_forces(const MechanicsDef& mechanics, std::span<const Pose> link_poses, Model& model) {
  ForceBuilder builder(mechanics, link_poses, model);
  for (const TranslationalForceDef& force : mechanics.translational_forces) builder.add_line(force);
  for (const RotationalForceDef& force : mechanics.rotational_forces) builder.add_angle(force);
}

void add_dummies(const MechanicsDef& mechanics, Model& model) {
  DummyBuilder builder(mechanics, model);
  builder.add_static_dummies();
  builder.add_force_dummies();
}

}  // namespace slew::multibody
