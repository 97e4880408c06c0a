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
  // The same for the files that nodes read as well: those of flexible bodies and of long tables.
  bool has_assets = has_folder;
  std::string asset_folder = folder;
  bool is_confined = true;   // files must lie in the folder; not those that a command line names
  bool reads_script = true;  // io alone needs the long tracks of a script

  [[nodiscard]] std::string path_of(const std::string& file) const;
  [[nodiscard]] std::string asset_path_of(const std::string& file) const;
  // What is wrong with the name of a file; nothing: it lies in the folder.
  [[nodiscard]] std::optional<Complaint> refusal_of(const std::string& file) const;
};

// Reads the file and merges it over the files its `include` names (one level); problems go to the report.
[[nodiscard]] std::optional<Node> read_with_includes(const std::string& path, Report& report);

// Puts the value of each "PATH=VALUE" into the tree; its problems carry the label "--set PATH=VALUE".
void apply_overrides(Node& root, const Overrides& overrides, Report& report);

}  // namespace slew::scene
