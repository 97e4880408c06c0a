// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <string>

#include "analysis/extremes/case_run.h"
#include "analysis/extremes/cases.h"
#include "analysis/extremes/extremes.h"
#include "analysis/extremes/judge.h"
#include "build_paths.h"
#include "tests/support/temporary_folder.h"

namespace slew::analysis {
namespace extremes_test {

Measures good_run() {
  Measures measures;
  measures.H = 1e-3;
  measures.highest_pressure = 200e5;
  measures.lowest_pressure = 2e3;
  measures.ceiling = 400e5;
  measures.made = 1e-4;
  measures.gap = 1e-12;
  return measures;
}

scene::Scene scene_of(const char* file) {
  return scene::load_file(std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file);
}

const ExtremeCase& named(const std::vector<ExtremeCase>& cases, std::string_view name) {
  for (const ExtremeCase& one : cases) {
    if (one.name == name) return one;
  }
  throw std::runtime_error("no case " + std::string(name));
}

TEST(Judge, RunInsideAllBoundsIsWithinAndNamesTheNearest) {
  const Judgement result = judge(good_run(), {});
  EXPECT_EQ(result.verdict, Verdict::within);
  ASSERT_EQ(result.checks.size(), 4u);
  EXPECT_EQ(result.checks.front().what, "highest pressure");
  EXPECT_DOUBLE_EQ(result.checks.front().share(), 0.5);
}

TEST(Judge, EachBoundThatIsBrokenIsTheOneNamed) {
  const auto broken = [](auto change, const Bounds& bounds = {}) {
    Measures measures = good_run();
    change(measures);
    const Judgement result = judge(measures, bounds);
    EXPECT_EQ(result.verdict, Verdict::exceeded);
    return result.checks.front().what;
  };
  EXPECT_EQ(broken([](Measures& m) { m.highest_pressure = 401e5; }), "highest pressure");
  EXPECT_EQ(broken([](Measures& m) { m.lowest_pressure = -1.0; }), "tension of the oil");
  EXPECT_EQ(broken([](Measures& m) { m.made = 1.1e-2; }), "energy made");
  EXPECT_EQ(broken([](Measures& m) { m.gap = 1.1e-5; }), "joints open");
  Bounds compared;
  compared.difference = 0.02;
  EXPECT_EQ(broken([](Measures& m) { m.difference = 0.021; }, compared), "force error");
  Bounds same;
  same.requires_same = true;
  EXPECT_EQ(broken([](Measures& m) { m.is_same = false; }, same), "bits that differ");
}

TEST(Judge, ValueThatIsNoNumberIsBeyondItsBound) {
  Measures measures = good_run();
  measures.gap = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(judge(measures, {}).verdict, Verdict::exceeded);
}

TEST(Judge, RefusalIsGoodAndDivergenceIsNot) {
  Measures refused = good_run();
  refused.refusal = "session.step: 1 s";
  EXPECT_EQ(judge(refused, {}).verdict, Verdict::refused);
  Measures diverged = good_run();
  diverged.failure = "Bag.position";
  EXPECT_EQ(judge(diverged, {}).verdict, Verdict::diverged);
  EXPECT_NE(advice(diverged, judge(diverged, {}), {true, 2e-3}).find("2 ms"), std::string::npos);
  EXPECT_NE(advice(diverged, judge(diverged, {}), {true, std::nullopt}).find("no step"), std::string::npos);
}

TEST(Judge, SessionThatItsAlarmEndedIsRefusedWhileItKeptItsBounds) {
  Measures ended = good_run();
  ended.alarm = "Cyl_Jib: the coupling has made energy";
  ended.ended_at = 0.9;
  const Judgement refused = judge(ended, {});
  EXPECT_EQ(refused.verdict, Verdict::refused);
  EXPECT_NE(advice(ended, refused, {true, 5e-3}).find("5 ms"), std::string::npos);
  ended.made = 0.15;  // before the alarm
  EXPECT_EQ(judge(ended, {}).verdict, Verdict::refused);
  ended.made = 0.5;
  EXPECT_EQ(judge(ended, {}).verdict, Verdict::exceeded);
  ended.failure = "Bag.position";
  EXPECT_EQ(judge(ended, {}).verdict, Verdict::diverged);
}

TEST(Judge, MachineThatDampsTooLittleForLateSamplesIsRefusedByName) {
  Measures measures = good_run();
  measures.unsuitable = "it swings up";
  measures.difference = 0.9;
  measures.made = 0.3;
  Bounds bounds;
  bounds.difference = 0.02;
  EXPECT_EQ(judge(measures, bounds).verdict, Verdict::refused);
  EXPECT_NE(advice(measures, judge(measures, bounds), {}).find("lockstep"), std::string::npos);
  // nothing else is excused
  measures.gap = 1e-3;
  EXPECT_EQ(judge(measures, bounds).verdict, Verdict::exceeded);
}

// two decays of one swing, e^-t/2 and e^-t: apart by 1/4 at t = 2 ln 2, of half the range
TEST(Judge, LostDampingLeavesTheDifferenceOfTwoDecays) {
  EXPECT_NEAR(error_of_lost_damping(0.5, 1, 10), 0.125, 1e-12);
  EXPECT_NEAR(error_of_lost_damping(0.5, 1, 1), 0.5 * (std::exp(-0.5) - std::exp(-1)), 1e-12);
  EXPECT_NEAR(error_of_lost_damping(1e-6, 1, 10), 0.5e-6 / std::exp(1), 1e-11);
  EXPECT_EQ(error_of_lost_damping(0, 1, 10), 0);
}

TEST(Judge, WarningBeforeTheRunExcusesNothing) {
  Measures measures = good_run();
  measures.warnings = {"Cyl_Jib: omega_H is 2"};
  measures.too_late = measures.creates_energy = 5;
  measures.made = 0.5;
  EXPECT_EQ(judge(measures, {}).verdict, Verdict::exceeded);
}

// coupling study, section 6: the boom with friction, omega 61.6 rad/s, steps of 1 ms, of a range of 45 kN
TEST(Judge, BoundsOfLateSamplesAreThoseOfTheStudy) {
  const double omega_H = 0.0616, range = 45;
  for (const auto& [late, error] : {std::pair(2, 0.88), std::pair(5, 4.1), std::pair(10, 14.0)}) {
    EXPECT_NEAR(error_of_late_samples(omega_H * late), error / range, 0.1 * error / range) << late;
  }
  EXPECT_EQ(error_of_lost_samples(omega_H * 10), 0.02);
  EXPECT_NEAR(error_of_lost_samples(omega_H * 20), 8.0 / range, 0.1 * 8.0 / range);
  EXPECT_EQ(error_of_lost_samples(omega_H * 50), 1);
  EXPECT_EQ(error_of_late_samples(0), 0.02);
}

TEST(ExtremeCases, InputsHoldTheirLastPoint) {
  const std::vector<InputPoint> points = {{0.2, 1}, {1.0, -1}};
  EXPECT_EQ(raw_at(points, 0.1), 0);
  EXPECT_EQ(raw_at(points, 0.2), 1);
  EXPECT_EQ(raw_at(points, 5.0), -1);
}

TEST(ExtremeCases, SceneWithoutACircuitHasCasesWithTheReasonWhyTheyDoNotApply) {
  const scene::Scene scene = scene_of("first_steps.yaml");
  const std::vector<ExtremeCase> cases = extreme_cases(scene);
  EXPECT_TRUE(named(cases, "zero_gravity").obstacle.empty());
  EXPECT_TRUE(named(cases, "load_1500_kg").obstacle.empty());
  EXPECT_FALSE(named(cases, "start_at_1_bar").obstacle.empty());
  EXPECT_FALSE(named(cases, "relief_chatter").obstacle.empty());
  EXPECT_FALSE(named(cases, "stiffness_1").obstacle.empty());
  EXPECT_FALSE(named(cases, "start_in_penetration").obstacle.empty());
}

TEST(ExtremeCases, CraneHasThemAllWithItsOwnNames) {
  const scene::Scene scene = scene_of("truck_crane.yaml");
  const std::vector<ExtremeCase> cases = extreme_cases(scene);
  std::set<std::string> names;
  for (const ExtremeCase& one : cases) {
    EXPECT_TRUE(one.obstacle.empty()) << one.name << ": " << one.obstacle;
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
  }
  EXPECT_EQ(named(cases, "load_1500_kg").changes.front().path, "Bag.mass");
  // a mass is more than 0
  EXPECT_GT(named(cases, "load_0_kg").changes.front().value, 0);
  EXPECT_EQ(named(cases, "valve_closes_in_1_ms").overrides.size(), 3u);
  EXPECT_EQ(hoses_of(scene, 1e-6).size(), 7u);
  for (const ExtremeCase& one : cases) {
    // the times of late cases are whole steps
    EXPECT_EQ(one.begin_ns % scene.session.step_duration().ns, 0) << one.name;
  }
}

TEST(ExtremeCases, LateTimesAreNotForMotionsAndForcesOverTime) {
  EXPECT_EQ(named(extreme_cases(scene_of("joints/gears.yaml")), "step_2^32").obstacle,
            "its motions are laws of the session's time");
  EXPECT_EQ(named(extreme_cases(scene_of("forces/rope.yaml")), "time_2^62_ns").obstacle, "");
}

// 1 g on 316 kN/m swings 18 times in what rk4 follows once
TEST(ExtremeCases, LightLoadOnARopeIsRefusedByName) {
  scene::SceneOptions options;
  options.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/forces/rope.yaml";
  const CaseOutcome outcome = run_case(options, "load_0_kg");
  EXPECT_EQ(outcome.judgement.verdict, Verdict::refused) << outcome.measures.failure;
  EXPECT_NE(outcome.measures.refusal.find("Hoist: it is too fast for rk4"), std::string::npos)
      << outcome.measures.refusal;
}

TEST(ExtremeCases, CaseThatChangesNothingIsLeftOutByName) {
  scene::SceneOptions options;
  options.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/two_dof_crane.yaml";
  const auto obstacle = [&](const char* name) {
    const scene::Scene scene = scene::load_scene(options);
    const std::vector<ExtremeCase> cases = extreme_cases(scene);
    const ExtremeCase& one = named(cases, name);
    return one.obstacle.empty() ? lack_of_effect(one, options, scene) : one.obstacle;
  };
  EXPECT_EQ(obstacle("zero_gravity"), "");
  EXPECT_EQ(obstacle("load_1500_kg"), "");
  EXPECT_EQ(obstacle("bulk_2e9_Pa"), "");  // of another oil law, which the case states
  EXPECT_EQ(obstacle("delay_1"), "");
  options.overrides = {"mechanics.gravity=[0, 0, 0]", "Load.mass=1500", "session.mode=free_running"};
  EXPECT_NE(obstacle("zero_gravity").find("changes nothing"), std::string::npos) << obstacle("zero_gravity");
  EXPECT_NE(obstacle("load_1500_kg").find("changes nothing"), std::string::npos) << obstacle("load_1500_kg");
  EXPECT_EQ(obstacle("delay_1"), "");
}

// A load that is put on swings to twice what holds it, whatever kind of cylinder holds it.
TEST(ExtremeCases, CylindersOfEveryKindBoundThePressuresByWhatTheyHold) {
  for (const char* file : {"single_cylinder.yaml", "two_dof_crane.yaml", "tipper.yaml"}) {
    const auto ceiling_with = [&](const char* gravity) {
      scene::SceneOptions options;
      options.file = std::string(SLEWRING_SOURCE_DIR) + "/scenes/" + file;
      options.overrides = {gravity, "hydraulics.start=table13"};
      const CaseOutcome outcome = run_case(options, "full_range_every_step");
      EXPECT_TRUE(outcome.measures.ceiling) << outcome.measures.refusal;
      return outcome.measures.ceiling.value_or(0);
    };
    EXPECT_GT(ceiling_with("mechanics.gravity=[0, -20, 0]"), 1.05 * ceiling_with("mechanics.gravity=[0, -5, 0]"))
        << file;
  }
}

// Whatever a valve's keys are called: where it is open, its pressure is among the bounds.
TEST(ExtremeCases, ReliefsOfEveryKindBoundThePressures) {
  std::ifstream file(SLEWRING_SOURCE_DIR "/scenes/single_cylinder.yaml");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t begin = text.find("    type: relief_valve"), end = text.find("  MainPump:", begin);
  ASSERT_LT(begin, end);
  text.replace(begin, end - begin,
               "    type: direct_relief_valve\n    port_1: Vol_MainPump\n    port_2: Vol_Tank\n"
               "    seat_diameter: 12 mm\n    crack_pressure: 900 bar\n    spring_constant: 1e4\n");
  const testing::TemporaryFolder folder("extremes");
  const std::filesystem::path scene = folder.path() / "scene.yaml";
  std::ofstream(scene) << text;
  scene::SceneOptions options;
  options.file = scene.string();
  options.overrides = {"hydraulics.start=table13"};
  const CaseOutcome outcome = run_case(options, "full_range_every_step");
  ASSERT_TRUE(outcome.measures.ceiling) << outcome.measures.refusal;
  EXPECT_GT(*outcome.measures.ceiling, 900e5);
}

// the tipper swings at 8 Hz and decays with 1.7 1/s by its monolith (docs/extremes.md); as the note has it
TEST(ExtremeCases, OfLateSamplesIncludeTheTippersOwnDamping) {
  scene::SceneOptions options;
  options.file = SLEWRING_SOURCE_DIR "/scenes/tipper.yaml";
  const CaseOutcome late = run_case(options, "delay_1");
  EXPECT_EQ(late.judgement.verdict, Verdict::within);
  double hertz = 0, decay = 0;
  for (const std::string& note : late.measures.notes) {
    (void)std::sscanf(note.c_str(), "swing of %lf Hz with an own decay of %lf", &hertz, &decay);
  }
  EXPECT_NEAR(hertz, 8, 0.8);
  EXPECT_NEAR(decay, 1.7, 0.3);
  // by the same runs two late steps take 1.9 1/s: it swings up
  const CaseOutcome later = run_case(options, "delay_2");
  EXPECT_EQ(later.judgement.verdict, Verdict::refused);
  EXPECT_NE(later.measures.unsuitable.find("it may swing up"), std::string::npos);
}

TEST(Extremes, UnfinishedAndDivergedRowsAreNotGood) {
  Extremes extremes;
  extremes.rows.push_back({.scene = "a",
                           .name = "one",
                           .what = {},
                           .obstacle = "no circuit",
                           .is_done = true,
                           .failure = {},
                           .result = {}});
  EXPECT_TRUE(extremes.is_good());
  Measures diverged = good_run();
  diverged.failure = "Bag.position";
  extremes.rows.push_back({.scene = "a",
                           .name = "two",
                           .what = {},
                           .obstacle = {},
                           .is_done = true,
                           .failure = {},
                           .result = to_json(diverged, judge(diverged, {}))});
  EXPECT_FALSE(extremes.is_good());
  extremes.rows.back().result = to_json(good_run(), judge(good_run(), {}));
  EXPECT_TRUE(extremes.is_good());
  Measures ended = good_run();
  ended.alarm = "Cyl_Jib: the coupling has made energy";
  extremes.rows.back().result = to_json(ended, judge(ended, {}));
  EXPECT_TRUE(extremes.is_good());
  extremes.rows.push_back({.scene = "a", .name = "three", .what = {}, .obstacle = {}, .failure = {}, .result = {}});
  EXPECT_FALSE(extremes.is_good());
  EXPECT_FALSE(extremes.is_complete());
}

}  // namespace extremes_test
}  // namespace slew::analysis
