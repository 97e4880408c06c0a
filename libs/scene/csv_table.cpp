// SPDX-License-Identifier: Apache-2.0
#include "scene/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "scene/scene.h"

namespace slew::scene {
namespace {

constexpr Range kTime{.min = 0, .max = 1e6, .min_is_open = false, .max_is_open = false};
constexpr Range kRaw{.min = -1, .max = 1, .min_is_open = false, .max_is_open = false};

bool is_time_name(std::string_view name) {
  constexpr std::string_view kName = "time";
  return std::equal(name.begin(), name.end(), kName.begin(), kName.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

}  // namespace

bool TimeTable::read_head() {
  if (!file_.read_head()) return false;
  const std::vector<ColumnHead>& head = file_.head();
  const auto time = std::find_if(head.begin(), head.end(), [](const ColumnHead& h) { return is_time_name(h.name); });
  if (time == head.end()) {
    report_.add(head.front().mark, "", {"no column of the header is 'time'", "a header such as 'time [s],Stick'", ""});
    return false;
  }
  time_ = static_cast<std::size_t>(time - head.begin());
  return true;
}

bool TimeTable::take_scales(const std::vector<std::size_t>& columns) {
  bool is_good = time_scale_.take(head()[time_], Dimension::time, units_, report_);
  for (const std::size_t column : columns) {
    for (const CsvColumn& other : columns_) {
      if (head()[other.index].name != head()[column].name) continue;
      report_.add(head()[column].mark, "",
                  {"'" + head()[column].name + "' is there twice", "one column for a name", ""});
      is_good = false;
    }
    columns_.push_back({.index = column, .points = {}});
    is_good = scales_.emplace_back().take(head()[column], Dimension::none, units_, report_) && is_good;
  }
  return is_good;
}

std::vector<CsvColumn> TimeTable::read(const std::vector<std::size_t>& columns) {
  const std::size_t problems = report_.size();
  if (!take_scales(columns)) return {};
  while (report_.size() < problems + kMaxReportedProblems) {
    const std::size_t before = report_.size();
    const std::vector<Cell>* cells = file_.next_row();
    if (cells != nullptr) {
      read_row(*cells);
    } else if (report_.size() == before) {
      break;
    }
  }
  if (report_.size() == problems) finish();
  return report_.size() == problems ? std::move(columns_) : std::vector<CsvColumn>();
}

// A second row at one time is a jump; a third would have no effect.
bool TimeTable::is_behind(const Cell& cell, double time) {
  const bool is_jump = time == last_time_;
  if (time < last_time_ || (is_jump && is_jump_)) {
    const char* what = is_jump ? "time '{}' stands in a third row" : "time '{}' lies before that of the row above";
    file_.report_problem(cell, {fmt::format(fmt::runtime(what), cell.text),
                                "times that do not fall; two rows at one time are a jump", ""});
    return false;
  }
  is_jump_ = is_jump;
  last_time_ = time;
  return true;
}

void TimeTable::read_row(const std::vector<Cell>& cells) {
  ++rows_;
  const auto number = file_.number(cells[time_]);
  if (!number) return;
  const double time = time_scale_.in_si(*number);
  if (!kTime.contains(time)) {
    file_.report_problem(cells[time_], {fmt::format("time '{}' is out of range", cells[time_].text),
                                        fmt::format("{} to {} s", kTime.min, kTime.max), ""});
    return;
  }
  if (!is_behind(cells[time_], time)) return;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Cell& cell = cells[columns_[i].index];
    if (cell.text.empty()) continue;
    const auto raw = file_.number(cell);
    if (!raw) continue;
    const double value = scales_[i].in_si(*raw);
    if (kRaw.contains(value)) {
      columns_[i].points.push_back({time, value});
    } else {
      file_.report_problem(cell, {fmt::format("value '{}' is out of range", cell.text),
                                  fmt::format("{} to {}", kRaw.min, kRaw.max), ""});
    }
  }
}

// Checks the file as a whole, and fills the time before the record.
void TimeTable::finish() {
  if (rows_ == 0) {
    file_.report_file_problem({"the file has a header and no rows", "a line for each time", ""});
    return;
  }
  for (CsvColumn& column : columns_) {
    Table& points = column.points;
    if (points.empty()) {
      report_.add(head()[column.index].mark, "",
                  {"the column '" + head()[column.index].name + "' has no values", "a value in some row", ""});
      continue;
    }
    const auto [time, value] = points.front();
    column.begin = time;
    if (time == 0 || value == 0) continue;
    // a jump at the start begins at 0: the first of its two values would have no duration
    if (points.size() > 1 && points[1][0] == time) points.erase(points.begin());
    points.insert(points.begin(), {{0, 0}, {time, 0}});
  }
}

}  // namespace slew::scene
