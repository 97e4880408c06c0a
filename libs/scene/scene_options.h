// SPDX-License-Identifier: Apache-2.0
// The scene of a session with its changes, as options of the command line (program/add_scene_options.h) give them.
#pragma once

#include <string>
#include <vector>

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
