// SPDX-License-Identifier: Apache-2.0
#include "analysis/comparison/comparison_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/display.h"
#include "core/escaped.h"
#include "core/json.h"
#include "core/report_table.h"
#include "plotting/scatter_svg.h"

namespace slew::analysis {
namespace {

std::string error_number(double value) {
  return value == 0 ? "0" : fmt::format("{:.1e}", value);
}

std::string cost(double microseconds) {
  return fmt::format("{:.3g}", microseconds);
}

std::string formulation_and_integrator(const Configuration& configuration) {
  return configuration.formulation + ", " + configuration.integrator;
}

// "yes", or the reason for no
std::string verdict(const ComparedRow& row) {
  if (!row.has_run()) return "cannot run: " + row.refusal;
  if (!row.failure.empty()) return fmt::format("no: at {:.4g} s {}", row.failed_at, row.failure);
  if (row.parted_at) return fmt::format("no: away from the reference from {:.4g} s on", *row.parted_at);
  return "yes";
}

// a difference within the reference's own error is only an upper bound
std::string difference_text(double value, double reference_error) {
  return value < reference_error ? '<' + error_number(reference_error) : error_number(value);
}

std::vector<ReportCell> cells_of(const Comparison& comparison, const ComparedRow& row) {
  const Configuration& c = row.configuration;
  std::vector<ReportCell> cells = {c.formulation, c.integrator,
                                   c.step > 0 ? ReportCell(step_text(c.step), c.step) : ReportCell("any", {})};
  const auto add = [&](std::string text, Json exact) {
    cells.push_back(row.has_run() ? ReportCell(std::move(text), std::move(exact)) : ReportCell("-", {}));
  };
  add(error_number(row.gap.position), row.gap.position);
  add(error_number(row.gap.rate), row.gap.rate);
  add(row.energy_drift ? error_number(*row.energy_drift) : "-", row.energy_drift ? Json(*row.energy_drift) : Json());
  for (std::size_t i = 0; i < comparison.classes.size(); ++i) {
    const VariableClass& one = comparison.classes[i];
    const Difference difference = row.has_run() ? row.differences[i] : Difference{};
    add(difference_text(difference.largest, one.reference_error), difference.largest);
    add(difference_text(difference.rms, one.reference_rms), difference.rms);
  }
  for (const double microseconds : {row.cost.mechanics, row.cost.mechanics_slowest, row.cost.whole}) {
    add(cost(microseconds), microseconds);
  }
  add(fmt::format("{:.2g}", row.iterations), row.iterations);
  add(std::to_string(row.not_converged), row.not_converged);
  cells.emplace_back(verdict(row));
  return cells;
}

ReportTable table_of(const Comparison& comparison) {
  constexpr std::size_t kNaming = 3;  // formulation, integrator, step
  std::vector<ReportColumn> columns = {{"formulation", "formulation"},
                                       {"integrator", "integrator"},
                                       {"step", "step [s]"},
                                       {"open", "joints open [m or rad]"},
                                       {"opening", "joints opening [m/s or rad/s]"},
                                       {"energy", "energy drift [1]"}};
  for (const VariableClass& one : comparison.classes) {
    columns.push_back({fmt::format("difference [{}]", one.unit), fmt::format("largest difference [{}]", one.unit)});
    columns.push_back({fmt::format("RMS [{}]", one.unit), fmt::format("RMS difference [{}]", one.unit)});
  }
  columns.push_back({"us/ms", "mechanics [us/ms]"});
  columns.push_back({"slowest", "slowest step [us/ms]"});
  columns.push_back({.csv = "all physics [us/ms]"});
  if (comparison.has_hydraulics) columns.back().text = "with hydraulics";
  columns.push_back({"iterations", "iterations per step"});
  columns.push_back({"not converged", "steps not converged"});
  columns.push_back({"stable", "stable"});
  ReportTable table(std::move(columns), kNaming);
  for (const ComparedRow& row : comparison.rows) table.add(cells_of(comparison, row));
  return table;
}

std::string energy_text(const Comparison& comparison) {
  if (!(comparison.largest_kinetic_energy > 0)) return "nothing moves";
  const std::string unit = fmt::format("{:.3g} J", comparison.largest_kinetic_energy);
  if (comparison.energy_rule == EnergyRule::kept) {
    return fmt::format("largest |E - E(0)| over the largest kinetic energy, {}; the reference keeps it to {}", unit,
                       error_number(comparison.reference_energy_drift));
  }
  return fmt::format(
      "largest |E - E of the reference| over the largest kinetic energy, {}: this scene is driven or "
      "loses energy",
      unit);
}

std::string reference_text(const Comparison& comparison) {
  std::string errors;
  for (const VariableClass& one : comparison.classes) {
    errors += fmt::format("{}{} {}", errors.empty() ? "" : ", ", error_number(one.reference_error), one.unit);
  }
  return fmt::format("{}, sub-steps of {}; its error is estimated at {} (difference to twice the sub-step)",
                     formulation_and_integrator(comparison.reference), step_text(comparison.reference.step), errors);
}

std::string fitting(const std::vector<std::string>& variables) {
  if (variables.size() == 1) return variables.front();
  return fmt::format("{} variables, {} to {}", variables.size(), variables.front(), variables.back());
}

// shorter steps near a singular position can be worse, which an estimate from two steps does not show
bool is_reference_in_doubt(const Comparison& comparison) {
  constexpr double kClearlyBetter = 0.1;
  constexpr double kRounding = 1e-12;
  return comparison.energy_rule == EnergyRule::kept && comparison.reference_energy_drift > kRounding &&
         std::any_of(comparison.rows.begin(), comparison.rows.end(), [&](const ComparedRow& row) {
           return row.is_stable() && row.energy_drift &&
                  *row.energy_drift < kClearlyBetter * comparison.reference_energy_drift;
         });
}

std::string remarks(const Comparison& comparison) {
  std::string text;
  if (is_reference_in_doubt(comparison)) {
    text +=
        "the reference keeps its energy worse than some rows: the differences may be its own; try another "
        "--reference\n";
  }
  for (const ComparedRow& row : comparison.rows) {
    const Configuration& c = row.configuration;
    if (row.has_run() && !row.cost.is_repeatable) {
      text += fmt::format("{} with {} did not end in the same state twice: please report this scene\n",
                          formulation_and_integrator(c), step_text(c.step));
    }
  }
  if (comparison.rows.size() < comparison.wanted_rows) {
    text += fmt::format("interrupted: {} of {} rows\n", comparison.rows.size(), comparison.wanted_rows);
  }
  return text;
}

Json json_of(const Comparison& comparison, const ComparedRow& row) {
  Json json = {{"formulation", row.configuration.formulation},
               {"integrator", row.configuration.integrator},
               {"has_run", row.has_run()},
               {"is_stable", row.is_stable()},
               {"verdict", verdict(row)}};
  if (row.configuration.step > 0) json["step"] = row.configuration.step;
  if (!row.has_run()) return json;
  json["joint_gap"] = {{"position", row.gap.position}, {"rate", row.gap.rate}, {"joint", row.open_joint}};
  json["energy_drift"] = row.energy_drift ? Json(*row.energy_drift) : Json();
  for (std::size_t i = 0; i < row.differences.size(); ++i) {
    json["differences"].push_back({{"unit", comparison.classes[i].unit},
                                   {"largest", row.differences[i].largest},
                                   {"rms", row.differences[i].rms}});
  }
  json["us_per_ms"] = {{"mechanics", row.cost.mechanics},
                       {"mechanics_slowest_step", row.cost.mechanics_slowest},
                       {"all_physics", row.cost.whole},
                       {"mechanics_run_median", row.cost.mechanics_run_median},
                       {"all_physics_run_median", row.cost.whole_run_median}};
  json["iterations_per_step"] = row.iterations;
  json["steps_not_converged"] = row.not_converged;
  json["is_repeatable"] = row.cost.is_repeatable;
  json["state_hash"] = {{"mechanics", fmt::format("{:016x}", row.state_hashes.mechanics)},
                        {"hydraulics", fmt::format("{:016x}", row.state_hashes.hydraulics)}};
  return json;
}

// the runs, the reference, and the meaning of the columns
std::string preamble(const Comparison& comparison) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<12}{}\n", name, value);
  };
  line("scene", fmt::format("{}, {:.6g} s in communication steps of {}", comparison.scene, comparison.until,
                            step_text(comparison.communication_step)));
  if (comparison.rows.empty()) return text;
  line("reference", reference_text(comparison));
  line("open", "largest opening of any joint [m, rad]; opening: how fast it opens [m/s, rad/s]");
  line("energy", energy_text(comparison));
  line("difference", fmt::format("largest and root mean square of {}", fitting(comparison.variables)));
  line("us/ms", fmt::format("microseconds of the mechanics for a simulated millisecond, each step at the fastest of {}",
                            counted(static_cast<std::uint64_t>(comparison.repeats), "run", "runs")));
  return text;
}

