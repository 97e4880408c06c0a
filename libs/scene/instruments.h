// SPDX-License-Identifier: Apache-2.0
// Measuring instruments of a scene and the node that computes what each of them measures.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace slew::scene {

enum class Computes : std::uint8_t { mechanics, hydraulics };

// The instruments that measure variables of this node's elements, in the order of the scene. Pre-condition:
// check_instruments() found nothing.
[[nodiscard]] std::vector<measurement::InstrumentDef> instruments_of(const Scene& scene, Computes node);

// Reports instruments that cannot measure: elements that are computed outside of a step, settings that do not fit the
// session's step. Whether the element has the variable is known once its node's model is built.
void check_instruments(const Scene& scene, Problems& problems);

}  // namespace slew::scene
