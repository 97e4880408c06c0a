// SPDX-License-Identifier: Apache-2.0
// Curves and marks over two linear axes as a picture: self-contained SVG. For a quantity over another one, such as a
// load over the reach, and for places with figures beside them.
//
// Each curve has a colour and a line in the legend. Points whose x or y is not finite are gaps. What lies above y_most
// is cut off at the edge of the plot.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace slew::plotting {

struct ChartPoint {
  double x = 0, y = 0;
  std::string label{};    // beside the mark; empty: none
  std::string tooltip{};  // empty: none
};

enum class CurveLook : std::uint8_t { line, wide_line, marks };

struct ChartCurve {
  std::string name{};
  std::vector<ChartPoint> points{};
  CurveLook look = CurveLook::line;
};

struct Chart {
  std::string title{}, subtitle{};
  std::string x_label{}, y_label{};
  std::vector<ChartCurve> curves{};
  double y_most = std::numeric_limits<double>::infinity();  // greatest y that is shown
  double width = 900, height = 560;                         // px, 300 or more
};

[[nodiscard]] std::string chart_svg(const Chart& chart);

}  // namespace slew::plotting
