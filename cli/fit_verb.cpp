// SPDX-License-Identifier: Apache-2.0
// `slewring fit SCENE --data FILE`: values of a scene that bring its signals nearest to measured ones.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "analysis/fit/fit.h"
#include "analysis/fit/signal_run.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/text_output.h"
#include "program/add_scene_options.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

constexpr int kMostFitIterations = 1000;

struct FitOptions {
  analysis::FitOptions settings;
  bool is_json = false, is_quiet = false;
};

struct FitRowOptions {
  std::string job, result;
  scene::Overrides settings;
};

ExitCode run_fit(const FitOptions& options) {
  if (!analysis::has_least_squares()) {
    throw Failure(ExitCode::resources,
                  "this build has no least squares; nothing was run; install libceres-dev and build Slewring again");
  }
  if (options.settings.scene.input == "keyboard") {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: every run needs the same input; nothing was run; write it into a .csv file");
  }
  session::count_interrupts();
  analysis::Fit fit;
  {
    ProgressLine line(options.is_quiet);
    fit = analysis::fit_scene(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  if (session::interrupts() > 0) {
    std::fprintf(stderr, "slewring: interrupted after %zu runs; they are kept, the same command continues\n", fit.runs);
    return static_cast<ExitCode>(session::interrupt_code());
  }
  const std::filesystem::path folder = fit.folder;
  write_text((folder / "fit.json").string(), report_json(fit).dump(2) + '\n');
  write_text((folder / "index.html").string(), report_html(fit));
  fmt::print("{}", options.is_json ? report_json(fit).dump(2) + '\n' : report_text(fit, output_width()));
  if (!options.is_json) fmt::print("{}\n{}\n", (folder / "fit.json").string(), (folder / "index.html").string());
  std::fflush(stdout);
  return fit.is_determined() ? ExitCode::ok : ExitCode::failed;
}

ExitCode run_fit_row(const FitRowOptions& options) {
  const std::optional<Json> json = analysis::read_result(options.job);
  if (!json) throw Failure(ExitCode::bad_input, options.job + " is no job of a fit");
  analysis::SignalJob job = analysis::signal_job_from(*json);
  job.scene.overrides.insert(job.scene.overrides.end(), options.settings.begin(), options.settings.end());
  analysis::write_result(options.result, to_json(analysis::run_signals(job)));
  return ExitCode::ok;
}

}  // namespace

void add_fit(options::Command& program) {
  options::Command verb = program.command("fit", "values of a scene that bring its signals nearest to measured ones");
  const auto options = std::make_shared<FitOptions>();  // lives as long as the command line's callbacks
  analysis::FitOptions& settings = options->settings;
  program::add_scene_file(verb, "scene", settings.scene.file).required();
  verb.option("--data", settings.data, "CSV file with a column 'time [s]' and columns such as 'p_A [bar]'")
      .value_name("FILE")
      .required();
  const auto repeated = [&verb](const char* name, std::vector<std::string>& to, const char* text, const char* type) {
    return verb.option(name, to, text).one_value_each().value_name(type);
  };
  repeated("--map", settings.maps,
           "a column and the expression of variables that it measures, such as 'p_A=Vol_LiftCyl_A.pressure'; repeat "
           "for more",
           "COLUMN=EXPRESSION")
      .required();
  repeated("--free", settings.free, "a value of the scene, or a parameter, and its bounds; repeat for more",
           "PATH=LOW..HIGH")
      .required();
  repeated("--set", settings.scene.overrides, "change a value of the scene; repeat for more", "PATH=VALUE");
  verb.option("--input", settings.scene.input, "script (the scene's own), none, or a .csv, .yaml or .lcm file")
      .value_name("SOURCE")
      .show_default();
  verb.option("--iterations", settings.most_iterations, "at most")
      .between(1, kMostFitIterations)
      .value_name("N")
      .show_default();
  verb.option("-o,--output", settings.engine.folder, "folder of the results and of the runs")
      .value_name("DIR")
      .required();
  verb.flag("--anew", settings.engine.is_fresh, "discard the runs that the folder has");
  verb.option("--workers", settings.engine.workers, "processes at once")
      .between(1, analysis::kMostWorkers)
      .value_name("N")
      .show_default();
  verb.flag("--json", options->is_json, "print the result as JSON and nothing else");
  verb.flag("--quiet", options->is_quiet, "no progress");
  verb.footer(
      "The search begins at the scene's own values. Exit code 0: it converged and the data determine the values; 1: "
      "not.\nWhat the intervals mean: docs/howto/sweep.md.\n\n"
      "Example:\n"
      "  slewring fit scenes/single_cylinder.yaml --data measured.csv --map 'F=Cyl_Lift.force' "
      "--free Boom.mass=400kg..900kg -o fit");
  verb.action([options] { return run_fit(*options); });
}

// the process of one run of a fit; not a verb for users
void add_fit_row(options::Command& program) {
  options::Command verb = program.command("fit-row", "one run of a fit");
  verb.hide();
  const auto options = std::make_shared<FitRowOptions>();
  verb.option("job", options->job, "file of the fit's job").required();
  verb.option("--set", options->settings, "value of the run").one_value_each();
  verb.option("--result", options->result, "file to write").required();
  verb.action([options] { return run_fit_row(*options); });
}

}  // namespace slew::cli
