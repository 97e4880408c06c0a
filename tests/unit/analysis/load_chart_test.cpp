// SPDX-License-Identifier: Apache-2.0
// Load charts: a crane of two bars by its lever arms, the excavator by those of its four-bar, tipping, refusals.
#include "analysis/load_chart/load_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/load_chart/tipping.h"
#include "build_paths.h"
#include "core/failure.h"
#include "multibody/model/model.h"
#include "multibody/results/observe.h"
#include "scene/ports.h"

namespace slew::analysis {
namespace load_chart_test {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGravity = 9.81;  // m/s2
const std::string kTwoBars = SLEWRING_SOURCE_DIR "/tests/unit/analysis/two_bar_crane.yaml";

LoadChart chart_of(const LoadChartOptions& options) {
  return find_load_chart(options, [](std::string_view, double) { return true; });
}

// Loads [kg] of two_bar_crane.yaml by the balance of moments; a: boom above level, b: jib from the boom.
struct ByHand {
  double reach, height, lift, jib, structure, tipping;
};

double arm(double x1, double y1, double x2, double y2) {
  // of the line from 1 to 2 about the origin
  return (x1 * y2 - y1 * x2) / std::hypot(x2 - x1, y2 - y1);
}

double push(double bore, double rod) {
  const double piston = 0.25 * std::numbers::pi * bore * bore;
  return 201e5 * piston - 1e5 * (piston - 0.25 * std::numbers::pi * rod * rod);
}

ByHand two_bars(double a, double b, double structure, double tipping_x) {
  const double jib_x = std::cos(a + b), boom_x = std::cos(a);
  const double lift_arm = arm(0.3, -0.8, 0.9 * std::cos(a), 0.9 * std::sin(a));
  // about the jib's pin, in axes of the boom
  const double jib_arm = arm(-0.8, -0.3, 0.5 * std::cos(b), 0.5 * std::sin(b));
  const double reach = 2 * boom_x + 1.5 * jib_x;
  const double own = 200 * boom_x + 80 * (2 * boom_x + 0.7 * jib_x);  // kg m about the foot
  const auto by_lift = [&](double F) { return (F * lift_arm / kGravity - own) / reach; };
  const double stands = 1200 * (tipping_x + 0.5) - (own - 280 * tipping_x);
  return {.reach = reach,
          .height = 2 * std::sin(a) + 1.5 * std::sin(a + b),
          .lift = by_lift(push(0.080, 0.045)),
          .jib = (push(0.040, 0.025) * jib_arm / kGravity - 80 * 0.7 * jib_x) / (1.5 * jib_x),
          .structure = by_lift(structure),
          .tipping = stands / (reach - tipping_x)};
}

TEST(LoadChart, OfTwoBarsIsTheBalanceOfMoments) {
  const LoadChart chart = chart_of({.scene = kTwoBars,
                                    .over = {"Boom_Foot=5deg..55deg:6", "Jib_Pin=-60deg..-10deg:3"},
                                    .lines = {"0.6 0 -1, 0.6 0 1"},
                                    .structure = {"Lift=60kN"}});
  ASSERT_EQ(chart.poses.size(), 18u);
  ASSERT_EQ(chart.limits.size(), 4u);
  EXPECT_EQ(chart.payload, "Load");
  std::vector<int> limiting(4, 0);
  for (std::size_t i = 0; i < chart.poses.size(); ++i) {
    const ChartPose& pose = chart.poses[i];
    const double a = (5 + 10 * static_cast<double>(i / 3)) * kDegree;
    const double b = (-60 + 25 * static_cast<double>(i % 3)) * kDegree;
    ASSERT_TRUE(pose.has_load()) << pose.refusal;
    const ByHand hand = two_bars(a, b, 60e3, 0.6);
    EXPECT_NEAR(pose.reach, hand.reach, 1e-9);
    EXPECT_NEAR(pose.height, hand.height, 1e-9);
    const double wanted[] = {hand.lift, hand.jib, hand.structure, hand.tipping};
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(pose.loads[k], wanted[k], 1e-5 * wanted[k]) << k << " " << i;
    EXPECT_EQ(pose.load, pose.loads[pose.limiting]);
    for (const double load : pose.loads) EXPECT_LE(pose.load, load);
    ++limiting[pose.limiting];
  }
  EXPECT_GT(limiting[1], 0) << "the jib's cylinder limits near to the machine";
  EXPECT_GT(limiting[3], 0) << "tipping far from it";
}

// The load hangs on a free hinge at the boom's end, so it pulls there, below it, at every pose; the chassis of 2 t tips
// about x = 1.4 m.
TEST(LoadChart, ALoadOnAFreeHingeHangsBelowTheBoomsEnd) {
  const LoadChart chart = chart_of({.scene = SLEWRING_SOURCE_DIR "/tests/unit/analysis/hinged_load.yaml",
                                    .over = {"Foot=-20deg..20deg:3"},
                                    .lines = {"1.4 -1 -1.1, 1.4 1 -1.1"},
                                    .structure = {"L_Cyl=70kN"}});
  ASSERT_EQ(chart.poses.size(), 3u);
  const double step = 1e-6;
  for (std::size_t i = 0; i < 3; ++i) {
    const ChartPose& pose = chart.poses[i];
    ASSERT_TRUE(pose.has_load()) << pose.refusal;
    const double a = (-20 + 20 * static_cast<double>(i)) * kDegree, c = std::cos(a), s = std::sin(a);
    const double tip = 3 * c - 0.2 * s, boom = 1.5 * c - 0.1 * s;
    EXPECT_NEAR(pose.reach, tip, 1e-7);
    EXPECT_NEAR(pose.height, 3 * s + 0.2 * c - 1.3, 1e-7);
    // by virtual work on two equal cylinders
    const auto length = [](double angle) {
      return std::hypot(std::cos(angle) + 0.1 * std::sin(angle) - 0.5, std::sin(angle) - 0.1 * std::cos(angle) + 1.1);
    };
    const double lever = 2 * (length(a + step) - length(a - step)) / (2 * step);
    EXPECT_NEAR(pose.loads[2], (70e3 * lever / kGravity - 300 * boom) / tip, 0.5);
    const double tipping = (2000 * (1.4 + 0.5) + 300 * (1.4 - boom)) / (tip - 1.4);
    EXPECT_NEAR(pose.loads.back(), tipping, 1e-5 * tipping) << pose.settings[0];
  }
}

// the crane's bag on its ball, as if it had been put plumb by hand
TEST(LoadChart, TheBagOfTheCraneHangsPlumb) {
  const std::string crane = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
  for (const double angle : {0.0, 60.0}) {
    LoadChartOptions options{.scene = crane, .over = {"Pillar_LiftBoom=0deg..60deg:2"}};
    const std::size_t number = angle == 0 ? 0 : 1;
    const ChartPose pose = chart_of(options).poses.at(number);
    // the bag's angle in the scene that makes it plumb: 25 deg less than the boom's
    options.overrides = {"Bag.orientation=[" + std::to_string(angle - 25) + " deg, 0, 0]"};
    const ChartPose plumb = chart_of(options).poses.at(number);
    EXPECT_NEAR(pose.reach, plumb.reach, 1e-7);
    EXPECT_NEAR(pose.height, plumb.height, 1e-7);
    EXPECT_NEAR(pose.load, plumb.load, 1e-6 * plumb.load);
    EXPECT_NEAR(pose.reach, angle == 0.0 ? 5.331 : 4.063, 5e-4);
    EXPECT_NEAR(pose.load, angle == 0.0 ? 1538 : 385, 0.5);
  }
}

TEST(LoadChart, AFreeJointWithoutRestIsNamed) {
  const LoadChartOptions options{.scene = SLEWRING_SOURCE_DIR "/tests/unit/analysis/hinged_load.yaml",
                                 .overrides = {"Hang.type=prismatic", "Hang.orientation1=[0, 0, 0]",
                                               "Hang.orientation2=[0, 0, 0]", "Hang.viscous_friction=5 Ns/m"},
                                 .over = {"Foot=0deg..5deg:2"}};
  try {
    static_cast<void>(chart_of(options));
    ADD_FAILURE();
  } catch (const Failure& failure) {
    EXPECT_NE(std::string(failure.what()).find("Hang has no stable equilibrium"), std::string::npos) << failure.what();
  }
}

TEST(LoadChart, APoseBeyondAStrokeHasNoLoad) {
  const LoadChart chart = chart_of({.scene = kTwoBars, .over = {"Boom_Foot=-40deg,30deg"}});
  ASSERT_EQ(chart.poses.size(), 2u);
  EXPECT_NE(chart.poses[0].refusal.find("Lift"), std::string::npos) << chart.poses[0].refusal;
  EXPECT_TRUE(chart.poses[1].has_load());
  EXPECT_NEAR(chart.poses[1].values[0], 30 * kDegree, 1e-9) << "a list is in SI";
  EXPECT_EQ(chart.coordinates[0].unit, "rad");
  EXPECT_EQ(chart.limits.size(), 2u) << "no tipping without lines or tyres, no structure without a force";
}

TEST(LoadChart, BadInputIsRefusedBeforeTheWork) {
  const LoadChartOptions good{.scene = kTwoBars, .over = {"Boom_Foot=0deg..30deg:4"}};
  const auto refuses = [](const LoadChartOptions& options, const std::string& text) {
    try {
      static_cast<void>(chart_of(options));
      ADD_FAILURE() << text;
    } catch (const Failure& failure) {
      EXPECT_NE(std::string(failure.what()).find(text), std::string::npos) << failure.what();
    }
  };
  LoadChartOptions bad = good;
  bad.over = {"Bom_Foot=0deg,1deg"};
  refuses(bad, "did you mean 'Boom_Foot'?");
  bad.over = {};
  refuses(bad, "one or two joints");
  bad.over = {"Boom_Foot=up,down"};
  refuses(bad, "'up' is no position");
  bad.over = {"Boom_Foot=-60deg,-50deg"};
  refuses(bad, "no position of --over has a load");
  bad = good, bad.scene = SLEWRING_SOURCE_DIR "/scenes/truck_crane_segmented.yaml";
  bad.over = {"Pillar_LiftBoom=0deg,10deg"};
  refuses(bad, "flexible or segmented bodies");
  bad = good, bad.lines = {"0 0 0, 0 0 0"};
  refuses(bad, "two points of Ground");
  bad.lines = {"1 0 1, 1 5 1"};
  refuses(bad, "'1 0 1, 1 5 1' is vertical");
  bad = good, bad.over = {"Boom_Foot=0deg,1deg", "Boom_Foot=5deg,6deg"};
  refuses(bad, "--over is given twice for Boom_Foot");
  bad = good, bad.structure = {"Lft=1kN"};
  refuses(bad, "no cylinder 'Lft'");
  bad = good, bad.structure = {"Lift=-1kN"};
  refuses(bad, "not above 0");
  bad = good, bad.from = "Absent";
  refuses(bad, "no body 'Absent'");
  bad = good, bad.overrides = {"mechanics.gravity=[0, 0, 0]"};
  refuses(bad, "no gravity");
}

// four wheels 1 m before and behind the middle of the wagon, 0.8 m to either side
TEST(LoadChart, TyresGiveTheTippingLines) {
  const scene::Scene scene = scene::load_file(SLEWRING_SOURCE_DIR "/scenes/forces/tyres.yaml");
  const multibody::Model model = multibody::build_model(scene.mechanics, scene::row_names(scene));
  const multibody::State state = multibody::start_state(model);
  multibody::Workspace ws(model);
  multibody::observe(model, state, ws);
  const std::vector<TippingLine> lines = lines_of_tyres(model, ws);
  ASSERT_EQ(lines.size(), 4u);
  double around = 0;
  for (const TippingLine& line : lines) {
    for (const math::Vec3& corner : {line.P, line.Q}) {
      EXPECT_NEAR(std::fabs(corner.x()), 1, 1e-9);
      EXPECT_NEAR(std::fabs(corner.z()), 0.8, 1e-9);
    }
    around += math::norm(line.Q - line.P);
    EXPECT_GT(line.side * side_of(line, {0, 0, 0}, model.gravity), 0) << "the machine stands between its tyres";
  }
  EXPECT_NEAR(around, 2 * (2 + 1.6), 1e-9);
}

TEST(LoadChart, TheTippingLoadIsTheBalanceOfMoments) {
  const math::Vec3 gravity(0, -kGravity, 0);
  TippingLine front{{1, 0, -0.8}, {1, 0, 0.8}};
  front.side = side_of(front, {0, 0, 0}, gravity);
  const auto load_of = [&](const Weight& weight, math::Vec3 payload) {
    return tipping_load(tipping_moments(front, std::vector<Weight>{weight}, payload, gravity), front.side);
  };
  EXPECT_NEAR(load_of({{0, 1, 0}, 480}, {2.5, 1, 0}), 480 * 1.0 / 1.5, 1e-9);
  EXPECT_TRUE(std::isinf(load_of({{0, 1, 0}, 480}, {0.5, 1, 0})));
  EXPECT_EQ(load_of({{1.2, 1, 0}, 480}, {2.5, 1, 0}), 0) << "tips without payload";
}

// The carrier's 1.2 t at x = -0.5 m about a line at -0.2 m: at low booms the own weight already tips the crane forward.
TEST(LoadChart, AMachineThatTipsWithoutLoadHasNone) {
  for (const char* over : {"Boom_Foot=5deg..55deg:6", "Boom_Foot=5deg..15deg:2"}) {
    const LoadChart chart = chart_of(
        {.scene = kTwoBars, .overrides = {"start.Jib_Pin=-35 deg"}, .over = {over}, .lines = {"-0.2 0 1, -0.2 0 -1"}});
    int tipped = 0;
    for (std::size_t i = 0; i < chart.poses.size(); ++i) {
      const ChartPose& pose = chart.poses[i];
      ASSERT_TRUE(pose.has_load()) << pose.refusal;
      const double wanted = two_bars((5 + 10 * static_cast<double>(i)) * kDegree, -35 * kDegree, 0, -0.2).tipping;
      EXPECT_EQ(pose.tips_alone, wanted < 0) << pose.settings[0];
      EXPECT_NEAR(pose.loads.back(), std::max(0.0, wanted), 1e-5 * std::fabs(wanted)) << pose.settings[0];
      if (pose.tips_alone) EXPECT_EQ(pose.load, 0) << pose.settings[0];
      tipped += pose.tips_alone ? 1 : 0;
    }
    EXPECT_GE(tipped, 2) << over;
    EXPECT_NE(report_csv(chart).find(",0,tipping: tips without load,"), std::string::npos) << report_csv(chart);
    ASSERT_EQ(chart.notes.size(), 1u);
    EXPECT_NE(chart.notes[0].find("on the side of its parts that are fixed to Ground (centre of mass at -0.5 0 0 m)"),
              std::string::npos)
        << chart.notes[0];
    EXPECT_NE(report_text(chart).find("note: tipping line '-0.2 0 1, -0.2 0 -1'"), std::string::npos);
  }
}

// The boom is behind a line at 12 m, and so is its payload: the machine stands there and never tips about it.
TEST(LoadChart, AThirdPointStatesTheSideOfALine) {
  const auto chart = [](const char* line) {
    return chart_of({.scene = kTwoBars, .over = {"Boom_Foot=5deg..15deg:2"}, .lines = {line}});
  };
  const LoadChart stated = chart("12 0 1, 12 0 -1, 0 0 0"), other = chart("12 0 1, 12 0 -1, 13 5 0");
  EXPECT_TRUE(stated.notes.empty());
  for (const ChartPose& pose : stated.poses) {
    EXPECT_FALSE(pose.tips_alone);
    EXPECT_TRUE(std::isinf(pose.loads.back())) << pose.loads.back();
  }
  for (const ChartPose& pose : other.poses) EXPECT_TRUE(pose.tips_alone);
  // as the side that the parts fixed to Ground decide
  const LoadChart found = chart("1.4 0 -1.2, 1.4 0 1.2"), same = chart("1.4 0 -1.2, 1.4 0 1.2, -2 0 0");
  for (std::size_t i = 0; i < found.poses.size(); ++i) {
    EXPECT_DOUBLE_EQ(found.poses[i].loads.back(), same.poses[i].loads.back());
  }
  for (const char* wrong : {"1 0 -1, 1 0 1, 1 3 0", "1 0 -1, 1 0 1, 0 0 0, 0 0 1", "1 0 -1, 1 0 1,"}) {
    EXPECT_THROW(static_cast<void>(chart(wrong)), Failure) << wrong;
  }
}

TEST(LoadChart, TheMachineStandsOnOneSideOfALine) {
  const math::Vec3 gravity(0, -kGravity, 0);
  const TippingLine front{{1, 0, -1}, {1, 0, 1}}, rear{{-1, 0, 1}, {-1, 0, -1}};
  const double behind_front = side_of(front, {0, 0, 0}, gravity);
  const auto side = [&](std::vector<TippingLine> lines, const std::vector<Weight>& weights,
                        const std::vector<math::Vec3>& payloads, const char* because) {
    std::vector<TippingMoments> moments;
    for (const math::Vec3& payload : payloads) {
      moments.push_back(tipping_moments(lines[0], weights, payload, gravity));
    }
    const std::string text = choose_side(lines, 0, weights, moments, gravity).text;
    EXPECT_NE(text.find(because), std::string::npos) << text;
    return lines[0].side * behind_front;
  };
  const std::vector<Weight> ahead = {{{1.5, 0, 0}, 100}}, back = {{{0.5, 0, 0}, 100}};
  const std::vector<Weight> on_carrier = {{{0, 0, 0}, 100, true}, {{3, 0, 0}, 900}};
  EXPECT_GT(side({front}, on_carrier, {{4, 0, 0}}, "fixed to Ground"), 0);
  EXPECT_GT(side({front}, on_carrier, {{-4, 0, 0}}, "fixed to Ground"), 0);
  EXPECT_GT(side({front, rear}, ahead, {{4, 0, 0}}, "other lines"), 0);
  EXPECT_GT(side({front}, ahead, {{4, 0, 0}, {2, 0, 0}}, "where the payload is not"), 0);
  EXPECT_GT(side({front}, back, {{4, 0, 0}, {2, 0, 0}}, "where the payload is not"), 0);
  EXPECT_GT(side({front}, back, {{4, 0, 0}, {-4, 0, 0}}, "at most positions (2 of 2)"), 0);
  EXPECT_LT(side({front}, ahead, {{4, 0, 0}, {-4, 0, 0}}, "at most positions (2 of 2)"), 0);
}

TEST(LoadChart, ReportsHaveEveryPose) {
  const LoadChart chart = chart_of({.scene = kTwoBars, .over = {"Boom_Foot=-40deg..50deg:10"}});
  const std::string csv = report_csv(chart), svg = report_svg(chart), text = report_text(chart);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 11);
  EXPECT_NE(csv.find("Boom_Foot [deg],reach [m],height [m],load [kg],limited by,Lift [kg],Jib_Cylinder [kg]"),
            std::string::npos)
      << csv;
  EXPECT_NE(text.find("outside of its limits"), std::string::npos);
  EXPECT_NE(svg.find("reach [m]"), std::string::npos);
}

}  // namespace load_chart_test
}  // namespace slew::analysis
