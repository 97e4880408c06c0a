// SPDX-License-Identifier: Apache-2.0
// `slewring stress SCENE`: measures how well this machine keeps a scene's deadlines.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include "analysis/stress/stress.h"
#include "cli/progress_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/text_output.h"
#include "program/add_scene_options.h"
#include "program/add_session_options.h"
#include "scene/scene_options.h"
#include "session/interrupts.h"

namespace slew::cli {
namespace {

struct StressOptions {
  analysis::StressOptions settings;
  analysis::StressBounds bounds;
  std::optional<double> max_miss_percent, p99_us;
  std::vector<std::string> schedulings, loads;
  std::string page;
  bool is_matrix = false, is_real_time = false, is_json = false, is_quiet = false;
};

struct LoadOptions {
  std::string kind, folder;
};

// A cell for each, the first of every value.
template <typename T>
void leave_out_repeats(std::vector<T>& values) {
  std::vector<T> kept;
  for (const T& value : values) {
    if (std::find(kept.begin(), kept.end(), value) == kept.end()) kept.push_back(value);
  }
  values = std::move(kept);
}

void complete(StressOptions& options) {
  analysis::StressOptions& settings = options.settings;
  const bool all = options.is_matrix;
  if (options.schedulings.empty()) {
    options.schedulings = all ? std::vector<std::string>{"normal", "fifo"}
                              : std::vector<std::string>{options.is_real_time ? "fifo" : "normal"};
  }
  if (options.loads.empty()) {
    options.loads = all ? std::vector<std::string>{"none", "cpu", "mixed"} : std::vector<std::string>{"none"};
  }
  if (settings.works_us.empty()) settings.works_us = all ? std::vector<double>{0, 200} : std::vector<double>{0};
  if (options.max_miss_percent) options.bounds.max_miss = *options.max_miss_percent / 100;
  if (options.p99_us) options.bounds.p99 = *options.p99_us * 1e-6;
  leave_out_repeats(options.schedulings);
  leave_out_repeats(options.loads);
  leave_out_repeats(settings.works_us);
  for (const std::string& text : options.schedulings) {
    settings.schedulings.push_back(text == "fifo" ? analysis::Scheduling::fifo : analysis::Scheduling::normal);
  }
  for (const std::string& text : options.loads) {
    settings.loads.push_back(text == "cpu"     ? analysis::Load::cpu
                             : text == "mixed" ? analysis::Load::mixed
                                               : analysis::Load::none);
  }
  settings.scene.pace = "real";
  static_cast<void>(
      scene::load_scene(settings.scene));  // the scene's errors are reported before its settings are replaced
  settings.scene.overrides.emplace_back("session.overrun=slip");  // a cell goes on to its end
  settings.scene.duration = fmt::format("{} s", settings.seconds);
}

ExitCode run(StressOptions options) {
  complete(options);
  if (!options.page.empty()) require_writable(options.page);
  session::count_interrupts();
  analysis::Stress stress;
  {
    ProgressLine line(options.is_quiet);
    stress = analysis::run_stress(options.settings, options.bounds, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return session::interrupts() == 0;
    });
  }
  fmt::print("{}",
             options.is_json ? analysis::report_json(stress) + '\n' : analysis::report_text(stress, output_width()));
  std::fflush(stdout);
  for (const analysis::StressCell& cell : stress.cells) {
    if (cell.skipped.empty()) continue;
    std::fprintf(stderr,
                 "slewring: warning: SCHED_FIFO was refused, and cells that need it were not run; run as root, or set "
                 "'rtprio 95' and 'memlock unlimited' for the user in /etc/security/limits.conf and log in again\n");
    break;
  }
  if (!options.page.empty()) {
    write_text(options.page, analysis::report_html(stress));
    if (!options.is_json) fmt::print("{}\n", options.page);
  }
  if (session::interrupts() > 0) return static_cast<ExitCode>(session::interrupt_code());
  return analysis::exit_code_of(stress);
}

void add_what(options::Command& verb, StressOptions& options) {
  analysis::StressOptions& settings = options.settings;
  program::add_scene_file(verb, "scene", settings.scene.file).required();
  verb.option("--set", settings.scene.overrides, "change a value of the scene; repeat for more")
      .one_value_each()
      .value_name("PATH=VALUE");
  verb.option("--step", settings.scene.step, "communication step, such as '1 ms'; without it the scene's")
      .value_name("TIME");
  verb.option("--input", settings.scene.input, "script (the scene's own), none, or a .csv, .yaml or .lcm file")
      .value_name("SOURCE")
      .show_default();
  verb.flag("!--no-record", settings.scene.is_recording, "without a recorder");
  verb.option(
          "--seconds", settings.seconds,
          "session time of every cell, more than twice session.start_grace (without it in the scene 1 s); a quarter "
          "of it more for the yardstick")
      .between(0.5, 86400.0)
      .value_name("S")
      .show_default();
}

void add_cells(options::Command& verb, StressOptions& options) {
  options::Option matrix =
      verb.flag("--matrix", options.is_matrix,
                "all cells: normal and fifo, no, cpu and mixed load, 0 and 200 us added; without it one of them")
          .group("Cells");
  options::Option real_time =
      verb.flag("--rt", options.is_real_time, "the one cell with SCHED_FIFO").excludes(matrix).group("Cells");
  verb.option("--scheduling", options.schedulings, "normal, fifo")
      .excludes(real_time)
      .one_of({"normal", "fifo"})
      .comma_separated()
      .one_value_each()
      .value_name("LIST")
      .group("Cells");
  verb.option("--load", options.loads,
              "none; cpu: a busy process for every processor; mixed: and memory, disk and network")
      .one_of({"none", "cpu", "mixed"})
      .comma_separated()
      .one_value_each()
      .value_name("LIST")
      .group("Cells");
  verb.option("--add-work", options.settings.works_us, "CPU time added to every step of each physics node")
      .between(0.0, 1e6)
      .comma_separated()
      .one_value_each()
      .value_name("US")
      .group("Cells");
  verb.option("--cpu", options.settings.cpus, "where the nodes run, such as mechanics=1,hydraulics=0; else the scene's")
      .value_name("ROLE=N")
      .group("Cells");
}

void add_verdict(options::Command& verb, StressOptions& options) {
  verb.option("--max-miss", options.max_miss_percent, "most steps that may be longer than the communication step")
      .between(0.0, 100.0)
      .value_name("PERCENT")
      .group("Verdict");
  verb.option("--p99", options.p99_us, "longest response of 99 % of the steps")
      .between(0.0, 1e9)
      .value_name("US")
      .group("Verdict");
}

}  // namespace

