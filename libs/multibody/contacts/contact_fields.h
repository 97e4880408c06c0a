// SPDX-License-Identifier: Apache-2.0
// Field tables of the contact Defs. Internal to the library.
#pragma once

#include "multibody/model/field_tables.h"

namespace slew::multibody {

[[nodiscard]] std::span<const ElementType> shape_types() noexcept;  // in the order of contact::ShapeType
[[nodiscard]] std::span<const ElementType> contact_types() noexcept;
[[nodiscard]] std::span<const ElementType> friction_types() noexcept;

}  // namespace slew::multibody
