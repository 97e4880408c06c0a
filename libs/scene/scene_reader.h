// SPDX-License-Identifier: Apache-2.0
// Reads an expanded tree into a Scene: elements by their tables, then the rules between them, domain by domain.
#pragma once

#include <string>

#include "scene/expand.h"
#include "scene/scene.h"
#include "scene/source.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// Problems go to the report, warnings to the scene. default_name: of a scene that has none.
[[nodiscard]] Scene read_scene(const Node& root, LoadContext load_context, Report& report,
                               const std::string& default_name);

}  // namespace slew::scene
