// SPDX-License-Identifier: Apache-2.0
// Field tables of prescribed motion. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/field_tables.h"

namespace slew::multibody {

// By MotionKind, then by MotionShape.
[[nodiscard]] std::span<const ElementType> motion_types() noexcept;
inline constexpr std::size_t kMotionShapes = 4;
[[nodiscard]] constexpr std::size_t motion_type_index(const MotionDef& motion) noexcept {
  return static_cast<std::size_t>(motion.kind) * kMotionShapes + static_cast<std::size_t>(motion.shape);
}

}  // namespace slew::multibody
