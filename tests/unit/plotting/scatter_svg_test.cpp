// SPDX-License-Identifier: Apache-2.0
// Marks over logarithmic axes: their positions, and omitted values.
#include "plotting/scatter_svg.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace slew::plotting {
namespace scatter_svg_test {

struct Place {
  double x = 0, y = 0;
  std::string fill;
};

double attribute(const std::string& tag, const std::string& name) {
  const std::size_t at = tag.find(" " + name + "=\"");
  return at == std::string::npos ? std::nan("") : std::strtod(tag.c_str() + at + name.size() + 3, nullptr);
}

std::vector<Place> marks(const std::string& svg) {
  std::vector<Place> found;
  for (std::size_t at = svg.find("<circle class=\"mark\""); at != std::string::npos;
       at = svg.find("<circle class=\"mark\"", at + 1)) {
    const std::string tag = svg.substr(at, svg.find('>', at) - at);
    const std::size_t fill = tag.find("fill=\"") + 6;
    found.push_back({attribute(tag, "cx"), attribute(tag, "cy"), tag.substr(fill, tag.find('"', fill) - fill)});
  }
  return found;
}

TEST(ScatterSvg, EqualFactorsAreEqualWays) {
  const auto m = marks(scatter_svg({.groups = {{"g", {{1, 1e-8, "a"}, {10, 1e-6, "b"}, {100, 1e-4, "c"}}}}}));
  ASSERT_EQ(m.size(), 3U);
  EXPECT_NEAR(m[1].x - m[0].x, m[2].x - m[1].x, 0.2);
  EXPECT_NEAR(m[0].y - m[1].y, m[1].y - m[2].y, 0.2);
  EXPECT_GT(m[1].x, m[0].x);
  EXPECT_LT(m[1].y, m[0].y) << "larger errors are higher up";
}

TEST(ScatterSvg, WhatIsBelowTheFloorStandsHollowOnIt) {
  const auto m =
      marks(scatter_svg({.groups = {{"g", {{1, 1e-9, "at"}, {2, 1e-12, "below"}, {3, 0, "zero"}, {4, 1e-3, "above"}}}},
                         .y_floor = 1e-9}));
  ASSERT_EQ(m.size(), 4U);
  EXPECT_DOUBLE_EQ(m[1].y, m[0].y);
  EXPECT_DOUBLE_EQ(m[2].y, m[0].y);
  EXPECT_EQ(m[1].fill, "#ffffff");
  EXPECT_EQ(m[2].fill, "#ffffff");
  EXPECT_NE(m[0].fill, "#ffffff");
}

TEST(ScatterSvg, LeavesOutWhatHasNoPlace) {
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  const std::string svg =
      scatter_svg({.groups = {{"g", {{0, 1, "a"}, {-1, 1, "b"}, {none, 1, "c"}, {1, endless, "d"}, {1, none, "e"}}},
                              {"nothing", {}}}});
  EXPECT_TRUE(marks(svg).empty());
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
}

TEST(ScatterSvg, OneMarkAloneHasARangeAroundIt) {
  const auto m = marks(scatter_svg({.groups = {{"g", {{5, 1e-5, "a"}}}}}));
  ASSERT_EQ(m.size(), 1U);
  EXPECT_TRUE(std::isfinite(m[0].x) && std::isfinite(m[0].y));
}

TEST(ScatterSvg, TextsAreSafe) {
  const std::string svg = scatter_svg({.title = "a<b", .groups = {{"c&d", {{1, 1, "e\"f"}}}}});
  EXPECT_NE(svg.find("a&lt;b"), std::string::npos);
  EXPECT_NE(svg.find("c&amp;d"), std::string::npos);
  EXPECT_EQ(svg.find("c&d"), std::string::npos);
}

}  // namespace scatter_svg_test
}  // namespace slew::plotting
