// SPDX-License-Identifier: Apache-2.0
// Marks over two logarithmic axes as a picture: self-contained SVG. For error over cost: lower left is better.
//
// Marks of a group share a colour and are joined by a line in their order; each has its label beside it and its figures
// in a tooltip. A value that is zero or below the floor is drawn on the floor, hollow. Values that are not finite, or
// not positive on x, are left out.
#pragma once

#include <string>
#include <vector>

namespace slew::plotting {

struct Mark {
  double x = 0, y = 0;
  std::string label{};
};

struct MarkGroup {
  std::string name{};
  std::vector<Mark> marks{};
};

struct Scatter {
  std::string title{}, subtitle{};
  std::string x_label{}, y_label{};
  std::vector<MarkGroup> groups{};
  double y_floor = 0;  // 0: none; else a dashed line with its label
  std::string y_floor_label{};
  double width = 900, height = 560;  // px, 300 or more
};

[[nodiscard]] std::string scatter_svg(const Scatter& scatter);

}  // namespace slew::plotting
