// From files and overrides to one tree: the scene, over what it includes, under what `--set` says.
#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// Whether files beside the scene may be read, and from where.
struct Surroundings {
  bool has_folder = false;
  std::string folder;  // empty: the working directory
  // The same for the files of flexible bodies, which nodes read as well.
  bool has_flexible_files = has_folder;
  std::string flexible_folder = folder;

  [[nodiscard]] std::string path_of(const std::string& file) const;
};

// Reads the file and merges it over the files its `include` names (one level); problems go to the report.
[[nodiscard]] std::optional<Node> read_with_includes(const std::string& path, Report& report);

// Puts the value of each "PATH=VALUE" into the tree; its problems carry the label "--set PATH=VALUE".
void apply_overrides(Node& root, const Overrides& overrides, Report& report);

}  // namespace slew::scene
