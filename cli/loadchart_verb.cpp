// SPDX-License-Identifier: Apache-2.0
// `slewring loadchart SCENE`: the largest payload over the reach for each limit, as table, CSV, JSON and picture.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "analysis/load_chart/load_chart.h"
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

struct ChartOptions {
  analysis::LoadChartOptions settings;
  std::vector<std::string> outputs;
  bool is_json = false, is_quiet = false;
};

std::string ending_of(const std::string& file) {
  return std::filesystem::path(file).extension().string();
}

void check_outputs(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const std::string ending = ending_of(file);
    if (ending == ".csv" || ending == ".json" || ending == ".svg") continue;
    throw Failure(ExitCode::bad_input, "'" + file +
                                           "' ends neither in .csv, .json nor .svg; nothing was computed; name "
                                           "such a file");
  }
}

ExitCode make_chart(const ChartOptions& options) {
  check_outputs(options.outputs);
  session::count_interrupts();
  analysis::LoadChart chart;
  {
    ProgressLine line(options.is_quiet);
    chart = analysis::find_load_chart(options.settings, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  for (const std::string& file : options.outputs) {
    const std::string ending = ending_of(file);
    write_text(file, ending == ".csv"    ? report_csv(chart)
                     : ending == ".json" ? report_json(chart).dump(2) + '\n'
                                         : report_svg(chart));
  }
  fmt::print("{}", options.is_json ? report_json(chart).dump(2) + '\n' : report_text(chart, output_width()));
  if (!options.is_json) {
    for (const std::string& file : options.outputs) fmt::print("{}\n", file);
  }
  std::fflush(stdout);
  return session::interrupts() > 0 ? static_cast<ExitCode>(session::interrupt_code()) : ExitCode::ok;
}

}  // namespace

void add_loadchart(options::Command& program) {
  options::Command verb = program.command("loadchart", "largest payload over the reach, and what limits it");
  const auto options = std::make_shared<ChartOptions>();  // lives as long as the command line's callbacks
  analysis::LoadChartOptions& settings = options->settings;
  program::add_scene_file(verb, "scene", settings.scene).required();
  const auto repeated = [&verb](const char* name, std::vector<std::string>& to, const char* text, const char* value) {
    return verb.option(name, to, text).one_value_each().value_name(value);
  };
  repeated("--over", settings.over,
           "a joint and its positions, such as 'Boom=-20deg..60deg:9' or 'Boom=0deg,30deg'; for one or two joints",
           "JOINT=VALUES")
      .required();
  repeated("--tipping-line", settings.lines,
           "two points of Ground [m] about whose line the machine tips, such as '1.4 0 -1.2, 1.4 0 1.2', and where its "
           "side is to be stated a third one on the machine's side, ', 0 0 0'; repeat for more; without it the lines "
           "around the scene's tyres",
           "POINTS");
  repeated("--structure", settings.structure,
           "force that a cylinder's structure allows, 'Cyl_Lift=400kN'; repeat for more", "CYLINDER=FORCE");
  verb.option("--from", settings.from, "body from whose origin the reach is measured (default: Ground)")
      .value_name("BODY");
  repeated("--set", settings.overrides, "change a value of the scene; repeat for more", "PATH=VALUE");
  repeated("-o,--output", options->outputs, "file to write: .csv, .json or .svg; repeat for more", "FILE");
  verb.flag("--json", options->is_json, "print the chart as JSON");
  verb.flag("--quiet", options->is_quiet, "no progress");
  verb.footer(
      "At each position of the joints the machine stands at rest. Limits: each cylinder with the pressure that its\n"
      "circuit gives at full stick, tipping, and the forces of --structure. No safety factor is contained.\n"
      "How to read a chart: docs/howto/loadchart.md.\n\n"
      "Examples:\n"
      "  slewring loadchart scenes/truck_crane.yaml --over Pillar_LiftBoom=0deg..60deg:13\n"
      "  slewring loadchart scenes/excavator_20t.yaml --over Boom_Foot=-40deg..50deg:10 --over "
      "Stick_Pin=-140deg..-30deg:12 -o chart.svg");
  verb.action([options] { return make_chart(*options); });
}

}  // namespace slew::cli
