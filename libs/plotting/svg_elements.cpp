// SPDX-License-Identifier: Apache-2.0
#include "plotting/svg_elements.h"

#include <cmath>
#include <cstdlib>

#include "plotting/svg_text.h"

namespace slew::plotting {

void put_head(std::string& out, double width, double height) {
  put(out,
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n<style>{2}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      width, height, kStyle);
}

void put_line(std::string& out, std::string_view kind, double x1, double y1, double x2, double y2) {
  put(out, "<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", kind, std::floor(x1) + 0.5,
      std::floor(y1) + 0.5, std::floor(x2) + 0.5, std::floor(y2) + 0.5);
}

std::string power_of_ten(int exponent) {
  return fmt::format("10<tspan dy=\"-4\" font-size=\"9\">{}{}</tspan>", exponent < 0 ? "\u2212" : "",
                     std::abs(exponent));
}

std::string factor_text(int exponent) {
  return exponent == 0 ? "" : " \u00d7 " + power_of_ten(exponent);
}

}  // namespace slew::plotting
