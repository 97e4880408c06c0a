// SPDX-License-Identifier: Apache-2.0
#include "multibody/joints/joint_axes.h"

#include <cmath>

namespace slew::multibody {

int coordinate_count(JointType type) noexcept {
  switch (type) {
    case JointType::revolute:
    case JointType::prismatic:
      return 1;
    case JointType::universal:
    case JointType::cylindrical:
      return 2;
    default:
      return 0;
  }
}

std::string_view suffix_of(JointType type, int number) noexcept {
  if (type == JointType::universal) return number == 0 ? "_1" : "_2";
  if (type == JointType::cylindrical) return number == 0 ? "_angle" : "";
  return "";
}

int coordinate_of_key(JointType type, std::string_view key) noexcept {
  int plain = 0;
  for (int number = 0; number < coordinate_count(type); ++number) {
    const std::string_view suffix = suffix_of(type, number);
    if (suffix.empty()) plain = number;
    if (!suffix.empty() && key.ends_with(suffix)) return number;
  }
  return plain;
}

bool is_angle(JointType type, int number) noexcept {
  return type != JointType::prismatic && !(type == JointType::cylindrical && number == 1);
}

const JointAxisDef& axis_of(const JointDef& joint, int number) noexcept {
  return number == 1 ? joint.second : joint.first;
}

bool has_limits(const JointAxisDef& axis) noexcept {
  return std::isfinite(axis.limit_min) || std::isfinite(axis.limit_max);
}

bool has_row(const JointAxisDef& axis) noexcept {
  return has_limits(axis) || axis.coulomb_friction > 0 || axis.viscous_friction > 0;
}

int row_count(JointType type) noexcept {
  return type == JointType::spherical ? 3 : coordinate_count(type);
}

bool has_row(const JointDef& joint, int number) noexcept {
  return has_row(axis_of(joint, joint.type == JointType::spherical ? 0 : number));
}

std::string row_label(const JointDef& joint, int number) {
  constexpr const char* kAxes[] = {".x", ".y", ".z"};
  if (joint.type == JointType::spherical) return joint.name + kAxes[number];
  const std::string_view suffix = suffix_of(joint.type, number);
  return suffix.empty() ? joint.name : joint.name + "." + std::string(suffix.substr(1));
}

}  // namespace slew::multibody
