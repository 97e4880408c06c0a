// SPDX-License-Identifier: Apache-2.0
// Words, numbers, texts and signs of a DBC file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slew::devices {

enum class DbcTokenKind : std::uint8_t { word, number, text, sign, broken, end };

struct DbcToken {
  DbcTokenKind kind = DbcTokenKind::end;
  std::string_view text;  // without the quotes of a text; a broken one: its fault
  int line = 0;
  bool begins_line = false;  // in the first column
};

// A number begins with a digit, or a sign directly before one. The last token is `end`.
[[nodiscard]] std::vector<DbcToken> dbc_tokens(std::string_view text);

// UTF-8 as it is; otherwise every byte above 127 as of Windows-1252.
[[nodiscard]] std::string dbc_text(std::string_view bytes);

}  // namespace slew::devices
