// SPDX-License-Identifier: Apache-2.0
// Figures of a comparison, on mechanisms whose answers are known otherwise.
#include "analysis/comparison/comparison.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "analysis/comparison/comparison_report.h"
#include "build_paths.h"
#include "core/failure.h"

namespace slew::analysis {
namespace comparison_test {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// two rods, one on the other, let go from the horizontal
constexpr const char* kDoublePendulum = R"(
bodies:
  Upper: {mass: 2 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 0.167, 0.167]}
  Lower: {position: [1 m, 0, 0], mass: 1 kg, center_of_mass: [0.5 m, 0, 0], inertia: [0, 0.083, 0.083]}
joints:
  Hinge: {type: revolute, body1: Ground, body2: Upper}
  Elbow: {type: revolute, body1: Upper, point1: [1 m, 0, 0], body2: Lower}
session: {duration: 1 s, step: 8 ms}
)";

class Compare : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("slewring_compare_" + std::to_string(::getpid()) + "_" +
                                                  ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    options.repeats = 1;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& text) {
    options.scene.file = (folder_ / "scene.yaml").string();
    std::ofstream(options.scene.file) << text;
  }
  void use(const char* scene) { options.scene.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + scene; }

  [[nodiscard]] Comparison run() const {
    return compare(options, [](std::string_view, double) { return true; });
  }
  [[nodiscard]] std::string failure() const {
    try {
      static_cast<void>(run());
    } catch (const Failure& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      return error.what();
    }
    return "";
  }

  ComparisonOptions options;

 private:
  std::filesystem::path folder_;
};

TEST_F(Compare, ErrorFallsBySixteenWhenTheStepIsHalved) {
  write(kDoublePendulum);
  options.formulations = {"recursive", "lagrange"};
  options.steps = {"2ms", "4ms", "8ms"};
  const Comparison result = run();
  ASSERT_EQ(result.rows.size(), 6U);
  for (const std::size_t first : {0U, 3U}) {
    for (std::size_t i = first; i < first + 2; ++i) {
      EXPECT_NEAR(result.rows[i].configuration.step * 2, result.rows[i + 1].configuration.step, 1e-12);
      const double ratio = result.rows[i + 1].differences[0].largest / result.rows[i].differences[0].largest;
      EXPECT_NEAR(ratio, 16, 2) << result.rows[i].configuration.formulation;
    }
    EXPECT_GT(result.rows[first].differences[0].largest, 100 * result.classes[0].reference_error);
  }
}

TEST_F(Compare, JointsStayClosedAndEnergyIsKeptInEveryRow) {
  write(kDoublePendulum);
  options.steps = {"1ms"};
  const Comparison result = run();
  EXPECT_EQ(result.energy_rule, EnergyRule::kept);
  std::size_t ran = 0;
  for (const ComparedRow& row : result.rows) {
    const std::string& name = row.configuration.formulation;
    if (name != "recursive" && name != "lagrange") continue;
    ++ran;
    EXPECT_TRUE(row.is_stable()) << name;
    EXPECT_LE(row.gap.position, name == "recursive" ? 1e-14 : 1e-8) << name;
    EXPECT_LE(row.gap.rate, name == "recursive" ? 1e-13 : 1e-8) << name;
    EXPECT_LT(*row.energy_drift, 1e-6) << name;
    EXPECT_GT(row.cost.mechanics, 0) << name;
    EXPECT_GE(row.cost.mechanics_slowest, row.cost.mechanics) << name;
    EXPECT_TRUE(row.cost.is_repeatable) << name;
  }
  EXPECT_EQ(ran, 2U);
  // body coordinates are off by something: a gauge that reads joint coordinates would show as little as recursive
  EXPECT_GT(result.rows[1].gap.position, 0);
}

