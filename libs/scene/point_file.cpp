#include "scene/point_file.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "scene/csv_cells.h"
#include "scene/field_reader.h"
#include "scene/number.h"

namespace slew::scene {
namespace {

class PointFileReader {
 public:
  PointFileReader(const SourceText& source, const Field& field, UnitSystem& units, Report& report)
      : source_(source), field_(field), units_(units), report_(report) {}

  std::optional<Table> read() {
    const std::vector<std::vector<Cell>> lines = csv_lines(source_);
    if (lines.empty() || !read_header(lines.front())) {
      if (lines.empty()) report_.add({source_.source, 1, 1}, "", {"the file is empty", kHeader, ""});
      return std::nullopt;
    }
    Table table;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      if (!read_line(lines[i], table)) return std::nullopt;
    }
    if (table.empty()) report_.add({source_.source, 1, 1}, "", {"the file has no points", "lines argument, value", ""});
    return table.empty() ? std::nullopt : std::optional<Table>(std::move(table));
  }

 private:
  static constexpr const char* kHeader = "a header such as 'deflection [mm], force [kN]'";

  bool complain(const Cell& cell, Complaint complaint) {
    report_.add(source_.mark_at(cell.byte), "", std::move(complaint));
    return false;
  }

  bool read_header(const std::vector<Cell>& cells) {
    if (cells.size() != 2) {
      return complain(cells[0], {fmt::format("the header has {} cell{}", cells.size(), cells.size() == 1 ? "" : "s"),
                                 "two: argument and value", ""});
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (split_number(cells[i].text).is_number) {
        return complain(cells[i], {fmt::format("the file begins with the number '{}'", cells[i].text), kHeader, ""});
      }
      const std::size_t open = cells[i].text.find('[');
      if (open == std::string_view::npos) continue;
      if (!cells[i].text.ends_with(']')) return complain(cells[i], {"this '[' is not closed", kHeader, ""});
      unit_[i] = cells[i].text.substr(open + 1, cells[i].text.size() - open - 2);
    }
    return true;
  }

  std::optional<double> read_cell(const Cell& cell, std::size_t column) {
    const Dimension dimension = column == 0 ? field_.dimension : field_.value_dimension;
    const NumberText number = split_number(cell.text);
    if (!number.is_number || !number.rest.empty()) {
      complain(cell, {fmt::format("'{}' is not a plain number", cell.text), "a number; its unit is in the header", ""});
      return std::nullopt;
    }
    const std::string text = std::string(cell.text) + (unit_[column].empty() ? "" : " " + std::string(unit_[column]));
    QuantityResult quantity = read_quantity(text, Writing::plain, dimension, units_);
    if (!quantity.value) {
      complain(cell, std::move(quantity.complaint));
    } else if (column == 1 && !field_.range.contains(*quantity.value)) {
      complain(cell, {fmt::format("'{}' is out of range", text), range_text(field_.range, dimension), ""});
      return std::nullopt;
    }
    return quantity.value;
  }

  bool read_line(const std::vector<Cell>& cells, Table& table) {
    if (cells.size() != 2) {
      return complain(cells[0], {fmt::format("the line has {} cell{}", cells.size(), cells.size() == 1 ? "" : "s"),
                                 "two: argument and value", ""});
    }
    const auto argument = read_cell(cells[0], 0);
    const auto value = read_cell(cells[1], 1);
    if (!argument || !value) return false;
    if (!table.empty() && !(*argument > table.back()[0])) {
      return complain(cells[0], {fmt::format("'{}' does not lie behind the line before it", cells[0].text),
                                 "increasing arguments", ""});
    }
    table.push_back({*argument, *value});
    return true;
  }

  const SourceText& source_;
  const Field& field_;
  UnitSystem& units_;
  Report& report_;
  std::string_view unit_[2];
};

}  // namespace

std::optional<Table> read_point_file(const SourceText& source, const Field& field, UnitSystem& units, Report& report) {
  return PointFileReader(source, field, units, report).read();
}

}  // namespace slew::scene
