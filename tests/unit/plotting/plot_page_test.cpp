// SPDX-License-Identifier: Apache-2.0
// The script of a plot's page, run: values under the pointer, zoomed ranges, and gaps of lines.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "plotting/html_plot.h"
#include "tests/support/played_page.h"

namespace slew::plotting {
namespace plot_page_test {

using nlohmann::json;

// px on a canvas of 800 px, as the page has it
constexpr const char* kDriver = R"(
const canvases=page.created.filter(e=>e.tag=='canvas'),W=800;
const at=x=>({offsetX:L+(x-a)/(b-a)*(W-L-R),pointerId:1,button:0,shiftKey:false,preventDefault(){}});
const readouts=()=>panels.flatMap(q=>q.p.curves.map(c=>c.value.textContent));
const lines=(n,colour)=>canvases[n].context.lines.filter(l=>l.colour==colour&&l.width==1.4)
 .map(l=>l.points.map(([x,y])=>a+(x-L)/(W-L-R)*(b-a)));
)";

class PlotPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!slew::testing::has_node()) GTEST_SKIP() << "there is no 'node' here, which runs the page's script";
    for (int k = 0; k <= 10; ++k) {
      fine_.push_back(0.1 * k);
      squares_.push_back(0.01 * k * k);
    }
    squares_[5] = std::numeric_limits<double>::quiet_NaN();
    plot_.series = {{"Arm.square", "m", fine_, squares_}, {"Arm.step", "rad", {0.05, 0.3, 0.55, 0.8}, {7, 8, 9, 10}}};
  }
  [[nodiscard]] json play(const std::string& drive) const {
    const json result = slew::testing::played_page(plot_html({&plot_, 1}, {}),
                                                   std::string(kDriver) + "function drive(){" + drive + "}");
    EXPECT_FALSE(result.is_null());
    return result;
  }

  std::vector<double> fine_, squares_;
  Plot plot_;
};

TEST_F(PlotPage, ShowsTheLastSampleThatIsNotLater) {
  const json result = play(R"(
    const out=[];for(const x of [.37,.3001,.55,.02,1]){canvases[0].onpointermove(at(x));out.push(readouts())}
    canvases[0].onpointerleave();out.push(readouts());return out)");
  EXPECT_EQ(result[0], (json{"0.09 at 0.3 s", "8 at 0.3 s"}));
  EXPECT_EQ(result[1], (json{"0.09 at 0.3 s", "8 at 0.3 s"}));
  EXPECT_EQ(result[2], (json{"no value at 0.5 s", "9 at 0.55 s"}));  // missing values are not invented
  EXPECT_EQ(result[3], (json{"0 at 0 s", ""}));                      // before the first sample
  EXPECT_EQ(result[4], (json{"1 at 1 s", "10 at 0.8 s"}));
  EXPECT_EQ(result[5], (json{"", ""}));
}

TEST_F(PlotPage, ZoomsByWheelAndDragMovesAndShowsAllAgain) {
  const json result = play(R"(
    const out=[[a,b]],c=canvases[1],show=()=>out.push([a,b]);
    const from=at(.2),to=at(.6);c.onpointerdown(from);c.onpointermove(to);c.onpointerup(to);show();
    const first=at(.3),second={...at(.35),shiftKey:true};c.onpointerdown({...first,shiftKey:true});c.onpointermove(second);
    c.onpointerup(second);show();
    c.ondblclick();show();
    c.listeners.wheel({...at(.4),deltaY:-400});show();
    for(let i=0;i<50;++i)c.listeners.wheel({...at((a+b)/2),deltaY:400});show();
    return out)");
  const auto expect_range = [&](std::size_t i, double low, double high) {
    EXPECT_NEAR(result[i][0].get<double>(), low, 1e-9) << i;
    EXPECT_NEAR(result[i][1].get<double>(), high, 1e-9) << i;
  };
  expect_range(0, 0, 1);
  expect_range(1, 0.2, 0.6);
  expect_range(2, 0.15, 0.55);
  expect_range(3, 0, 1);
  const double factor = std::exp(-400 * 0.0015);
  expect_range(4, 0.4 - 0.4 * factor, 0.4 + 0.6 * factor);
  expect_range(5, 0, 1);  // never more than there is
}

TEST_F(PlotPage, BreaksTheLineWhereAValueIsMissingAndHidesACurve) {
  const json result = play(R"(
    const drawn=()=>lines(0,colours[0]);
    const out=[drawn()];
    const legend=page.created.find(e=>e.tag=='span'&&e.children[1].startsWith('Arm.square'));
    legend.onclick();out.push(drawn());legend.onclick();out.push(drawn());return out)");
  ASSERT_EQ(result[0].size(), 2u);
  const auto expect_times = [&](const json& line, std::size_t from, std::size_t to) {
    ASSERT_EQ(line.size(), to - from);
    for (std::size_t i = from; i < to; ++i) EXPECT_NEAR(line[i - from].get<double>(), fine_[i], 1e-9);
  };
  expect_times(result[0][0], 0, 5);
  expect_times(result[0][1], 6, 11);
  EXPECT_EQ(result[1], json::array());
  EXPECT_EQ(result[2].size(), 2u);
}

}  // namespace plot_page_test
}  // namespace slew::plotting