TEST_F(Compare, ARunThatFailsFailsAlikeEveryTime) {
  // Across its line the spring has no stiffness at the start, and 10 rad a step later: Runge-Kutta then takes every
  // swing four hundredfold.
  write(R"(
bodies:
  Mass: {mass: 1 kg, inertia: [1, 1, 1]}
joints:
  Slide: {type: prismatic, body1: Ground, body2: Mass, initial_velocity: 600 m/s}
forces:
  Spring: {type: translational, body1: Ground, point1: [1 m, 0, 0], body2: Mass, free_length: 1 m,
           spring_constant: 1.56e6 N/m}
mechanics: {gravity: [0, 0, 1]}
session: {duration: 2 s, step: 8 ms}
)");
  options.formulations = {"recursive"};
  options.steps = {"8ms"};
  options.reference_step = "1ms";
  const Comparison result = run();
  ASSERT_EQ(result.rows.size(), 1U);
  EXPECT_FALSE(result.rows[0].is_stable());
  EXPECT_NE(result.rows[0].failure, "");
  EXPECT_TRUE(result.rows[0].cost.is_repeatable);
}

// every formulation of the field table is compared, and a refused one has its reason
TEST_F(Compare, EveryFormulationThatTheFieldTableListsHasARow) {
  write(kDoublePendulum);
  options.scene.duration = "0.08s";
  options.steps = {"2ms"};
  options.formulations = {"all"};
  const Comparison result = run();
  const std::vector<std::string> known = choices_of("formulation");
  ASSERT_EQ(result.rows.size(), known.size());
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_EQ(result.rows[i].configuration.formulation, known[i]);
    if (result.rows[i].has_run()) continue;
    EXPECT_TRUE(contains(report_text(result), "cannot run: " + result.rows[i].refusal));
  }
}

// a rule has its own name, not the default's; `all` has no row for a rule that a formulation lacks
TEST_F(Compare, EveryRowNamesTheRuleThatItRunsWith) {
  write(kDoublePendulum);
  options.scene.duration = "0.02s";
  options.steps = {"2ms"};
  const auto rules = [this] {
    std::vector<std::string> names;
    for (const ComparedRow& row : run().rows) {
      EXPECT_TRUE(row.has_run()) << row.refusal;
      names.push_back(row.configuration.formulation + " " + row.configuration.integrator);
    }
    return names;
  };
  EXPECT_EQ(rules(),
            (std::vector<std::string>{"recursive rk4", "lagrange rk4", "augmented index3_trapezoidal", "penalty rk4"}));
  options.formulations = {"augmented", "penalty"};
  options.integrators = {"all"};
  EXPECT_EQ(rules(), (std::vector<std::string>{"augmented index3_trapezoidal", "penalty rk4"}));
  options.integrators = {"rk4"};
  const Comparison explicit_rule = run();
  EXPECT_TRUE(contains(explicit_rule.rows[0].refusal, "the formulation 'augmented' has no integrator 'rk4'"));
  EXPECT_TRUE(explicit_rule.rows[1].has_run());
}

TEST_F(Compare, DampedMotionIsComparedWithTheEnergyOfTheReference) {
  use("first_steps.yaml");
  options.scene.duration = "1s";
  options.formulations = {"recursive"};
  options.steps = {"1ms"};
  const Comparison result = run();
  EXPECT_EQ(result.energy_rule, EnergyRule::compared);
  EXPECT_GT(result.reference_energy_drift, 1e-3);
  EXPECT_LT(*result.rows[0].energy_drift, 1e-5);
  EXPECT_TRUE(contains(report_text(result), "loses energy"));
}

TEST_F(Compare, AStepAboveTheCommunicationStepReplacesIt) {
  use("first_steps.yaml");
  options.scene.duration = "0.5s";
  options.formulations = {"recursive"};
  options.steps = {"1ms", "5ms"};
  const Comparison result = run();
  ASSERT_EQ(result.rows.size(), 2U);
  EXPECT_GT(result.rows[1].differences[0].largest, 0);
  EXPECT_GT(result.rows[1].differences[0].largest, result.rows[0].differences[0].largest);
  EXPECT_LT(result.rows[1].differences[0].largest, 1e-3);
}

TEST_F(Compare, VariablesOfSeveralDimensionsAreJudgedApart) {
  write(kDoublePendulum);
  options.formulations = {"recursive"};
  options.steps = {"4ms"};
  options.variables = {"Hinge.position", "Lower.position.?", "Elbow.position"};
  const Comparison result = run();
  ASSERT_EQ(result.classes.size(), 2U);
  EXPECT_EQ(result.classes[0].unit, "rad");
  EXPECT_EQ(result.classes[0].columns, (std::vector<std::size_t>{0, 4}));
  EXPECT_EQ(result.classes[1].unit, "m");
  EXPECT_EQ(result.rows[0].differences.size(), 2U);
}

