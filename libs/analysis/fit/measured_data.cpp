// SPDX-License-Identifier: Apache-2.0
#include "analysis/fit/measured_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "scene/csv_cells.h"
#include "scene/diagnostic.h"
#include "scene/scene.h"
#include "scene/source.h"

namespace slew::analysis {
namespace {

constexpr std::string_view kHeader = "time [s],p_A [bar]";

class DataReader {
 public:
  DataReader(const scene::SourceText& source, const std::vector<std::string>& names, scene::Report& report)
      : report_(report), file_(source, kHeader, units_, report), names_(names) {}

  std::vector<MeasuredSignal> read() {
    if (!file_.read_head()) return {};
    const bool has_time = find_column("time", time_);
    for (const std::string& name : names_) {
      Column column;
      if (find_column(name, column)) columns_.push_back(column);
      signals_.push_back(
          {.name = name, .has_unit = column.has_unit, .exponent = column.unit.exponent, .time = {}, .value = {}});
    }
    if (!has_time || columns_.size() < names_.size()) return {};
    std::size_t problems = report_.size();
    while (report_.size() < problems + scene::kMaxReportedProblems) {
      const std::size_t before = report_.size();
      const std::vector<scene::Cell>* cells = file_.next_row();
      if (cells != nullptr) {
        read_row(*cells);
      } else if (report_.size() == before) {
        break;
      }
    }
    for (const MeasuredSignal& signal : signals_) {
      if (signal.time.empty()) file_.report_file_problem({"'" + signal.name + "' has no values", "at least one", ""});
    }
    return std::move(signals_);
  }

 private:
  struct Column {
    std::size_t index = 0;
    scene::Unit unit{};
    bool has_unit = false;
  };

  bool find_column(const std::string& name, Column& column) {
    const std::optional<std::size_t> found = file_.find_column(name, fmt::format("a header such as '{}'", kHeader));
    if (!found) return false;
    column.index = *found;
    const scene::ColumnHead* const at = &file_.head()[*found];
    if (!at->problem.what.empty()) {
      report_.add(at->mark, "", at->problem);
      return false;
    }
    if (at->unit.empty()) return true;
    const scene::Unit* unit = units_.find(at->unit);
    if (unit == nullptr || unit->has_other_base) {
      report_.add(at->mark, "", {"unknown unit '" + at->unit + "'", "a unit such as bar, mm or kN", ""});
      return false;
    }
    column.unit = *unit;
    column.has_unit = true;
    return true;
  }

  void read_row(const std::vector<scene::Cell>& cells) {
    const scene::Cell& time_cell = cells[time_.index];
    const std::optional<long double> time = file_.number(time_cell);
    if (!time) return;
    const auto t = static_cast<double>(*time * time_.unit.scale + time_.unit.offset);
    if (t < last_time_ || t < 0) {
      file_.report_problem(time_cell,
                           {fmt::format("time '{}' is negative or lies before that of the row above", time_cell.text),
                            "times from 0 that do not fall", ""});
      return;
    }
    last_time_ = t;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const scene::Cell& cell = cells[columns_[i].index];
      if (cell.text.empty()) continue;
      const std::optional<long double> number = file_.number(cell);
      if (!number) continue;
      signals_[i].time.push_back(t);
      signals_[i].value.push_back(static_cast<double>(*number * columns_[i].unit.scale + columns_[i].unit.offset));
    }
  }

  scene::Report& report_;
  scene::UnitSystem units_;
  scene::CsvFile file_;
  const std::vector<std::string>& names_;
  Column time_;
  std::vector<Column> columns_;
  std::vector<MeasuredSignal> signals_;
  double last_time_ = 0;
};

}  // namespace

std::vector<MeasuredSignal> read_measured(const std::string& file, const std::vector<std::string>& names) {
  return scene::guarded(file, [&] {
    scene::Report report;
    const int index = report.add_source(file);
    const std::optional<scene::SourceText> source = scene::read_source(file, index, report, scene::kMaxTableBytes);
    std::vector<MeasuredSignal> signals;
    if (source) signals = DataReader(*source, names, report).read();
    if (!report.is_clean()) report.fail(scene::kMaxReportedProblems);
    return signals;
  });
}

}  // namespace slew::analysis
