// SPDX-License-Identifier: Apache-2.0
// Signs of YAML inside of `${...}`, which are text there: `[${min(a, b)}, 0, 0]` needs no quotes.
//
// While YAML is parsed, a character of a private plane stands for each of these signs, one for one, so that columns
// stay. An expression ends at the next `}` of its line and has no quotes.
#pragma once

#include <string>
#include <string_view>

namespace slew::scene {

// First bytes of the characters that stand for signs: U+F0000 to U+F003F.
inline constexpr std::string_view kSignPlane = "\xF3\xB0\x80";

// The text with the signs of its expressions replaced; empty: it has none.
[[nodiscard]] std::string without_signs(std::string_view text);

void restore_signs(std::string& text);

}  // namespace slew::scene
