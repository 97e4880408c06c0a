// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "analysis/parameter_sweep/parameter_sweep.h"
#include "core/display.h"
#include "core/report_table.h"

namespace slew::analysis {
namespace {

// rows of the table for users; files have all
constexpr std::size_t kMostShownRows = 40, kFirstRows = 20;

std::string bracketed(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : fmt::format("{} [{}]", text, unit);
}

// six digits of the number of a row's value
std::string short_value(const Variation& variation, const std::string& value) {
  const std::optional<double> number = number_of(variation, value);
  if (!number || !variation.range) return value;
  return fmt::format("{}{}{}", digits_text(*number, 6), variation.unit.empty() ? "" : " ", variation.unit);
}

std::string result_of(const SweptRow& row) {
  if (!row.is_done) return "not run";
  std::string text =
      row.has_failed() ? fmt::format("code {}: {}", static_cast<int>(row.outcome.code), row.outcome.message) : "ok";
  if (row.is_foreign) text += " (other build or processor)";
  return text;
}

std::string text_in(const SweptMeasure& measure, double value) {
  return quantity_text(value, measure.unit, measure.variable);
}

ReportTable rows_table(const ParameterSweep& sweep, const std::vector<std::size_t>& rows) {
  std::vector<ReportColumn> columns = {{"row", "row", "row"}};
  for (const Variation& variation : sweep.variations) {
    columns.push_back({variation.path, bracketed(variation.path, variation.unit), {}});
  }
  for (const SweptMeasure& measure : sweep.measures) {
    columns.push_back({measure.text, bracketed(measure.text, measure.unit), {}});
  }
  columns.push_back({"result", {}, {}});
  for (const char* name : {"code", "message", "steps not converged", "state hash", "build", "self test"}) {
    columns.push_back({.csv = name});
  }
  ReportTable table(std::move(columns));
  for (const std::size_t i : rows) {
    const SweptRow& row = sweep.rows[i];
    const RowOutcome& outcome = row.outcome;
    std::vector<ReportCell> cells = {ReportCell(std::to_string(i), Json(i))};
    for (std::size_t v = 0; v < sweep.variations.size(); ++v) {
      const std::string& value = row.settings[v].second;
      const std::optional<double> number = number_of(sweep.variations[v], value);
      cells.emplace_back(short_value(sweep.variations[v], value), number ? Json(*number) : Json(value));
    }
    for (std::size_t m = 0; m < sweep.measures.size(); ++m) {
      const std::optional<double> value = m < outcome.values.size() ? outcome.values[m] : std::nullopt;
      cells.push_back(value ? ReportCell(text_in(sweep.measures[m], *value), Json(*value)) : ReportCell("-", Json()));
    }
    cells.emplace_back(result_of(row));
    cells.emplace_back("", static_cast<int>(outcome.code));
    for (const std::string& text : {outcome.message, std::to_string(outcome.not_converged), outcome.state_hash,
                                    outcome.fingerprint.build, outcome.fingerprint.self_test}) {
      cells.emplace_back(text);
    }
    table.add(std::move(cells));
  }
  return table;
}

std::vector<std::size_t> all_rows(const ParameterSweep& sweep) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < sweep.rows.size(); ++i) {
    if (sweep.rows[i].is_done) rows.push_back(i);
  }
  return rows;
}

// All rows, or of many the first ones and those that failed.
std::vector<std::size_t> shown_rows(const ParameterSweep& sweep) {
  const std::vector<std::size_t> all = all_rows(sweep);
  if (all.size() <= kMostShownRows) return all;
  std::vector<std::size_t> rows(all.begin(), all.begin() + kFirstRows);
  for (std::size_t i = kFirstRows; i < all.size() && rows.size() < kMostShownRows; ++i) {
    if (sweep.rows[all[i]].has_failed()) rows.push_back(all[i]);
  }
  return rows;
}

std::string interval_text(const std::optional<Interval>& interval, const SweptMeasure& measure) {
  if (!interval) return "-";
  return fmt::format("{} .. {}", text_in(measure, interval->low), text_in(measure, interval->high));
}

// statistics of a grid would describe the grid
std::string statistics_text(const ParameterSweep& sweep, std::size_t width) {
  if (sweep.sampling == Sampling::grid) return "";
  ReportTable table({"measure", "rows", "mean", "deviation", "95 % interval of the mean"});
  for (std::size_t m = 0; m < sweep.measures.size(); ++m) {
    const SampleStatistics statistics = statistics_of(sweep, m);
    if (statistics.count == 0) continue;
    const SweptMeasure& measure = sweep.measures[m];
    table.add({measure.text, std::to_string(statistics.count), text_in(measure, statistics.mean),
               statistics.count > 1 ? text_in(measure, statistics.deviation) : "-",
               interval_text(statistics.interval, measure)});
  }
  return '\n' + table.text("", width);
}

std::string correlation_text(const std::optional<Correlation>& correlation) {
  if (!correlation) return "-";
  std::string text = decimals_text(correlation->value, 2);
  if (correlation->interval) {
    text += fmt::format(" ({} .. {})", decimals_text(correlation->interval->low, 2),
                        decimals_text(correlation->interval->high, 2));
  }
  return text;
}

