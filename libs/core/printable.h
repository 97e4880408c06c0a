// SPDX-License-Identifier: Apache-2.0
// Foreign text on a terminal: file contents, names from the wire, messages that quote them.
//
// Control characters (C0, DEL, C1), those that change the direction or the line (U+061C, U+200E, U+200F, U+2028 to
// U+202E, U+2066 to U+2069) and bytes that are no UTF-8 are shown as \xNN, byte by byte: the terminal would execute the
// first and display the second misleadingly.
#pragma once

#include <string>
#include <string_view>

namespace slew {

// The whole text in one line.
[[nodiscard]] std::string printable(std::string_view text);
// The same, keeping line feeds.
[[nodiscard]] std::string printable_lines(std::string_view text);
// True if no byte would be shown as \xNN.
[[nodiscard]] bool is_printable(std::string_view text);

// Length of the UTF-8 sequence at text[at] (Unicode 15, table 3-7), 0 when it is malformed.
[[nodiscard]] std::size_t sequence_length(std::string_view text, std::size_t at);

}  // namespace slew
