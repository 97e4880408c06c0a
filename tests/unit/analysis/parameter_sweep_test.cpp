// SPDX-License-Identifier: Apache-2.0
// Rows and measures of a parameter sweep: samples and their order, measures of signals with known values, statistics
// against printed tables.
#include "analysis/parameter_sweep/parameter_sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analysis/parameter_sweep/measure.h"
#include "analysis/parameter_sweep/row_run.h"
#include "analysis/parameter_sweep/statistics.h"
#include "analysis/parameter_sweep/variation.h"
#include "core/failure.h"

namespace slew::analysis {
namespace parameter_sweep_test {

std::string refusal_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::bad_input);
    return failure.what();
  }
  return "accepted";
}

// ---- variations

TEST(Variation, AGridIncludesBothEndsInTheUnitOfTheUser) {
  EXPECT_EQ(grid_values(parse_variation("Bag.mass=200kg..1500kg:3", Sampling::grid)),
            (std::vector<std::string>{"200 kg", "850 kg", "1500 kg"}));
  EXPECT_EQ(grid_values(parse_variation("p=0..30 bar:4", Sampling::grid)),
            (std::vector<std::string>{"0 bar", "10 bar", "20 bar", "30 bar"}));
  EXPECT_EQ(grid_values(parse_variation("n=-1..1:3", Sampling::grid)), (std::vector<std::string>{"-1", "0", "1"}));
  EXPECT_EQ(grid_values(parse_variation("c=hold,two", Sampling::grid)), (std::vector<std::string>{"hold", "two"}));
}

TEST(Variation, TheLastOneOfAGridChangesFastest) {
  const std::vector<Variation> variations = {parse_variation("a=1,2", Sampling::grid),
                                             parse_variation("b=3..5:3", Sampling::grid)};
  const std::vector<Settings> rows = sweep_rows(variations, Sampling::grid, 0, 1);
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[1], (Settings{{"a", "1"}, {"b", "4"}}));
  EXPECT_EQ(rows[3], (Settings{{"a", "2"}, {"b", "3"}}));
}

TEST(Variation, ALatinHypercubeHasOneValueInEachPartOfEachRange) {
  constexpr std::size_t kRows = 17;
  const std::vector<Variation> variations = {parse_variation("a=0..17", Sampling::lhs),
                                             parse_variation("b=10 m..44 m", Sampling::lhs)};
  const std::vector<Settings> rows = sweep_rows(variations, Sampling::lhs, kRows, 3);
  std::set<int> parts_a, parts_b;
  bool are_in_one_order = true;
  for (const Settings& row : rows) {
    const int a = static_cast<int>(*number_of(variations[0], row[0].second));
    const int b = static_cast<int>((*number_of(variations[1], row[1].second) - 10) / 2);
    parts_a.insert(a);
    parts_b.insert(b);
    are_in_one_order = are_in_one_order && a == b;
  }
  EXPECT_EQ(parts_a.size(), kRows);
  EXPECT_EQ(parts_b.size(), kRows);
  EXPECT_FALSE(are_in_one_order);
}

TEST(Variation, TheSeedAloneDeterminesTheRows) {
  const std::vector<Variation> variations = {parse_variation("a=0..1", Sampling::random)};
  for (const Sampling sampling : {Sampling::random, Sampling::lhs}) {
    const auto rows = sweep_rows(variations, sampling, 5, 7);
    EXPECT_EQ(rows, sweep_rows(variations, sampling, 5, 7));
    EXPECT_NE(rows, sweep_rows(variations, sampling, 5, 8));
  }
  // std::mt19937_64 with seed 5489 begins with 14514284786278117030 (C++ standard: its 10000th is 9981545732273789042)
  const double first = static_cast<double>(14514284786278117030ull >> 11) * 0x1p-53;
  EXPECT_EQ(number_of(variations[0], sweep_rows(variations, Sampling::random, 1, 5489)[0][0].second), first);
}

TEST(Variation, ListsHaveNumbersInSiWhereTheyAreQuantitiesOfOneKind) {
  const Variation masses = parse_variation("a=500 kg,2 t", Sampling::grid);
  EXPECT_EQ(masses.unit, "kg");
  EXPECT_EQ(number_of(masses, "2 t"), 2000);
  EXPECT_EQ(number_of(parse_variation("a=hold,two", Sampling::grid), "two"), std::nullopt);
  EXPECT_EQ(number_of(parse_variation("a=1 m,2 kg", Sampling::grid), "1 m"), std::nullopt);
}

