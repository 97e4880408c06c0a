// Time tables as CSV: a header `time,NAME,NAME,...`, then one line for each time in seconds.
#pragma once

#include <string>
#include <vector>

#include "core/field.h"
#include "scene/diagnostic.h"
#include "scene/source.h"

namespace slew::scene {

struct CsvColumn {
  std::string name;
  Mark mark;     // of the name in the header
  Table points;  // time [s], value -1..1
};

// Separators are commas; blank lines and lines that begin with # are skipped. An empty cell is no point of its column.
// Problems go to the report; the columns then are incomplete.
[[nodiscard]] std::vector<CsvColumn> read_time_table(const SourceText& source, Report& report);

}  // namespace slew::scene
