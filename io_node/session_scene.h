// SPDX-License-Identifier: Apache-2.0
// Scene of a session, from a scene file or a saved session, and the states from which it continues.
#pragma once

#include <optional>
#include <vector>

#include "io_node/io_config.h"
#include "io_node/scene_config.h"
#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::io_node {

struct SessionScene {
  scene::Scene scene;
  std::optional<ResumeState> resume;  // states of a saved session
  std::vector<wire::Asset> assets;    // assets of a saved session's scene
};

// Throws Failure or scene::LoadError. A saved session of another build is a warning in the scene.
[[nodiscard]] SessionScene load_session_scene(const scene::SceneOptions& options);

// make_config() of the scene, with the states.
[[nodiscard]] IoConfig make_config(const SessionScene& session, std::string session_name, Recording recording);

}  // namespace slew::io_node
