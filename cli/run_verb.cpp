// SPDX-License-Identifier: Apache-2.0
// `slewring run SCENE`: runs a scene as processes or in one process, records it, and prints its summary.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "analysis/run_report/run_report.h"
#include "analysis/start_check.h"
#include "cli/keyboard.h"
#include "cli/run_session.h"
#include "cli/status_line.h"
#include "cli/terminal.h"
#include "cli/verbs.h"
#include "cli/window_process.h"
#include "core/failure.h"
#include "core/node_names.h"
#include "core/printable.h"
#include "observer/observer.h"
#include "program/add_scene_options.h"
#include "program/add_session_options.h"
#include "program/node_options.h"
#include "scene/scene_outline.h"
#include "session/recording_forecast.h"
#include "session/run.h"
#include "session/unrecorded.h"

namespace slew::cli {

namespace {

// Shows a run on the terminal: a status line, and levers on the keyboard where the scene's input is `keyboard`.
class TerminalWatcher final : public session::RunWatcher {
 public:
  // Throws Failure (bad_input) when the input is the keyboard and standard input is no terminal.
  TerminalWatcher(const session::RunOptions& options, const scene::Scene& scene, WindowProcess* window)
      : mode_(status_mode(options.is_quiet || options.is_json)),
        status_(mode_),
        text_(scene),
        session_(options.session.session),
        window_(window) {
    if (options.scene.input == "keyboard") keyboard_.emplace(scene);
  }

  [[nodiscard]] bool reads_values() const override { return mode_ != StatusLine::Mode::off || keyboard_; }
  void begin() override {
    if (keyboard_) status_.print_line(keyboard_->levers().help());
    if (window_ != nullptr) window_->start(session_);
  }
  void report(const std::string& message) override { status_.print_line(message); }
  bool update(observer::Observer& observer, std::int64_t now_ns, bool is_ending) override {
    if (keyboard_) keyboard_->poll(observer, now_ns);
    print_window();
    text_.measure(observer.view(), now_ns);
    if (status_.is_due(now_ns) && !is_ending) status_.show(text_.text(observer.view(), status_width(mode_)), now_ns);
    return window_ == nullptr || !window_->wants_restart();
  }
  void end() override {
    if (window_ != nullptr) window_->finish();
    print_window();
    status_.clear();
  }

 private:
  void print_window() {
    if (window_ == nullptr) return;
    for (const std::string& line : window_->take_lines()) {
      status_.clear();
      fmt::print("{}\n", printable(line));
      std::fflush(stdout);
    }
  }

