// SPDX-License-Identifier: Apache-2.0
#include "analysis/drawing/mechanism_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "plotting/svg_text.h"

namespace slew::analysis {

std::string with_white(std::string_view colour, double white) {
  std::string mixed = "#";
  for (std::size_t i = 1; i < colour.size(); i += 2) {
    const double part = std::stoi(std::string(colour.substr(i, 2)), nullptr, 16);
    fmt::format_to(std::back_inserter(mixed), "{:02x}", static_cast<int>(part + white * (255 - part)));
  }
  return mixed;
}

std::string hex_colour(const Triple& colour) {
  if (!std::isfinite(colour[0])) return "";
  std::string text = "#";
  for (const double part : colour) {
    fmt::format_to(std::back_inserter(text), "{:02x}", static_cast<int>(std::lround(255 * std::clamp(part, 0.0, 1.0))));
  }
  return text;
}

std::string mechanism_style() {
  std::string style =
      ".diagram .mechanism "
      "path{fill:none;stroke:var(--ink);stroke-width:1.3;stroke-linejoin:round;stroke-linecap:round}"
      ".diagram .mechanism .bar{fill:none;stroke-width:9;stroke-opacity:.75}"
      ".diagram .mechanism .leader{stroke:var(--quiet);stroke-width:.7;opacity:.7}"
      ".diagram .mechanism .rod{stroke:var(--quiet);stroke-width:4}.diagram .mechanism .tube{stroke:var(--ink);"
      "stroke-width:10;stroke-linecap:butt}.diagram .mechanism "
      ".bore{stroke:var(--ground);stroke-width:6;stroke-linecap:butt}"
      ".diagram .mechanism .rope{stroke-width:2}.diagram .mechanism .tyre{stroke-width:3}"
      ".diagram .joints circle,.diagram .joints rect{fill:var(--ground);stroke:var(--ink);stroke-width:1.5}"
      ".diagram .joints .point,.diagram .masses .point{fill:var(--ink);stroke:none}"
      ".diagram .joints .loose{fill:none;stroke-dasharray:3 2}"
      ".diagram .masses .light{fill:var(--ground);stroke:var(--ink);stroke-width:1.2}"
      ".diagram .mechanism .axis-x{stroke:#d0342c}.diagram .mechanism .axis-y{stroke:#2a9d3c}"
      ".diagram .mechanism .axis-z{stroke:#2f6fd6}"
      ".diagram .of-joint,.diagram .of-force{font-weight:400}.diagram .of-force{fill:var(--supply)}"
      ".diagram .mechanism .scale{stroke:var(--quiet)}";
  // faces that look at the viewer are the lightest
  const auto add_shades = [&](const std::string& name, std::string_view colour, double white) {
    for (int shade = 0; shade < kShades; ++shade) {
      fmt::format_to(std::back_inserter(style), ".diagram .mechanism .{0}.s{1}{{fill:{2};stroke:{2};stroke-width:.5}}",
                     name, shade, with_white(colour, white + 0.11 * shade));
    }
  };
  add_shades("g", "#8a929a", 0.3);
  for (std::size_t i = 0; i < plotting::kColours.size(); ++i) {
    const std::string_view colour = plotting::colour_of(i);
    fmt::format_to(std::back_inserter(style), ".diagram .mechanism .b{}{{stroke:{}}}", i, colour);
    add_shades(fmt::format("b{}", i), colour, 0.16);
  }
  return style;
}

}  // namespace slew::analysis
