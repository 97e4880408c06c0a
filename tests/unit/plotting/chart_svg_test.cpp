// SPDX-License-Identifier: Apache-2.0
// Curves and marks over linear axes: their places, gaps, and what is cut off.
#include "plotting/chart_svg.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace slew::plotting {
namespace chart_svg_test {

std::vector<std::array<double, 2>> circles(const std::string& svg) {
  std::vector<std::array<double, 2>> found;
  for (std::size_t at = svg.find("<title>"); at != std::string::npos; at = svg.find("<title>", at + 1)) {
    const std::size_t circle = svg.rfind("<circle cx=\"", at);
    if (circle == std::string::npos) continue;
    found.push_back({std::strtod(svg.c_str() + circle + 12, nullptr),
                     std::strtod(svg.c_str() + svg.find("cy=\"", circle) + 4, nullptr)});
  }
  return found;
}

TEST(ChartSvg, EqualDistancesAreEqualWays) {
  const auto m =
      circles(chart_svg({.curves = {{"m", {{1, 2, "", "a"}, {2, 4, "", "b"}, {3, 6, "", "c"}}, CurveLook::marks}}}));
  ASSERT_EQ(m.size(), 3u);
  EXPECT_NEAR(m[1][0] - m[0][0], m[2][0] - m[1][0], 0.2);
  EXPECT_NEAR(m[0][1] - m[1][1], m[1][1] - m[2][1], 0.2);
  EXPECT_GT(m[1][0], m[0][0]);
  EXPECT_LT(m[1][1], m[0][1]) << "larger values are higher up";
}

TEST(ChartSvg, APointThatIsNotFiniteIsAGap) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = chart_svg({.curves = {{"curve", {{0, 0}, {1, 1}, {2, kNone}, {3, 3}, {4, 4}}}}});
  const std::string path = svg.substr(svg.find(" d=\"M"), svg.find("<title>curve") - svg.find(" d=\"M"));
  EXPECT_EQ(path.find('M', path.find('M') + 1) != std::string::npos, true) << path;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(ChartSvg, NamesAreEscapedAndNoCurveIsNoError) {
  EXPECT_NE(chart_svg({.curves = {{"a<b", {{0, 0}}}}}).find("a&lt;b"), std::string::npos);
  EXPECT_NE(chart_svg({.title = "empty"}).find("</svg>"), std::string::npos);
}

}  // namespace chart_svg_test
}  // namespace slew::plotting
