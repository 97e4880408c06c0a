// SPDX-License-Identifier: Apache-2.0
// The workspace of the page (layout, panels, cameras, map of inputs): a JSON file in the user's state folder, one for
// each scene. The page defines its content; here it is an object with a version.
//
// Two pages do not overwrite each other's: a change names the state that it replaces by its entity tag (RFC 9110, 8.8.3
// and 13.1.1). The file is replaced as a whole, also against another window of the same scene.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "view_node/entity_tag.h"

namespace slew::view_node {

inline constexpr std::size_t kMostWorkspaceBytes = 1u << 20;

class WorkspaceFile {
 public:
  // path: empty: there is no folder for it.
  explicit WorkspaceFile(std::filesystem::path path) : path_(std::move(path)) {}

  // Nothing: none was saved, or it cannot be read.
  [[nodiscard]] std::optional<std::string> read() const;

  struct Result {
    unsigned status = 204;     // of HTTP
    std::string problem{};     // empty: the text was written
    std::string entity_tag{};  // of the state now; empty: there is none
  };
  // Replaces the state whose tag if_match has, or makes the first one. Refused: 400 what is no workspace, 412 another
  // state, 428 a replacement without a condition, 500 and 507 what cannot be written.
  [[nodiscard]] Result replace(const std::string& text, const Conditions& conditions) const;

 private:
  std::filesystem::path path_;
};

// XDG_STATE_HOME/slewring/workspaces/SCENE.json (XDG base directory specification); empty: the environment names no
// folder. scene: characters that are not of a file's name become '_'.
[[nodiscard]] std::filesystem::path workspace_path(const std::string& scene);

}  // namespace slew::view_node
