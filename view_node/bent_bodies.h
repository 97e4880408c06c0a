// SPDX-License-Identifier: Apache-2.0
// Bodies that bend by modes, for the page: the places of their nodes, whose deflections are variables.
#pragma once

#include <string>

#include "core/json.h"
#include "scene/scene.h"

namespace slew::view_node {

// [{body, nodes: [{id, position}]}], position [m] in the undeformed body. text: of the scene; folder: of its flexible
// files. Bodies of more than 500 nodes are not in it; empty where the files cannot be read. The page draws others
// straight.
[[nodiscard]] Json bent_bodies_json(const scene::Scene& scene, const std::string& text, const std::string& folder);

}  // namespace slew::view_node
