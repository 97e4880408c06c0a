#include "scene/csv_cells.h"

#include <utility>

namespace slew::scene {
namespace {

std::vector<Cell> split_line(const SourceText& source, std::size_t begin, std::size_t end) {
  std::vector<Cell> cells;
  const std::string_view text = source.text;
  for (std::size_t start = begin; start <= end;) {
    std::size_t stop = text.find(',', start);
    if (stop == std::string_view::npos || stop > end) stop = end;
    std::size_t first = start, last = stop;
    while (first < last && (text[first] == ' ' || text[first] == '\t')) ++first;
    while (last > first && (text[last - 1] == ' ' || text[last - 1] == '\t' || text[last - 1] == '\r')) --last;
    cells.push_back({text.substr(first, last - first), first});
    start = stop + 1;
  }
  return cells;
}

}  // namespace

std::vector<std::vector<Cell>> csv_lines(const SourceText& source) {
  std::vector<std::vector<Cell>> lines;
  for (std::size_t line = 0; line < source.line_start.size(); ++line) {
    const std::size_t begin = source.line_start[line];
    const std::size_t end = line + 1 < source.line_start.size() ? source.line_start[line + 1] - 1 : source.text.size();
    std::vector<Cell> cells = split_line(source, begin, end);
    const bool is_blank = cells.size() == 1 && cells[0].text.empty();
    if (!is_blank && !cells[0].text.starts_with('#')) lines.push_back(std::move(cells));
  }
  return lines;
}

}  // namespace slew::scene
