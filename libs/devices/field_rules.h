// SPDX-License-Identifier: Apache-2.0
// Rules that a field table states, for definitions of devices: ranges, required texts, numbers that are finite.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/field.h"
#include "core/problem.h"

namespace slew::devices {

// Appends a problem for each member of the Def that breaks its row.
void check_fields(std::string_view path, const void* def, std::span<const Field> fields, Problems& problems);

// Letters, digits and _, no digit first, at most 63 characters: fit for scenes and for C.
[[nodiscard]] bool is_identifier(std::string_view name) noexcept;

}  // namespace slew::devices
