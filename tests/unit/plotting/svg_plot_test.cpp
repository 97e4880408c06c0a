// SPDX-License-Identifier: Apache-2.0
#include "plotting/svg_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace slew::plotting {
namespace svg_plot_test {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// every element that is opened is closed, in order, and no text holds a bare '<'
bool is_well_formed(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::size_t end = svg.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = svg.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find(' '));
    if (tag.front() == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(name);
    }
  }
  return open.empty();
}

Series line(const std::string& name, const std::string& unit) {
  return {name, unit, {0, 1, 2}, {1, 3, 2}};
}

TEST(SvgPlot, HasOnePanelPerUnitAndOneTimeAxis) {
  const std::vector<Series> series = {line("a", "kN"), line("b", "bar"), line("c", "kN")};
  const std::string svg = plot_svg(series, {"title", "subtitle"});
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "<clipPath"), 2u);
  EXPECT_EQ(count(svg, "time [s]"), 1u);
  EXPECT_EQ(count(svg, "<title>"), 3u);
  EXPECT_EQ(count(svg, ">title</text>"), 1u);
  EXPECT_EQ(count(svg, "nan"), 0u);
}

TEST(SvgPlot, ManyCurvesOfAUnitHavePanelsOfTwelve) {
  std::vector<Series> series;
  for (int i = 0; i < 26; ++i) {
    series.push_back(line("force" + std::to_string(i), "kN"));
    if (i < 3) series.push_back(line("pressure" + std::to_string(i), "bar"));
  }
  const std::string svg = plot_svg(series, {"", ""});
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "<clipPath"), 4u);
  EXPECT_EQ(count(svg, "<title>"), 29u);
  // the panels of a unit lie below each other
  EXPECT_LT(svg.find("<title>force25<"), svg.find("<title>pressure0<"));
}

TEST(SvgPlot, PlotsShareNoPanelAndAUnitOfAPlotHasOne) {
  const std::vector<Plot> plots = {{"Height", {{"high", "m", {0, 1}, {100, 400}}}},
                                   {"Tip <y>", {{"low", "m", {0, 3}, {0.1, 0.3}}, line("b", "bar"), line("c", "m")}},
                                   {"", {line("d", "bar")}},
                                   {"nothing", {}}};
  const std::string svg = plot_svg(plots, {"", ""});
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "<clipPath"), 4u);
  EXPECT_EQ(count(svg, "time [s]"), 1u);
  EXPECT_EQ(count(svg, "class=\"heading\""), 2u);
  // in the order of the scene, each heading above the panels of its own plot
  std::size_t at = 0;
  for (const char* text :
       {">Height<", ">high</text>", ">Tip &lt;y&gt;<", ">low</text>", ">c</text>", ">b</text>", ">d</text>"}) {
    const std::size_t next = svg.find(text, at);
    ASSERT_NE(next, std::string::npos) << text;
    at = next;
  }
  // each range is that of its own plot
  EXPECT_EQ(count(svg, ">400</text>"), 1u);
  EXPECT_GE(count(svg, ">0.5</text>") + count(svg, ">1</text>") + count(svg, ">1.0</text>"), 1u);
}

TEST(SvgPlot, AHeadingTakesItsOwnRow) {
  const std::vector<Plot> plain = {{"", {line("a", "m")}}}, headed = {{"Height", {line("a", "m")}}};
  const auto height = [](const std::string& svg) { return std::stoi(svg.substr(svg.find("height=\"") + 8)); };
  EXPECT_EQ(height(plot_svg(headed, {"", ""})), height(plot_svg(plain, {"", ""})) + 20);
}

TEST(SvgPlot, TextIsEscaped) {
  const std::vector<Series> series = {line("a<b & \"c\"", "m3/s2")};
  const std::string svg = plot_svg(series, {"<script>", ""});
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "<script>"), 0u);
  EXPECT_GE(count(svg, "a&lt;b &amp; &quot;c&quot;"), 1u);
  EXPECT_EQ(count(svg, "m\u00b3/s\u00b2"), 1u);
}

TEST(SvgPlot, HoldsForAwkwardCurves) {
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Series> series = {
      {"empty", "a", {}, {}},
      {"one", "b", {1}, {5}},
      {"constant", "c", {0, 1}, {7, 7}},
      {"gaps", "d", {0, 1, 2, 3}, {nan, 1, inf, -inf}},
      {"huge", "e", {0, 1}, {-1e299, 1e299}},
      {"tiny", "f", {0, 1}, {0, std::numeric_limits<double>::denorm_min()}},
      {"unequal", "g", {0, 1, 2}, {1}},
      {"time", "h", {nan, inf, 2}, {1, 1, 1}},
  };
  const std::string svg = plot_svg(series, {"", ""});
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_EQ(count(svg, "nan"), 0u);
  EXPECT_EQ(count(svg, "inf"), 0u);
  EXPECT_EQ(count(svg, "no values"), 1u);
  EXPECT_TRUE(is_well_formed(plot_svg(std::span<const Series>(), {"", ""})));
}

TEST(SvgPlot, SizeDoesNotGrowWithTheRecording) {
  Series series = {"s", "m", {}, {}};
  for (int i = 0; i < 600'000; ++i) {
    series.time.push_back(1e-3 * i);
    series.values.push_back(std::sin(0.37 * i));
  }
  EXPECT_LT(plot_svg({&series, 1}, {"", ""}).size(), 70'000u);
}

TEST(SvgPlot, ManyCurvesStayDifferent) {
  std::vector<Series> series;
  for (int i = 0; i < 12; ++i) series.push_back(line("Element_With_A_Name_" + std::to_string(i), "m"));
  const std::string svg = plot_svg(series, {"", ""});
  EXPECT_EQ(count(svg, "curve dash"), 8u);  // four curves and their entries in the legend
}

}  // namespace svg_plot_test
}  // namespace slew::plotting
