// SPDX-License-Identifier: Apache-2.0
// `slewring param list|get|set`: parameters of a scene or of a running session.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/report_table.h"
#include "core/suggestion.h"
#include "node/driver.h"
#include "observer/observer.h"
#include "program/add_scene_options.h"
#include "program/add_session_options.h"
#include "scene/field_reader.h"
#include "scene/names.h"
#include "scene/parameters.h"
#include "scene/scene_options.h"
#include "session/survey.h"

namespace slew::cli {
namespace {

struct ParamOptions {
  node::SessionOptions session;
  std::string scene;
  std::vector<std::string> words;  // patterns, a path, or path and value
  std::string over;
  bool only_live = false;
  bool is_json = false;
};

// A parameter with its present value: the scene's, or the one in a running session.
struct Present {
  const scene::ParameterInfo* about = nullptr;
  double value = 0;      // SI
  StepIndex step = -1;   // the value is the one before this step; -1: the scene's
  std::string remark{};  // a change that is not complete
};

// The parameters of a scene file, or of a session with its replies.
class Source {
 public:
  explicit Source(const ParamOptions& options)
      : observer_(options.scene.empty() ? session::find_session(options.session, session::Access::steer) : nullptr),
        directory_(
            observer_ ? scene::load_text(observer_->view().session().scene_text, observer_->view().session().scene_name)
                      : scene::load_file(options.scene)) {}

  [[nodiscard]] const scene::ParameterDirectory& directory() const noexcept { return directory_; }
  [[nodiscard]] bool is_session() const noexcept { return observer_ != nullptr; }

  // Only a live parameter can have another value than the scene's.
  [[nodiscard]] Present present(const scene::ParameterInfo& parameter) const {
    Present present{.about = &parameter, .value = parameter.value};
    if (!is_session() || parameter.change != Change::live) return present;
    wire::ControlRequest request;
    request.action = wire::ControlAction::get_parameter;
    request.path = parameter.path;
    wire::ControlReply reply = observer_->request_reply(request);
    if (!reply.is_accepted) throw Failure(ExitCode::failed, parameter.path + ": " + reply.reason);
    present.value = reply.value;
    present.step = reply.header.step;
    present.remark = std::move(reply.reason);
    return present;
  }