constexpr std::string_view kComparisonStyle =
    "body{font-family:sans-serif;margin:2em}svg{max-width:100%;height:auto}pre{white-space:pre-wrap}"
    "table{border-collapse:collapse;font-size:13px}"
    "td,th{padding:.2em .6em;text-align:left;border-bottom:1px solid #ddd;white-space:nowrap}";

}  // namespace

std::string report_text(const Comparison& comparison, std::size_t width) {
  if (comparison.rows.empty()) return preamble(comparison) + "interrupted before the first row\n";
  return preamble(comparison) + '\n' + table_of(comparison).text("", width) + remarks(comparison);
}

std::string report_json(const Comparison& comparison) {
  Json json = {{"scene", comparison.scene},
               {"until", comparison.until},
               {"communication_step", comparison.communication_step},
               {"repeats", comparison.repeats},
               {"is_complete", comparison.rows.size() == comparison.wanted_rows},
               {"variables", comparison.variables},
               {"rows", Json::array()}};
  Json& reference = json["reference"];
  reference = {{"formulation", comparison.reference.formulation},
               {"integrator", comparison.reference.integrator},
               {"step", comparison.reference.step},
               {"energy_drift", comparison.reference_energy_drift},
               {"largest_kinetic_energy", comparison.largest_kinetic_energy}};
  for (const VariableClass& one : comparison.classes) {
    reference["errors"].push_back({{"unit", one.unit}, {"largest", one.reference_error}, {"rms", one.reference_rms}});
  }
  json["energy_rule"] = comparison.energy_rule == EnergyRule::kept ? "from_start" : "from_reference";
  for (const ComparedRow& row : comparison.rows) json["rows"].push_back(json_of(comparison, row));
  return json.dump(2);
}

