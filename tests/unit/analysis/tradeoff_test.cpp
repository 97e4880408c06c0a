// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "analysis/tradeoff/overlay.h"
#include "analysis/tradeoff/tradeoff_report.h"
#include "build_paths.h"
#include "core/failure.h"

namespace slew::analysis {
namespace tradeoff_test {

const std::string kScenes = std::string(SLEWRING_SOURCE_DIR) + "/scenes/";
constexpr double kNever = std::numeric_limits<double>::infinity();

bool has_axis(const std::vector<Axis>& axes, const std::string& path) {
  return std::any_of(axes.begin(), axes.end(), [&](const Axis& axis) { return axis.path == path; });
}

// ---- grid

TEST(Grid, ReadsAnAxisWithListsAndQuotes) {
  const Axis steps = parse_axis("session.step=0.5ms,1ms");
  EXPECT_EQ(steps.path, "session.step");
  EXPECT_EQ(steps.values, (std::vector<std::string>{"0.5ms", "1ms"}));
  const Axis gravity = parse_axis("mechanics.gravity=[0, -9.81, 0],[0, 0, 0]");
  EXPECT_EQ(gravity.values, (std::vector<std::string>{"[0, -9.81, 0]", "[0, 0, 0]"}));
  EXPECT_EQ(parse_axis("Boom.flex_modes=\"1;2\",none").values, (std::vector<std::string>{"\"1;2\"", "none"}));
  for (const char* wrong : {"session.step", "session.step=", "=1"}) {
    EXPECT_THROW(static_cast<void>(parse_axis(wrong)), Failure) << wrong;
  }
}

TEST(Grid, HasTheAxesThatTheSceneContains) {
  const std::vector<Axis> crane = default_axes(scene::load_file(kScenes + "truck_crane_flexible.yaml"));
  for (const char* path : {"session.step", "session.coupling", "mechanics.formulation", "mechanics.max_substep",
                           "hydraulics.relative_tolerance", "Truck_JibBoom.flex_modes"}) {
    EXPECT_TRUE(has_axis(crane, path)) << path;
  }
  const std::vector<Axis> pendulum = default_axes(scene::load_file(kScenes + "first_steps.yaml"));
  EXPECT_TRUE(has_axis(pendulum, "mechanics.integrator"));
  for (const char* path : {"session.coupling", "session.contact", "hydraulics.relative_tolerance"}) {
    EXPECT_FALSE(has_axis(pendulum, path)) << path;
  }
  EXPECT_TRUE(has_axis(default_axes(scene::load_file(kScenes + "contact/bouncing_ball.yaml")), "session.contact"));
}

TEST(Grid, OfTheCraneIsModestAndBeginsWithTheSceneAsItIs) {
  const std::vector<Axis> axes = default_axes(scene::load_file(kScenes + "truck_crane.yaml"));
  const std::vector<Settings> rows = default_grid(axes, GridSize::modest);
  EXPECT_TRUE(rows.front().empty());
  EXPECT_GT(rows.size(), 40u);
  EXPECT_LT(rows.size(), 100u);
  const std::vector<Axis> few = {{"a.b", {"1", "2", "3"}}, {"c.d", {"x", "y"}}};
  EXPECT_EQ(default_grid(few, GridSize::full).size(), 1u + 3u + 2u + 3u * 2u);
}

TEST(Grid, ProductHasEveryCombinationOnce) {
  const std::vector<Axis> axes = {{"a.b", {"1", "2"}}, {"c.d", {"x", "y", "x"}}};
  const std::vector<Settings> rows = product_grid(axes);
  EXPECT_EQ(rows.size(), 1u + 4u);
  EXPECT_EQ(overrides_of(rows[1]), (scene::Overrides{"a.b=1", "c.d=x"}));
}

// ---- answers

TradeoffRow row_of(double cost, double error, const char* step) {
  TradeoffRow row{.settings = {{"session.step", step}}, .is_done = true, .result = {}};
  row.result.errors = {VariableError{error, error / 2}};
  row.result.cost = {cost, cost, 2 * cost};
  return row;
}

// force of a range of 10 kN
Tradeoff example() {
  Tradeoff tradeoff;
  tradeoff.scene = "example";
  tradeoff.axes = {{"session.step", {"1ms"}}};
  tradeoff.variables = {
      {.name = "Cyl.force", .unit = "N", .dimension = Dimension::force, .range = 1e4, .spread = std::nullopt}};
  tradeoff.rows = {row_of(10, 100, "1ms"), row_of(5, 400, "2ms"), row_of(20, 50, "0.5ms"),
                   row_of(12, 300, "3ms"), row_of(1, 10, "20ms"), row_of(2, 0, "5ms")};
  tradeoff.rows[0].settings.clear();
  tradeoff.rows[4].parts_from_reference = true;
  tradeoff.rows[5].result = {.refusal = "session.step: no"};
  return tradeoff;
}

// noise of a machine at rest is no error: its range is that of the reference's own error
TEST(Variable, ThatMovesNoMoreThanTheReferenceErrsIsAtRest) {
  Tradeoff tradeoff = example();
  tradeoff.variables.push_back({.name = "Bag.position.x", .unit = "m", .range = 7, .spread = 1e-6});
  tradeoff.variables.push_back({.name = "Bag.position.y", .unit = "m", .range = 7, .spread = 2e-6});
  tradeoff.variables.push_back({.name = "Hinge.torque", .unit = "N m", .range = 6.9e-10, .spread = 1e-11});
  tradeoff.variables.push_back({.name = "Foot.force.x", .unit = "N", .range = 1e-9, .spread = 0});
  tradeoff.variables.push_back({.name = "Foot.force.y", .unit = "N", .range = 1e-9, .spread = 4e-10});
  // 1e-5 N of 6600, 0.1 um of 1 m
  tradeoff.variables.push_back({.name = "Rod.force", .unit = "N", .range = 1e-5, .size = 6600, .spread = 1e-9});
  tradeoff.variables.push_back({.name = "Hook.position", .unit = "m", .range = 1e-7, .size = 1, .spread = 1e-12});
  mark_at_rest(tradeoff.variables);
  std::vector<bool> rests;
  for (const TradeoffVariable& variable : tradeoff.variables) rests.push_back(variable.is_at_rest);
  EXPECT_EQ(rests, (std::vector<bool>{false, false, false, true, true, true, true, false}));
  for (TradeoffRow& row : tradeoff.rows) row.result.errors.resize(8, VariableError{1e-9, 1e-9});
  EXPECT_EQ(relative_error(tradeoff, tradeoff.rows[0], 3), std::nullopt);
  EXPECT_DOUBLE_EQ(worst_error(tradeoff, tradeoff.rows[0]), 0.01);
  const std::string text = report_text(tradeoff, std::nullopt);
  EXPECT_NE(text.find("Hinge.torque"), std::string::npos) << text;
  EXPECT_NE(text.find("(at rest, no error)"), std::string::npos) << text;
}

TEST(ParetoFront, KeepsWhatNothingBeats) {
  EXPECT_EQ(pareto_front({1, 2, 3, 4}, {4, 3, 2, 1}), (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_EQ(pareto_front({4, 1, 2, 3}, {1, 1, 0.5, 0.7}), (std::vector<std::size_t>{1, 2}));
  // equal ones once, the first
  EXPECT_EQ(pareto_front({1, 1, 1}, {2, 2, 3}), (std::vector<std::size_t>{0}));
  EXPECT_EQ(pareto_front({1, 2, NAN, 0.5}, {kNever, 1, 0, kNever}), (std::vector<std::size_t>{1}));
  EXPECT_TRUE(pareto_front({}, {}).empty());
}

TEST(ParetoFront, LeavesOutRowsThatAreNotStable) {
  Tradeoff tradeoff = example();
  mark_pareto(tradeoff);
  std::vector<bool> marks;
  for (const TradeoffRow& row : tradeoff.rows) marks.push_back(row.is_pareto);
  EXPECT_EQ(marks, (std::vector<bool>{true, true, true, false, false, false}));
}

TEST(Answer, OfABudgetIsTheLeastErrorWithinIt) {
  const Tradeoff tradeoff = example();
  EXPECT_EQ(best_row(tradeoff, {.budget = 12, .errors = {}}), 0u);
  EXPECT_EQ(best_row(tradeoff, {.budget = 100, .errors = {}}), 2u);
  EXPECT_EQ(best_row(tradeoff, {.budget = 5, .errors = {}}), 1u);
  EXPECT_EQ(best_row(tradeoff, {.budget = 4.9, .errors = {}}), std::nullopt);
  EXPECT_EQ(parse_budget("20 us/ms"), 20);
  EXPECT_EQ(parse_budget("20us/ms"), 20);
  EXPECT_EQ(parse_budget(" 7.5 "), 7.5);
  for (const char* wrong : {"", "us/ms", "20 s", "-1", "0", "nan", "20 us"}) {
    EXPECT_THROW(static_cast<void>(parse_budget(wrong)), Failure) << wrong;
  }
}

TEST(Answer, OfAnErrorIsTheLeastCostThatKeepsIt) {
  const Tradeoff tradeoff = example();
  const auto best = [&](const std::string& text) {
    return best_row(tradeoff, {.budget = {}, .errors = {parse_error(text, tradeoff)}});
  };
  EXPECT_EQ(best("Cyl.force 5%"), 1u);
  EXPECT_EQ(best("Cyl.force 1 %"), 0u);
  EXPECT_EQ(best("Cyl.force 0.3kN"), 0u);
  EXPECT_EQ(best("Cyl.* 60"), 2u);
  EXPECT_EQ(best("Cyl.force 1 N"), std::nullopt);
  const Question both{.budget = 15, .errors = {parse_error("Cyl.force 60 N", tradeoff)}};
  EXPECT_EQ(best_row(tradeoff, both), std::nullopt);
  for (const char* wrong : {"Cyl.force", "Cyl.forc 1%", "Cyl.force x%", "Cyl.force 1 bar", "Cyl.force 0%"}) {
    EXPECT_THROW(static_cast<void>(parse_error(wrong, tradeoff)), Failure) << wrong;
  }
}

// each text of a message once
TEST(Answer, OfAWrongQuantityIsRefusedWithItsDimension) {
  try {
    static_cast<void>(parse_error("Cyl.force 1 kg", example()));
    ADD_FAILURE();
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(),
                 "--error 'Cyl.force 1 kg': '1 kg' is a mass; expected a force such as '1 kN', or a bare number in N; "
                 "nothing was run");
  }
}

TEST(Answer, ThatCannotBeGivenIsRefusedBeforeAnythingRuns) {
  TradeoffOptions options;
  options.scene.file = kScenes + "first_steps.yaml";
  options.folder = ::testing::TempDir() + "tradeoff_refused";
  options.errors = {"Rod.center_of_mass 1 bar"};
  options.variables = {"Rod.center_of_mass"};
  const auto no_run = [](std::string_view doing, double) -> bool {
    ADD_FAILURE() << doing;
    return false;
  };
  EXPECT_THROW(static_cast<void>(trade_off(options, no_run)), Failure);
  EXPECT_FALSE(std::filesystem::exists(options.folder));
}

TEST(Answer, OfAVectorIsAboutAllItsComponents) {
  Tradeoff tradeoff;
  for (const char* name : {"Bag.position.x", "Bag.position.y", "Bag.mass"}) {
    tradeoff.variables.push_back(
        {.name = name, .unit = "m", .dimension = Dimension::length, .range = 2, .spread = std::nullopt});
  }
  EXPECT_EQ(parse_error("Bag.position 1mm", tradeoff).variables, (std::vector<std::size_t>{0, 1}));
  EXPECT_DOUBLE_EQ(parse_error("Bag.position 1mm", tradeoff).bound, 1e-3);
}

// ---- results and reports

TEST(RowResult, AndJobComeBackFromJson) {
  RowResult result;
  result.errors = {VariableError{1.5, 0.25}, std::nullopt};
  result.eta = 1e-5;
  result.net = -2e-6;
  result.gap = 1e-9;
  result.open_joint = "Hinge";
  result.not_converged = 3;
  result.cost = {1, 2, 3};
  result.low = {-1, 0};
  result.high = {1, 2};
  EXPECT_EQ(result_from(Json::parse(to_json(result).dump()).value()), result);
  RowJob job;
  job.scene.file = "a.yaml";
  job.scene.overrides = {"session.step=2ms"};
  job.variables = {"Cyl.force"};
  job.kind = RunKind::reference;
  job.row_step = 0.002;
  EXPECT_EQ(to_json(job_from(to_json(job))).dump(), to_json(job).dump());
}

TEST(StepCost, IsPerSimulatedMillisecond) {
  // steps of 2 ms that take 10, 30, 20, 100 us
  const StepCost cost = cost_of({10'000, 30'000, 20'000, 100'000}, milliseconds(2));
  EXPECT_DOUBLE_EQ(cost.median, 12.5);
  EXPECT_DOUBLE_EQ(cost.mean, 20);
  EXPECT_DOUBLE_EQ(cost.worst, 50);
}

TEST(TradeoffReport, HasRefusalsInstabilityAndTheAnswer) {
  Tradeoff tradeoff = example();
  mark_pareto(tradeoff);
  const Answer answer{.question = {.budget = 5, .errors = {}}, .row = 1, .overlay = "example_tradeoff.yaml"};
  const std::string text = report_text(tradeoff, answer);
  EXPECT_NE(text.find("refused: session.step: no"), std::string::npos) << text;
  EXPECT_NE(text.find("no: error exceeds the reference's own range"), std::string::npos) << text;
  EXPECT_NE(text.find("at most 5 us/ms: step 2ms (5 us/ms, worst error 4 %)"), std::string::npos) << text;
  const nlohmann::json json = nlohmann::json::parse(report_json(tradeoff, answer));
  EXPECT_EQ(json.at("rows").size(), 6u);
  EXPECT_DOUBLE_EQ(json.at("rows").at(1).at("errors").at("Cyl.force").at("relative"), 0.04);
  EXPECT_EQ(json.at("answer").at("row"), 1);
  const std::string csv = report_csv(tradeoff);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  // the page needs no external resource, and names cannot leave their place
  tradeoff.scene = "</script><b>";
  const std::string page = report_html(tradeoff, std::nullopt);
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_EQ(page.find("src="), std::string::npos);
}

// ---- overlay

class Overlay : public ::testing::Test {
 protected:
  Overlay() {
    std::filesystem::create_directories(folder_);
    std::filesystem::copy_file(kScenes + "single_cylinder.yaml", folder_ / "single_cylinder.yaml",
                               std::filesystem::copy_options::overwrite_existing);
  }
  ~Overlay() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("slewring-overlay-" + std::to_string(::getpid()));
};

TEST_F(Overlay, IsTheSceneWithTheSettings) {
  const scene::Overrides settings = {"session.step=2ms", "Load.mass=1200kg", "hydraulics.relative_tolerance=1e-3"};
  const std::string file = overlay_target(path("single_cylinder.yaml"), "", "tradeoff");
  EXPECT_EQ(file, path("single_cylinder_tradeoff.yaml"));
  write_overlay(path("single_cylinder.yaml"), settings, "why", file);
  scene::Scene read = scene::load_file(file), expected = scene::load_file(path("single_cylinder.yaml"), settings);
  EXPECT_EQ(read.expanded_text, expected.expanded_text);
  EXPECT_EQ(read.session.step, 2e-3);
  // it may be replaced by another one
  EXPECT_EQ(overlay_target(path("single_cylinder.yaml"), "", "tradeoff"), file);
  write_overlay(path("single_cylinder.yaml"), {"session.step=4ms"}, "why", file);
  EXPECT_EQ(scene::load_file(file).session.step, 4e-3);
}

TEST_F(Overlay, OfASceneThatIncludesHoldsItsKeysToo) {
  std::ofstream(path("long.yaml")) << "include: single_cylinder.yaml\nscene: long\nsession: {duration: 7 s}\n"
                                      "bodies: {Load: {mass: 900 kg}}\n";
  const scene::Overrides settings = {"session.step=2ms", "Load.center_of_mass=[0.1, 0, 0]"};
  const std::string file = path("long_tradeoff.yaml");
  write_overlay(path("long.yaml"), settings, "why", file);
  EXPECT_EQ(scene::load_file(file).expanded_text, scene::load_file(path("long.yaml"), settings).expanded_text);
}

TEST_F(Overlay, SetsParametersAndElementsOfInstances) {
  std::ofstream(path("rods.yaml"))
      << "scene: rods\nparameters: {w: 4 m}\ngroups:\n  Swing:\n    bodies:\n"
         "      Rod: {position: [${w / 2}, 0, 0], mass: 1 kg, inertia: [0, 1, 1]}\n    joints:\n"
         "      Hinge: {type: revolute, point1: [${w / 2}, 0, 0], body2: Rod}\n"
         "instances: {A: {group: Swing}}\n";
  std::ofstream(path("more.yaml")) << "include: rods.yaml\nscene: more\nparameters: {w: \"${2 * 4 m}\"}\n";
  for (const char* scene : {"rods", "more"}) {
    const scene::Overrides settings = {"w=6 m", "A_Rod.mass=8 kg"};
    const std::string from = path((std::string(scene) + ".yaml").c_str()), file = path("overlay.yaml");
    write_overlay(from, settings, "why", file);
    EXPECT_EQ(scene::load_file(file).expanded_text, scene::load_file(from, settings).expanded_text);
    EXPECT_EQ(scene::load_file(file).mechanics.bodies.at(0).position[0], 3);
  }
}

TEST_F(Overlay, NeverReplacesWhatIsNotItsOwn) {
  std::ofstream(path("mine.yaml")) << "bodies: {}\n";
  EXPECT_THROW(static_cast<void>(overlay_target(path("single_cylinder.yaml"), path("mine.yaml"), "tradeoff")), Failure);
}

TEST_F(Overlay, LiesBesideItsScene) {
  std::filesystem::create_directories(folder_ / "elsewhere");
  EXPECT_THROW(
      static_cast<void>(overlay_target(path("single_cylinder.yaml"), path("elsewhere/overlay.yaml"), "tradeoff")),
      Failure);
}

}  // namespace tradeoff_test
}  // namespace slew::analysis