TEST(Variation, RefusesWhatIsNoRange) {
  const auto refusal = [](const std::string& text, Sampling sampling) {
    return refusal_of([&] { static_cast<void>(parse_variation(text, sampling)); });
  };
  EXPECT_NE(refusal("Bag.mass", Sampling::grid).find("'=' is missing"), std::string::npos);
  EXPECT_NE(refusal("a=1..2", Sampling::grid).find("needs the number of values"), std::string::npos);
  EXPECT_NE(refusal("a=1..2:3", Sampling::lhs).find("a count belongs to --sample grid"), std::string::npos);
  EXPECT_NE(refusal("a=1..2:1", Sampling::grid).find("'1' is no count"), std::string::npos);
  EXPECT_NE(refusal("a=1..2:3x", Sampling::grid).find("'3x' is no count"), std::string::npos);
  EXPECT_NE(refusal("a=1m..2kg:3", Sampling::grid).find("one unit is needed"), std::string::npos);
  EXPECT_NE(refusal("a=2..2:3", Sampling::grid).find("the same value"), std::string::npos);
  EXPECT_NE(refusal("a=x..2:3", Sampling::grid), "accepted");
  EXPECT_NE(refusal("a=", Sampling::grid).find("no list of values"), std::string::npos);
  const std::vector<Variation> many = {parse_variation("a=0..1:1000", Sampling::grid),
                                       parse_variation("b=0..1:101", Sampling::grid)};
  EXPECT_NE(
      refusal_of([&] { static_cast<void>(sweep_rows(many, Sampling::grid, 0, 1)); }).find("more than 100000 rows"),
      std::string::npos);
}

// ---- measures

class MeasureTest : public ::testing::Test {
 protected:
  MeasureTest() {
    scene_.session.duration = 2;
    scene_.parameter_texts = {{"ref", "250 mm"}, {"word", "two"}};
  }
  [[nodiscard]] Measure measure(const std::string& text) const { return parse_measure(text, scene_, variables_); }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    return refusal_of([&] { static_cast<void>(measure(text)); });
  }
  // value of the measure over a signal x(t) sampled n times in 2 s; the angle is constant
  template <typename Signal>
  std::optional<double> over(const std::string& text, Signal&& x, int n = 2000) {
    const Measure of = measure(text);
    MeasuredRun run(of);
    for (int i = 0; i <= n; ++i) {
      const double t = 2.0 * i / n;
      run.add(t, std::vector<double>{x(t), 0.5});
    }
    undefined_at_ = run.undefined_at();
    return run.value();
  }

  scene::Scene scene_;
  std::vector<ElementVariable> variables_ = {{"Bag.position.x", Dimension::length}, {"Hinge.angle", Dimension::angle}};
  std::optional<double> undefined_at_;
};

