// SPDX-License-Identifier: Apache-2.0
// Field tables of the thirteen joints, in the order of JointType. Internal to the library.
#pragma once

#include <span>

#include "multibody/model/field_tables.h"

namespace slew::multibody {

[[nodiscard]] std::span<const ElementType> joint_types() noexcept;

}  // namespace slew::multibody
