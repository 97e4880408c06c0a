// SPDX-License-Identifier: Apache-2.0
// Masses that parts and joints carry, as a scene states them. Frames as in model/defs.h.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/field.h"

namespace slew::multibody {

// Mass that one body carries, placed in the frame of another as it is at the start.
struct PartDummyDef {
  std::string name{};
  std::string relative_to = "Ground";  // body that position and orientation refer to
  std::string carried_by{};            // body that it is fixed to
  Triple position{};                   // m
  Triple orientation{};                // rad, Euler z-x'-z''
  double mass = 0;                     // kg
  Triple center_of_mass{};             // m, dummy's frame
  Triple inertia{};                    // kg m2 about the centre of mass, dummy's frame
};

// Mass of a joint's own part, fixed to the joint's frame on body 1 or on body 2.
struct ConstraintDummyDef {
  std::string name{};
  std::string relative_to{};  // joint
  std::int64_t index = 1;     // 1: frame on body 1, 2: frame on body 2
  Triple position{};          // m, in the joint's frame
  Triple orientation{};       // rad, Euler z-x'-z''
  double mass = 0;            // kg
  Triple center_of_mass{};    // m, dummy's frame
  Triple inertia{};           // kg m2 about the centre of mass, dummy's frame
};

[[nodiscard]] std::span<const Field> part_dummy_fields() noexcept;
[[nodiscard]] std::span<const Field> constraint_dummy_fields() noexcept;

}  // namespace slew::multibody
