// SPDX-License-Identifier: Apache-2.0
#include "scene/point_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "scene/csv_cells.h"
#include "scene/field_reader.h"

namespace slew::scene {
namespace {

class PointFileReader {
 public:
  PointFileReader(const SourceText& source, const Field& field, UnitSystem& units, Report& report)
      : field_(field), units_(units), report_(report), file_(source, "deflection [mm], force [kN]", units, report) {}

  std::optional<Table> read(const std::vector<std::string>& columns) {
    if (!file_.read_head() || !find_columns(columns)) return std::nullopt;
    for (std::size_t i = 0; i < 2; ++i) {
      if (!scale_[i].take(file_.head()[column_[i]], dimension(i), units_, report_)) return std::nullopt;
    }
    const std::size_t problems = report_.size();
    Table table;
    while (const std::vector<Cell>* cells = file_.next_row()) {
      if (!read_row(*cells, table)) return std::nullopt;
    }
    if (report_.size() > problems) return std::nullopt;
    if (table.empty()) file_.report_file_problem({"the file has a header and no points", "a line for each point", ""});
    return table.empty() ? std::nullopt : std::optional<Table>(std::move(table));
  }

 private:
  [[nodiscard]] Dimension dimension(std::size_t column) const {
    return column == 0 ? field_.dimension : field_.value_dimension;
  }

  bool find_columns(const std::vector<std::string>& columns) {
    const std::vector<ColumnHead>& head = file_.head();
    if (columns.empty()) {
      if (head.size() == 2) return true;
      report_.add(head.front().mark, "",
                  {fmt::format("the header has {} cell{}", head.size(), head.size() == 1 ? "" : "s"),
                   "two, argument and value, or the names of two: {file: FILE, columns: [ARGUMENT, VALUE]}", ""});
      return false;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      const std::optional<std::size_t> found = file_.find_column(columns[i], "");
      if (!found) return false;
      column_[i] = *found;
    }
    return true;
  }

  std::optional<double> value_of(const Cell& cell, std::size_t i) {
    const auto number = file_.number(cell);
    if (!number) return std::nullopt;
    const double value = scale_[i].in_si(*number);
    const std::string& unit = file_.head()[column_[i]].unit;
    if (std::isfinite(value) && (i == 0 || field_.range.contains(value))) return value;
    file_.report_problem(cell, {fmt::format("'{}{}' is out of range", cell.text, unit.empty() ? "" : " " + unit),
                                range_text(field_.range, dimension(i)), ""});
    return std::nullopt;
  }

  bool read_row(const std::vector<Cell>& cells, Table& table) {
    const auto argument = value_of(cells[column_[0]], 0);
    const auto value = value_of(cells[column_[1]], 1);
    if (!argument || !value) return false;
    if (!may_follow(table, *argument, field_)) {
      file_.report_problem(
          cells[column_[0]],
          {fmt::format("'{}' does not lie behind the line before it", cells[column_[0]].text), order_text(field_), ""});
      return false;
    }
    table.push_back({*argument, *value});
    return true;
  }

  const Field& field_;
  UnitSystem& units_;
  Report& report_;
  CsvFile file_;
  std::array<std::size_t, 2> column_ = {0, 1};
  std::array<ColumnScale, 2> scale_;
};

}  // namespace

std::optional<Table> read_point_file(const SourceText& source, const std::vector<std::string>& columns,
                                     const Field& field, UnitSystem& units, Report& report) {
  return PointFileReader(source, field, units, report).read(columns);
}

}  // namespace slew::scene
