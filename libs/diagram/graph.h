// SPDX-License-Identifier: Apache-2.0
// A circuit as blocks in rows and the nets between them: the first step of its diagram. Internal to the library.
//
// Rows are counted from the bottom: the prime mover, pumps and what relieves their lines, valves by their distance from
// the supply, actuators. Channel c lies below row c. A net that has to pass a row passes it in a gap, a block without a
// symbol. Lines to a tank end in a symbol of their own at each port.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "diagram/circuit_layout.h"
#include "diagram/symbol.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::diagram {

struct Graph {
  std::vector<Net> nets;
  std::vector<Block> blocks;
  int rows = 0;

  [[nodiscard]] int channel_of(const Block& block, const BlockPort& port) const noexcept {
    return port.side == Side::top ? block.row + 1 : block.row;
  }
};

// The circuit's components in its order, then gaps.
[[nodiscard]] Graph build_graph(const hydraulics::HydraulicsDef& circuit, const std::vector<ControlledBy>& inputs);

// Width of a text of the diagram [px].
[[nodiscard]] double name_width(std::string_view text);
[[nodiscard]] double figure_width(std::string_view text);

}  // namespace slew::diagram
