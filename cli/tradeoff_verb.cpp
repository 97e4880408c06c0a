// SPDX-License-Identifier: Apache-2.0
// `slewring tradeoff SCENE`: error against cost of many settings of one scene, and the best of them.
#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "analysis/tradeoff/overlay.h"
#include "analysis/tradeoff/tradeoff_report.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/text_output.h"
#include "program/add_scene_options.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

struct TradeoffOptions {
  analysis::TradeoffOptions settings;
  std::string budget;
  std::string page, csv, overlay;
  bool is_full = false, is_json = false, is_quiet = false;

  [[nodiscard]] bool has_question() const { return !budget.empty() || !settings.errors.empty(); }
};

struct RowOptions {
  std::string job, result;
};

// the answer's settings beside the user's own changes
scene::Overrides overlay_settings(const TradeoffOptions& options, const analysis::TradeoffRow& row) {
  scene::Overrides overrides = options.settings.scene.overrides;
  for (std::string& one : analysis::overrides_of(row.settings)) overrides.push_back(std::move(one));
  return overrides;
}

std::optional<analysis::Answer> answer(const TradeoffOptions& options, const analysis::Tradeoff& tradeoff) {
  analysis::Answer answer;
  if (!options.budget.empty()) answer.question.budget = analysis::parse_budget(options.budget);
  for (const std::string& text : options.settings.errors)
    answer.question.errors.push_back(analysis::parse_error(text, tradeoff));
  if (!answer.question.has_limits()) return std::nullopt;
  answer.row = analysis::best_row(tradeoff, answer.question);
  if (answer.row && *answer.row > 0) {
    analysis::write_overlay(tradeoff.file, overlay_settings(options, tradeoff.rows[*answer.row]),
                            "tradeoff: " + analysis::answer_text(tradeoff, answer), options.overlay);
    answer.overlay = options.overlay;
  }
  return answer;
}