  StatusLine::Mode mode_;
  StatusLine status_;
  StatusText text_;
  std::optional<Keyboard> keyboard_;
  std::string session_;
  WindowProcess* window_;  // null: none
};

// All physics as one system: one process, without deadlines.
void check_monolithic(const options::Command& verb) {
  for (const char* option : {"--remote", "--domain", "--interface", "--peer", "--join-timeout", "--rt", "--cpu"}) {
    if (!verb.has(option)) continue;
    const std::string why = std::string_view(option) == "--rt" ? "the duration of its steps has no bound"
                                                               : "it is one system in one process";
    throw Failure(ExitCode::bad_input, fmt::format("a monolithic run takes no {}: {}; nothing was started; "
                                                   "leave one out",
                                                   option, why));
  }
}

// A controller cannot take part in a run in one process, and step 0 would wait for it.
void check_controllers(const scene::Scene& scene) {
  for (const scene::InputDef& input : scene.inputs) {
    if (input.controller == scene::ControllerMode::sampled) continue;
    throw Failure(ExitCode::bad_input,
                  fmt::format("a run in one process has no place for a controller, and input {0} waits for "
                              "one in every step (controller: lockstep); nothing was started; run it as "
                              "processes, or without the controller: --set {0}.controller=sampled",
                              input.name));
  }
}

ExitCode run(session::RunOptions options, const options::Command& verb) {
  if (options.is_monolithic) options.scene.overrides.emplace_back("session.solution=monolithic");
  if (!options.rtol.empty()) options.scene.overrides.push_back("session.rtol=" + options.rtol);
  if (options.is_monolithic && !options.scene.from.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--from and --monolithic exclude each other: CVODE's history is not saved; nothing was "
                  "started; leave one out");
  }
  const io_node::SessionScene session = io_node::load_session_scene(options.scene);
  if (session.scene.session.solution == scene::Solution::monolithic) {
    check_monolithic(verb);
    options.is_in_process = true;
  }
  return run_session(std::move(options), session);
}

// A model that cannot be built is reported by the run.
void print_forecast(const scene::Scene& scene) {
  try {
    const session::DirectSession session(scene);
    fmt::print("{}\n", session::forecast_text(
                           scene, session::recorded_bytes(scene, session::recorded_numbers(scene, session))));
    std::fflush(stdout);
  } catch (const Failure&) {
    return;
  }
}

void print_messages(const analysis::RunReport& report) {
  for (const std::string& message : report.messages) std::fprintf(stderr, "%s\n", printable_lines(message).c_str());
}

// For people; the path of the recording is the last line. Of a session that failed before its first step the messages
// alone.
void print(const analysis::RunReport& report) {
  if (report.steps == 0 && report.code != ExitCode::ok) return print_messages(report);
  fmt::print("{}", analysis::report_text(report, output_width()));
  std::fflush(stdout);
  print_messages(report);
  if (!report.plots.empty()) fmt::print("{}\n", printable(report.plots));
  if (!report.recording.empty()) fmt::print("{}\n", printable(report.recording));
}

// With --json standard output has a result in every case; the texts are on standard error too.
ExitCode run_or_report(const session::RunOptions& options, const options::Command& verb) {
  try {
    return run(options, verb);
  } catch (const scene::LoadError& error) {
    if (options.is_json) fmt::print("{}\n", scene::problems_json(error).dump(2));
    throw;
  } catch (const Failure& failure) {
    if (options.is_json) fmt::print("{}\n", scene::problems_json(failure).dump(2));
    throw;
  }
}

}  // namespace

ExitCode run_session(session::RunOptions options, const io_node::SessionScene& session, WindowProcess* window) {
  const scene::Scene& scene = session.scene;
  for (const std::string& warning : scene.warnings)
    std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
  for (const std::string& warning : session::unrecorded_plots(scene))
    std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
  for (const std::string& warning : session::unmet_patterns(scene))
    std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
  for (const std::string& warning : analysis::start_warnings(scene))
    std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
  if (options.session.session.empty()) options.session.session = node::session_name_of(scene.name);
  if (options.is_in_process && !options.remote.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--in-process and --remote exclude each other; nothing was started; leave one out");
  }
  if (options.is_in_process) check_controllers(scene);
  if (options.is_in_process && !options.cpus.empty()) {
    throw Failure(ExitCode::bad_input,
                  "--cpu places processes, and --in-process has one; nothing was started; leave one out");
  }
  if (options.is_in_process && options.join_timeout) {
    throw Failure(ExitCode::bad_input,
                  "--join-timeout waits for other processes, and --in-process has none; nothing was "
                  "started; leave one out");
  }
  if (options.is_in_process && !options.is_without_devices && !scene.devices.names().empty()) {
    std::fprintf(stderr,
                 "warning: the devices of the scene are not started: a run in one process has no place for a "
                 "controller; run it as processes\n");
  }
  if (options.scene.is_recording && !options.is_json && !options.is_quiet) print_forecast(scene);
  options.kept = analysis::report_variables(scene);
  TerminalWatcher watcher(options, scene, window);
  const session::RunOutcome outcome = options.is_in_process ? session::run_in_process(options, session, watcher)
                                                            : session::run_distributed(options, session, watcher);
  if (!outcome.has_begun) {
    const std::vector<std::string> messages = session::without_echoes(outcome.messages);
    if (options.is_json) {
      fmt::print("{}\n",
                 scene::problems_json(Failure(outcome.code, fmt::format("{}", fmt::join(messages, "\n")))).dump(2));
    }
    for (const std::string& message : messages) std::fprintf(stderr, "%s\n", printable_lines(message).c_str());
    return outcome.code;
  }
  const analysis::RunReport report = analysis::make_report(outcome, scene, options.assets());
  if (options.is_json) {
    fmt::print("{}\n", analysis::report_json(report).dump(2));
    print_messages(report);
  } else {
    print(report);
  }
  return report.code;
}

