// SPDX-License-Identifier: Apache-2.0
// Curves over time as a picture: self-contained SVG, plots below each other, one time axis for all.
//
// A plot has a heading and one panel per unit, in the order in which its units first appear, with at most
// kMaxCurvesOfPanel curves; further ones of the unit are in further panels below. Plots share no panel, so that each
// has its own range. Units are shown as they are given, scaling is the caller's. Each panel has its own legend; curves
// beyond the eighth of a panel repeat the colours with a dashed line. Not covered: second axes, logarithmic axes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plotting/series.h"

namespace slew::plotting {

struct PlotOptions {
  std::string title;          // bold, on top; may be empty
  std::string subtitle;       // grey, below; may be empty
  double width = 1000;        // px, of the whole picture, 300 or more
  double panel_height = 170;  // px, of each plot area, 60 or more
};

inline constexpr std::size_t kMaxCurvesOfPanel = 12;

struct Plot {
  std::string title;  // above its first panel; may be empty
  std::vector<Series> series{};
};

[[nodiscard]] std::string plot_svg(std::span<const Plot> plots, const PlotOptions& options);
// One plot without a heading.
[[nodiscard]] std::string plot_svg(std::span<const Series> series, const PlotOptions& options);

}  // namespace slew::plotting
