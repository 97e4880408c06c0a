#include "cli/comparison/comparison_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/display.h"
#include "cli/plotting/scatter_svg.h"
#include "core/escaped.h"
#include "core/json.h"

namespace slew::cli {
namespace {

using Cells = std::vector<std::string>;

std::string number(double value) {
  return value == 0 ? "0" : fmt::format("{:.1e}", value);
}

std::string cost(double microseconds) {
  return fmt::format("{:.3g}", microseconds);
}

std::string formulation_and_integrator(const Configuration& configuration) {
  return configuration.formulation + ", " + configuration.integrator;
}

// "yes", or why not
std::string verdict(const ComparedRow& row) {
  if (!row.has_run()) return "cannot run: " + row.refusal;
  if (!row.failure.empty()) return fmt::format("no: {} is not finite at {:.4g} s", row.failure, row.failed_at);
  if (row.parted_at) return fmt::format("no: away from the reference from {:.4g} s on", *row.parted_at);
  return "yes";
}

// what is within the reference's own error says only that
std::string difference_text(double value, double reference_error) {
  return value < reference_error ? '<' + number(reference_error) : number(value);
}

Cells heading(const Comparison& comparison) {
  Cells cells = {"formulation", "integrator", "step", "open", "opening", "energy"};
  for (const VariableClass& one : comparison.classes) {
    cells.push_back(fmt::format("difference [{}]", one.unit));
    cells.push_back(fmt::format("RMS [{}]", one.unit));
  }
  cells.insert(cells.end(), {"us/ms", "slowest"});
  if (comparison.has_hydraulics) cells.emplace_back("with hydraulics");
  cells.insert(cells.end(), {"iterations", "not converged", "stable"});
  return cells;
}

Cells cells_of(const Comparison& comparison, const ComparedRow& row) {
  const Configuration& c = row.configuration;
  Cells cells = {c.formulation, c.integrator, c.step > 0 ? step_text(c.step) : "any"};
  if (!row.has_run()) {
    cells.resize(heading(comparison).size() - 1, "-");
    cells.push_back(verdict(row));
    return cells;
  }
  cells.push_back(number(row.gap.position));
  cells.push_back(number(row.gap.rate));
  cells.push_back(row.energy_drift ? number(*row.energy_drift) : "-");
  for (std::size_t i = 0; i < row.differences.size(); ++i) {
    cells.push_back(difference_text(row.differences[i].largest, comparison.classes[i].reference_error));
    cells.push_back(difference_text(row.differences[i].rms, comparison.classes[i].reference_rms));
  }
  cells.push_back(cost(row.cost.mechanics));
  cells.push_back(cost(row.cost.mechanics_slowest));
  if (comparison.has_hydraulics) cells.push_back(cost(row.cost.whole));
  cells.push_back(fmt::format("{:.2g}", row.iterations));
  cells.push_back(std::to_string(row.not_converged));
  cells.push_back(verdict(row));
  return cells;
}

std::string energy_text(const Comparison& comparison) {
  if (!(comparison.largest_kinetic_energy > 0)) return "nothing moves";
  const std::string unit = fmt::format("{:.3g} J", comparison.largest_kinetic_energy);
  if (comparison.energy_rule == EnergyRule::kept) {
    return fmt::format("largest |E - E(0)| over the largest kinetic energy, {}; the reference keeps it to {}", unit,
                       number(comparison.reference_energy_drift));
  }
  return fmt::format(
      "largest |E - E of the reference| over the largest kinetic energy, {}: this scene is driven or "
      "loses energy",
      unit);
}

std::string reference_text(const Comparison& comparison) {
  std::string errors;
  for (const VariableClass& one : comparison.classes) {
    errors += fmt::format("{}{} {}", errors.empty() ? "" : ", ", number(one.reference_error), one.unit);
  }
  return fmt::format("{}, sub-steps of {}; its error is estimated at {} (difference to twice the sub-step)",
                     formulation_and_integrator(comparison.reference), step_text(comparison.reference.step), errors);
}

std::string fitting(const std::vector<std::string>& variables) {
  if (variables.size() == 1) return variables.front();
  return fmt::format("{} variables, {} to {}", variables.size(), variables.front(), variables.back());
}

// steps near a singular position can be worse when they are shorter, which an estimate by two steps does not see
bool is_reference_in_doubt(const Comparison& comparison) {
  constexpr double kClearlyBetter = 0.1;
  constexpr double kRounding = 1e-12;
  return comparison.energy_rule == EnergyRule::kept && comparison.reference_energy_drift > kRounding &&
         std::any_of(comparison.rows.begin(), comparison.rows.end(), [&](const ComparedRow& row) {
           return row.is_stable() && row.energy_drift &&
                  *row.energy_drift < kClearlyBetter * comparison.reference_energy_drift;
         });
}

std::vector<std::string> remarks(const Comparison& comparison) {
  std::vector<std::string> lines;
  if (is_reference_in_doubt(comparison)) {
    lines.emplace_back(
        "the reference keeps its energy worse than some rows: the differences may be its own; try another --reference");
  }
  for (const ComparedRow& row : comparison.rows) {
    const Configuration& c = row.configuration;
    if (row.has_run() && !row.cost.is_repeatable) {
      lines.push_back(fmt::format("{} with {} did not end in the same state twice: please report this scene",
                                  formulation_and_integrator(c), step_text(c.step)));
    }
  }
  if (comparison.rows.size() < comparison.wanted_rows) {
    lines.push_back(fmt::format("interrupted: {} of {} rows", comparison.rows.size(), comparison.wanted_rows));
  }
  return lines;
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

Cells csv_cells(const Comparison& comparison, const ComparedRow& row) {
  const Configuration& c = row.configuration;
  const auto exact = [&](double value) { return row.has_run() ? fmt::format("{}", value) : std::string(); };
  Cells cells = {c.formulation, c.integrator, c.step > 0 ? fmt::format("{}", c.step) : ""};
  cells.push_back(exact(row.gap.position));
  cells.push_back(exact(row.gap.rate));
  cells.push_back(row.energy_drift ? exact(*row.energy_drift) : "");
  for (std::size_t i = 0; i < comparison.classes.size(); ++i) {
    const bool is_known = i < row.differences.size();
    cells.push_back(is_known ? exact(row.differences[i].largest) : "");
    cells.push_back(is_known ? exact(row.differences[i].rms) : "");
  }
  for (const double value : {row.cost.mechanics, row.cost.mechanics_slowest, row.cost.whole, row.iterations}) {
    cells.push_back(exact(value));
  }
  cells.push_back(row.has_run() ? std::to_string(row.not_converged) : "");
  cells.push_back(verdict(row));
  return cells;
}

}  // namespace

std::string report_text(const Comparison& comparison) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<12}{}\n", name, value);
  };
  line("scene", fmt::format("{}, {:.6g} s in communication steps of {}", comparison.scene, comparison.until,
                            step_text(comparison.communication_step)));
  if (comparison.rows.empty()) return text + "interrupted before the first row\n";
  line("reference", reference_text(comparison));
  line("open", "largest opening of any joint [m, rad]; opening: how fast it opens [m/s, rad/s]");
  line("energy", energy_text(comparison));
  line("difference", fmt::format("largest and root mean square of {}", fitting(comparison.variables)));
  line("us/ms", fmt::format("microseconds of the mechanics for a simulated millisecond, each step at the fastest of {}",
                            counted(static_cast<std::uint64_t>(comparison.repeats), "run", "runs")));
  text += '\n';
  std::vector<Cells> rows = {heading(comparison)};
  for (const ComparedRow& row : comparison.rows) rows.push_back(cells_of(comparison, row));
  text += table_text(rows, "");
  for (const std::string& remark : remarks(comparison)) text += remark + '\n';
  return text;
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
  Cells cells = {"formulation",     "integrator", "step [s]", "joints open [m or rad]", "joints opening [m/s or rad/s]",
                 "energy drift [1]"};
  for (const VariableClass& one : comparison.classes) {
    cells.push_back(fmt::format("largest difference [{}]", one.unit));
    cells.push_back(fmt::format("RMS difference [{}]", one.unit));
  }
  cells.insert(cells.end(), {"mechanics [us/ms]", "slowest step [us/ms]", "all physics [us/ms]", "iterations per step",
                             "steps not converged", "stable"});
  std::string text = csv_line(cells);
  for (const ComparedRow& row : comparison.rows) text += csv_line(csv_cells(comparison, row));
  return text;
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
  const std::string title = escaped(comparison.scene);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}: accuracy against cost</title>\n"
      "<style>body{{font-family:sans-serif;margin:2em}}pre{{overflow-x:auto}}svg{{max-width:100%;height:auto}}</style>"
      "</head>\n<body>\n{1}<pre>{2}</pre>\n</body>\n</html>\n",
      title, report_svg(comparison), escaped(report_text(comparison)));
}

}  // namespace slew::cli
