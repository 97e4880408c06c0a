// SPDX-License-Identifier: Apache-2.0
#include "program/add_scene_options.h"

namespace slew::program {

options::Option add_scene_file(options::Command& app, const std::string& name, std::string& file,
                               const std::string& description) {
  return app.option(name, file, description).value_name("SCENE").replaced_by(scene::find_scene);
}

void add_scene_options(options::Command& app, scene::SceneOptions& options) {
  const options::Option file = add_scene_file(app, "scene", options.file);
  const options::Option from =
      app.option("--from", options.from,
                 "continue a saved session ('slewring control save') instead of a scene; --set then changes "
                 "live parameters and the control of inputs (controller, supervisor)")
          .value_name("FILE")
          .group("Scene");
  app.option("--assets", options.assets, "with --from: folder with the scene's files; without it this one")
      .value_name("DIR")
      .group("Scene");
  app.require_one_of(file, from);
  app.option("--set", options.overrides, "change a value of the scene; repeat for more")
      .value_name("PATH=VALUE")
      .one_value_each()
      .group("Scene");
  app.option("--step", options.step, "communication step H, such as '1 ms'").value_name("TIME").group("Scene");
  app.option("--duration", options.duration, "length of the run, such as '20 s'; 0: until it is stopped")
      .value_name("TIME")
      .group("Scene");
  app.option("--pace", options.pace, "real: paced by the wall clock; free: as fast as possible")
      .one_of({"real", "free"})
      .value_name("PACE")
      .group("Scene");
  app.option("--input", options.input,
             "script (the scene's own), none, keyboard, or a .csv, .yaml or .lcm file; changes of parameters in the "
             "scene's script stay (without them: --set 'script.parameters=[]')")
      .value_name("SOURCE")
      .show_default()
      .group("Scene");
  app.flag("--record,!--no-record", options.is_recording, "write a recording (default)").group("Scene");
  app.option("--record-steps", options.recorded_steps,
             "all: ticks and samples; ticks: what replay needs; none: variables and events alone; without it the "
             "scene's recording.steps")
      .one_of({"all", "ticks", "none"})
      .value_name("WHICH")
      .group("Scene");
}

}  // namespace slew::program
