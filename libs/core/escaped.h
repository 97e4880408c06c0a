// SPDX-License-Identifier: Apache-2.0
// Escapes text for HTML, SVG or XML.
#pragma once

#include <string>
#include <string_view>

namespace slew {

// The text with & < > " as entities, fit for an element or a quoted attribute; control characters but the line feed
// become spaces.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace slew
