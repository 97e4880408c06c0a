// SPDX-License-Identifier: Apache-2.0
// Colours and lines of a mechanism's picture.
#pragma once

#include <string>
#include <string_view>

#include "core/field.h"

namespace slew::analysis {

inline constexpr int kShades = 5;  // of a face, by its angle to the view

// A colour "#1b6ca8" mixed with a share of white, 0 .. 1.
[[nodiscard]] std::string with_white(std::string_view colour, double white);

// Red, green and blue, 0 .. 1, as "#1b6ca8"; empty for the colours of a file.
[[nodiscard]] std::string hex_colour(const Triple& colour);

// Styles of a mechanism's parts, beside plotting::kStyle and diagram::kDiagramStyle.
[[nodiscard]] std::string mechanism_style();

}  // namespace slew::analysis
