// SPDX-License-Identifier: Apache-2.0
// `slewring variables`: the variables of a scene or a running session, for plots, watches and controllers.
#include <fmt/format.h>

#include <algorithm>

#include "cli/terminal.h"
#include "cli/verbs.h"
#include "core/display.h"
#include "core/failure.h"
#include "core/report_table.h"
#include "io_node/input_gate.h"
#include "node/identity.h"
#include "program/add_scene_options.h"
#include "program/add_session_options.h"
#include "scene/names.h"
#include "scene/scene_options.h"
#include "session/monolithic_session.h"
#include "session/survey.h"
#include "transport/roles.h"

namespace slew::cli {
namespace {

using wire::Role;

struct VariablesOptions {
  node::SessionOptions session;
  std::string scene;
  std::vector<std::string> patterns;
  bool is_json = false;
};

struct Named {
  std::string name, unit, owner;
};

std::vector<Named> of_scene(const std::string& file) {
  const scene::Scene scene = scene::load_file(file);
  std::vector<Named> all;
  session::SubsystemFamily family;
  for (const scene::InputDef& input : scene.inputs) {
    for (const io_node::ChannelVariable& variable : io_node::kChannelVariables) {
      all.push_back({input.name + variable.quantity, variable.unit, "io"});
    }
  }
  for (const Role role : transport::physics_roles()) {
    const auto subsystem = family.make(role, scene);
    if (subsystem == nullptr) continue;
    const std::string owner(node::to_text(role));
    for (const ElementVariable& variable : subsystem->variables()) {
      all.push_back({variable.name, std::string(info(variable.dimension).si_unit), owner});
    }
  }
  return all;
}

std::vector<Named> of_session(const node::SessionOptions& options) {
  const auto observer = session::find_session(options, session::Access::look);
  if (!observer->wait_for([&] { return observer->view().has_whole_directory(); }, milliseconds(5000))) {
    throw Failure(ExitCode::failed, "session '" + observer->session_name() +
                                        "' has not named its variables within 5 s; it may still be "
                                        "starting: try again");
  }
  std::vector<Named> all;
  for (const observer::VariableView* variable : observer->view().variables())
    all.push_back({variable->name, variable->unit, ""});
  return all;
}

ExitCode list(const VariablesOptions& options) {
  std::vector<Named> all = options.scene.empty() ? of_session(options.session) : of_scene(options.scene);
  std::erase_if(all, [&](const Named& variable) {
    return !options.patterns.empty() &&
           std::none_of(options.patterns.begin(), options.patterns.end(),
                        [&](const std::string& pattern) { return scene::fits_pattern(variable.name, pattern); });
  });
  ReportTable table({{.text = "variable", .json = "name"},
                     {.text = "unit", .json = "unit"},
                     {.text = options.scene.empty() ? "" : "node"}});
  for (const Named& variable : all) table.add({variable.name, variable.unit, variable.owner});
  if (options.is_json) {
    fmt::print("{}\n", table.json().dump(2));
    return ExitCode::ok;
  }
  if (all.empty()) {
    throw Failure(ExitCode::bad_input, "no variable fits; 'slewring variables' without --only lists all");
  }
  print_table(table);
  return ExitCode::ok;
}

}  // namespace

void add_variables(options::Command& program) {
  options::Command verb = program.command("variables", "list the variables of a scene or of a running session");
  const auto options = std::make_shared<VariablesOptions>();  // lives as long as the command line's callbacks
  program::add_scene_file(verb, "scene", options->scene, "scene file; without it a running session");
  verb.option("--only", options->patterns, "only these names, with * and ?; repeat for more")
      .value_name("PATTERN")
      .one_value_each();
  program::add_session_options(verb, options->session, false);
  verb.flag("--json", options->is_json, "for machines");
  verb.footer("Example:\n  slewring variables scenes/truck_crane.yaml --only 'Cyl_*'");
  verb.action([options] { return list(*options); });
}

}  // namespace slew::cli
