// SPDX-License-Identifier: Apache-2.0
// What an editor of a scene file reads: the scene with a text that is not in the file, and the settings over it.
#pragma once

#include <string>

#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::scene {

// load_file() with a text in the place of the file's content: what the file would give with it.
[[nodiscard]] Scene load_edited(const std::string& path, const std::string& text, const Overrides& overrides = {});

// The settings that load_scene() puts over the file: --set, --step, --duration, --pace and --record-steps.
[[nodiscard]] Overrides overrides_of(const SceneOptions& options);

}  // namespace slew::scene
