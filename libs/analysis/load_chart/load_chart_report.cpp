// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/load_chart/load_chart.h"
#include "core/display.h"
#include "core/report_table.h"
#include "plotting/chart_svg.h"

namespace slew::analysis {
namespace {

// of a curve over the largest load of a chart: what lies higher is cut off
constexpr double kShownAboveLargest = 1.5;

std::string kilograms(double load) {
  return std::isfinite(load) ? fmt::format("{:.0f} kg", load) : "-";
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

ReportTable table_of(const LoadChart& chart) {
  std::vector<ReportColumn> columns;
  for (const ChartCoordinate& one : chart.coordinates) {
    columns.push_back(
        {one.joint, one.unit.empty() ? one.joint : fmt::format("{} [{}]", one.joint, one.unit), one.joint});
  }
  columns.push_back({"reach", "reach [m]", "reach"});
  columns.push_back({"height", "height [m]", "height"});
  columns.push_back({"load", "load [kg]", "load"});
  columns.push_back({"limited by", "limited by", "limited_by"});
  for (const ChartLimit& limit : chart.limits) columns.push_back({{}, limit.name + " [kg]", limit.name});
  ReportTable table(std::move(columns), chart.coordinates.size());
  for (const ChartPose& pose : chart.poses) {
    std::vector<ReportCell> row;
    for (std::size_t i = 0; i < pose.values.size(); ++i) row.emplace_back(pose.settings[i], Json(pose.values[i]));
    if (!pose.has_load()) {
      for (int i = 0; i < 3; ++i) row.emplace_back("-", Json());
      row.emplace_back(pose.refusal);
      table.add(std::move(row));
      continue;
    }
    row.emplace_back(decimals_text(pose.reach, 3) + " m", Json(pose.reach));
    row.emplace_back(decimals_text(pose.height, 3) + " m", Json(pose.height));
    row.emplace_back(kilograms(pose.load), Json(pose.load));
    const ChartLimit& limit = chart.limits[pose.limiting];
    const bool tips_alone = pose.tips_alone && limit.kind == LimitKind::tipping;
    row.emplace_back(tips_alone ? limit.name + ": tips without load" : limit.name);
    for (const double load : pose.loads) row.emplace_back("", number_or_null(load));
    table.add(std::move(row));
  }
  return table;
}

std::string heading_of(const LoadChart& chart) {
  return fmt::format("largest load of {} ({} in the scene), reach from {}", chart.payload,
                     quantity_text(chart.mass, "kg"), chart.from);
}

// load over reach, a curve for each limit
void add_curves(const LoadChart& chart, plotting::Chart& picture) {
  double largest = 0;
  plotting::ChartCurve least{.name = "load", .look = plotting::CurveLook::wide_line};
  for (const ChartPose& pose : chart.poses) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    least.points.push_back({pose.has_load() ? pose.reach : none, pose.load});
    largest = std::max(largest, pose.load);
  }
  for (std::size_t i = 0; i < chart.limits.size(); ++i) {
    plotting::ChartCurve curve{.name = chart.limits[i].name};
    for (const ChartPose& pose : chart.poses) {
      curve.points.push_back({pose.reach, pose.has_load() ? pose.loads[i] : std::numeric_limits<double>::quiet_NaN()});
    }
    const auto is_shown = [](const plotting::ChartPoint& point) { return std::isfinite(point.y); };
    if (std::any_of(curve.points.begin(), curve.points.end(), is_shown)) picture.curves.push_back(std::move(curve));
  }
  picture.curves.push_back(std::move(least));
  picture.y_label = "load [kg]";
  picture.y_most = kShownAboveLargest * largest;
}

// the poses by reach and height, with the load in tonnes beside each
void add_marks(const LoadChart& chart, plotting::Chart& picture) {
  for (std::size_t i = 0; i < chart.limits.size(); ++i) {
    plotting::ChartCurve marks{.name = chart.limits[i].name, .look = plotting::CurveLook::marks};
    for (const ChartPose& pose : chart.poses) {
      if (!pose.has_load() || pose.limiting != i) continue;
      marks.points.push_back({pose.reach, pose.height, fmt::format("{:.1f}", pose.load * 1e-3),
                              fmt::format("{}: {}", fmt::join(pose.settings, ", "), kilograms(pose.load))});
    }
    if (!marks.points.empty()) picture.curves.push_back(std::move(marks));
  }
  picture.y_label = "height [m]";
  picture.subtitle += "; figures: load [t], colours: what limits it";
}

}  // namespace

std::string report_text(const LoadChart& chart, std::size_t width) {
  std::string text = fmt::format("{}\n\n{}", heading_of(chart), table_of(chart).text("  ", width));
  for (const std::string& note : chart.notes) text += "\nnote: " + note + '\n';
  for (const std::string& warning : chart.warnings) text += "\nwarning: " + warning + '\n';
  return text;
}

std::string report_csv(const LoadChart& chart) {
  return table_of(chart).csv();
}

Json report_json(const LoadChart& chart) {
  Json coordinates = Json::array(), notes = Json::array(), warnings = Json::array();
  for (const ChartCoordinate& one : chart.coordinates) {
    coordinates.push_back({{"joint", one.joint}, {"unit", one.unit}});
  }
  for (const std::string& note : chart.notes) notes.push_back(note);
  for (const std::string& warning : chart.warnings) warnings.push_back(warning);
  return {{"scene", chart.scene}, {"payload", chart.payload},   {"mass", chart.mass},
          {"from", chart.from},   {"coordinates", coordinates}, {"poses", table_of(chart).json()},
          {"notes", notes},       {"warnings", warnings}};
}

std::string report_svg(const LoadChart& chart) {
  plotting::Chart picture{
      .title = "Load chart of " + chart.scene, .subtitle = heading_of(chart), .x_label = "reach [m]"};
  if (chart.coordinates.size() == 1) {
    add_curves(chart, picture);
  } else {
    add_marks(chart, picture);
  }
  return plotting::chart_svg(picture);
}

}  // namespace slew::analysis