TEST_F(MeasureTest, HasTheKnownValuesOfASine) {
  constexpr double kPi = std::numbers::pi;
  const auto sine = [](double t) { return 3 * std::sin(kPi * t); };  // one period
  EXPECT_NEAR(*over("max(Bag.position.x)", sine), 3, 1e-12);
  EXPECT_NEAR(*over("min(Bag.position.x)", sine), -3, 1e-12);
  EXPECT_NEAR(*over("time_of_max(Bag.position.x)", sine), 0.5, 1e-12);
  EXPECT_NEAR(*over("time_of_min(Bag.position.x)", sine), 1.5, 1e-12);
  EXPECT_NEAR(*over("mean(Bag.position.x)", sine), 0, 1e-12);
  EXPECT_NEAR(*over("rms(Bag.position.x)", sine), 3 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(*over("final(Bag.position.x)", sine), 0, 1e-12);
  // sin > 1/2 in a third of a half period; the polygon of 2000 samples crosses within its square of the step
  EXPECT_NEAR(*over("duration_above(Bag.position.x, 1.5 m)", sine), 2.0 / 3, 1e-6);
}

TEST_F(MeasureTest, IsExactForALineWhateverItsSamples) {
  const auto line = [](double t) { return 1 - 2 * t; };
  EXPECT_DOUBLE_EQ(*over("at(Bag.position.x, 0.35 s)", line, 3), 0.3);
  EXPECT_DOUBLE_EQ(*over("duration_above(Bag.position.x, 0.5 m)", line, 3), 0.25);
  EXPECT_DOUBLE_EQ(*over("duration_above(-Bag.position.x, 0.5 m)", line, 3), 1.25);
  EXPECT_DOUBLE_EQ(*over("mean(Bag.position.x - ref)", line, 3), -1.25);
  EXPECT_DOUBLE_EQ(*over("at(Bag.position.x, 0 s)", line, 3), 1);
  EXPECT_DOUBLE_EQ(*over("at(Bag.position.x, 2 s)", line, 3), -3);
  EXPECT_DOUBLE_EQ(*over("final(max(Bag.position.x, ref) / (1 m))", line, 3), 0.25);
}

TEST_F(MeasureTest, HasNoValueYetBeforeTheTimeOfAt) {
  const Measure at_end = measure("at(Bag.position.x, 2 s)");
  MeasuredRun run(at_end);
  run.add(1.5, std::vector<double>{1, 0});
  run.add(1.9, std::vector<double>{3, 0});
  EXPECT_TRUE(run.needs_more());
  EXPECT_EQ(run.value(), std::nullopt);
  run.add(2.3, std::vector<double>{7, 0});
  EXPECT_FALSE(run.needs_more());
  EXPECT_DOUBLE_EQ(*run.value(), 4);
}

// A block at constant acceleration: at() has the closed form's value at 0.1 s with steps that do not divide it.
TEST(SweepRow, OfAnyStepHasTheStepsOfARunAndTheValueAtItsTime) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "row_of_any_step.yaml";
  std::ofstream(file) << R"(
bodies:
  Block: {mass: 10 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Rail: {type: prismatic, orientation1: [0, 90 deg, 0], body2: Block, orientation2: [0, 90 deg, 0]}
mechanics: {gravity: [2, 0, 0]}
session: {duration: 0.1 s}
)";
  const SweepJob job{.scene = {.file = file.string()},
                     .measures = {"at(Rail.velocity, 0.1 s)", "final(Rail.velocity)"}};
  const std::pair<const char*, int> steps[] = {{"1 ms", 100}, {"3 ms", 33}, {"6 ms", 17}, {"7 ms", 14}};
  for (const auto& [step, count] : steps) {
    const RowOutcome row = run_row(job, {std::string("session.step=") + step});
    ASSERT_EQ(row.code, ExitCode::ok) << row.message;
    EXPECT_EQ(row.steps, count) << step;
    ASSERT_EQ(row.values.size(), 2u);
    EXPECT_NEAR(*row.values[0], 0.2, 1e-12) << step;
    EXPECT_NEAR(*row.values[1], 2e-3 * std::stod(step) * count, 1e-12) << step;
  }
}

TEST_F(MeasureTest, HasTheUnitOfItsExpression) {
  EXPECT_EQ(measure("max(Bag.position.x)").unit, "m");
  EXPECT_EQ(measure("max(Bag.position.x / (1 s))").unit, "m/s");
  EXPECT_EQ(measure("max(cos(Hinge.angle))").unit, "");
  EXPECT_EQ(measure("time_of_max(Hinge.angle)").unit, "s");
  EXPECT_EQ(measure("duration_above(Hinge.angle, 3 deg)").unit, "s");
}

TEST_F(MeasureTest, HasNoValueWhereASampleHasNone) {
  EXPECT_EQ(over("mean(sqrt(Bag.position.x / ref))", [](double t) { return 1.1 - t; }), std::nullopt);
  ASSERT_TRUE(undefined_at_);
  EXPECT_NEAR(*undefined_at_, 1.101, 1e-9);
}

