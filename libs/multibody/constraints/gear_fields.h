// SPDX-License-Identifier: Apache-2.0
// Field tables of gears. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/field_tables.h"

namespace slew::multibody {

// By GearKind.
[[nodiscard]] std::span<const ElementType> gear_types() noexcept;

}  // namespace slew::multibody
