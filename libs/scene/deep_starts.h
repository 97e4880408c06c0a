// SPDX-License-Identifier: Apache-2.0
// Shapes that a scene starts deep in each other.
#pragma once

#include <string>

#include "scene/scene.h"

namespace slew::scene {

// "Ground_Bag: the shapes start 0.02 m deep in each other, ...", one after the other; empty: none. Builds the
// mechanism. Pre-condition: a validated scene.
[[nodiscard]] std::string deep_starts(const Scene& scene);

}  // namespace slew::scene