TEST_F(Compare, TheHydraulicMachineIsPlayedWithItsScript) {
  use("tipper.yaml");
  options.scene.duration = "2s";
  options.formulations = {"recursive", "lagrange"};
  options.steps = {"0.5ms"};
  options.variables = {"Platform.center_of_mass.?", "Vol_A.pressure"};
  const Comparison result = run();
  EXPECT_EQ(result.energy_rule, EnergyRule::compared);
  EXPECT_GT(result.classes[0].extent, 0.05) << "the script did not tip it";
  for (const ComparedRow& row : result.rows) {
    EXPECT_TRUE(row.is_stable());
    EXPECT_LT(row.differences[0].largest, 1e-5);
    EXPECT_GT(row.cost.whole, row.cost.mechanics);
    EXPECT_GT(row.iterations, 0);
  }
}

TEST_F(Compare, WhatIsBelowTheErrorOfTheReferenceIsShownAsThat) {
  write(kDoublePendulum);
  options.formulations = {"recursive"};
  options.steps = {"1ms"};
  options.reference_step = "1ms";
  const Comparison result = run();
  EXPECT_EQ(result.rows[0].differences[0].largest, 0);  // the reference itself
  EXPECT_GT(result.classes[0].reference_error, 0);
  EXPECT_TRUE(contains(report_text(result), " <")) << report_text(result);
}

TEST_F(Compare, ImpossibleOptionsAreRefusedBeforeAnythingRuns) {
  write(kDoublePendulum);
  options.formulations = {"recursiv"};
  EXPECT_TRUE(contains(failure(),
                       "--formulations: there is no 'recursiv' in this version; expected all, or some of "
                       "recursive, lagrange"));
  options.formulations.clear();
  options.integrators = {"magic"};
  EXPECT_TRUE(contains(failure(), "--integrators: there is no 'magic' in this version"));
  options.integrators.clear();
  options.steps = {"3ms"};
  EXPECT_TRUE(contains(failure(), "--steps: 3 ms neither divides the communication step 8 ms nor is a multiple of it"));
  options.steps = {"3bar"};
  EXPECT_TRUE(contains(failure(), "--steps: '3bar'"));
  options.steps = {"1s"};
  EXPECT_TRUE(contains(failure(), "--steps: 1000 ms is out of range; expected 0.001 ms to 20 ms"));
  options.steps.clear();
  options.variables = {"Absent.position.x"};
  EXPECT_TRUE(contains(failure(), "Absent.position.x"));
  options.variables.clear();
  options.scene.duration = "0s";
  EXPECT_TRUE(contains(failure(), "--until"));
}

TEST_F(Compare, EndsWithTheFinishedRowsOnRequest) {
  write(kDoublePendulum);
  options.formulations = {"recursive"};
  options.steps = {"2ms", "4ms"};
  const Comparison result =
      compare(options, [](std::string_view doing, double) { return !contains(std::string(doing), "4 ms"); });
  ASSERT_EQ(result.rows.size(), 1U);
  EXPECT_EQ(result.wanted_rows, 2U);
  EXPECT_TRUE(contains(report_text(result), "interrupted: 1 of 2 rows"));
  EXPECT_FALSE(nlohmann::json::parse(report_json(result)).at("is_complete").get<bool>());
}

TEST_F(Compare, ProgressGoesFromNothingToAllWithoutStepsBack) {
  write(kDoublePendulum);
  options.steps = {"4ms"};
  double last = 0;
  bool goes_up = true;
  static_cast<void>(compare(options, [&](std::string_view, double share) {
    goes_up = goes_up && share >= last && share <= 1;
    last = share;
    return true;
  }));
  EXPECT_TRUE(goes_up);
  EXPECT_GT(last, 0.8);
}

// ---- figures without a run ------------------------------------------------------------------------------------------

TEST(ComparedDifference, IsTheLargestAndTheRootMeanSquareOfSharedSamples) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Observation reference, run;
  reference.variables = run.variables = 2;
  reference.energy = run.energy = {0, 0, 0};
  reference.values = {1, 10, 2, 20, 3, 30};
  run.values = {1, 10, kNone, kNone, 7, 27};
  const Difference both = difference(run, reference, {.columns = {0, 1}});
  EXPECT_DOUBLE_EQ(both.largest, 4);
  EXPECT_DOUBLE_EQ(both.rms, std::sqrt((16.0 + 9) / 4));
  EXPECT_DOUBLE_EQ(difference(run, reference, {.columns = {1}}).largest, 3);
}

