// SPDX-License-Identifier: Apache-2.0
// A robot as definitions of a mechanism.
//
// Links with mass become bodies of the same frames; a link without rides on another (placement.h). With the axis a of a
// joint, R_CA the turn about x, y' that takes z to a, and X_PC its origin at the start, the joint's frame 2 in the
// child is R_CA and its frame 1 in the parent X_PC R_CA, so that the joint's coordinate is URDF's:
//   I_C = R_CI I R_CI^T   inertia about the centre, in the link's axes; R_CI from the inertial's rpy               (1)
//   k = omega^2 I_q,  c = 2 omega I_q   stiffness and damping of a joint's limits, omega = kStopFrequency           (2)
// I_q is the load of the joint: its inertia about the axis, or its mass along it. URDF's limits have no stiffness: (2)
// stops the load critically damped, within about v/omega of the limit. damping and friction become viscous and Coulomb
// friction. A planar joint with the normal n becomes three joints:
//   point of the child in the parent's plane, and n_C at a right angle to two directions of that plane           (3)
// and a joint that follows another (<mimic>), q_2 = a q_1 + b, a gear, whose coordinates may be whole turns less:
//   q_2' = a q_1' + b + a turns_1 - turns_2                                                                    (4)
#pragma once

#include <map>
#include <string>
#include <vector>

#include "contact/contact_def.h"
#include "multibody/model/defs.h"
#include "urdf/collision_shape.h"
#include "urdf/placement.h"
#include "urdf/robot.h"

namespace slew::urdf {

inline constexpr double kStopFrequency = 100;  // rad/s, slow against sub-steps of 1 ms, fast against machines

struct Conversion {
  multibody::MechanicsDef mechanics;
  std::map<std::string, std::vector<std::string>> comments;  // by element
  std::map<std::string, int> lines;                          // lines of the URDF, by element
  std::map<std::string, contact::MeshDef> meshes;            // meshes of shapes with a file, by shape
  std::vector<Note> notes;                                   // notes of the robot and of the conversion, by line
  std::vector<Note> changes{};                               // changes requested before the conversion
};

// Pre-condition: find_starts() and settle_mass_properties() found no problem.
[[nodiscard]] Conversion convert(const Robot& robot, RootMount mount, const Folders& folders);

}  // namespace slew::urdf
