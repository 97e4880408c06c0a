// SPDX-License-Identifier: Apache-2.0
// Mode shapes as a picture: self-contained SVG, one panel per mode, each with the undeformed and the deformed line in
// the x-y plane above and in the x-z plane below, in the axes of the body frame.
//
// Deflections are scaled so that the largest of a mode is a fixed part of the body's length; the scale is not that of a
// load. Lines follow the nodes in their order, which suits beams; for other models nodes are drawn as dots.
#pragma once

#include <span>
#include <string>

#include "flex/reduction.h"

namespace slew::flex {

struct ModeShapePlotOptions {
  std::string title;          // bold, on top; empty: the model's name
  int columns = 3;            // panels beside each other, 1 or more
  double panel_width = 320;   // px, 200 or more
  double panel_height = 230;  // px, 160 or more
};

// ordinals: counted from 1, in the order of the panels. Throws InputError for one that does not exist.
[[nodiscard]] std::string mode_shape_svg(const Reduction& reduction, std::span<const int> ordinals,
                                         const ModeShapePlotOptions& options = {});

}  // namespace slew::flex
