// SPDX-License-Identifier: Apache-2.0
// Time tables as CSV: a header with `time` and names of columns, then one line for each time.
//
//   time [ms]; Stick [%]; Boom.position.y [m]
//   0; 0; 1,25
//   500; 100; 1,31
//   500; -100; 1,31        a second row at one time is a jump
// Without a unit times are in seconds and values plain numbers. An empty cell gives no point; before the first point of
// a column its value is 0, after the last one it is held. csv_cells.h describes such files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/field.h"
#include "scene/csv_cells.h"
#include "scene/diagnostic.h"
#include "scene/source.h"

namespace slew::scene {

struct CsvColumn {
  std::size_t index = 0;  // in TimeTable::head()
  Table points;           // time [s], value -1..1; two may have the same time
  double begin = 0;       // s, time of the first value in the file; the points may begin earlier, with 0
};

class TimeTable {
 public:
  TimeTable(const SourceText& source, UnitSystem& units, Report& report)
      : source_(source), units_(units), report_(report), file_(source, "time [s],Stick", units, report) {}

  // Reads the header. False after a reported problem.
  [[nodiscard]] bool read_head();
  [[nodiscard]] const std::vector<ColumnHead>& head() const noexcept { return file_.head(); }
  [[nodiscard]] bool is_time(std::size_t column) const noexcept { return column == time_; }

  // The columns with these indices in head(). Empty after a reported problem.
  [[nodiscard]] std::vector<CsvColumn> read(const std::vector<std::size_t>& columns);

 private:
  [[nodiscard]] bool take_scales(const std::vector<std::size_t>& columns);
  void read_row(const std::vector<Cell>& cells);
  [[nodiscard]] bool is_behind(const Cell& cell, double time);
  void finish();

  const SourceText& source_;
  UnitSystem& units_;
  Report& report_;
  CsvFile file_;
  std::size_t time_ = 0;
  ColumnScale time_scale_;
  std::vector<ColumnScale> scales_;
  std::vector<CsvColumn> columns_;
  std::size_t rows_ = 0;
  double last_time_ = -1;
  bool is_jump_ = false;  // the row before was the second one at its time
};

}  // namespace slew::scene
