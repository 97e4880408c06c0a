// SPDX-License-Identifier: Apache-2.0
// From files and overrides to one tree: included files, the scene over them, `--set` over both.
#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// Permission and folder for reading files beside the scene.
struct LoadContext {
  bool has_folder = false;
  std::string folder;  // empty: the working directory
  // The same for the files that nodes read too: those of flexible bodies and of long tables.
  bool has_assets = has_folder;
  std::string asset_folder = folder;
  std::optional<std::string> device_folder{};  // of databases of devices; none: the text has what they define
  bool is_confined = true;                     // files must lie in the folder, except those named on a command line
  bool reads_script = true;                    // only io needs the long tracks of a script

  [[nodiscard]] std::string path_of(const std::string& file) const;
  [[nodiscard]] std::string asset_path_of(const std::string& file) const;
  // The fault of a file's name; nothing: the file lies in the folder.
  [[nodiscard]] std::optional<ValueProblem> refusal_of(const std::string& file) const;
};

// Reads the file and merges it over the files its `include` names (one level); problems go to the report.
[[nodiscard]] std::optional<Node> read_with_includes(const std::string& path, Report& report);

// Sets the value of each "PATH=VALUE" in the tree; its problems have the label "--set PATH=VALUE".
void apply_overrides(Node& root, const Overrides& overrides, Report& report);

}  // namespace slew::scene
