// `slewring param list|get|set`: parameters of a scene or of a running session.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/display.h"
#include "cli/observer.h"
#include "cli/verbs.h"
#include "cli_support/failure.h"
#include "node/driver.h"
#include "scene/field_reader.h"
#include "scene/names.h"
#include "scene/parameters.h"
#include "scene/suggestion.h"

namespace slew::cli {
namespace {

using cli_support::Failure;

struct Options {
  cli_support::SessionOptions session;
  std::string scene;
  std::vector<std::string> words;  // patterns, a path, or path and value
  std::string over;
  bool only_live = false;
  bool is_json = false;
};

// The parameters as the scene file, or the session's scene, states them.
scene::ParameterDirectory directory_of(const Options& options) {
  if (!options.scene.empty()) return scene::ParameterDirectory(scene::load_file(options.scene));
  const auto observer = find_session(options.session);
  const wire::SessionDescription& session = observer->view().session();
  return scene::ParameterDirectory(scene::load_text(session.scene_text, session.scene_name));
}

nlohmann::json to_json(const scene::ParameterInfo& parameter) {
  nlohmann::json json = {{"path", parameter.path},
                         {"value", parameter.value},
                         {"unit", info(parameter.dimension).si_unit},
                         {"live", parameter.change == Change::live},
                         {"range", scene::range_text(parameter.range, parameter.dimension)},
                         {"doc", parameter.doc}};
  if (parameter.change == Change::live) json["spread_over_s"] = parameter.ramp;
  return json;
}

ExitCode list(const Options& options) {
  const scene::ParameterDirectory directory = directory_of(options);
  std::vector<std::vector<std::string>> rows = {{"parameter", "value", "change", "range", "meaning"}};
  nlohmann::json all = nlohmann::json::array();
  for (const scene::ParameterInfo& parameter : directory.all()) {
    if (options.only_live && parameter.change != Change::live) continue;
    const bool is_wanted = options.words.empty() ||
                           std::any_of(options.words.begin(), options.words.end(), [&](const std::string& pattern) {
                             return scene::fits_pattern(parameter.path, pattern);
                           });
    if (!is_wanted) continue;
    all.push_back(to_json(parameter));
    rows.push_back({parameter.path, scene::with_unit(parameter.value, parameter.dimension),
                    parameter.change == Change::live ? "live" : "restart",
                    scene::range_text(parameter.range, parameter.dimension), std::string(parameter.doc)});
  }
  if (options.is_json) {
    fmt::print("{}\n", all.dump(2));
  } else {
    fmt::print("{}", table_text(rows, ""));
  }
  return ExitCode::ok;
}

ExitCode get(const Options& options) {
  const scene::ParameterDirectory directory = directory_of(options);
  const std::string& path = options.words.front();
  const scene::ParameterInfo* parameter = directory.find(path);
  if (parameter == nullptr) {
    std::vector<std::string_view> paths;
    for (const scene::ParameterInfo& candidate : directory.all()) paths.push_back(candidate.path);
    const std::string meant = scene::closest(path, paths);
    throw Failure(ExitCode::bad_input,
                  "there is no parameter '" + path + "'; " +
                      (meant.empty() ? "'slewring param list' lists all" : "did you mean '" + meant + "'?"));
  }
  if (options.is_json) {
    fmt::print("{}\n", to_json(*parameter).dump(2));
  } else {
    const bool is_live = parameter->change == Change::live;
    fmt::print("{} = {} (as the scene states it; {})\n", path, scene::with_unit(parameter->value, parameter->dimension),
               is_live ? "can be changed while the session runs" : "fixed while the session runs");
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
  return static_cast<std::int64_t>(*time.value * 1e9);
}

ExitCode set(const Options& options) {
  const std::string text = options.words.size() == 1 ? options.words[0] : options.words[0] + "=" + options.words[1];
  const std::int64_t over_ns = options.over.empty() ? -1 : spread_ns(options.over);
  node::install_signal_handlers();
  const auto observer = find_session(options.session);
  const wire::SessionDescription& session = observer->view().session();
  scene::ParameterDirectory directory(scene::load_text(session.scene_text, session.scene_name));
  const scene::Assignment assignment = directory.parse_assignment(text);
  if (!assignment.status.is_ok()) {
    throw Failure(ExitCode::bad_input, "refused, nothing was changed: " + assignment.status.text);
  }
  wire::ControlRequest request;
  request.action = wire::ControlAction::set_parameter;
  request.path = assignment.path;
  request.value = assignment.value;
  request.over_ns = over_ns;
  const wire::ControlReply reply = observer->ask(request);
  const Dimension dimension = directory.find(assignment.path)->dimension;
  const std::string value = scene::with_unit(assignment.value, dimension);
  if (options.is_json) {
    fmt::print("{}\n", nlohmann::json({{"path", assignment.path},
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
    const double over = static_cast<double>(over_ns >= 0 ? over_ns : assignment.over.ns) * 1e-9;
    fmt::print("accepted({}): {} = {}, spread over {}\n", reply.header.step, assignment.path, value,
               duration_text(over));
  }
  return ExitCode::ok;
}

using Do = ExitCode (*)(const Options&);

CLI::App* add_part(CLI::App& verb, const char* name, const char* doc, Do what, Action& action,
                   const std::shared_ptr<Options>& options) {
  CLI::App* part = verb.add_subcommand(name, doc);
  cli_support::add_session_options(*part, options->session, false);
  part->add_flag("--json", options->is_json, "for machines, values in SI");
  part->callback([&action, options, what] { action = [options, what] { return what(*options); }; });
  return part;
}

}  // namespace

void add_param(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("param", "list, read and change parameters");
  verb->require_subcommand(1);
  verb->footer("Example:\n  slewring param set Bag.mass=1500kg --session truck_crane");
  const auto options = std::make_shared<Options>();  // lives as long as the command line's callbacks

  CLI::App* list_part = add_part(*verb, "list", "all parameters with value, range and meaning", list, action, options);
  list_part->add_option("patterns", options->words, "only these paths, with * and ?")->type_name("PATH");
  list_part->add_option("--scene", options->scene, "of a scene file, without a session")->type_name("SCENE");
  list_part->add_flag("--live", options->only_live, "only those that can be changed while the session runs");
  list_part->footer("Example:\n  slewring param list 'Bag.*' --scene scenes/truck_crane.yaml");

  CLI::App* get_part = add_part(*verb, "get", "one parameter as the scene states it", get, action, options);
  get_part->add_option("path", options->words, "Element.key")->required()->expected(1)->type_name("PATH");
  get_part->add_option("--scene", options->scene, "of a scene file, without a session")->type_name("SCENE");
  get_part->footer("Example:\n  slewring param get Bag.mass --session truck_crane");

  CLI::App* set_part = add_part(*verb, "set", "change a live parameter of a running session", set, action, options);
  set_part->add_option("assignment", options->words, "PATH=VALUE, or PATH VALUE")
      ->required()
      ->expected(1, 2)
      ->type_name("PATH=VALUE");
  set_part->add_option("--over", options->over, "spread the change over this time; without it the parameter's own")
      ->type_name("TIME");
  set_part->footer(
      "Prints accepted(step), or refused with the reason and exit code 2.\n\n"
      "Example:\n  slewring param set Bag.mass=1500kg --over '2 s'");
}

}  // namespace slew::cli
