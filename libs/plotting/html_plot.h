// SPDX-License-Identifier: Apache-2.0
// Curves over time as an interactive page: one file without external resources, panels as in plot_svg, one time axis
// for all.
//
// The wheel and a dragged range zoom, with shift the range is moved, a double click shows all; panels scale to the
// visible part. Under the pointer each curve shows the value and the time of its last sample that is not later. A click
// on a name hides its curve. Columns of a pixel show the least and the largest value, so that no peak is lost in long
// recordings. Values have seven digits.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "plotting/svg_plot.h"

namespace slew::plotting {

// options.width is not used: the page takes the window's.
[[nodiscard]] std::string plot_html(std::span<const Plot> plots, const PlotOptions& options);

// Data for a <script> element: nothing in it can end the element.
[[nodiscard]] std::string in_script(std::string text);

// A JSON string with its quotes; bytes that are no UTF-8 are replaced.
[[nodiscard]] std::string json_string(std::string_view text);

// For options::Option::check(): empty for a name that ends in .svg or .html, for "-" and for a device such as
// /dev/stdout; otherwise what is wrong.
[[nodiscard]] std::string problem_of_picture_name(const std::string& path);

}  // namespace slew::plotting
