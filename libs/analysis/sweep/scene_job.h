// SPDX-License-Identifier: Apache-2.0
// The scene of a task that another process computes, among the members of the task's JSON.
#pragma once

#include "core/json.h"
#include "scene/scene_options.h"

namespace slew::analysis {

void put_scene(Json& job, const scene::SceneOptions& scene);

// Nothing is recorded. Throws Failure (bad_input) where a member is missing or of another kind.
[[nodiscard]] scene::SceneOptions scene_in(const Json& job);

}  // namespace slew::analysis
