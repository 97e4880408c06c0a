// SPDX-License-Identifier: Apache-2.0
// From files and overrides to one tree: included files, the scene over them, `--set` over both, and all that the scene
// language abbreviates written out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/named_points.h"
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
  std::optional<std::string> device_folder{};  // of files of devices; none: the text has what databases define
  bool is_confined = true;                     // files must lie in the folder, except those named on a command line
  bool reads_script = true;                    // only io needs the long tracks of a script

  [[nodiscard]] std::string path_of(const std::string& file) const;
  [[nodiscard]] std::string asset_path_of(const std::string& file) const;
  // The one check of every file that a scene names, before it is opened: its name and, where there is a folder, the
  // file behind symbolic links lie in the folder (which itself may be reached by a link). Nothing: it may be read.
  [[nodiscard]] std::optional<ValueProblem> refusal_of(const std::string& file) const;
};

inline constexpr std::size_t kMaxIncludeDepth = 8;
inline constexpr std::size_t kMaxIncludedFiles = 256;

// with_prefix: an entry of `include` may be {file: , prefix: , parameters: }, a group of elements (instances.h).
enum class Includes : std::uint8_t { plain, with_prefix };

// Reads the file and lays it over the files its `include` names, and those that they include; all names are relative to
// the folder of the file. text: stands for the content of the file, which is then not read. Problems go to the report.
[[nodiscard]] std::optional<Node> read_with_includes(const std::string& path, Report& report,
                                                     Includes includes = Includes::plain,
                                                     const std::string* text = nullptr);

// The scene's tree without parameters, expressions, templates, groups and named points. overrides: "PARAMETER=VALUE" is
// set before, "PATH=VALUE" after instances are made; their problems have the label "--set PATH=VALUE". warnings: those
// of instances.h. values: receives the scene's own parameters; points, unless null, its named points. False: problems
// were reported that leave the tree unfinished.
[[nodiscard]] bool expand(Node& root, const Overrides& overrides, Report& report, std::vector<std::string>* warnings,
                          std::vector<ParameterText>& values, std::vector<NamedPoint>* points = nullptr);

}  // namespace slew::scene
