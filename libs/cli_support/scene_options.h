// Which scene a session runs and with what changes: the options that `slewring run` and io_node share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace slew::cli_support {

struct SceneOptions {
  std::string file;
  std::vector<std::string> overrides;  // "Bag.mass=1500kg"
  std::string step;                    // quantities; empty: as the scene says
  std::string duration;
  std::string pace;
  std::string input = "script";  // script, none, keyboard, or a .csv or .yaml file
  bool is_recording = true;

  [[nodiscard]] bool has_script() const noexcept { return input != "none" && input != "keyboard"; }
};

// SCENE, --set, --step, --duration, --pace, --input, --record, --no-record.
void add_scene_options(CLI::App& app, SceneOptions& options);

// The scene with every option applied: step, pace, duration and the input file become part of its text. Throws
// scene::LoadError.
[[nodiscard]] scene::Scene load_scene(const SceneOptions& options);

// The same as command-line arguments, for a child process.
[[nodiscard]] std::vector<std::string> scene_arguments(const SceneOptions& options);

}  // namespace slew::cli_support
