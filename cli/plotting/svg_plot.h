// Curves over time as a picture: self-contained SVG, one panel per unit above each other, one time axis for all.
//
// Panels come in the order in which their units first appear; units are shown as they are given, scaling is the
// caller's. Each panel has its own legend; curves beyond the eighth of a panel repeat the colours with a dashed line.
// Not covered: second axes, logarithmic axes, panels of one unit with different ranges.
#pragma once

#include <span>
#include <string>

#include "cli/plotting/series.h"

namespace slew::plotting {

struct PlotOptions {
  std::string title;          // bold, on top; may be empty
  std::string subtitle;       // grey, below; may be empty
  double width = 1000;        // px, of the whole picture, 300 or more
  double panel_height = 170;  // px, of each plot area, 60 or more
};

[[nodiscard]] std::string plot_svg(std::span<const Series> series, const PlotOptions& options);

}  // namespace slew::plotting