 private:
  std::unique_ptr<observer::Observer> observer_;
  scene::ParameterDirectory directory_;
};

std::string value_text(double value, const scene::ParameterInfo& parameter) {
  if (parameter.is_choice()) return std::string(parameter.choice_of(value));
  const bool is_plain = scene::is_plain_number(parameter.dimension);
  return chosen_text(value, is_plain ? std::string_view() : info(parameter.dimension).si_unit);
}

// The allowed values of the parameter.
std::string range_text(const scene::ParameterInfo& parameter) {
  if (parameter.is_choice()) return scene::choice_list(parameter.choices);
  return scene::range_text(parameter.range, parameter.dimension);
}

Json to_json(const Present& present, bool is_of_session) {
  const scene::ParameterInfo& parameter = *present.about;
  Json json = {{"path", parameter.path},
               {"value", present.value},
               {"unit", info(parameter.dimension).si_unit},
               {"live", parameter.change == Change::live},
               {"range", range_text(parameter)},
               {"doc", parameter.doc}};
  if (parameter.is_choice()) {
    json["choice"] = parameter.choice_of(present.value);
    json["choices"] = std::vector<std::string>(parameter.choices.begin(), parameter.choices.end());
  }
  if (parameter.change == Change::live) json["spread_over_s"] = parameter.ramp;
  if (!parameter.obstacle.empty()) json["not_live_because"] = parameter.obstacle;
  if (is_of_session) json["scene_value"] = parameter.value;
  if (present.step >= 0) json["step"] = present.step;
  if (!present.remark.empty()) json["remark"] = present.remark;
  return json;
}

bool is_wanted(const scene::ParameterInfo& parameter, const ParamOptions& options) {
  if (options.only_live && parameter.change != Change::live) return false;
  return options.words.empty() ||
         std::any_of(options.words.begin(), options.words.end(),
                     [&](const std::string& pattern) { return scene::fits_pattern(parameter.path, pattern); });
}

ReportTable table_of(const std::vector<Present>& all) {
  const auto is_changed = [](const Present& present) { return present.value != present.about->value; };
  const bool has_changed = std::any_of(all.begin(), all.end(), is_changed);
  ReportColumn in_scene;
  if (has_changed) in_scene.text = "in the scene";
  ReportTable table({{"parameter"}, {"value"}, in_scene, {"change"}, {"range"}, {"meaning"}});
  for (const Present& present : all) {
    const scene::ParameterInfo& parameter = *present.about;
    table.add({parameter.path, value_text(present.value, parameter),
               is_changed(present) ? value_text(parameter.value, parameter) : "",
               parameter.change == Change::live ? "live" : "restart", range_text(parameter),
               std::string(parameter.doc)});
  }
  return table;
}

ExitCode list(const ParamOptions& options) {
  node::install_signal_handlers();
  const Source source(options);
  std::vector<Present> all;
  for (const scene::ParameterInfo& parameter : source.directory().all()) {
    if (is_wanted(parameter, options)) all.push_back(source.present(parameter));
  }
  if (options.is_json) {
    Json json = Json::array();
    for (const Present& present : all) json.push_back(to_json(present, source.is_session()));
    fmt::print("{}\n", json.dump(2));
    return ExitCode::ok;
  }
  if (all.empty()) {
    throw Failure(ExitCode::bad_input, "no parameter fits; 'slewring param list' without names lists all");
  }
  print_table(table_of(all));
  return ExitCode::ok;
}

// "at step 5880, on its way to a new value; the scene: 500 kg; can be changed ..."
std::string circumstances(const Present& present, bool is_of_session) {
  const scene::ParameterInfo& parameter = *present.about;
  std::string text = is_of_session && present.step < 0 ? "of the scene" : "as in the scene";
  if (present.step >= 0) text = fmt::format("at step {}", present.step);
  if (!present.remark.empty()) text += ", " + present.remark;
  if (present.value != parameter.value) text += "; the scene: " + value_text(parameter.value, parameter);
  if (!parameter.obstacle.empty()) return text + "; a change would do nothing: " + parameter.obstacle;
  const bool is_live = parameter.change == Change::live;
  return text + (is_live ? "; can be changed while the session runs" : "; fixed while the session runs");
}

ExitCode get(const ParamOptions& options) {
  node::install_signal_handlers();
  const Source source(options);
  const std::string& path = options.words.front();
  const scene::ParameterInfo* parameter = source.directory().find(path);
  if (parameter == nullptr) {
    std::vector<std::string_view> paths;
    for (const scene::ParameterInfo& candidate : source.directory().all()) paths.push_back(candidate.path);
    const std::string meant = closest(path, paths);
    throw Failure(ExitCode::bad_input,
                  "there is no parameter '" + path + "'; " +
                      (meant.empty() ? "'slewring param list' lists all" : "did you mean '" + meant + "'?"));
  }
  const Present present = source.present(*parameter);
  if (options.is_json) {
    fmt::print("{}\n", to_json(present, source.is_session()).dump(2));
  } else {
    fmt::print("{} = {} ({})\n", printable(path), value_text(present.value, *parameter),
               circumstances(present, source.is_session()));
  }
  return ExitCode::ok;
}

std::int64_t spread_ns(const std::string& text) {
  scene::UnitSystem units;
  const scene::QuantityResult time = scene::read_quantity(text, scene::Writing::plain, Dimension::time, units);
  if (!time.value || !(*time.value >= 0 && *time.value <= 3600)) {
    throw Failure(ExitCode::bad_input,
                  "--over: '" + text + "' is no time from 0 to 3600 s; nothing was sent; write it like '2 s'");
  }
  return duration_of_seconds(*time.value).ns;
}

ExitCode set(const ParamOptions& options) {
  if (options.words.size() > 1 && options.words[0].find('=') != std::string::npos) {
    throw Failure(ExitCode::bad_input, fmt::format("'{}' has its value, and '{}' is a second one; nothing was changed; "
                                                   "set one parameter a call",
                                                   options.words[0], options.words[1]));
  }
  const std::string text = options.words.size() == 1 ? options.words[0] : options.words[0] + "=" + options.words[1];
  const std::optional<SimDuration> spread =
      options.over.empty() ? std::nullopt : std::optional(SimDuration{spread_ns(options.over)});
  node::install_signal_handlers();
  const auto observer = session::find_session(options.session, session::Access::steer);
  const wire::SessionDescription& session = observer->view().session();
  scene::ParameterDirectory directory(scene::load_text(session.scene_text, session.scene_name));
  const scene::Assignment assignment = directory.parse_assignment(text, spread, scene::Beside::session);
  if (!assignment.status.is_ok()) {
    if (options.is_json) {
      fmt::print(
          "{}\n",
          Json({{"path", text.substr(0, text.find('='))}, {"accepted", false}, {"reason", assignment.status.text}})
              .dump(2));
      std::fflush(stdout);
    }
    throw Failure(ExitCode::bad_input, "refused, nothing was changed: " + assignment.status.text);
  }
  const scene::ParameterInfo& parameter = *directory.find(assignment.path);
  wire::ControlRequest request;
  request.action = wire::ControlAction::set_parameter;
  request.path = assignment.path;
  request.value = assignment.value;
  request.over_ns = assignment.over.ns;
  const wire::ControlReply reply = observer->request_reply(request);
  const std::string value = value_text(assignment.value, parameter);
  if (options.is_json) {
    fmt::print("{}\n", Json({{"path", assignment.path},
                             {"value", assignment.value},
                             {"accepted", reply.is_accepted},
                             {"step", reply.header.step},
                             {"reason", reply.reason}})
                           .dump(2));
  }
  if (!reply.is_accepted) {
    throw Failure(ExitCode::bad_input,
                  "refused, nothing was changed: " + assignment.path + " = " + value + ": " + reply.reason);
  }
  if (!options.is_json) {
    const double over = assignment.over.seconds();
    fmt::print("accepted({}): {} = {}, {}\n", reply.header.step, assignment.path, value,
               over > 0 ? "spread over " + duration_text(over) : "at once");
  }
  return ExitCode::ok;
}

using Do = ExitCode (*)(const ParamOptions&);

options::Command add_part(options::Command& verb, const char* name, const char* doc, Do what,
                          const std::shared_ptr<ParamOptions>& options) {
  options::Command part = verb.command(name, doc);
  program::add_session_options(part, options->session, false);
  part.flag("--json", options->is_json, "for machines, values in SI");
  part.action([options, what] { return what(*options); });
  return part;
}

}  // namespace

void add_param(options::Command& program) {
  options::Command verb = program.command("param", "list, read and change parameters");
  verb.require_command();
  verb.footer("Example:\n  slewring param set Bag.mass=1500kg --session truck_crane");
  const auto options = std::make_shared<ParamOptions>();  // lives as long as the command line's callbacks

  options::Command list_part = add_part(verb, "list", "all parameters with value, range and meaning", list, options);
  list_part.option("patterns", options->words, "only these paths, with * and ?").value_name("PATH");
  program::add_scene_file(list_part, "--scene", options->scene, "of a scene file, without a session");
  list_part.flag("--live", options->only_live, "only those that can be changed while the session runs");
  list_part.footer(
      "Of a running session: the present values.\n\nExample:\n  slewring param list 'Bag.*' --scene "
      "scenes/truck_crane.yaml");

  options::Command get_part = add_part(verb, "get", "one parameter: its present value", get, options);
  get_part.option("path", options->words, "Element.key").required().values(1, 1).value_name("PATH");
  program::add_scene_file(get_part, "--scene", options->scene, "of a scene file, without a session");
  get_part.footer(
      "Of a running session: the present value.\n\nExample:\n  slewring param get Bag.mass --session truck_crane");

  options::Command set_part = add_part(verb, "set", "change a live parameter of a running session", set, options);
  set_part.option("assignment", options->words, "PATH=VALUE, or PATH VALUE")
      .required()
      .values(1, 2)
      .value_name("PATH=VALUE");
  set_part.option("--over", options->over, "spread the change over this time; without it the parameter's own")
      .value_name("TIME");
  set_part.footer(
      "Prints accepted(step), or refused with the reason and exit code 2.\n\n"
      "Example:\n  slewring param set Bag.mass=1500kg --over '2 s'");
}

}  // namespace slew::cli