TEST_F(MeasureTest, RefusesWithThePlaceBeforeAnyRun) {
  EXPECT_EQ(refusal("max(Bag.position.z)"),
            "--measure 'max(Bag.position.z)': column 5: there is no variable, parameter or value 'Bag.position.z'; "
            "expected a name of 'slewring variables SCENE'; did you mean 'Bag.position.x'?; nothing was run");
  EXPECT_NE(refusal("max(Bag.position.x + Hinge.angle)").find("column 20: '+' between a length and an angle"),
            std::string::npos);
  EXPECT_NE(refusal("max(Bag.position.x - 2 furlongz)").find("unknown unit"), std::string::npos);
  EXPECT_NE(refusal("maxx(Hinge.angle)").find("did you mean 'max'?"), std::string::npos);
  EXPECT_NE(refusal("Hinge.angle").find("is no measure"), std::string::npos);
  EXPECT_NE(refusal("max(Hinge.angle) + 1").find("is no measure"), std::string::npos);
  EXPECT_NE(refusal("max(Hinge.angle) + (1)").find("this bracket ends the measure"), std::string::npos);
  EXPECT_NE(refusal("max(Hinge.angle, 1)").find("has 2 arguments"), std::string::npos);
  EXPECT_NE(refusal("at(Hinge.angle)").find("has 1 arguments"), std::string::npos);
  EXPECT_NE(refusal("at(Hinge.angle, 2.5 s)").find("outside of the run"), std::string::npos);
  EXPECT_NE(refusal("at(Hinge.angle, 1 m)").find("a time is a length"), std::string::npos);
  EXPECT_NE(refusal("duration_above(Hinge.angle, Hinge.angle)").find("there is no variable"), std::string::npos);
  EXPECT_NE(refusal("max(word)"), "accepted");
}

TEST_F(MeasureTest, RefusesAValueThatTheScriptChanges) {
  EXPECT_EQ(refusal("max(mechanics.gravity.y * (1 s))"), "accepted");
  scene_.script.changes.push_back({.at = 0.5, .set = "mechanics.gravity.y", .value = -1});
  EXPECT_NE(refusal("max(mechanics.gravity.y * (1 s))")
                .find("the script changes 'mechanics.gravity.y' from 0.5 s on, and a measure has one value of it"),
            std::string::npos);
}

// ---- statistics

// the numbers 1 to 10; the t quantile with 9 degrees of freedom is 2.262 in every table
TEST(Statistics, HaveTheIntervalOfStudentsTable) {
  const std::vector<double> samples = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  const SampleStatistics statistics = statistics_of(samples);
  EXPECT_EQ(statistics.mean, 5.5);
  EXPECT_NEAR(statistics.deviation, std::sqrt(55.0 / 6), 1e-12);
  ASSERT_TRUE(statistics.interval);
  EXPECT_NEAR((statistics.interval->high - 5.5) / (statistics.deviation / std::sqrt(10.0)), 2.262, 5e-4);
  EXPECT_NEAR(statistics.interval->low + statistics.interval->high, 11, 1e-12);
  EXPECT_FALSE(statistics_of(std::vector<double>{4}).interval);
  EXPECT_EQ(statistics_of(std::vector<double>{}).count, 0u);
}

// Anscombe 1973, The American Statistician 27, p. 17, first set: r = 0.81642
TEST(Statistics, HaveTheCorrelationOfAnscombesFirstSet) {
  const std::vector<double> x = {10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5};
  const std::vector<double> y = {8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68};
  const auto correlation = correlation_of(x, y);
  ASSERT_TRUE(correlation && correlation->interval);
  EXPECT_NEAR(correlation->value, 0.81642, 5e-6);
  // 0.4244 .. 0.9507 for n = 11, as R's cor.test() prints it
  EXPECT_NEAR(correlation->interval->low, 0.4244, 1e-4);
  EXPECT_NEAR(correlation->interval->high, 0.9507, 1e-4);
}

TEST(Statistics, HaveNoCorrelationWithAConstant) {
  EXPECT_FALSE(correlation_of(std::vector<double>{1, 2, 3}, std::vector<double>{0.1, 0.1, 0.1}));
  EXPECT_FALSE(correlation_of(std::vector<double>{1}, std::vector<double>{2}));
  const auto line = correlation_of(std::vector<double>{1, 2, 3}, std::vector<double>{-1, -3, -5});
  ASSERT_TRUE(line);
  EXPECT_DOUBLE_EQ(line->value, -1);
  EXPECT_FALSE(line->interval);
}

// ---- outcomes

TEST(RowOutcome, SurvivesItsFile) {
  RowOutcome outcome{.code = ExitCode::diverged,
                     .message = "Boom is not finite at 0.3 s",
                     .values = {0.1, std::nullopt},
                     .steps = 300,
                     .not_converged = 2,
                     .state_hash = "0123456789abcdef",
                     .fingerprint = own_fingerprint()};
  EXPECT_EQ(row_outcome_from(*Json::parse(to_json(outcome).dump())), outcome);
}

}  // namespace parameter_sweep_test
}  // namespace slew::analysis
