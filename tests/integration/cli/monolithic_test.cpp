// SPDX-License-Identifier: Apache-2.0
// Runs with all physics as one system: the same summary, recording, replay and parameters as other runs.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "command.h"

namespace slew::testing {
namespace monolithic_test {

class MonolithicRun : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) { return run("slewring", arguments, work_.path()); }

  // `how`: the kind of run, --monolithic by default
  CommandResult run_scene(const std::string& scene, std::vector<std::string> more, const char* how = "--monolithic") {
    more.insert(more.begin(), {"run", scene, how, "--pace", "free", "--json"});
    return slewring(more);
  }

  void expect_refused(const std::vector<std::string>& more, const std::string& what) {
    std::vector<std::string> arguments = {"--duration", "0.1", "--no-record"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run_scene(scene_file("single_cylinder.yaml"), arguments);
    EXPECT_EQ(result.code, 2) << what;
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err;
  }

  WorkFolder work_;
};

std::vector<std::string> variables_of(const nlohmann::json& report) {
  std::vector<std::string> names;
  for (const auto& [name, value] : report.at("variables").items()) names.push_back(name);
  return names;
}

TEST_F(MonolithicRun, OfTheCraneIsRecordedComparableAndVerifiedByReplay) {
  const CommandResult split =
      run_scene(scene_file("truck_crane.yaml"), {"--duration", "1.5", "--no-record"}, "--in-process");
  ASSERT_EQ(split.code, 0) << split.err;
  const CommandResult whole = run_scene(scene_file("truck_crane.yaml"), {"--duration", "1.5"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  const nlohmann::json other = nlohmann::json::parse(split.out), report = nlohmann::json::parse(whole.out);
  EXPECT_EQ(report.at("steps"), 1500);
  EXPECT_EQ(report.at("lost"), "none");
  EXPECT_EQ(variables_of(report), variables_of(other));
  for (const auto& [name, value] : report.at("variables").items()) {
    const nlohmann::json& there = other.at("variables").at(name);
    const double scale = std::max(std::fabs(value.at("max").get<double>()), std::fabs(value.at("min").get<double>()));
    EXPECT_NEAR(value.at("last").get<double>(), there.at("last").get<double>(), 1e-2 * scale) << name;
  }
  // nothing is coupled, so that nothing is lost between the parts
  for (const auto& [name, port] : report.at("ports").items()) EXPECT_LT(port.at("eta_max").get<double>(), 1e-9) << name;
  const CommandResult replayed = slewring({"replay", work_.recording().string(), "--verify", "--json"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  const nlohmann::json replay = nlohmann::json::parse(replayed.out);
  EXPECT_EQ(replay.at("compared"), 2 * 1501);
  EXPECT_EQ(replay.at("different"), 0);
}

TEST_F(MonolithicRun, FollowsParametersThatTheScriptChangesModesAndSegments) {
  std::ofstream(work_.path() / "input.yaml")
      << "inputs:\n  Input_Lift: [[0 s, 0], [0.05 s, 1], [0.2 s, 0]]\n"
         "parameters:\n  - {at: 0.1 s, set: Bag.mass, value: 700 kg, over: 0.05 s}\n";
  // a chain of segments is slow as one system: a look at its first oscillation is enough
  const std::pair<const char*, const char*> scenes[] = {{"truck_crane_flexible.yaml", "0.3"},
                                                        {"truck_crane_segmented.yaml", "0.04"}};
  for (const auto& [scene, duration] : scenes) {
    const std::vector<std::string> more = {"--duration", duration, "--input", "input.yaml"};
    const CommandResult whole = run_scene(scene_file(scene), more);
    ASSERT_EQ(whole.code, 0) << scene << whole.err;
    const nlohmann::json report = nlohmann::json::parse(whole.out);
    const CommandResult split = run_scene(scene_file(scene), more, "--in-process");
    ASSERT_EQ(split.code, 0) << scene << split.err;
    const nlohmann::json other = nlohmann::json::parse(split.out);
    const char* const deflection = "Truck_JibBoom.deflection.y";
    const double there = other.at("variables").at(deflection).at("last");
    EXPECT_GT(std::fabs(there), 1e-4) << scene;
    EXPECT_NEAR(report.at("variables").at(deflection).at("last"), there, 0.01 * std::fabs(there)) << scene;
    EXPECT_EQ(slewring({"replay", report.at("recording"), "--verify"}).code, 0) << scene;
  }
}

TEST_F(MonolithicRun, OfMechanicsAloneHoldsLoopsAndKeepsEnergy) {
  const CommandResult result = run_scene(scene_file("four_bar.yaml"), {"--duration", "2"});
  ASSERT_EQ(result.code, 0) << result.err;
  const CommandResult shown =
      slewring({"export", work_.recording().string(), "mechanics.*energy", "--csv", "-o", "energy.csv"});
  ASSERT_EQ(shown.code, 0) << shown.err;
  std::ifstream file(work_.path() / "energy.csv");
  std::string line;
  std::getline(file, line);
  double first = NAN, largest = 0;
  int lines = 0;
  while (std::getline(file, line)) {
    double t = 0, a = 0, b = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &t, &a, &b), 3) << line;
    if (lines++ == 0) first = a + b;
    largest = std::max(largest, std::fabs(a + b - first));
  }
  EXPECT_GT(lines, 1000);
  EXPECT_LT(largest, 1e-5);  // share of 36 J, of which 1.5 J move
}

TEST_F(MonolithicRun, EndsWithCodeFiveWhereShapesTouch) {
  const CommandResult result = run_scene(scene_file("truck_crane_contact.yaml"), {"--duration", "6"});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_NE(result.err.find("the shapes of "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("touch at "), std::string::npos) << result.err;
}

TEST_F(MonolithicRun, RefusesWhatItCannotBeByName) {
  expect_refused({"--remote", "hydraulics"}, "a monolithic run takes no --remote");
  expect_refused({"--domain", "3"}, "a monolithic run takes no --domain");
  expect_refused({"--interface", "lo"}, "a monolithic run takes no --interface");
  expect_refused({"--peer", "127.0.0.1"}, "a monolithic run takes no --peer");
  expect_refused({"--rt"}, "a monolithic run takes no --rt");
  expect_refused({"--rtol", "1e-11"}, "session.rtol");
  expect_refused({"--rtol", "0.01"}, "session.rtol");
  const CommandResult alone =
      run_scene(scene_file("single_cylinder.yaml"), {"--rtol", "1e-6", "--duration", "0.1", "--no-record"}, "--quiet");
  EXPECT_EQ(alone.code, 2);
  EXPECT_NE(alone.err.find("--monolithic"), std::string::npos) << alone.err;
}

TEST_F(MonolithicRun, TighterToleranceChangesLess) {
  // distance of the lift's force at the end from the tightest run
  const auto force = [&](const char* rtol) {
    const CommandResult result =
        run_scene(scene_file("single_cylinder.yaml"), {"--rtol", rtol, "--duration", "1", "--no-record"});
    EXPECT_EQ(result.code, 0) << result.err;
    return nlohmann::json::parse(result.out).at("variables").at("Cyl_Lift.force").at("last").get<double>();
  };
  const double tightest = force("1e-10");
  EXPECT_LT(std::fabs(force("1e-9") - tightest), 1);
  EXPECT_GT(std::fabs(force("1e-3") - tightest), 10 * std::fabs(force("1e-8") - tightest));
}

}  // namespace monolithic_test
}  // namespace slew::testing