void add_running_options(options::Command& verb, session::RunOptions& options) {
  verb.option("--out", options.runs, "folder in which the recording gets a folder of its own")
      .value_name("DIR")
      .show_default();
  verb.option("--keep-free", options.keep_free_mb,
              "room on its file system that the recording leaves to others; 0: none")
      .between(0.0, 1e9)
      .value_name("MB")
      .show_default();
  verb.option("--join-timeout", options.join_timeout,
              "seconds to wait for all nodes of the session, and for lockstep controllers; without it 10")
      .between(program::kShortestJoin, program::kLongestJoin)
      .value_name("S")
      .group("Session");
  verb.flag("--rt", options.is_real_time, "real-time scheduling and locked memory for the nodes");
  verb.option("--cpu", options.cpus,
              "processor of each node, such as mechanics=1,hydraulics=0; without it session.cpus, else any")
      .value_name("ROLE=N");
  verb.flag("--without-devices", options.is_without_devices, "do not start the devices of the scene");
  verb.flag("--insecure-devices", options.are_devices_insecure,
            "let devices receive and send UDP beyond this machine: any program there can read the values and move the "
            "machine")
      .group("Network");
  verb.flag("--quiet", options.is_quiet, "no status line");
}

void add_run(options::Command& program) {
  options::Command verb = program.command("run", "run a scene: start its nodes, drive, record, plot");
  const auto options = std::make_shared<session::RunOptions>();  // lives as long as the command line's callbacks
  program::add_scene_options(verb, options->scene);
  program::add_session_options(verb, options->session, false);
  verb.find("--session").description("name of the session; without it the scene's");
  verb.option("--remote", options->remote, "roles that are started elsewhere, separated by commas")
      .comma_separated()
      .one_value_each()
      .one_of({std::begin(kNodeNames), std::end(kNodeNames)})
      .value_name("ROLE")
      .group("Session");
  verb.flag("--in-process", options->is_in_process, "all nodes in this process, on one thread").group("Session");
  options::Option monolithic =
      verb.flag("--monolithic", options->is_monolithic,
                "all physics as one system in this process (CVODE): the reference for accuracy")
          .group("Accuracy");
  verb.option("--rtol", options->rtol, "its relative tolerance, 1e-10 to 1e-3; without it the scene's")
      .needs(monolithic)
      .value_name("NUMBER")
      .group("Accuracy");
  add_running_options(verb, *options);
  verb.flag("--json", options->is_json, "print the summary as JSON and nothing else");
  verb.footer(
      "The first Ctrl-C ends the session in order, the second one at once.\n\n"
      "Examples:\n"
      "  slewring run scenes/truck_crane.yaml\n"
      "  slewring run scenes/truck_crane.yaml --set Bag.mass=1000kg --duration 10 --pace free --in-process\n"
      "  slewring run scenes/truck_crane.yaml --monolithic --rtol 1e-9 --pace free\n"
      "  slewring run scenes/truck_crane.yaml --remote hydraulics --interface eth0 --peer 192.168.1.20 "
      "--keys plant\n"
      "  slewring run --from crane.saved --set Bag.mass=1000kg --duration 60s");
  verb.action([options, verb] { return run_or_report(*options, verb); });
}

}  // namespace slew::cli
