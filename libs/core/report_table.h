// SPDX-License-Identifier: Apache-2.0
// A table of a report: its columns are stated once, and text, CSV, JSON and HTML are made from them.
//
//   ReportTable table({{"variable", "variable", "name"}, {"range", "range [m]", "range"}});
//   table.add({variable.name, {quantity_text(variable.range, "m"), variable.range}});
//   std::fputs(table.text().c_str(), stdout);
//
// A cell has a text for users and an exact value for programs. Text and HTML show the text, CSV and JSON the value.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/json.h"

namespace slew {

// Column name in each form. A form without a name omits the column; an empty name gives a column without a heading.
struct ReportColumn {
  std::optional<std::string> text{};  // heading in the text and in HTML
  std::optional<std::string> csv{};   // heading in CSV, with the unit
  std::optional<std::string> json{};  // member of a row's object
};

struct ReportCell {
  ReportCell(std::string shown) : text(std::move(shown)), exact(text) {}
  ReportCell(const char* shown) : ReportCell(std::string(shown)) {}
  ReportCell(std::string shown, Json value) : text(std::move(shown)), exact(std::move(value)) {}

  std::string text;
  Json exact;  // number, text or null
};

class ReportTable {
 public:
  // naming: the first columns in the text that name a row, such as formulation and step.
  explicit ReportTable(std::vector<ReportColumn> columns, std::size_t naming = 1);
  // For text and HTML alone.
  explicit ReportTable(std::initializer_list<const char*> headings, std::size_t naming = 1);

  // Adds one cell per column, in column order. A row may end early: its last cells are then omitted, or null.
  void add(std::vector<ReportCell> row);

  // Lines of columns aligned by spaces, two between them; the last cell of a line is not padded. Lengths are counted in
  // characters of UTF-8. The line of headings is left out when all of them are empty.
  // width [characters]: limit of the line length; 0: no limit. A wider table is split into blocks below each other with
  // an empty line between them. Each block repeats the naming columns, or as many as fit, at least one. A line exceeds
  // the width only in a block with a single further column that does not fit.
  [[nodiscard]] std::string text(std::string_view indent = "", std::size_t width = 0) const;

  // Comma-separated values (RFC 4180) with a line of headings. Doubles have the fewest digits that reproduce them; null
  // and non-finite values are empty.
  [[nodiscard]] std::string csv() const;

  // An array with an object for each row.
  [[nodiscard]] Json json() const;

  // An element <table> with the columns of the text.
  [[nodiscard]] std::string html() const;

 private:
  std::vector<ReportColumn> columns_;
  std::size_t naming_;
  std::vector<std::vector<ReportCell>> rows_;
};

}  // namespace slew
