// SPDX-License-Identifier: Apache-2.0
// What the verbs for LCM share: a scene as the bridge needs it, and the options of its messages.
#pragma once

#include <vector>

#include "bridge/settings.h"
#include "options/options.h"
#include "scene/scene.h"

namespace slew::cli {

[[nodiscard]] bridge::SceneView lcm_scene(const scene::Scene& scene);

// --channel, --signals, --every.
std::vector<options::Option> add_lcm_options(options::Command& verb, bridge::Settings& settings);

}  // namespace slew::cli
