// SPDX-License-Identifier: Apache-2.0
// Lines of a diagram, in the channels between its rows: the third step. Internal to the library.
//
// A net has one horizontal piece in a channel, on a track, from which its lines go up and down to ports and gaps. Two
// nets with lines near each other's have an order, so that they do not touch; of the orders that are left the one with
// few crossings is taken. The name of each volume stands on one of its pieces, where no other line passes.
#pragma once

#include "diagram/graph.h"

namespace slew::diagram {

// Sets y of all blocks, and lines, names and tanks. x of blocks: by arrange(); some are moved where lines would touch.
[[nodiscard]] CircuitLayout route(Graph graph);

}  // namespace slew::diagram
