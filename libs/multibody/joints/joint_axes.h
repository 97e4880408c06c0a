// SPDX-License-Identifier: Apache-2.0
// Numbers and suffixes of joint coordinates for friction, limits and variables.
//
// Number 0 or 1: revolute and prismatic 0; universal about z of frame 1, of frame 2; cylindrical angle, displacement.
// Keys and variables of a coordinate end with its suffix: "limit_min_2", "position_angle".
#pragma once

#include <string>
#include <string_view>

#include "multibody/model/defs.h"

namespace slew::multibody {

// 0, 1 or 2.
[[nodiscard]] int coordinate_count(JointType type) noexcept;

[[nodiscard]] std::string_view suffix_of(JointType type, int number) noexcept;
[[nodiscard]] bool is_angle(JointType type, int number) noexcept;

// The coordinate that a key with a suffix belongs to.
[[nodiscard]] int coordinate_of_key(JointType type, std::string_view key) noexcept;

// Friction and limits of a coordinate.
[[nodiscard]] const JointAxisDef& axis_of(const JointDef& joint, int number) noexcept;
[[nodiscard]] bool has_limits(const JointAxisDef& axis) noexcept;
// True if the axis has friction or limits; the mechanism then has a row for it.
[[nodiscard]] bool has_row(const JointAxisDef& axis) noexcept;

// Rows of friction and limits: one a coordinate; of a spherical joint three, about the axes of frame 1, for its
// friction.
[[nodiscard]] int row_count(JointType type) noexcept;
[[nodiscard]] bool has_row(const JointDef& joint, int number) noexcept;

// Name of the row: the joint's, and for a coordinate with a suffix "Joint.2", "Joint.angle"; of a ball "Joint.x".
[[nodiscard]] std::string row_label(const JointDef& joint, int number);

}  // namespace slew::multibody
