// SPDX-License-Identifier: Apache-2.0
#include "plotting/html_plot.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace slew::plotting {
namespace html_plot_test {

// data of the page's script
nlohmann::json data_of(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(HtmlPlot, HoldsAPanelPerUnitAndEachTimeAxisOnce) {
  const std::vector<double> coarse = {0, 0.1, 0.2}, fine = {0, 0.05, 0.1};
  const Plot plots[] = {{.title = "Lift",
                         .series = {{"Cyl.force", "kN", coarse, {1, 2, 3}},
                                    {"Vol.pressure", "bar", fine, {4, 5, 6}},
                                    {"Cyl.limit", "kN", coarse, {7, 7, 7}}}},
                        {.title = "", .series = {{"Bag.y", "m", fine, {0.12345678901, -1e-9, 0}}}}};
  const nlohmann::json data = data_of(plot_html(plots, {}));
  EXPECT_EQ(data["times"], (nlohmann::json{coarse, fine}));
  ASSERT_EQ(data["plots"].size(), 2u);
  const nlohmann::json& panels = data["plots"][0]["panels"];
  ASSERT_EQ(panels.size(), 2u);
  EXPECT_EQ(panels[0]["unit"], "kN");
  EXPECT_EQ(panels[0]["curves"][1], (nlohmann::json{{"name", "Cyl.limit"}, {"t", 0}, {"v", {7, 7, 7}}}));
  EXPECT_EQ(panels[1]["curves"][0]["t"], 1);
  EXPECT_EQ(data["plots"][1]["panels"][0]["curves"][0]["v"], (nlohmann::json{0.1234568, -1e-9, 0}));
}

TEST(HtmlPlot, ShowsGapsAsNoValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Plot plot{.title = "", .series = {{"a", "", {0, 1, 2}, {1, nan, std::numeric_limits<double>::infinity()}}}};
  const nlohmann::json data = data_of(plot_html({&plot, 1}, {}));
  EXPECT_EQ(data["plots"][0]["panels"][0]["curves"][0]["v"], (nlohmann::json{1, nullptr, nullptr}));
}

TEST(HtmlPlot, StandsAlone) {
  const Plot plot{.title = "</script><b>", .series = {{"<i>\"x\"", "m", {0, 1}, {1, 2}}}};
  PlotOptions options;
  options.title = "<b>";
  options.subtitle = "a & b";
  const std::string page = plot_html({&plot, 1}, options);
  EXPECT_EQ(page.find("<b>"), page.find("<b>", page.find("application/json")));  // nowhere in the page's own text
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_NE(page.find("a &amp; b"), std::string::npos);
  for (const char* resource : {"src=", "href=", "http:", "https:", "import("}) {
    EXPECT_EQ(page.find(resource), std::string::npos) << resource;
  }
  EXPECT_EQ(data_of(page)["plots"][0]["title"], "</script><b>");
}

}  // namespace html_plot_test
}  // namespace slew::plotting
