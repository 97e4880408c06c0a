// Lines, cells and numbers of a CSV file as spreadsheets, measuring programs and this program write it.
//
// The first line decides what separates cells: ';' where it has one, else the more frequent of tab and comma; or a line
// "sep=;" in front of it does. Cells may stand in double quotes ("" is one of them), within a line. Blank lines and
// lines that begin with # are skipped, empty cells behind the last column as well. Where cells are not separated by
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

inline constexpr std::size_t kMaxTableBytes = 256'000'000;  // of a CSV file
inline constexpr std::size_t kMaxTableRows = 5'000'000;

struct Cell {
  std::string_view text;  // without spaces and quotes around it
  std::size_t byte = 0;
};

// Name and unit of a column: "deflection [mm]".
struct ColumnHead {
  std::string name;
  std::string unit;  // empty: none is given
  Mark mark;
};

class CsvFile {
 public:
  // The texts must live as long as this. example: of a header, for messages.
  CsvFile(const SourceText& source, std::string_view example, Report& report)
      : source_(source), example_(example), report_(report) {}

  // Reads the header. False after a complaint.
  [[nodiscard]] bool read_head();
  [[nodiscard]] const std::vector<ColumnHead>& head() const noexcept { return head_; }

  // The next line of as many cells as the header has, valid until the next call. Null at the end of the file, and after
  // a complaint about the line or when the file has given enough of them.
  [[nodiscard]] const std::vector<Cell>* next_row();

  // The number in a cell; nothing after a complaint.
  [[nodiscard]] std::optional<long double> number(const Cell& cell);

  void complain(const Cell& cell, Complaint complaint);
  void complain_of_file(Complaint complaint) { report_.add({source_.source, 1, 1}, "", std::move(complaint)); }

 private:
  [[nodiscard]] bool next_line();
  [[nodiscard]] bool split(std::size_t begin, std::size_t end);
  [[nodiscard]] std::size_t read_quoted(std::size_t open, std::size_t end);
  [[nodiscard]] bool read_column_head(const Cell& cell);
  [[nodiscard]] std::string_view with_decimal_point(const Cell& cell);

  const SourceText& source_;
  std::string_view example_;
  Report& report_;
  std::size_t line_ = 0;  // of the next one
  std::size_t rows_ = 0;
  std::size_t complaints_ = 0;
  char separator_ = 0;  // 0: not known yet
  char decimal_ = 0;    // mark that the file has used
  Mark decimal_mark_;
  std::vector<ColumnHead> head_;
  std::vector<Cell> cells_;
  std::deque<std::string> unquoted_;  // cells of the line that held ""
  std::string number_;
};

// The values of one column in SI.
class ColumnScale {
 public:
  // False after a complaint: no unit of this dimension.
  [[nodiscard]] bool take(const ColumnHead& head, Dimension dimension, UnitSystem& units, Report& report);
  [[nodiscard]] double in_si(long double number) const noexcept;

 private:
  std::optional<Unit> unit_;
};

}  // namespace slew::scene