std::string report_csv(const Comparison& comparison) {
  return table_of(comparison).csv();
}

std::string report_svg(const Comparison& comparison) {
  plotting::Scatter scatter;
  scatter.title = comparison.scene + ": accuracy against cost";
  scatter.subtitle = fmt::format("{:.6g} s; reference {}", comparison.until, reference_text(comparison));
  scatter.x_label = "mechanics [\u00b5s per simulated ms]";
  if (comparison.classes.empty()) return plotting::scatter_svg(scatter);
  const VariableClass& shown = comparison.classes.front();
  scatter.y_label = fmt::format("largest difference to the reference [{}]", shown.unit);
  scatter.y_floor = shown.reference_error;
  scatter.y_floor_label = "error of the reference";
  for (const ComparedRow& row : comparison.rows) {
    if (!row.is_stable()) continue;
    const std::string name = formulation_and_integrator(row.configuration);
    auto group = std::find_if(scatter.groups.begin(), scatter.groups.end(),
                              [&name](const plotting::MarkGroup& one) { return one.name == name; });
    if (group == scatter.groups.end()) group = scatter.groups.insert(group, {name, {}});
    group->marks.push_back({row.cost.mechanics, row.differences.front().largest, step_text(row.configuration.step)});
  }
  return plotting::scatter_svg(scatter);
}

std::string report_html(const Comparison& comparison) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}: accuracy against cost</title>\n"
      "<style>{1}</style></head>\n<body>\n{2}<pre>{3}</pre>\n{4}<pre>{5}</pre>\n</body>\n</html>\n",
      escaped(comparison.scene), kComparisonStyle, report_svg(comparison), escaped(preamble(comparison)),
      table_of(comparison).html(), escaped(remarks(comparison)));
}

}  // namespace slew::analysis
