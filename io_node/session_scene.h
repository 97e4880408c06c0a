// The scene that a session is to run, from a scene file or from a saved session, and the states that it begins with.
#pragma once

#include <optional>
#include <vector>

#include "io_node/io_node.h"
#include "io_node/scene_config.h"
#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::io_node {

struct SessionScene {
  scene::Scene scene;
  std::optional<Beginning> beginning;  // of a saved session
  std::vector<wire::Asset> assets;     // of a saved session's scene, as they were
};

// Throws Failure or scene::LoadError. A saved session of another build is a warning in the scene.
[[nodiscard]] SessionScene load_session_scene(const scene::SceneOptions& options);

// make_config() and the states.
[[nodiscard]] IoConfig make_config(const SessionScene& session, const SessionWish& wish);

}  // namespace slew::io_node
