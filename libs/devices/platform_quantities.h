// SPDX-License-Identifier: Apache-2.0
// Quantities of a motion platform by name: what its packets can have, and what a monitor shows.
#pragma once

#include <span>
#include <string_view>

#include "devices/motion_platform.h"

namespace slew::devices {

struct PlatformQuantity {
  std::string_view name, unit, doc;
  double (*value)(const MotionPlatformState& state) noexcept = nullptr;
};

// leg_1 to leg_6 first.
[[nodiscard]] std::span<const PlatformQuantity> platform_quantities() noexcept;
// Null: there is none of the name.
[[nodiscard]] const PlatformQuantity* find_platform_quantity(std::string_view name) noexcept;

}  // namespace slew::devices
