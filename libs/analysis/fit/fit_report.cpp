// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "analysis/fit/fit.h"
#include "core/display.h"
#include "core/report_table.h"
#include "plotting/html_plot.h"

namespace slew::analysis {
namespace {

std::string in_unit(double value, const std::string& unit) {
  return fmt::format("{}{}{}", digits_text(value, 6), unit.empty() ? "" : " ", unit);
}

std::string interval_of(const FittedValue& value) {
  if (!value.interval) return "not determined";
  std::string text = digits_text(value.interval->low, 6) + " .. " + digits_text(value.interval->high, 6);
  if (value.is_beyond_range) text += ", wider than its bounds: the data do not determine it";
  if (value.is_at_bound) text += ", at its bound: the interval does not hold";
  return text;
}

std::string correlations_of(const Fit& fit, std::size_t width) {
  const std::size_t n = fit.values.size();
  if (n < 2 || fit.correlations.empty()) return "";
  std::vector<ReportColumn> columns = {{.text = "correlation"}};
  for (const FittedValue& value : fit.values) columns.push_back({.text = value.path});
  ReportTable table(std::move(columns));
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<ReportCell> cells = {fit.values[i].path};
    for (std::size_t j = 0; j < n; ++j) cells.emplace_back(decimals_text(fit.correlations[i * n + j], 2));
    table.add(std::move(cells));
  }
  return '\n' + table.text("", width);
}

std::string combination_text(const Undetermined& combination, const Fit& fit) {
  std::string text;
  for (const Undetermined::Part& part : combination.parts) {
    const FittedValue& value = fit.values[part.value];
    text += text.empty() ? "" : " with ";
    text += value.path + " by " +
            (part.is_relative ? fmt::format("{:+.3g} %", 100 * part.change)
                              : fmt::format("{:+.3g} {}", part.change, value.unit));
  }
  return text;
}

std::string undetermined_text(const Fit& fit) {
  if (fit.undetermined.empty() && !fit.search.normal_inverse.empty()) return "";
  std::string text = "\nThe data do not determine the values";
  if (fit.undetermined.empty()) text += ": a change of some of them together changes no signal";
  text += ".\n";
  for (const Undetermined& one : fit.undetermined) {
    text += fmt::format("A change of {} {} no signal.\n", combination_text(one, fit),
                        one.parts.size() > 1 ? "changes practically" : "changes");
  }
  return text + "Fix a value by --set in the place of --free, or measure another signal.\n";
}

}  // namespace

std::string report_text(const Fit& fit, std::size_t width) {
  ReportTable values({"value", "before", "after", "95 % interval"});
  std::string settings;
  for (const FittedValue& value : fit.values) {
    values.add({value.path, in_unit(value.before, value.unit), in_unit(value.after, value.unit), interval_of(value)});
    settings += fmt::format(" --set '{}'", value.setting);
  }
  ReportTable signals({"signal", "measured", "RMS before", "RMS after"});
  for (const FittedSignal& signal : fit.signals) {
    signals.add({signal.expression, signal.column,
                 quantity_text(signal.rms(signal.before), signal.unit, signal.expression),
                 quantity_text(signal.rms(signal.after), signal.unit, signal.expression)});
  }
  std::string text =
      fmt::format("{}: {} after {}, {}\n\n", fit.scene, fit.search.has_converged ? "converged" : "not converged",
                  counted(static_cast<std::uint64_t>(fit.search.iterations), "iteration", "iterations"),
                  counted(fit.runs, "run", "runs"));
  text += values.text("", width) + '\n' + signals.text("", width) + correlations_of(fit, width);
  if (!fit.search.has_converged) text += "\nwhy the search stopped: " + fit.search.reason + '\n';
  text += undetermined_text(fit);
  return text + '\n' + settings.substr(settings.empty() ? 0 : 1) + '\n';
}

Json report_json(const Fit& fit) {
  Json json = {{"scene", fit.scene},
               {"folder", fit.folder},
               {"has_converged", fit.search.has_converged},
               {"reason", fit.search.reason},
               {"iterations", fit.search.iterations},
               {"runs", fit.runs},
               {"squares", Json::array({fit.search.squares_before, fit.search.squares_after})},
               {"values", Json::array()},
               {"signals", Json::array()},
               {"correlations", fit.correlations},
               {"is_determined", fit.is_determined()},
               {"undetermined", Json::array()}};
  for (const FittedValue& value : fit.values) {
    json["values"].push_back(
        {{"path", value.path},
         {"unit", value.unit},
         {"bounds", Json::array({value.low, value.high})},
         {"before", value.before},
         {"after", value.after},
         {"interval", value.interval ? Json::array({value.interval->low, value.interval->high}) : Json()},
         {"is_at_bound", value.is_at_bound},
         {"is_beyond_range", value.is_beyond_range},
         {"setting", value.setting}});
  }
  for (const Undetermined& one : fit.undetermined) {
    Json parts = Json::array();
    for (const Undetermined::Part& part : one.parts) {
      parts.push_back({{"path", fit.values[part.value].path},
                       {"change", part.change},
                       {"unit", part.is_relative ? Json("1") : Json(fit.values[part.value].unit)}});
    }
    json["undetermined"].push_back(std::move(parts));
  }
  for (const FittedSignal& signal : fit.signals) {
    json["signals"].push_back({{"column", signal.column},
                               {"expression", signal.expression},
                               {"unit", signal.unit},
                               {"samples", signal.measured.size()},
                               {"rms", Json::array({signal.rms(signal.before), signal.rms(signal.after)})}});
  }
  return json;
}

std::string report_html(const Fit& fit) {
  std::vector<plotting::Plot> plots;
  for (const FittedSignal& signal : fit.signals) {
    const DisplayUnit unit = display_unit(signal.unit, signal.expression);
    const auto series = [&](const char* name, const std::vector<double>& values) {
      plotting::Series one{.name = name, .unit = std::string(unit.unit), .time = signal.time, .values = values};
      for (double& value : one.values) value *= unit.factor;
      return one;
    };
    plots.push_back({.title = signal.expression,
                     .series = {series("measured", signal.measured), series("before", signal.before),
                                series("after", signal.after)}});
  }
  std::string subtitle;
  for (const FittedValue& value : fit.values) {
    subtitle += fmt::format("{}{}: {} to {}", subtitle.empty() ? "" : ", ", value.path,
                            in_unit(value.before, value.unit), in_unit(value.after, value.unit));
  }
  return plotting::plot_html(plots, {.title = "Fit of " + fit.scene, .subtitle = subtitle});
}

}  // namespace slew::analysis
