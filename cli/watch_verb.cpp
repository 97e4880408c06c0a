// SPDX-License-Identifier: Apache-2.0
// `slewring watch VAR...`: values of variables of a running session, a line at a time.
#include <fmt/format.h>

#include <cstdio>

#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "node/driver.h"
#include "observer/observer.h"
#include "program/add_session_options.h"
#include "scene/name_pattern.h"
#include "session/survey.h"

namespace slew::cli {
namespace {

struct WatchOptions {
  node::SessionOptions session;
  std::vector<std::string> variables;
  double interval = 0.2;  // s
  std::int64_t count = 0;
  bool is_json = false;
};

constexpr SimDuration kDirectoryTimeout = milliseconds(5000);

std::vector<std::string> chosen_names(observer::Observer& observer, const std::vector<std::string>& patterns) {
  observer.wait_for([&] { return observer.view().has_whole_directory() || observer.view().is_over(); },
                    kDirectoryTimeout);
  std::vector<std::string> names;
  for (const observer::VariableView* variable : observer.view().variables()) names.push_back(variable->name);
  if (names.empty()) {
    throw Failure(ExitCode::failed, "session '" + observer.session_name() +
                                        "' has not named its variables within 5 s; it may still be "
                                        "starting: try again, or look with 'slewring sessions'");
  }
  return scene::choose(patterns, names);
}

void print_line(const observer::SessionView& view, const std::vector<std::string>& names, bool is_json) {
  StepIndex step = kJoinStep;
  for (const std::string& name : names) step = std::max(step, view.find(name)->step);
  if (step < 0) step = view.step();
  const double time = static_cast<double>(std::max<StepIndex>(0, step) * view.session().step_ns) * 1e-9;
  if (is_json) {
    Json line = {{"step", step}, {"time", time}, {"values", Json::object()}};
    for (const std::string& name : names) {
      const observer::VariableView& variable = *view.find(name);
      const bool is_left_out = view.is_left_out(name);
      if (is_left_out) line["left_out"].push_back(name);
      // null: none has come
      line["values"][name] = !is_left_out && variable.step >= 0 ? Json(variable.value) : Json();
    }
    fmt::print("{}\n", line.dump());
  } else {
    std::string line = fmt::format("{:10.3f} s", time);
    const char* const missing = view.is_paused() ? "comes with the next step, after the pause" : "not yet published";
    for (const std::string& name : names) {
      const observer::VariableView& variable = *view.find(name);
      line += fmt::format("  {} {}", name,
                          view.is_left_out(name) ? "left out (session.shed)"
                          : variable.step >= 0   ? quantity_text(variable.value, variable.unit, name)
                                                 : missing);
    }
    fmt::print("{}\n", printable(line));
  }
  std::fflush(stdout);
}

ExitCode watch(const WatchOptions& options) {
  node::install_signal_handlers();
  const auto observer = session::find_session(options.session, session::Access::look);
  const std::vector<std::string> names = chosen_names(*observer, options.variables);
  const SimDuration interval = duration_of_seconds(options.interval);
  for (std::int64_t lines = 0; options.count == 0 || lines < options.count; ++lines) {
    observer->wait_for([&] { return observer->view().is_over(); }, interval);
    print_line(observer->view(), names, options.is_json);
    if (observer->view().is_over() || node::stop_requested.load() != 0) break;
  }
  return static_cast<ExitCode>(node::stop_requested.load());
}

}  // namespace

void add_watch(options::Command& program) {
  options::Command verb = program.command("watch", "print variables of a running session as they change");
  const auto options = std::make_shared<WatchOptions>();  // lives as long as the command line's callbacks
  verb.option("variables", options->variables, "names, or patterns with * and ?").required().value_name("VAR");
  program::add_session_options(verb, options->session, false);
  verb.option("--every", options->interval, "seconds between two lines")
      .between(0.01, 3600.0)
      .value_name("S")
      .show_default();
  verb.option("--count", options->count, "end after so many lines; 0: with the session")
      .not_negative()
      .value_name("N")
      .show_default();
  verb.flag("--json", options->is_json, "one JSON object a line, values in SI; null where none has come");
  verb.footer(
      "Without --session: the one that runs on the domain.\n\n"
      "Example:\n  slewring watch Cyl_Lift.force 'Bag.position.*' --session truck_crane");
  verb.action([options] { return watch(*options); });
}

}  // namespace slew::cli
