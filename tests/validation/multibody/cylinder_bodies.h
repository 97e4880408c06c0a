// SPDX-License-Identifier: Apache-2.0
// Cylinders as two bodies each instead of masses on their line of force: a tube that hangs on body 1 by a universal
// joint, a rod that slides in it, and a ball at body 2 that closes the loop.
#pragma once

#include <algorithm>

#include "multibody/model/defs.h"
#include "multibody/model/topology.h"
#include "tests/validation/multibody/angles.h"

namespace slew::multibody::testing {

// Masses of a force's dummies at one end, as a body on the line with x along it.
struct LineMass {
  double mass = 0, center = 0, transverse = 0;  // kg, m, kg m2
};

inline LineMass line_mass(const MechanicsDef& def, const std::string& force, int index) {
  LineMass sum;
  double second = 0;
  for (const ForceDummyDef& dummy : def.force_dummies) {
    if (dummy.relative_to != force || dummy.index != index) continue;
    sum.mass += dummy.mass;
    sum.center += dummy.mass * dummy.center_of_mass[0];
    second += dummy.mass * dummy.center_of_mass[0] * dummy.center_of_mass[0];
    sum.transverse += 0.5 * (dummy.inertia[1] + dummy.inertia[2]);
  }
  sum.center /= sum.mass;
  sum.transverse += second - sum.mass * sum.center * sum.center;
  return sum;
}

// `cross`: direction in body 1 that the universal joint first turns about, at a right angle to the line at the start.
inline void replace_dummies(MechanicsDef& def, const std::string& force, math::Vec3 cross_1) {
  const auto is_force = [&](const auto& f) { return f.name == force; };
  const TranslationalForceDef line =
      *std::find_if(def.translational_forces.begin(), def.translational_forces.end(), is_force);
  Problems problems;
  const std::vector<Pose> poses = start_poses(def, problems);
  const Pose& body1 = poses[static_cast<std::size_t>(find_body(def, line.body1))];
  const Pose& body2 = poses[static_cast<std::size_t>(find_body(def, line.body2))];
  const math::Vec3 P1 = body1.p + body1.R * math::Vec3(line.point1), P2 = body2.p + body2.R * math::Vec3(line.point2);
  const math::Vec3 x = (P1 - P2) * (1 / norm(P1 - P2));
  const math::Vec3 aside = body1.R * cross_1;
  const math::Vec3 y = (aside - x * dot(aside, x)) * (1 / norm(aside - x * dot(aside, x)));
  const math::Mat3 R{x, y, cross(x, y)};
  const Triple orientation = angles_zxz(R);
  const auto add = [&](const std::string& name, math::Vec3 origin, const LineMass& mass) {
    def.bodies.push_back({.name = name,
                          .position = origin.array(),
                          .orientation = orientation,
                          .mass = mass.mass,
                          .center_of_mass = {mass.center, 0, 0},
                          .inertia = {0, mass.transverse, mass.transverse}});
  };
  add(force + "_Tube", P1, line_mass(def, force, 1));
  add(force + "_Rod", P2, line_mass(def, force, 2));
  // first about y of the tube as body 1 holds it, then about its z
  const math::Mat3 first{cross(y, x), x, y};
  def.joints.push_back({.name = force + "_Eye",
                        .type = JointType::universal,
                        .body1 = line.body1,
                        .point1 = line.point1,
                        .orientation1 = angles_xyz(transpose(body1.R) * first),
                        .body2 = force + "_Tube"});
  def.joints.push_back({.name = force + "_Slide",
                        .type = JointType::prismatic,
                        .body1 = force + "_Tube",
                        .orientation1 = {0, M_PI / 2, 0},
                        .body2 = force + "_Rod",
                        .orientation2 = {0, M_PI / 2, 0}});
  def.joints.push_back({.name = force + "_Ball",
                        .type = JointType::spherical,
                        .body1 = force + "_Rod",
                        .body2 = line.body2,
                        .point2 = line.point2});
  std::erase_if(def.force_dummies, [&](const ForceDummyDef& dummy) { return dummy.relative_to == force; });
}

}  // namespace slew::multibody::testing
