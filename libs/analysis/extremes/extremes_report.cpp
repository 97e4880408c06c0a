// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/extremes/extremes.h"
#include "core/display.h"
#include "core/json.h"
#include "core/report_table.h"

namespace slew::analysis {
namespace {

// a number that JSON may have lost because it was not finite
double number(const Json& json) {
  return json.is_number() ? json.number() : std::nan("");
}

std::string value_text(double value, const std::string& unit) {
  return unit.empty() ? fmt::format("{:.2g}", value) : quantity_text(value, unit);
}

// "highest pressure 212 bar of 381 bar, 56 %": the value nearest to its bound
std::string nearest_text(const Json& result) {
  if (const std::string& refusal = result.at("refusal").text(); !refusal.empty()) return refusal;
  std::string text;
  for (const char* end : {"failure", "alarm"}) {
    const std::string& why = result.at(end).text();
    if (!why.empty()) text += fmt::format("at {:.4g} s: {}; ", number(result.at("ended_at")), why);
  }
  if (const std::string& unsuitable = result.at("unsuitable").text(); !unsuitable.empty()) return text + unsuitable;
  const std::vector<Json>& checks = result.at("checks").items();
  if (checks.empty()) return text + "finite";
  const Json& first = checks.front();
  const double value = number(first.at("value")), bound = number(first.at("bound"));
  const std::string& unit = first.at("unit").text();
  text += fmt::format("{} {}", first.at("what").text(), value_text(value, unit));
  if (bound > 0) text += fmt::format(" of {}, {:.0f} %", value_text(bound, unit), 100 * value / bound);
  return text;
}

std::string edge_text(const Json& result) {
  if (!result.at("has_edge").boolean()) return "-";
  const Json& step = result.at("largest_step");
  return step.is_number() ? fmt::format("{:.4g} ms", step.number() * 1e3) : "none";
}

std::string notes_text(const Json& result) {
  std::string text;
  for (const Json& note : result.at("notes").items()) text += (text.empty() ? "" : "; ") + note.text();
  return text;
}

std::vector<ReportCell> cells_of(const ExtremesRow& row) {
  if (!row.obstacle.empty()) return {row.name, "n/a", row.obstacle, "", "", ""};
  if (!row.is_done) return {row.name, "not run", "", "", "", ""};
  if (!row.result.is_object()) return {row.name, "FAILED", row.failure, "", "", "run it alone with --only"};
  return {row.name,
          row.result.at("verdict").text(),
          nearest_text(row.result),
          edge_text(row.result),
          row.result.at("advice").text(),
          notes_text(row.result)};
}

}  // namespace

std::string report_text(const Extremes& extremes, std::size_t width) {
  std::string text;
  std::size_t within = 0, refused = 0, bad = 0, not_for = 0, left = 0;
  for (std::size_t i = 0; i < extremes.rows.size();) {
    const std::string& scene = extremes.rows[i].scene;
    ReportTable table({"case", "verdict", "nearest to its bound", "largest stable step", "what to do", "notes"});
    for (; i < extremes.rows.size() && extremes.rows[i].scene == scene; ++i) {
      const ExtremesRow& row = extremes.rows[i];
      table.add(cells_of(row));
      const bool is_refused = row.result.is_object() && row.result.at("verdict").text() == to_text(Verdict::refused);
      ++(!row.obstacle.empty() ? not_for : !row.is_done ? left : is_refused ? refused : row.is_good() ? within : bad);
    }
    text += scene + "\n" + table.text("  ", width) + "\n";
  }
  text +=
      "within: finite and inside all bounds to the end. refused: by name, before it ran, by the session's own alarm "
      "(session.coupling_alarm)\nat the time that is named, or for the machine's own damping, all other bounds kept. "
      "EXCEEDED: beyond a bound. "
      "DIVERGED: not finite.\n";
  text +=
      fmt::format("{} within, {} refused by name, {} neither, {} not for their scene", within, refused, bad, not_for);
  if (left > 0) text += fmt::format(", {} not run: the same command goes on from here", left);
  if (extremes.kept > 0) text += fmt::format("; {} kept from {}", extremes.kept, extremes.folder);
  return text + "\n";
}

std::string report_json(const Extremes& extremes) {
  Json rows = Json::array();
  for (const ExtremesRow& row : extremes.rows) {
    Json one = {{"scene", row.scene},
                {"name", row.name},
                {"group", to_text(row.group)},
                {"what", row.what},
                {"obstacle", row.obstacle},
                {"is_done", row.is_done},
                {"is_good", row.is_done && row.is_good()},
                {"failure", row.failure},
                {"result", row.result}};
    rows.push_back(std::move(one));
  }
  return Json{{"rows", rows},
              {"is_complete", extremes.is_complete()},
              {"is_good", extremes.is_good()},
              {"kept", extremes.kept},
              {"folder", extremes.folder}}
      .dump(2);
}

}  // namespace slew::analysis
