// SPDX-License-Identifier: Apache-2.0
// Names of a picture's parts in its margins, each with a thin line to its part, so that no name covers the picture.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "diagram/pen.h"

namespace slew::analysis {

struct MarginName {
  std::string text{}, element{};
  std::string style{};   // class of the text
  diagram::Point at{};   // px, of the part
  bool is_left = false;  // set by spread_names()
  double y = 0;          // px, of the text's middle; set by spread_names()
};

inline constexpr double kMarginLine = 15;  // px, from name to name

// Gives each name a margin and a place there, in the order of its part's height, so that lines cross little. middle: of
// the picture. Returns the least height of the picture that holds the fuller margin.
double spread_names(std::vector<MarginName>& names, double middle, double top, double height);

// Width of the longest name [px].
[[nodiscard]] double margin_width(const std::vector<MarginName>& names);

// Texts and lines; left and right: inner borders of the margins.
[[nodiscard]] std::string margin_group(const std::vector<MarginName>& names, double left, double right);

}  // namespace slew::analysis