void add_stress(options::Command& program) {
  options::Command verb = program.command("stress", "how well this machine keeps a scene's deadlines, and a bare loop");
  const auto options = std::make_shared<StressOptions>();  // lives as long as the command line's callbacks
  add_what(verb, *options);
  add_cells(verb, *options);
  add_verdict(verb, *options);
  program::add_network_options(verb, options->settings.session);
  verb.option("--folder", options->settings.folder, "for recordings and files that come and go")
      .value_name("DIR")
      .show_default();
  verb.option("-o,--output", options->page, "page with the largest responses over time").value_name("FILE");
  verb.flag("--json", options->is_json, "print the result as JSON and nothing else");
  verb.flag("--quiet", options->is_quiet, "no progress");
  verb.footer(
      "Exit code 3 when a cell is over --max-miss or --p99, 7 when one could not be run. Quantities and method: "
      "docs/realtime.md.\n\n"
      "Examples:\n"
      "  slewring stress scenes/truck_crane.yaml --rt --seconds 60 --max-miss 0.5 --p99 500\n"
      "  slewring stress scenes/truck_crane.yaml --matrix --seconds 30 -o stress.html");
  verb.action([options] { return run(*options); });
}

// a process of other load; not a verb for users
void add_stress_load(options::Command& program) {
  options::Command verb = program.command("stress-load", "one process of other load");
  verb.hide();
  const auto options = std::make_shared<LoadOptions>();
  verb.option("kind", options->kind, "cpu, memory, disk or network").required();
  verb.option("folder", options->folder, "where files come and go").required();
  verb.action([options] {
    analysis::work_as(options->kind, options->folder);
    return ExitCode::ok;
  });
}

}  // namespace slew::cli
