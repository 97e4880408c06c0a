// SPDX-License-Identifier: Apache-2.0
// The truck crane with a rigid jib (scenes/truck_crane.yaml has the same numbers), for tests of the mechanics alone.
#pragma once

#include <cmath>

#include "multibody/model/defs.h"

namespace slew::multibody::testing {

inline constexpr double kDegree = M_PI / 180;

enum class Dummies { with, without };
enum class BagDamper { with, without };

struct CraneOptions {
  double lift = 15 * kDegree;  // rad, raising of the lift boom
  double fold = 25 * kDegree;  // rad, folding of the jib
  double slew = 37.5 * kDegree;
  double bag_mass = 500;  // kg
  Dummies dummies = Dummies::with;
  BagDamper damper = BagDamper::with;
};

inline void add_crane_bodies(MechanicsDef& def, const CraneOptions& o) {
  // products: the tensor's element, minus what the CAD program prints
  def.bodies.push_back({.name = "Truck_Pillar",
                        .position = {3.21922, 0.8830184, 0.00036178},
                        .orientation = {90 * kDegree, o.slew, -90 * kDegree},
                        .mass = 412.77395,
                        .center_of_mass = {0.09521, 1.0047, 0},
                        .inertia = {672.81864, 21.18306, 682.45175},
                        .products = {-60.25371, 0, 0},
                        .inertia_about = InertiaPoint::body_origin});
  def.bodies.push_back({.name = "Truck_LiftBoom",
                        .relative_to = "Truck_Pillar",
                        .position = {0.5, 2, 0},
                        .orientation = {-o.lift, 0, 0},
                        .mass = 400,
                        .center_of_mass = {-1.3, 0, 0},
                        .inertia = {12, 230, 230}});
  def.bodies.push_back({.name = "Truck_JibBoomAttachment",
                        .relative_to = "Truck_LiftBoom",
                        .position = {-2.6, 0, 0},
                        .orientation = {o.fold, 0, 0},
                        .mass = 30,
                        .center_of_mass = {-0.1, 0, 0},
                        .inertia = {0.6, 0.6, 0.6}});
  def.bodies.push_back({.name = "Truck_JibBoom",
                        .relative_to = "Truck_JibBoomAttachment",
                        .position = {0.3, 0, -0.195},
                        .mass = 127.5618,
                        .center_of_mass = {-3.25, 0.02904, 0.1507},
                        .inertia = {3.8, 451, 451}});
  def.bodies.push_back({.name = "Truck_Hook",
                        .relative_to = "Truck_JibBoom",
                        .position = {-6.5, -0.15, 0.15},
                        .mass = 20,
                        .center_of_mass = {0, -0.1, 0},
                        .inertia = {0.2, 0.2, 0.2}});
  const double share = o.bag_mass / 500;
  def.bodies.push_back({.name = "Bag",
                        .relative_to = "Truck_Hook",
                        .position = {0, -0.3, 0},
                        .orientation = {o.lift - o.fold, 0, 0},
                        .mass = o.bag_mass,
                        .center_of_mass = {0, -0.6, 0},
                        .inertia = {100 * share, 100 * share, 100 * share}});
}

inline void add_crane_joints(MechanicsDef& def) {
  def.joints.push_back({.name = "Body_Pillar",
                        .point1 = {3.21922, 0.8830184, 0.00036178},
                        .orientation1 = {-90 * kDegree, 0, 0},
                        .body2 = "Truck_Pillar",
                        .orientation2 = {-90 * kDegree, 0, 0},
                        .first = {.coulomb_friction = 800, .viscous_friction = 3000}});
  def.joints.push_back(
      {.name = "Pillar_LiftBoom",
       .body1 = "Truck_Pillar",
       .point1 = {0.5, 2, 0},
       .orientation1 = {180 * kDegree, 0, 0},
       .body2 = "Truck_LiftBoom",
       .orientation2 = {180 * kDegree, 0, 0},
       .first = {.limit_min = -12 * kDegree, .limit_max = 65 * kDegree, .limit_stiffness = 2e7, .limit_damping = 2e6}});
  def.joints.push_back(
      {.name = "LiftBoom_JibBoomAttachment",
       .body1 = "Truck_LiftBoom",
       .point1 = {-2.6, 0, 0},
       .body2 = "Truck_JibBoomAttachment",
       .first = {.limit_min = -5 * kDegree, .limit_max = 75 * kDegree, .limit_stiffness = 2e7, .limit_damping = 2e6}});
  def.joints.push_back({.name = "JibBoomAttachment_JibBoom",
                        .type = JointType::fixed,
                        .body1 = "Truck_JibBoomAttachment",
                        .point1 = {0.3, 0, -0.195},
                        .body2 = "Truck_JibBoom"});
  def.joints.push_back({.name = "JibBoom_Hook",
                        .type = JointType::fixed,
                        .body1 = "Truck_JibBoom",
                        .point1 = {-6.5, -0.15, 0.15},
                        .body2 = "Truck_Hook"});
  def.joints.push_back({.name = "Hook_Bag",
                        .type = JointType::spherical,
                        .body1 = "Truck_Hook",
                        .point1 = {0, -0.3, 0},
                        .body2 = "Bag"});
}

inline void add_crane_forces(MechanicsDef& def, const CraneOptions& o) {
  def.translational_forces.push_back({.name = "ForceT_Lift",
                                      .body1 = "Truck_Pillar",
                                      .point1 = {-0.221712, 0.22223, -0.00376529},
                                      .body2 = "Truck_LiftBoom",
                                      .point2 = {-0.221712, 0.165, -0.00376529}});
  def.translational_forces.push_back({.name = "ForceT_Jib",
                                      .body1 = "Truck_LiftBoom",
                                      .point1 = {-0.7, -0.25, 0},
                                      .body2 = "Truck_JibBoomAttachment",
                                      .point2 = {0, -0.35, 0}});
  def.rotational_forces.push_back({.name = "ForceR_Pillar", .body1 = "Ground", .body2 = "Truck_Pillar"});
  if (o.damper == BagDamper::with) {
    const auto damper = [&def](const char* name, Triple f, Triple g) {
      def.rotational_forces.push_back(
          {.name = name, .body1 = "Truck_Hook", .f1 = f, .g1 = g, .body2 = "Bag", .f2 = f, .damping_constant = 5000});
    };
    damper("ForceR_FrictionX", {0, 0, 1}, {0, 1, 0});
    damper("ForceR_FrictionY", {0, 0, 1}, {1, 0, 0});
    damper("ForceR_FrictionZ", {1, 0, 0}, {0, 1, 0});
  }
  if (o.dummies == Dummies::without) return;
  def.force_dummies = {{"Dummy_PillarCylinder", "ForceT_Lift", 1, 31.63103, {-0.56644, 0, 0}, {0.31882, 4.015, 4.015}},
                       {"Dummy_PillarPiston", "ForceT_Lift", 2, 25, {0.55, 0, 0}, {0.1, 1.44, 1.44}},
                       {"Dummy_LiftBoomCylinder", "ForceT_Jib", 1, 22, {-0.45, 0, 0}, {0.2, 1.545, 1.545}},
                       {"Dummy_LiftBoomPiston", "ForceT_Jib", 2, 18, {0.45, 0, 0}, {0.1, 1.355, 1.355}}};
}

inline MechanicsDef crane_def(const CraneOptions& options = {}) {
  MechanicsDef def;
  add_crane_bodies(def, options);
  add_crane_joints(def);
  add_crane_forces(def, options);
  return def;
}

}  // namespace slew::multibody::testing
