// SPDX-License-Identifier: Apache-2.0
// Options of `slewring run` and io_node for the scene of a session and its changes.
#pragma once

#include <string>
#include <vector>

#include "options/options.h"
#include "scene/parameters.h"
#include "scene/scene.h"

namespace slew::scene {

struct SceneOptions {
  std::string file;
  std::string from;                    // a saved session instead of a scene file
  std::string assets;                  // folder of its scene's files; empty: here
  std::vector<std::string> overrides;  // "Bag.mass=1500kg"
  std::string step;                    // quantities; empty: the scene's
  std::string duration;
  std::string pace;
  std::string input = "script";  // script, none, keyboard, or a .csv, .yaml or .lcm file
  bool is_recording = true;
  std::string recorded_steps;  // all, ticks, none; empty: the scene's

  [[nodiscard]] bool has_script() const noexcept { return input != "none" && input != "keyboard"; }
};

// A scene file as it was given, or, where there is no such file, that of the installation: "truck_crane.yaml" and
// "scenes/truck_crane.yaml" are found from any folder once Slewring is installed.
[[nodiscard]] std::string find_scene(const std::string& file);

// An option or argument whose value is a scene file, looked up by find_scene().
options::Option add_scene_file(options::Command& app, const std::string& name, std::string& file,
                               const std::string& description = "scene file");

// SCENE or --from FILE and --assets, --set, --step, --duration, --pace, --input, --record, --no-record,
// --record-steps.
void add_scene_options(options::Command& app, SceneOptions& options);

// The scene with every option applied: step, pace, duration and the input file become part of its text. Throws
// scene::LoadError.
[[nodiscard]] scene::Scene load_scene(const SceneOptions& options);

// The scene of a saved session with the permitted changes: duration, pace, input, and the control of inputs
// (controller, controller_delay, controller_wait, supervisor) become part of its text; all other settings are changes
// of live parameters. Throws Failure or scene::LoadError.
struct ContinuedScene {
  scene::Scene scene;
  std::vector<scene::Assignment> changes;
};
[[nodiscard]] ContinuedScene continue_scene(const SceneOptions& options, const std::string& scene_text,
                                            const std::string& scene_name);

// The same as command-line arguments, for a child process.
[[nodiscard]] std::vector<std::string> scene_arguments(const SceneOptions& options);

}  // namespace slew::scene
