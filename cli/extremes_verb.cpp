// SPDX-License-Identifier: Apache-2.0
// `slewring extremes SCENE|--suite`: the hard cases of a scene, each judged by its bounds, and its distance from the
// edge.
#include <fmt/format.h>

#include <cstdio>

#include "analysis/extremes/case_run.h"
#include "analysis/extremes/extremes.h"
#include "analysis/sweep/sweep.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/installation.h"
#include "program/add_scene_options.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

struct ExtremesOptions {
  analysis::ExtremesOptions settings;
  std::string scene, scenes = installed_scenes().empty() ? "scenes" : installed_scenes();
  bool is_suite = false, is_json = false, is_quiet = false;
};

struct CaseOptions {
  scene::SceneOptions scene;
  std::string name, result;
};

ExitCode run(ExtremesOptions options) {
  if (options.is_suite == !options.scene.empty()) {
    throw Failure(ExitCode::bad_input, "a scene file or --suite is needed, one of both; nothing was run");
  }
  options.settings.files =
      options.is_suite ? analysis::suite_files(options.scenes) : std::vector<std::string>{options.scene};
  session::count_interrupts();
  analysis::Extremes extremes;
  {
    ProgressLine line(options.is_quiet);
    extremes = analysis::run_extremes(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  fmt::print(
      "{}", options.is_json ? analysis::report_json(extremes) + '\n' : analysis::report_text(extremes, output_width()));
  std::fflush(stdout);
  if (session::interrupts() > 0) return static_cast<ExitCode>(session::interrupt_code());
  return extremes.is_good() ? ExitCode::ok : ExitCode::failed;
}

}  // namespace

void add_extremes(options::Command& program) {
  options::Command verb =
      program.command("extremes", "hard cases of a scene: within their bounds, and how near the edge");
  const auto options = std::make_shared<ExtremesOptions>();  // lives as long as the command line's callbacks
  analysis::ExtremesOptions& settings = options->settings;
  program::add_scene_file(verb, "scene", options->scene);
  verb.flag("--suite", options->is_suite, "the repository's own machines instead of a scene");
  verb.option("--scenes", options->scenes, "folder of the suite's scenes").value_name("DIR").show_default();
  const auto repeated = [&verb](const char* name, std::vector<std::string>& to, const char* text, const char* type) {
    verb.option(name, to, text).one_value_each().value_name(type);
  };
  repeated("--set", settings.overrides, "change a value of the scene for all cases; repeat for more", "PATH=VALUE");
  repeated("--only", settings.only, "run these cases: names, or patterns with * and ?; repeat for more", "NAME");
  verb.option("--folder", settings.folder, "where results are kept").value_name("DIR").show_default();
  verb.flag("--anew", settings.is_fresh, "compute also what the folder has already");
  verb.option("--workers", settings.workers, "processes at once")
      .between(1, analysis::kMostWorkers)
      .value_name("N")
      .show_default();
  verb.flag("--json", options->is_json, "print the table as JSON and nothing else");
  verb.flag("--quiet", options->is_quiet, "no progress");
  verb.footer(
      "Each case is a process of its own, two at once. Ctrl-C keeps what is done; the same command goes on from "
      "there.\n"
      "Exit code 0: every case ended within its bounds or was refused by name, before it ran or by the session's own "
      "alarm;\n1: one was not.\n"
      "The cases, their bounds and the suite's table: docs/extremes.md.\n\n"
      "Examples:\n"
      "  slewring extremes scenes/truck_crane.yaml\n"
      "  slewring extremes --suite --only 'lost_*' --only end_stops");
  verb.action([options] { return run(*options); });
}

// the process of one case; not a verb for users
void add_extremes_case(options::Command& program) {
  options::Command verb = program.command("extremes-case", "one hard case");
  verb.hide();
  const auto options = std::make_shared<CaseOptions>();
  verb.option("scene", options->scene.file, "scene file").required();
  verb.option("name", options->name, "case").required();
  verb.option("--set", options->scene.overrides, "change").one_value_each();
  verb.option("--result", options->result, "file to write").required();
  verb.action([options] {
    analysis::write_result(options->result, analysis::to_json(analysis::run_case(options->scene, options->name)));
    return ExitCode::ok;
  });
}

}  // namespace slew::cli