ExitCode run(TradeoffOptions options) {
  if (options.settings.scene.input == "keyboard") {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: every run needs the same input; nothing was run; write it "
                  "into a .csv file");
  }
  // refused before anything has run
  if (!options.budget.empty()) static_cast<void>(analysis::parse_budget(options.budget));
  if (options.has_question())
    options.overlay = analysis::overlay_target(options.settings.scene.file, options.overlay, "tradeoff");
  options.settings.size = options.is_full ? analysis::GridSize::full : analysis::GridSize::modest;
  session::count_interrupts();
  analysis::Tradeoff tradeoff;
  {
    ProgressLine line(options.is_quiet);
    tradeoff = analysis::trade_off(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  const std::optional<analysis::Answer> found = tradeoff.done() > 0 ? answer(options, tradeoff) : std::nullopt;
  fmt::print("{}", options.is_json ? analysis::report_json(tradeoff, found) + '\n'
                                   : analysis::report_text(tradeoff, found, output_width()));
  std::fflush(stdout);
  const std::string page = options.page.empty() ? tradeoff.folder + "/tradeoff.html" : options.page;
  write_text(page, analysis::report_html(tradeoff, found));
  if (!options.csv.empty()) write_text(options.csv, analysis::report_csv(tradeoff));
  if (!options.is_json) {
    if (found && !found->overlay.empty()) fmt::print("{}\n", found->overlay);
    if (!options.csv.empty()) fmt::print("{}\n", options.csv);
    fmt::print("{}\n", page);
  }
  if (session::interrupts() > 0) return static_cast<ExitCode>(session::interrupt_code());
  return found && !found->row ? ExitCode::failed : ExitCode::ok;
}

ExitCode run_row(const RowOptions& options) {
  std::ifstream in(options.job, std::ios::binary);
  const std::optional<Json> job = Json::parse(std::string(std::istreambuf_iterator<char>(in), {}));
  if (!job) throw Failure(ExitCode::bad_input, options.job + " is no row of a tradeoff");
  analysis::write_result(options.result, analysis::to_json(analysis::compute(analysis::job_from(*job))));
  return ExitCode::ok;
}

void add_what(options::Command& verb, TradeoffOptions& options) {
  analysis::TradeoffOptions& settings = options.settings;
  program::add_scene_file(verb, "scene", settings.scene.file).required();
  const auto repeated = [&verb](const char* name, std::vector<std::string>& to, const char* text, const char* type) {
    verb.option(name, to, text).one_value_each().value_name(type);
  };
  repeated("--set", settings.scene.overrides, "change a value of the scene for all rows; repeat for more",
           "PATH=VALUE");
  repeated("--axis", settings.axes,
           "values of a setting to try, such as session.step=0.5ms,1ms,2ms; repeat for the product. Without it the "
           "scene's own axes: step, coupling, formulation, integrators, tolerances, modes, contact",
           "PATH=VALUES");
  repeated(
      "--variables", settings.variables,
      "variables whose error is shown: names, or patterns with * and ?; repeat for more; without it the forces of the "
      "actuators and the place of the payload (payload)",
      "PATTERN");
  verb.flag("--full", options.is_full, "the whole product of the scene's own axes: may take hours");
  verb.option("--until", settings.scene.duration,
              "how long to simulate, such as '5 s'; without it the scene's duration")
      .value_name("TIME");
  verb.option("--input", settings.scene.input, "script (the scene's own), none, or a .csv, .yaml or .lcm file")
      .value_name("SOURCE")
      .show_default();
}

void add_answers(options::Command& verb, TradeoffOptions& options) {
  verb.option("--budget", options.budget, "answer: least error at no more than this cost, such as '20 us/ms'")
      .value_name("COST")
      .group("Answer");
  verb.option("--error", options.settings.errors,
              "answer: least cost with no more than this error, such as 'Cyl_Lift.force 1%' (of its range) or "
              "'Bag.position 1mm'; repeat for more")
      .one_value_each()
      .value_name("BOUND")
      .group("Answer");
  verb.option("--overlay", options.overlay,
              "where the answer is written as a scene; without it SCENE_tradeoff.yaml beside the scene")
      .value_name("FILE")
      .group("Answer");
}

void add_how(options::Command& verb, TradeoffOptions& options) {
  analysis::TradeoffOptions& settings = options.settings;
  verb.option("--folder", settings.folder, "where results are kept; without it runs/tradeoff-SCENE").value_name("DIR");
  verb.flag("--anew", settings.is_fresh, "compute also what the folder has already");
  verb.option("--workers", settings.workers, "processes at once")
      .between(1, analysis::kMostWorkers)
      .value_name("N")
      .show_default();
  verb.option("--repeats", settings.repeats, "timed runs of every row")
      .between(1, analysis::kMostTimedRuns)
      .value_name("N")
      .show_default();
  verb.option("-o,--output", options.page, "the page; without it tradeoff.html in the folder").value_name("FILE");
  verb.option("--csv", options.csv, "write the table as comma-separated values too").value_name("FILE");
  verb.flag("--json", options.is_json, "print the table as JSON and nothing else");
  verb.flag("--quiet", options.is_quiet, "no progress");
}

}  // namespace

void add_tradeoff(options::Command& program) {
  options::Command verb = program.command("tradeoff", "error against cost of a scene's settings, and the best of them");
  const auto options = std::make_shared<TradeoffOptions>();  // lives as long as the command line's callbacks
  add_what(verb, *options);
  add_answers(verb, *options);
  add_how(verb, *options);
  verb.footer(
      "Each row is a process of its own, two at once. Ctrl-C keeps what is done; the same command goes on from there.\n"
      "What the columns mean: docs/howto/tradeoff.md.\n\n"
      "Examples:\n"
      "  slewring tradeoff scenes/truck_crane.yaml --budget '20 us/ms'\n"
      "  slewring tradeoff scenes/truck_crane.yaml --until 5s --axis session.step=1ms,2ms,5ms "
      "--axis session.coupling=hold,two --error 'Cyl_Lift.force 1%'");
  verb.action([options] { return run(*options); });
}

// the process of one row; not a verb for users
void add_tradeoff_row(options::Command& program) {
  options::Command verb = program.command("tradeoff-row", "one row of a tradeoff");
  verb.hide();
  const auto options = std::make_shared<RowOptions>();
  verb.option("job", options->job, "file of the row").required();
  verb.option("--result", options->result, "file to write").required();
  verb.action([options] { return run_row(*options); });
}

}  // namespace slew::cli
