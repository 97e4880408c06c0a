// SPDX-License-Identifier: Apache-2.0
// Order and places of the blocks in their rows: the second step of a diagram. Internal to the library.
//
// Layered drawing after Sugiyama, Tagawa, Toda 1981: sweeps over the rows move each block to the mean of the ports that
// it is connected to; then neighbours change places where that makes lines shorter or removes crossings. Places are the
// weighted least squares under the least distances (isotonic regression by pooling neighbours). Deterministic.
#pragma once

#include "diagram/graph.h"

namespace slew::diagram {

// Sets x of all blocks, whole numbers.
void arrange(Graph& graph);

}  // namespace slew::diagram
