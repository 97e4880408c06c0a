// SPDX-License-Identifier: Apache-2.0
// Hard cases of a small scene: processes, verdicts, kept results, exit codes.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "command.h"

namespace slew::testing {
namespace extremes_test {

class Extremes : public ::testing::Test {
 protected:
  Extremes() { std::filesystem::copy_file(scene_file("single_cylinder.yaml"), work_.path() / "boom.yaml"); }
  CommandResult extremes(std::vector<std::string> more) {
    more.insert(more.begin(), {"extremes", "boom.yaml", "--quiet"});
    return run("slewring", more, work_.path());
  }
  static nlohmann::json parsed(const CommandResult& result) {
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  static const nlohmann::json& row(const nlohmann::json& report, const std::string& name) {
    for (const nlohmann::json& one : report.at("rows")) {
      if (one.at("name") == name) return one;
    }
    throw std::runtime_error("no row " + name);
  }

  WorkFolder work_;
};

TEST_F(Extremes, JudgesCasesAndKeepsThem) {
  const std::vector<std::string> arguments = {
      "--json", "--only", "lost_1", "--only", "time_2^62_ns", "--only", "start_in_penetration"};
  const CommandResult first = extremes(arguments);
  ASSERT_EQ(first.code, 0) << first.err << first.out;
  const nlohmann::json report = parsed(first);
  ASSERT_EQ(report.at("rows").size(), 3u);
  EXPECT_TRUE(report.at("is_complete").get<bool>());
  const nlohmann::json& lost = row(report, "lost_1").at("result");
  EXPECT_EQ(lost.at("verdict"), "within");
  EXPECT_GT(lost.at("difference").get<double>(), 0);
  EXPECT_LT(lost.at("difference").get<double>(), 0.02);
  EXPECT_GE(lost.at("largest_step").get<double>(), 1e-3);
  EXPECT_TRUE(row(report, "time_2^62_ns").at("result").at("is_same").get<bool>());
  EXPECT_NE(row(report, "start_in_penetration").at("obstacle"), "");
  const CommandResult second = extremes(arguments);
  EXPECT_EQ(parsed(second).at("kept"), 2);
}

TEST_F(Extremes, RefusalsNameWhatIsWrongAndAreGood) {
  const CommandResult result = run("slewring",
                                   {"extremes", scene_file("truck_crane.yaml"), "--quiet", "--json", "--only",
                                    "start_in_penetration", "--only", "load_0_kg"},
                                   work_.path());
  ASSERT_EQ(result.code, 0) << result.err << result.out;
  const nlohmann::json report = parsed(result);
  const nlohmann::json& start = row(report, "start_in_penetration").at("result");
  EXPECT_EQ(start.at("verdict"), "refused");
  const std::string why = start.at("refusal");
  for (const char* part : {"hydraulics.start: equilibrium requires", "Vol_LiftCyl", "Cyl_Lift", "L90Lift", "Ground_Bag",
                           "deep", "hydraulics.start: table13"}) {
    EXPECT_NE(why.find(part), std::string::npos) << part << " in " << why;
  }
  const nlohmann::json& load = row(report, "load_0_kg").at("result");
  EXPECT_EQ(load.at("verdict"), "refused");
  EXPECT_NE(load.at("refusal").get<std::string>().find("ForceR_Friction"), std::string::npos) << load.at("refusal");
}

TEST_F(Extremes, WhatTheCouplingCannotFollowIsRefusedAndTheStepThatSuitsIsFound) {
  const CommandResult result =
      extremes({"--json", "--only", "stiffness_1", "--only", "stiffness_100", "--only", "lost_50"});
  ASSERT_EQ(result.code, 0) << result.err << result.out;
  const nlohmann::json report = parsed(result);
  EXPECT_EQ(row(report, "stiffness_1").at("result").at("verdict"), "within");
  const nlohmann::json& stiff = row(report, "stiffness_100").at("result");
  EXPECT_EQ(stiff.at("verdict"), "refused");
  const std::string refusal = stiff.at("refusal");
  EXPECT_NE(refusal.find("above the Nyquist limit of the exchange"), std::string::npos) << refusal;
  EXPECT_LT(stiff.at("largest_step").get<double>(), stiff.at("step").get<double>());
  const nlohmann::json& lost = row(report, "lost_50").at("result");
  // wrong by half of the force range, inside the case's bound, and not growing: the alarm is silent
  EXPECT_EQ(lost.at("verdict"), "within");
  EXPECT_EQ(lost.at("alarm"), "");
}

TEST_F(Extremes, RunsNothingOfASceneThatIsWrong) {
  const CommandResult result = extremes({"--json", "--only", "step_10_us", "--set", "mechanics.max_substep=3"});
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_NE(result.err.find("mechanics.max_substep"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs"));
}

TEST_F(Extremes, WrongOptionsAreRefused) {
  EXPECT_EQ(extremes({"--only", "no_such_case"}).code, 2);
  EXPECT_EQ(extremes({"--suite"}).code, 2);
  const CommandResult nowhere = run("slewring", {"extremes", "--suite", "--scenes", "nowhere"}, work_.path());
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_NE(nowhere.err.find("--scenes"), std::string::npos) << nowhere.err;
}

}  // namespace extremes_test
}  // namespace slew::testing
