// SPDX-License-Identifier: Apache-2.0
// `slewring bridge lcm`: a running session on LCM channels, and inputs from there.
#include <fmt/format.h>

#include <cstdio>

#include "bridge/bridge.h"
#include "cli/lcm_scene.h"
#include "cli/verbs.h"
#include "core/failure.h"
#include "core/json.h"
#include "core/printable.h"
#include "core/text_output.h"
#include "node/driver.h"
#include "program/add_session_options.h"
#include "session/survey.h"

namespace slew::cli {
namespace {

struct BridgeOptions {
  node::SessionOptions session;
  bridge::Settings lcm;
  std::string types;
  bool is_json = false;
};

ExitCode write_types(const BridgeOptions& options, bridge::Bridge& bridge, observer::Observer& observer) {
  write_text(options.types, bridge.types(observer));
  return ExitCode::ok;
}

ExitCode run(BridgeOptions options) {
  bridge::require_lcm();
  node::install_signal_handlers();
  options.lcm.is_insecure_lan = options.session.is_insecure_lan;
  bridge::Bridge bridge(options.lcm);
  const auto access = bridge.is_door() ? session::Access::control : session::Access::look;
  const auto observer = session::find_session(options.session, access, &bridge.receiver());
  if (!options.types.empty()) return write_types(options, bridge, *observer);
  const wire::SessionDescription& session = observer->view().session();
  const scene::Scene scene = scene::load_text(session.scene_text, session.scene_name);
  bridge.run(*observer, lcm_scene(scene), [&](const std::string& line) {
    fmt::print(options.is_json ? stderr : stdout, "{}\n", printable(line));
    std::fflush(options.is_json ? stderr : stdout);
  });
  fmt::print("{}\n", options.is_json ? bridge.summary().dump(2) : bridge.summary_text());
  return static_cast<ExitCode>(node::stop_requested.load());
}

}  // namespace

bridge::SceneView lcm_scene(const scene::Scene& scene) {
  bridge::SceneView view;
  for (const scene::InputDef& input : scene.inputs) {
    view.channels.push_back(
        {input.name, input.type == scene::InputType::digital, input.controller == scene::ControllerMode::lockstep});
  }
  view.variables_every = scene.recording.every;
  view.neutral_after = duration_of_seconds(scene.session.controller_timeout);
  return view;
}

std::vector<options::Option> add_lcm_options(options::Command& verb, bridge::Settings& settings) {
  std::vector<options::Option> added;
  added.push_back(
      verb.option("--channel", settings.prefix, "beginning of the names of channels; without it SLEWRING_<session>")
          .value_name("PREFIX"));
  added.push_back(verb.option("--signals", settings.signals,
                              "these variables as a struct NAME_t of their own on channel PREFIX_NAME; repeat for more")
                      .value_name("NAME=VAR,VAR")
                      .one_value_each());
  added.push_back(
      verb.option("--every", settings.every, "steps between two messages; 0: as often as variables are published")
          .not_negative()
          .value_name("N")
          .show_default());
  for (options::Option& option : added) option.group("LCM");
  return added;
}

void add_bridge(options::Command& program) {
  options::Command verb = program.command("bridge", "carry a running session to programs of another middleware");
  verb.require_command();
  verb.footer("Example:\n  slewring bridge lcm --session truck_crane");
  options::Command lcm =
      verb.command("lcm", "variables, health and signal lists to LCM; inputs and parameters from it");
  const auto options = std::make_shared<BridgeOptions>();  // lives as long as the command line's callbacks
  program::add_session_options(lcm, options->session, false);
  add_lcm_options(lcm, options->lcm);
  lcm.option("--url", options->lcm.url, "LCM's address; a ttl above 0 needs --insecure-lan")
      .value_name("URL")
      .show_default()
      .group("LCM");
  lcm.option("--controller", options->lcm.controllers,
             "accept inputs of this controller, with leases in the name lcm:NAME; repeat for more; without it none")
      .value_name("NAME")
      .one_value_each()
      .group("LCM");
  lcm.flag("--parameters", options->lcm.takes_parameters, "accept requests that read and change live parameters")
      .group("LCM");
  lcm.option("--write-types", options->types, "write the types of --signals for lcm-gen, and end")
      .value_name("FILE")
      .group("LCM");
  lcm.flag("--json", options->is_json, "print the counts at the end as JSON and nothing else");
  lcm.footer(
      "Types: share/slewring/slewring.lcm. Without --session: the one that runs on the domain.\n\n"
      "Examples:\n"
      "  slewring bridge lcm --session truck_crane\n"
      "  slewring bridge lcm --signals crane=Cyl_Lift.stroke,Cyl_Lift.force --controller joystick\n"
      "  slewring bridge lcm --signals crane=Cyl_Lift.stroke,Cyl_Lift.force --write-types crane.lcm");
  lcm.action([options] { return run(*options); });
}

}  // namespace slew::cli
