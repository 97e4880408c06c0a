// SPDX-License-Identifier: Apache-2.0
// `slewring compare SCENE`: one scene and input under every formulation, as a table and a picture of error over cost.
#include <fmt/format.h>

#include <cstdio>

#include "analysis/comparison/comparison_report.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/text_output.h"
#include "program/add_scene_options.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

struct CompareOptions {
  analysis::ComparisonOptions settings;
  std::string picture;  // empty: in the working folder, named after the scene
  std::string csv;
  bool is_json = false;
  bool is_quiet = false;
};

bool is_html(const std::string& path) {
  return path.ends_with(".html") || path.ends_with(".htm");
}

// a wrong name is refused before the runs
void check_picture(const std::string& path) {
  if (path.empty() || path.ends_with(".svg") || is_html(path)) return;
  throw Failure(ExitCode::bad_input,
                "-o " + path + ": the picture is .svg or .html; nothing was run; give the file one of these endings");
}

ExitCode run(const CompareOptions& options) {
  check_picture(options.picture);
  if (options.settings.scene.input == "keyboard") {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: every run needs the same input; nothing was run; write it "
                  "into a .csv file");
  }
  session::count_interrupts();
  analysis::Comparison comparison;
  {
    ProgressLine line(options.is_quiet);
    comparison = analysis::compare(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  fmt::print("{}", options.is_json ? analysis::report_json(comparison) + '\n'
                                   : analysis::report_text(comparison, output_width()));
  std::fflush(stdout);
  if (!comparison.rows.empty()) {
    if (!options.csv.empty()) write_text(options.csv, analysis::report_csv(comparison));
    const std::string path = options.picture.empty() ? comparison.scene + "_compare.svg" : options.picture;
    write_text(path, is_html(path) ? analysis::report_html(comparison) : analysis::report_svg(comparison));
    if (!options.is_json) {
      if (!options.csv.empty()) fmt::print("{}\n", options.csv);
      fmt::print("{}\n", path);
    }
  }
  return session::interrupts() > 0 ? static_cast<ExitCode>(session::interrupt_code()) : ExitCode::ok;
}

void add_what(options::Command& verb, CompareOptions& options) {
  analysis::ComparisonOptions& settings = options.settings;
  program::add_scene_file(verb, "scene", settings.scene.file).required();
  const auto list = [&verb](const char* name, std::vector<std::string>& to, const char* text, const char* type) {
    verb.option(name, to, text).comma_separated().one_value_each().value_name(type);
  };
  list("--formulations", settings.formulations, "names separated by commas, or all; all without it", "NAMES");
  list("--integrators", settings.integrators, "names separated by commas, or all; without it the scene's", "NAMES");
  list("--steps", settings.steps,
       "sub-steps of the mechanics, such as 0.5ms,1ms, that divide the communication step; a multiple of that "
       "replaces it too. Without it the whole, a half and a quarter of the scene's",
       "TIMES");
  verb.option("--until", settings.scene.duration,
              "how long to simulate, such as '5 s'; without it the scene's duration")
      .value_name("TIME");
  verb.option("--variables", settings.variables,
              "variables whose difference to the reference is shown: names, or patterns with * and ?; repeat for more; "
              "without it origins and centres of mass of all bodies")
      .value_name("PATTERN")
      .one_value_each();
  verb.option("--reference", settings.reference_step,
              "sub-step of the reference; without it an eighth of the smallest of the steps")
      .value_name("TIME");
  verb.option("--repeats", settings.repeats, "timed runs of every row")
      .between(1, analysis::kMostTimedRuns)
      .value_name("N")
      .show_default();
}

}  // namespace

void add_compare(options::Command& program) {
  options::Command verb = program.command("compare", "accuracy against cost of formulations, integrators and steps");
  const auto options = std::make_shared<CompareOptions>();  // lives as long as the command line's callbacks
  add_what(verb, *options);
  verb.option("--set", options->settings.scene.overrides, "change a value of the scene; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  verb.option("--input", options->settings.scene.input, "script (the scene's own), none, or a .csv, .yaml or .lcm file")
      .value_name("SOURCE")
      .show_default();
  verb.option("-o,--output", options->picture, "picture, .svg or .html; without it SCENE_compare.svg")
      .value_name("FILE");
  verb.option("--csv", options->csv, "write the table as comma-separated values too").value_name("FILE");
  verb.flag("--json", options->is_json, "print the table as JSON and nothing else");
  verb.flag("--quiet", options->is_quiet, "no progress");
  verb.footer(
      "All runs are in this process, one after the other, with the same input. Ctrl-C prints the rows that are done.\n"
      "What the columns mean: docs/howto/compare.md.\n\n"
      "Examples:\n"
      "  slewring compare scenes/truck_crane.yaml --formulations all --until 5s\n"
      "  slewring compare scenes/four_bar.yaml --formulations recursive,lagrange --steps 0.5ms,1ms,2ms -o bars.html");
  verb.action([options] { return run(*options); });
}

}  // namespace slew::cli
