// SPDX-License-Identifier: Apache-2.0
// Reading a scene's files: size and kind are checked before a byte is read, the bytes before they are parsed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/diagnostic.h"

namespace slew::scene {

inline constexpr std::size_t kMaxFileBytes = 10'000'000;

// Text of one source with the byte offsets of its lines, for marks in characters.
struct SourceText {
  int source = 0;
  std::string text;
  std::vector<std::size_t> line_start;

  // Mark of a byte: line and column from 1, column counted in characters.
  [[nodiscard]] Mark mark_at(std::size_t byte) const;
  // Byte of a mark's line and column; at most the size of the text.
  [[nodiscard]] std::size_t byte_of(const Mark& mark) const;
};

// Reads a regular file of at most `most` bytes; a problem goes to the report and the result is empty.
[[nodiscard]] std::optional<SourceText> read_source(const std::string& path, int source, Report& report,
                                                    std::size_t most = kMaxFileBytes);

// Checks text that is already in memory: size, UTF-8, no NUL or control characters. A UTF-8 byte order mark is dropped.
[[nodiscard]] std::optional<SourceText> check_source(std::string text, int source, Report& report,
                                                     std::size_t most = kMaxFileBytes);

// The fault of a text with resolved escapes, by the same rules; empty: none.
[[nodiscard]] std::string text_problem(std::string_view text);

}  // namespace slew::scene
