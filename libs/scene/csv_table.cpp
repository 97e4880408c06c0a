#include "scene/csv_table.h"

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "scene/csv_cells.h"
#include "scene/number.h"

namespace slew::scene {
namespace {

// A plain number in a range, or nothing after a complaint.
std::optional<double> read_cell(const SourceText& source, const Cell& cell, const Range& range, std::string_view what,
                                Report& report) {
  const NumberText number = split_number(cell.text);
  const auto complain = [&](Complaint complaint) { report.add(source.mark_at(cell.byte), "", std::move(complaint)); };
  if (!number.is_number) {
    complain(number.complaint);
  } else if (!number.rest.empty()) {
    complain({fmt::format("'{}' is not a plain number", cell.text), "a number without unit", ""});
  } else if (!range.contains(static_cast<double>(number.value))) {
    complain(
        {fmt::format("{} '{}' is out of range", what, cell.text), fmt::format("{} to {}", range.min, range.max), ""});
  } else {
    return static_cast<double>(number.value);
  }
  return std::nullopt;
}

class TimeTableReader {
 public:
  TimeTableReader(const SourceText& source, Report& report) : source_(source), report_(report) {}

  std::vector<CsvColumn> read() {
    for (const std::vector<Cell>& cells : csv_lines(source_)) {
      if (!has_header_) {
        if (!read_header(cells)) break;
      } else {
        read_row(cells);
      }
    }
    if (!has_header_ && report_.size() == 0)
      report_.add({source_.source, 1, 1}, "", {"the file is empty", "a header time,INPUT,...", ""});
    return std::move(columns_);
  }

 private:
  void complain(const Cell& cell, Complaint complaint) {
    report_.add(source_.mark_at(cell.byte), "", std::move(complaint));
  }

  bool read_header(const std::vector<Cell>& cells) {
    if (cells[0].text != "time" || cells.size() < 2) {
      complain(cells[0], {"the header begins with '" + std::string(cells[0].text) + "'", "time,INPUT,...", ""});
      return false;
    }
    for (std::size_t i = 1; i < cells.size(); ++i) {
      for (const CsvColumn& other : columns_) {
        if (other.name == cells[i].text)
          complain(cells[i], {"'" + other.name + "' is there twice", "one column for an input", ""});
      }
      columns_.push_back({std::string(cells[i].text), source_.mark_at(cells[i].byte), {}});
    }
    has_header_ = true;
    return true;
  }

  void read_row(const std::vector<Cell>& cells) {
    if (cells.size() != columns_.size() + 1) {
      complain(cells[0], {fmt::format("the line has {} cell{}", cells.size(), cells.size() == 1 ? "" : "s"),
                          fmt::format("{} as in the header", columns_.size() + 1), ""});
      return;
    }
    constexpr Range kTime{.min = 0, .max = 1e6, .min_is_open = false, .max_is_open = false};
    constexpr Range kRaw{.min = -1, .max = 1, .min_is_open = false, .max_is_open = false};
    const auto time = read_cell(source_, cells[0], kTime, "time", report_);
    if (!time) return;
    if (*time <= last_time_) {
      complain(cells[0], {"time '" + std::string(cells[0].text) + "' does not lie behind the line before it",
                          "increasing times", ""});
      return;
    }
    last_time_ = *time;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (cells[i + 1].text.empty()) continue;
      if (const auto value = read_cell(source_, cells[i + 1], kRaw, "value", report_))
        columns_[i].points.push_back({*time, *value});
    }
  }

  const SourceText& source_;
  Report& report_;
  bool has_header_ = false;
  double last_time_ = -1;
  std::vector<CsvColumn> columns_;
};

}  // namespace

std::vector<CsvColumn> read_time_table(const SourceText& source, Report& report) {
  return TimeTableReader(source, report).read();
}

}  // namespace slew::scene