std::string correlations_text(const ParameterSweep& sweep, std::size_t width) {
  std::vector<ReportColumn> columns = {{.text = "correlation (95 % interval)"}};
  for (const Variation& variation : sweep.variations) columns.push_back({.text = variation.path});
  ReportTable table(std::move(columns));
  bool has_any = false;
  for (std::size_t m = 0; m < sweep.measures.size(); ++m) {
    std::vector<ReportCell> cells = {sweep.measures[m].text};
    for (std::size_t v = 0; v < sweep.variations.size(); ++v) {
      const std::optional<Correlation> correlation = correlation_of(sweep, m, v);
      has_any = has_any || correlation.has_value();
      cells.emplace_back(correlation_text(correlation));
    }
    table.add(std::move(cells));
  }
  return has_any ? '\n' + table.text("", width) : "";
}

std::string notes_text(const ParameterSweep& sweep, std::size_t shown) {
  std::string text;
  if (sweep.kept > 0) {
    text += fmt::format("{} of an earlier sweep {} kept; add --anew to compute all\n",
                        counted(sweep.kept, "row", "rows"), sweep.kept == 1 ? "was" : "were");
  }
  if (sweep.done() > shown) {
    text += fmt::format("{} of {} rows are shown; the files have all\n", shown, sweep.done());
  }
  if (sweep.done() < sweep.rows.size()) {
    text += fmt::format("{} of {} rows are done; the same command continues\n", sweep.done(), sweep.rows.size());
  }
  if (sweep.failed() > 0) text += fmt::format("{} failed\n", counted(sweep.failed(), "row", "rows"));
  std::size_t not_converged = 0;
  for (const SweptRow& row : sweep.rows) not_converged += row.outcome.not_converged > 0 ? 1 : 0;
  if (not_converged > 0) {
    text += fmt::format("{} had steps that did not converge: see 'steps not converged' in rows.csv\n",
                        counted(not_converged, "row", "rows"));
  }
  if (sweep.foreign() > 0) {
    text +=
        fmt::format("{} of another build or processor family: their bits may differ; add --anew to compute them here\n",
                    counted(sweep.foreign(), "row is", "rows are"));
  }
  return text;
}

Json json_of(const std::optional<Interval>& interval) {
  return interval ? Json::array({interval->low, interval->high}) : Json();
}

Json json_of_measure(const ParameterSweep& sweep, std::size_t m) {
  Json json = {{"text", sweep.measures[m].text}, {"unit", sweep.measures[m].unit}, {"correlations", Json::object()}};
  const SampleStatistics statistics = statistics_of(sweep, m);
  json["rows"] = statistics.count;
  if (sweep.sampling != Sampling::grid && statistics.count > 0) {
    json["mean"] = statistics.mean;
    json["deviation"] = statistics.count > 1 ? Json(statistics.deviation) : Json();
    json["interval"] = json_of(statistics.interval);
  }
  for (std::size_t v = 0; v < sweep.variations.size(); ++v) {
    const std::optional<Correlation> correlation = correlation_of(sweep, m, v);
    if (!correlation) continue;
    json["correlations"][sweep.variations[v].path] = {{"value", correlation->value},
                                                      {"interval", json_of(correlation->interval)}};
  }
  return json;
}

Json json_of_row(const ParameterSweep& sweep, const SweptRow& row) {
  Json json = to_json(row.outcome);
  json["is_done"] = row.is_done;
  json["is_foreign"] = row.is_foreign;
  json["settings"] = Json::object();
  Json varied = Json::array();
  for (std::size_t v = 0; v < sweep.variations.size(); ++v) {
    const std::string& value = row.settings[v].second;
    json["settings"][sweep.variations[v].path] = value;
    const std::optional<double> number = number_of(sweep.variations[v], value);
    varied.push_back(number ? Json(*number) : Json(value));
  }
  json["varied"] = varied;
  return json;
}

}  // namespace

std::string report_text(const ParameterSweep& sweep, std::size_t width) {
  std::string text = fmt::format("{}: {} of {}, {}", sweep.scene, counted(sweep.rows.size(), "row", "rows"),
                                 sweep.duration_text(), to_text(sweep.sampling));
  if (sweep.sampling != Sampling::grid) text += fmt::format(" with seed {}", sweep.seed);
  text += "\n\n";
  const std::vector<std::size_t> shown = shown_rows(sweep);
  text += rows_table(sweep, shown).text("", width);
  text += statistics_text(sweep, width) + correlations_text(sweep, width);
  const std::string notes = notes_text(sweep, shown.size());
  return notes.empty() ? text : text + '\n' + notes;
}

std::string report_csv(const ParameterSweep& sweep) {
  return rows_table(sweep, all_rows(sweep)).csv();
}

Json report_json(const ParameterSweep& sweep) {
  Json json = {{"scene", sweep.scene},
               {"file", sweep.file},
               {"until", sweep.until},
               {"sample", to_text(sweep.sampling)},
               {"seed", sweep.sampling == Sampling::grid ? Json() : Json(sweep.seed)},
               {"folder", sweep.folder},
               {"is_complete", sweep.done() == sweep.rows.size()},
               {"kept", sweep.kept},
               {"failed", sweep.failed()},
               {"variations", Json::array()},
               {"measures", Json::array()},
               {"rows", Json::array()}};
  for (const Variation& variation : sweep.variations) {
    json["variations"].push_back({{"path", variation.path}, {"unit", variation.unit}});
  }
  for (std::size_t m = 0; m < sweep.measures.size(); ++m) json["measures"].push_back(json_of_measure(sweep, m));
  for (const SweptRow& row : sweep.rows) json["rows"].push_back(json_of_row(sweep, row));
  return json;
}

}  // namespace slew::analysis
