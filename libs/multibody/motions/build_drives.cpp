// SPDX-License-Identifier: Apache-2.0
#include "multibody/motions/build_drives.h"

#include <cstddef>

#include "multibody/constraints/constraint.h"

namespace slew::multibody {

int driven_coordinate(const MotionDef& motion, JointType joint) noexcept {
  const bool is_rotation = motion.kind == MotionKind::rotation;
  switch (joint) {
    case JointType::revolute:
      return is_rotation && motion.axis == 1 ? 0 : -1;
    case JointType::prismatic:
      return is_rotation ? -1 : 0;
    case JointType::cylindrical:
      return !is_rotation ? 1 : motion.axis == 1 ? 0 : -1;
    case JointType::universal:
      return is_rotation ? static_cast<int>(motion.axis) - 1 : -1;
    default:
      return -1;
  }
}

std::vector<Drive> declared_drives(const MechanicsDef& mechanics) {
  std::vector<Drive> drives;
  for (const MotionDef& motion : mechanics.motions) {
    Drive& drive = drives.emplace_back();
    drive.name = motion.name;
    drive.is_angle = motion.kind == MotionKind::rotation;
    for (std::size_t j = 0; j < mechanics.joints.size(); ++j) {
      if (mechanics.joints[j].name != motion.joint) continue;
      drive.joint = static_cast<int>(j);
      drive.number = driven_coordinate(motion, mechanics.joints[j].type);
    }
  }
  return drives;
}

bool begin_drives(const MechanicsDef& mechanics, int joint, const std::array<double, 2>& start, Model& model) {
  bool has_some = false;
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    Drive& drive = model.drives[k];
    if (drive.joint != joint) continue;
    drive.law = motion_law(mechanics.motions[k], start[static_cast<std::size_t>(drive.number)]);
    has_some = true;
  }
  return has_some;
}

void add_drive_rows(const Model& model, int joint, Constraint& constraint) {
  for (std::size_t k = 0; k < model.drives.size(); ++k) {
    const Drive& drive = model.drives[k];
    if (drive.joint != joint) continue;
    constraint.rows.push_back(coordinate_row(model.joints[static_cast<std::size_t>(joint)].type, drive.number));
    constraint.rows.back().drive = static_cast<int>(k);
  }
}

}  // namespace slew::multibody
