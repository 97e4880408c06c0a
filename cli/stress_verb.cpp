// `slewring stress SCENE`: how well this machine keeps a scene's deadlines.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "cli/interrupts.h"
#include "cli/progress_line.h"
#include "cli/stress/stress_report.h"
#include "cli/text_output.h"
#include "cli/verbs.h"
#include "cli_support/number_range.h"
#include "core/failure.h"

namespace slew::cli {
namespace {

struct Options {
  StressWish wish;
  StressBounds bounds;
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

void complete(Options& options) {
  StressWish& wish = options.wish;
  const bool all = options.is_matrix;
  if (options.schedulings.empty()) {
    options.schedulings = all ? std::vector<std::string>{"normal", "fifo"}
                              : std::vector<std::string>{options.is_real_time ? "fifo" : "normal"};
  }
  if (options.loads.empty()) {
    options.loads = all ? std::vector<std::string>{"none", "cpu", "mixed"} : std::vector<std::string>{"none"};
  }
  if (wish.works_us.empty()) wish.works_us = all ? std::vector<double>{0, 200} : std::vector<double>{0};
  leave_out_repeats(options.schedulings);
  leave_out_repeats(options.loads);
  leave_out_repeats(wish.works_us);
  for (const std::string& text : options.schedulings) {
    wish.schedulings.push_back(text == "fifo" ? Scheduling::fifo : Scheduling::normal);
  }
  for (const std::string& text : options.loads) {
    wish.loads.push_back(text == "cpu" ? Load::cpu : text == "mixed" ? Load::mixed : Load::none);
  }
  wish.scene.pace = "real";
  static_cast<void>(cli_support::load_scene(wish.scene));     // what is replaced below is refused as everywhere
  wish.scene.overrides.emplace_back("session.overrun=slip");  // a cell goes on to its end
  wish.scene.duration = fmt::format("{} s", wish.seconds);
}

ExitCode run(Options options) {
  complete(options);
  if (!options.page.empty()) require_writable(options.page);
  count_interrupts();
  Stress stress;
  {
    ProgressLine line(options.is_quiet);
    stress = run_stress(options.wish, options.bounds, [&line](std::string_view doing, double share) {
      line.show(doing, share);
      return interrupts() == 0;
    });
  }
  fmt::print("{}", options.is_json ? report_json(stress) + '\n' : report_text(stress));
  std::fflush(stdout);
  for (const StressCell& cell : stress.cells) {
    if (cell.skipped.empty()) continue;
    std::fprintf(stderr,
                 "slewring: warning: SCHED_FIFO was refused, and cells that need it were not run; run as root, or set "
                 "'rtprio 95' and 'memlock unlimited' for the user in /etc/security/limits.conf and log in again\n");
    break;
  }
  if (!options.page.empty()) {
    write_text(options.page, report_html(stress));
    if (!options.is_json) fmt::print("{}\n", options.page);
  }
  if (interrupts() > 0) return static_cast<ExitCode>(interrupt_code());
  return exit_code_of(stress);
}

void add_what(CLI::App& verb, Options& options) {
  StressWish& wish = options.wish;
  verb.add_option("scene", wish.scene.file, "scene file")->required()->type_name("SCENE");
  verb.add_option("--set", wish.scene.overrides, "change a value of the scene; repeat for more")
      ->allow_extra_args(false)
      ->type_name("PATH=VALUE");
  verb.add_option("--step", wish.scene.step, "communication step, such as '1 ms'; without it the scene's")
      ->type_name("TIME");
  verb.add_option("--input", wish.scene.input, "script (the scene's own), none, or a .csv or .yaml file")
      ->type_name("SOURCE")
      ->capture_default_str();
  verb.add_flag("!--no-record", wish.scene.is_recording, "without a recorder");
  verb.add_option("--seconds", wish.seconds, "session time of every cell; a quarter of it more for the yardstick")
      ->check(cli_support::number_range(0.5, 86400.0))
      ->type_name("S")
      ->capture_default_str();
}

void add_cells(CLI::App& verb, Options& options) {
  CLI::Option* matrix =
      verb.add_flag("--matrix", options.is_matrix,
                    "all cells: normal and fifo, no, cpu and mixed load, 0 and 200 us added; without it one of them")
          ->group("Cells");
  CLI::Option* real_time =
      verb.add_flag("--rt", options.is_real_time, "the one cell with SCHED_FIFO")->excludes(matrix)->group("Cells");
  verb.add_option("--scheduling", options.schedulings, "normal, fifo")
      ->excludes(real_time)
      ->check(CLI::IsMember({"normal", "fifo"}))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->group("Cells");
  verb.add_option("--load", options.loads,
                  "none; cpu: a busy process for every processor; mixed: and memory, disk and network")
      ->check(CLI::IsMember({"none", "cpu", "mixed"}))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->group("Cells");
  verb.add_option("--add-work", options.wish.works_us, "CPU time added to every step of each physics node")
      ->check(cli_support::number_range(0.0, 1e6))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("US")
      ->group("Cells");
  verb.add_option("--cpu", options.wish.cpus, "where the nodes run, such as mechanics=1,hydraulics=0; else the scene's")
      ->type_name("ROLE=N")
      ->group("Cells");
}

void add_verdict(CLI::App& verb, Options& options) {
  verb.add_option_function<double>(
          "--max-miss", [&options](double percent) { options.bounds.max_miss = percent / 100; },
          "most steps that may be longer than the communication step")
      ->check(cli_support::number_range(0.0, 100.0))
      ->type_name("PERCENT")
      ->group("Verdict");
  verb.add_option_function<double>(
          "--p99", [&options](double us) { options.bounds.p99 = us * 1e-6; }, "longest response of 99 % of the steps")
      ->check(cli_support::number_range(0.0, 1e9))
      ->type_name("US")
      ->group("Verdict");
}

}  // namespace

void add_stress(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("stress", "how well this machine keeps a scene's deadlines, and a bare loop");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks
  add_what(*verb, *options);
  add_cells(*verb, *options);
  add_verdict(*verb, *options);
  cli_support::add_network_options(*verb, options->wish.session);
  verb->add_option("--folder", options->wish.folder, "for recordings and files that come and go")
      ->type_name("DIR")
      ->capture_default_str();
  verb->add_option("-o,--output", options->page, "page with the largest responses over time")->type_name("FILE");
  verb->add_flag("--json", options->is_json, "print the result as JSON and nothing else");
  verb->add_flag("--quiet", options->is_quiet, "no progress");
  verb->footer(
      "Exit code 3 when a cell is over --max-miss or --p99, 7 when one could not be run. What is measured and how: "
      "docs/realtime.md.\n\n"
      "Examples:\n"
      "  slewring stress scenes/truck_crane.yaml --rt --seconds 60 --max-miss 0.5 --p99 500\n"
      "  slewring stress scenes/truck_crane.yaml --matrix --seconds 30 -o stress.html");
  verb->callback([&action, options] { action = [options] { return run(*options); }; });
}

// a process of other load: no verb for people
void add_stress_load(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("stress-load", "one process of other load")->group("");
  const auto options = std::make_shared<LoadOptions>();
  verb->add_option("kind", options->kind, "cpu, memory, disk or network")->required();
  verb->add_option("folder", options->folder, "where files come and go")->required();
  verb->callback([&action, options] {
    action = [options] {
      work_as(options->kind, options->folder);
      return ExitCode::ok;
    };
  });
}

}  // namespace slew::cli
