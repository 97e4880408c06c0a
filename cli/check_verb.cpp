// SPDX-License-Identifier: Apache-2.0
// `slewring check SCENE`: reads a scene as strictly as a run does, builds its models and finds its start state.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "analysis/description/liftable_load.h"
#include "analysis/start_check.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/suggestion.h"
#include "io_node/scene_config.h"
#include "io_node/session_variables.h"
#include "program/add_scene_options.h"
#include "scene/canonical.h"
#include "scene/scene_options.h"
#include "scene/scene_outline.h"
#include "session/direct_session.h"
#include "session/recording_forecast.h"
#include "session/unrecorded.h"
#include "transport/roles.h"

namespace slew::cli {
namespace {

using wire::Role;

struct CheckOptions {
  std::string scene;
  std::vector<std::string> overrides;
  bool is_json = false;
  bool is_expanded = false;
};

// Checks names that only the built models have: variables of outputs and devices must exist, in the dimension of what
// they are compared with. Those that a scene only shows (plots, recording.variables) are warnings, as in a run.
void check_variables(const scene::Scene& scene, const session::DirectSession& session) {
  std::vector<std::string> names, units;
  for (const Role role : transport::physics_roles()) {
    if (session.subsystem(role) == nullptr) continue;
    for (const ElementVariable& variable : session.subsystem(role)->variables()) {
      names.push_back(variable.name);
      units.emplace_back(info(variable.dimension).si_unit);
    }
  }
  std::vector<std::string> inputs;
  for (const scene::InputDef& input : scene.inputs) inputs.push_back(input.name);
  for (wire::VariableEntry& own :
       io_node::own_variables(inputs, io_node::required_roles(scene, io_node::Recording::none))) {
    names.push_back(std::move(own.name));
    units.push_back(std::move(own.unit));
  }
  for (const scene::NamedVariable& one : scene::variables_of(scene.devices, scene.outputs)) {
    const auto found = std::find(names.begin(), names.end(), one.variable);
    if (found == names.end()) {
      const std::string meant = closest(one.variable, {names.begin(), names.end()});
      throw Failure(ExitCode::bad_input, fmt::format("{}: there is no variable '{}'; {}", one.path, one.variable,
                                                     meant.empty() ? "'slewring variables SCENE' lists them"
                                                                   : fmt::format("did you mean '{}'?", meant)));
    }
    const std::string& unit = units[static_cast<std::size_t>(found - names.begin())];
    if (scene::is_same_dimension(one.unit, unit)) continue;
    throw Failure(ExitCode::bad_input,
                  fmt::format("{}: '{}' is in {}, not in {}; state a quantity of the same dimension", one.path,
                              one.variable, unit, one.unit));
  }
}

// A payload that the scene's valves do not lift: a physical result, and rarely intended.
void check_payload(scene::Scene& scene) {
  for (const analysis::LiftableLoad& load :
       analysis::find_liftable_of_each(scene, {}, analysis::ListedSettings::left_out)) {
    if (!load.has_answer() || load.mass <= load.limit().load) continue;
    scene.warnings.push_back(fmt::format(
        "{}: {} kg cannot be lifted from where the scene begins, but {}; see 'slewring describe {} --liftable'",
        load.payload, load.mass, analysis::limit_text(load), scene.name));
  }
}

// The scene as sessions publish and recordings keep it, less what nothing reads: a file of its own, with its warnings
// on standard error.
ExitCode print_expanded(scene::Scene& scene) {
  for (const std::string& warning : scene.warnings) {
    std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
  }
  fmt::print("{}", scene::file_text(scene));
  return ExitCode::ok;
}

ExitCode check(const CheckOptions& options) {
  try {
    scene::Scene scene = scene::load_file(options.scene, options.overrides);
    if (options.is_expanded) return print_expanded(scene);
    session::DirectSession session(scene);
    require(session.start());
    check_variables(scene, session);
    check_payload(scene);
    std::vector<std::string> warnings = scene.warnings;
    for (std::string& warning : session::unrecorded_plots(scene)) warnings.push_back(std::move(warning));
    for (std::string& warning : session::unmet_patterns(scene, session)) warnings.push_back(std::move(warning));
    for (std::string& warning : analysis::start_warnings(scene, session)) warnings.push_back(std::move(warning));
    const double bytes = session::recorded_bytes(scene, session::recorded_numbers(scene, session));
    if (options.is_json) {
      fmt::print("{}\n", Json({{"ok", true},
                               {"scene", scene.name},
                               {"warnings", warnings},
                               {"recorded_bytes_per_hour", std::round(3600 * bytes)}})
                             .dump(2));
      return ExitCode::ok;
    }
    for (const std::string& warning : warnings) std::fprintf(stderr, "warning: %s\n", printable_lines(warning).c_str());
    fmt::print("{}: ok ({}, {}, {}, {})\n", printable(options.scene),
               counted(scene.mechanics.bodies.size(), "body", "bodies"),
               counted(scene.hydraulics.volumes.size(), "volume", "volumes"),
               counted(scene.hydraulics.components.size(), "component", "components"),
               counted(scene.inputs.size(), "input", "inputs"));
    fmt::print("{}\n", session::forecast_text(scene, bytes));
    return ExitCode::ok;
  } catch (const scene::LoadError& error) {
    if (!options.is_json) throw;
    fmt::print("{}\n", scene::problems_json(error).dump(2));
    return ExitCode::bad_input;
  }
}

}  // namespace

void add_check(options::Command& program) {
  options::Command verb = program.command("check", "check a scene: file, models, start state");
  const auto options = std::make_shared<CheckOptions>();  // lives as long as the command line's callbacks
  program::add_scene_file(verb, "scene", options->scene).required();
  verb.option("--set", options->overrides, "change a value or a parameter of the scene; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each();
  verb.flag("--json", options->is_json, "for machines: every problem with file, line and column");
  verb.flag("--expanded", options->is_expanded,
            "print the scene that it became: parameters, templates, groups, includes and --set written out, in SI");
  verb.footer("Example:\n  slewring check scenes/truck_crane.yaml");
  verb.action([options] { return check(*options); });
}

}  // namespace slew::cli
