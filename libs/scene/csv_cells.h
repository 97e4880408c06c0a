// Cells of a CSV file: separators are commas; blank lines and lines that begin with # are skipped.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "scene/source.h"

namespace slew::scene {

struct Cell {
  std::string_view text;  // without spaces around it
  std::size_t byte = 0;
};

// The lines that hold something; the views are into the source's text.
[[nodiscard]] std::vector<std::vector<Cell>> csv_lines(const SourceText& source);

}  // namespace slew::scene
