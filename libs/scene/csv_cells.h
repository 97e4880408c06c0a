// SPDX-License-Identifier: Apache-2.0
// Lines, cells and numbers of CSV files from spreadsheets, measuring programs and this program.
//
// The first line determines the separator: ';' if present, else the more frequent of tab and comma; a line "sep=;" in
// front of it takes precedence. Cells may stand in double quotes ("" is a quote character), within a line. Blank lines
// and lines that begin with # are skipped, empty cells behind the last column as well. Where cells are not separated by
// commas a number may have a decimal comma; a file has one kind of decimal mark.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/diagnostic.h"
#include "scene/source.h"
#include "scene/units.h"

namespace slew::scene {

inline constexpr std::size_t kMaxTableBytes = 256'000'000;  // limit of a CSV file
inline constexpr std::size_t kMaxTableRows = 5'000'000;

struct Cell {
  std::string_view text;  // without spaces and quotes around it
  std::size_t byte = 0;
};

// Name and unit of a column: "deflection [mm]", "deflection (mm) filtered". Text in round brackets that is no unit is
// part of the name.
struct ColumnHead {
  std::string text;  // the header's whole cell
  std::string name;  // what stands before the unit
  std::string unit;  // empty: no unit
  Mark mark;
  ValueProblem problem;  // of the unit; empty: none. Matters where the column is taken.
};

class CsvFile {
 public:
  // The arguments must outlive the object. example: a header, for messages.
  CsvFile(const SourceText& source, std::string_view example, UnitSystem& units, Report& report)
      : source_(source), example_(example), units_(units), report_(report) {}

  // Reads the header. False after a reported problem.
  [[nodiscard]] bool read_head();
  [[nodiscard]] const std::vector<ColumnHead>& head() const noexcept { return head_; }
  // The one column with this name. None after a reported problem.
  [[nodiscard]] std::optional<std::size_t> find_column(std::string_view name, std::string expected);

  // The next line with as many cells as the header, valid until the next call. Null at the end of the file, after a
  // problem in the line, or after the limit of reported problems.
  [[nodiscard]] const std::vector<Cell>* next_row();

  // The number in a cell; nothing after a reported problem.
  [[nodiscard]] std::optional<long double> number(const Cell& cell);

  void report_problem(const Cell& cell, ValueProblem problem);
  void report_file_problem(ValueProblem problem) { report_.add({source_.source, 1, 1}, "", std::move(problem)); }

 private:
  [[nodiscard]] bool next_line();
  [[nodiscard]] bool split(std::size_t begin, std::size_t end);
  [[nodiscard]] std::size_t read_quoted(std::size_t open, std::size_t end);
  [[nodiscard]] bool read_column_head(const Cell& cell);
  [[nodiscard]] std::string_view with_decimal_point(const Cell& cell);

  const SourceText& source_;
  std::string_view example_;
  UnitSystem& units_;
  Report& report_;
  std::size_t line_ = 0;  // number of the next line
  std::size_t rows_ = 0;
  std::size_t problem_count_ = 0;
  char separator_ = 0;  // 0: not determined yet
  char decimal_ = 0;    // decimal mark found in the file
  Mark decimal_mark_;
  std::vector<ColumnHead> head_;
  std::vector<Cell> cells_;
  std::deque<std::string> unquoted_;  // cells of the line that held ""
  std::string number_;
};

// The values of one column in SI.
class ColumnScale {
 public:
  // False after a reported problem: no unit of this dimension, or one outside of brackets.
  [[nodiscard]] bool take(const ColumnHead& head, Dimension dimension, UnitSystem& units, Report& report);
  [[nodiscard]] double in_si(long double number) const noexcept;

 private:
  std::optional<Unit> unit_;
};

}  // namespace slew::scene
