// SPDX-License-Identifier: Apache-2.0
// `slewring simplify SCENE --error "Bag.position 1mm"`: finds the parts of a scene that may be left out by trial,
// measures the saving and writes an overlay.
#include <fmt/format.h>

#include <cstdio>

#include "analysis/simplify/simplify.h"
#include "analysis/tradeoff/overlay.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "program/add_scene_options.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

struct SimplifyOptions {
  analysis::SimplifyOptions settings;
  std::string overlay;
  bool is_json = false, is_quiet = false;
};

std::string remark(const analysis::Simplification& result) {
  std::string text = "simplify with";
  for (const analysis::Watched& watched : result.watched) {
    text += fmt::format(" {} {:.4g} {},", watched.name, watched.tolerance, watched.unit);
  }
  return fmt::format("{} {:.3g} instead of {:.3g} us per simulated ms", text, result.combined.cost, result.base_cost);
}

ExitCode run(const SimplifyOptions& options) {
  if (options.settings.scene.input == "keyboard") {
    throw Failure(ExitCode::bad_input,
                  "--input keyboard: every run needs the same input; nothing was run; write it into a "
                  ".csv file");
  }
  const std::string target = analysis::overlay_target(options.settings.scene.file, options.overlay, "simplified");
  session::count_interrupts();
  analysis::Simplification result;
  {
    ProgressLine line(options.is_quiet);
    result = analysis::simplify(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  if (result.helps()) {
    scene::Overrides settings = options.settings.scene.overrides;
    settings.insert(settings.end(), result.settings.begin(), result.settings.end());
    analysis::write_overlay(options.settings.scene.file, settings, remark(result), target);
  }
  if (options.is_json) {
    Json json = analysis::report_json(result);
    if (result.helps()) json["overlay"] = target;
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}", analysis::report_text(result, output_width()));
    if (result.helps()) fmt::print("{}\n", target);
  }
  return session::interrupts() > 0 ? static_cast<ExitCode>(session::interrupt_code()) : ExitCode::ok;
}

}  // namespace

void add_simplify(options::Command& program) {
  options::Command verb =
      program.command("simplify", "parts of a scene that may be left out while chosen variables stay as they are");
  const auto options = std::make_shared<SimplifyOptions>();  // lives as long as the command line's callbacks
  analysis::SimplifyOptions& settings = options->settings;
  program::add_scene_file(verb, "scene", settings.scene.file).required();
  verb.option("--error", settings.errors,
              "a variable and by how much it may change: a quantity, or a part of its range in %; repeat for more; "
              "without it 1 mm of the position of each payload that the scene names")
      .value_name("'VARIABLE TOLERANCE'")
      .one_value_each();
  verb.option("--until", settings.scene.duration, "how long each run is; without it the scene's duration")
      .value_name("TIME");
  verb.option("--set", settings.scene.overrides, "change a value of the scene first; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  verb.option("--input", settings.scene.input, "script (the scene's own), none, or a .csv, .yaml or .lcm file")
      .value_name("SOURCE")
      .show_default();
  verb.option("-o,--overlay", options->overlay, "file to write, beside the scene; without it SCENE_simplified.yaml")
      .value_name("FILE");
  verb.option("--repeats", settings.repeats, "timed runs of everything tried")
      .between(1, 100)
      .value_name("N")
      .show_default();
  verb.flag("--json", options->is_json, "print the result as JSON and nothing else");
  verb.flag("--quiet", options->is_quiet, "no progress");
  verb.footer(
      "Every part is tried alone, then those that hold and save time together; all runs are in this process, with the\n"
      "same input. The overlay includes the scene. Scope of the judgement: "
      "docs/howto/describe-and-simplify.md.\n\n"
      "Example:\n"
      "  slewring simplify scenes/truck_crane.yaml --error 'Bag.position 1mm' --error 'Cyl_Lift.force 1%'");
  verb.action([options] { return run(*options); });
}

}  // namespace slew::cli