Comparison by_hand() {
  Comparison c;
  c.scene = "by_hand";
  c.until = 1;
  c.communication_step = 1e-3;
  c.repeats = 2;
  c.reference = {"recursive", "rk4", 1e-4};
  c.largest_kinetic_energy = 5;
  c.variables = {"A.position.x"};
  c.classes = {{.unit = "m", .columns = {0}, .extent = 1, .reference_error = 1e-9, .reference_rms = 1e-10}};
  c.rows.resize(4);
  const auto fill = [&c](std::size_t i, const char* name, double step, double error, double cost) {
    c.rows[i].configuration = {name, "rk4", step};
    c.rows[i].differences = {{error, error / 2}};
    c.rows[i].cost = {cost, 2 * cost, 3 * cost};
    c.rows[i].energy_drift = 1e-5;
  };
  fill(0, "recursive", 1e-3, 1e-4, 2);
  fill(1, "recursive", 5e-4, 1e-12, 4);
  fill(2, "lagrange", 1e-3, 3, 8);
  c.rows[2].parted_at = 0.25;
  c.rows[3].configuration = {"penalty", "rk4", 0};
  c.rows[3].refusal = "a <reason>, with a comma";
  c.wanted_rows = 4;
  return c;
}

TEST(ComparisonReport, NamesWhatIsUnstableAndWhatCannotRun) {
  const std::string text = report_text(by_hand());
  EXPECT_TRUE(contains(text, "no: away from the reference from 0.25 s on")) << text;
  EXPECT_TRUE(contains(text, "cannot run: a <reason>, with a comma")) << text;
  EXPECT_TRUE(contains(text, "<1.0e-09")) << text;
  EXPECT_TRUE(contains(text, "1.0e-04")) << text;
}

TEST(ComparisonReport, DoubtsAReferenceThatIsWorseThanWhatItJudges) {
  Comparison comparison = by_hand();
  EXPECT_FALSE(contains(report_text(comparison), "try another --reference"));
  comparison.reference_energy_drift = 1e-3;  // the rows' is 1e-5
  EXPECT_TRUE(contains(report_text(comparison), "try another --reference"));
}

TEST(ComparisonReport, PictureHasAMarkForEveryStableRow) {
  const std::string svg = report_svg(by_hand());
  std::size_t marks = 0;
  for (std::size_t at = svg.find("class=\"mark\""); at != std::string::npos; at = svg.find("class=\"mark\"", at + 1)) {
    ++marks;
  }
  EXPECT_EQ(marks, 2U);
  EXPECT_TRUE(contains(svg, ">0.5 ms</text>"));
  EXPECT_FALSE(contains(svg, "lagrange"));
  const std::string html = report_html(by_hand());
  EXPECT_TRUE(contains(html, "<svg "));
  EXPECT_TRUE(contains(html, "<td>cannot run: a &lt;reason&gt;, with a comma</td>")) << html;
  EXPECT_TRUE(contains(html, "1 s in communication steps of 1 ms\n")) << "lines stay lines";
}

TEST(ComparisonReport, TableOfValuesHasOneLineForEveryRowAndAllDigits) {
  const std::string csv = report_csv(by_hand());
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_TRUE(contains(csv, "\r\nrecursive,rk4,0.001,0,0,1e-05,0.0001,5e-05,2,4,6,0,0,yes\r\n")) << csv;
  EXPECT_TRUE(contains(csv, "penalty,rk4,,,,,,,,,,,,\"cannot run: a <reason>, with a comma\"\r\n")) << csv;
}

TEST(ComparisonReport, JsonHoldsEveryRowAndTheReference) {
  const nlohmann::json json = nlohmann::json::parse(report_json(by_hand()));
  EXPECT_EQ(json.at("rows").size(), 4U);
  EXPECT_EQ(json.at("reference").at("errors").at(0).at("largest"), 1e-9);
  EXPECT_FALSE(json.at("rows").at(2).at("is_stable").get<bool>());
  EXPECT_FALSE(json.at("rows").at(3).at("has_run").get<bool>());
}

}  // namespace comparison_test
}  // namespace slew::analysis
