// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "analysis/simplify/simplify.h"
#include "core/display.h"
#include "core/json.h"
#include "core/report_table.h"

namespace slew::analysis {
namespace {

std::string settings_text(const scene::Overrides& settings) {
  std::string text;
  for (const std::string& one : settings) text += (text.empty() ? "" : ", ") + one;
  return text;
}

std::string worst_text(const Simplification& result, const Trial& trial) {
  if (trial.was_interrupted || trial.changes.empty()) return "-";
  const std::size_t worst = worst_of(result.watched, trial);
  return fmt::format("{} by {}", result.watched[worst].name,
                     quantity_text(trial.changes[worst], result.watched[worst].unit, result.watched[worst].name));
}

std::string verdict_text(const Simplification& result, const Trial& trial) {
  if (trial.was_interrupted) return "interrupted, not judged";
  if (!trial.has_run()) return "cannot: " + trial.refusal;
  if (!holds(result.watched, trial)) return "changes too much";
  if (trial.is_taken) return "taken";
  if (trial.cost >= (1 - kLeastSaving) * result.base_cost) return "saves nothing";
  if (result.is_interrupted) return "holds and saves; interrupted before it was tried with others";
  return result.helps() ? "not beside those taken" : "its saving did not repeat";
}

std::vector<ReportCell> row(const Simplification& result, const Trial& trial) {
  const std::string cost = trial.cost > 0 ? fmt::format("{:.3g}", trial.cost) : "-";
  return {trial.candidate.title, worst_text(result, trial), cost, verdict_text(result, trial)};
}

Json to_json(const Simplification& result, const Trial& trial) {
  Json changes = Json::object();
  for (std::size_t i = 0; i < trial.changes.size(); ++i) changes[result.watched[i].name] = trial.changes[i];
  Json json = {{"title", trial.candidate.title}, {"settings", trial.candidate.settings},
               {"has_run", trial.has_run()},     {"holds", holds(result.watched, trial)},
               {"is_taken", trial.is_taken},     {"was_interrupted", trial.was_interrupted},
               {"refusal", trial.refusal},       {"changes", changes}};
  if (trial.cost > 0) json["us_per_ms"] = trial.cost;
  return json;
}

}  // namespace

std::string report_text(const Simplification& result, std::size_t width) {
  const std::string cost = result.base_cost > 0 ? fmt::format("{:.3g} us per simulated ms (fastest of {} runs)",
                                                              result.base_cost, result.repeats)
                                                : "not measured";
  std::string text = fmt::format("{}, {} of its run; as it is {}\n", result.scene, duration_text(result.until), cost);
  ReportTable limits({"variable", "may change by", "range in the run"});
  for (const Watched& watched : result.watched) {
    limits.add({watched.name, quantity_text(watched.tolerance, watched.unit, watched.name),
                quantity_text(watched.range, watched.unit, watched.name)});
  }
  text += limits.text("  ", width) + "\n";
  if (result.trials.empty() && !result.is_interrupted) text += "nothing in this scene could be left out\n";
  if (!result.trials.empty()) {
    ReportTable trials({"alone", "largest change", "us/ms", ""});
    for (const Trial& trial : result.trials) trials.add(row(result, trial));
    text += trials.text("  ", width) + "\n";
  }
  if (result.is_interrupted) return text + "interrupted: nothing was taken, nothing is written\n";
  if (!result.helps()) return text + "nothing helps: the scene stays as it is, nothing is written\n";
  text += fmt::format("together: {}\n", settings_text(result.settings));
  text += fmt::format("measured: {:.3g} us per simulated ms, {:.0f} % less; largest changes:\n", result.combined.cost,
                      100 * (1 - result.combined.cost / result.base_cost));
  ReportTable changes({"", ""});
  for (std::size_t i = 0; i < result.watched.size(); ++i) {
    const Watched& watched = result.watched[i];
    changes.add({watched.name, quantity_text(result.combined.changes[i], watched.unit, watched.name)});
  }
  return text + changes.text("  ", width);
}

Json report_json(const Simplification& result) {
  Json watched = Json::array(), trials = Json::array();
  for (const Watched& one : result.watched) {
    watched.push_back({{"name", one.name}, {"unit", one.unit}, {"tolerance", one.tolerance}, {"range", one.range}});
  }
  for (const Trial& trial : result.trials) trials.push_back(to_json(result, trial));
  Json json = {{"scene", result.scene},         {"until", result.until},   {"repeats", result.repeats},
               {"us_per_ms", result.base_cost}, {"watched", watched},      {"trials", trials},
               {"settings", result.settings},   {"helps", result.helps()}, {"is_interrupted", result.is_interrupted}};
  if (result.helps()) json["combined"] = to_json(result, result.combined);
  return json;
}

}  // namespace slew::analysis
