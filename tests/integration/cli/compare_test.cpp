// SPDX-License-Identifier: Apache-2.0
// `slewring compare`: the program around the comparison.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.h"
#include "sample_hashes.h"

namespace slew::testing {
namespace compare_test {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class CompareVerb : public ::testing::Test {
 protected:
  CommandResult compare(const std::string& scene, std::vector<std::string> more) {
    more.insert(more.begin(), {"compare", scene_file(scene)});
    return run("slewring", more, work_.path());
  }
  [[nodiscard]] std::string text_of(const char* file) const {
    std::ifstream stream(work_.path() / file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  WorkFolder work_;
};

TEST_F(CompareVerb, PrintsTheTableAndWritesPictureAndValues) {
  const CommandResult result =
      compare("first_steps.yaml", {"--until", "0.5s", "--steps", "0.5ms,1ms", "--repeats", "1", "--formulations",
                                   "recursive,lagrange", "--csv", "table.csv"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(contains(result.out, "formulation")) << result.out;
  EXPECT_TRUE(contains(result.out, "\nlagrange ")) << result.out;
  EXPECT_TRUE(result.out.ends_with("\ntable.csv\nfirst_steps_compare.svg\n")) << result.out;
  EXPECT_TRUE(contains(result.err, "lagrange")) << "progress goes to standard error";
  EXPECT_TRUE(contains(text_of("first_steps_compare.svg"), "<svg "));
  const std::string csv = text_of("table.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5) << csv;
}

// nodes of flexible bodies are joints of the mechanism, not of the scene
TEST_F(CompareVerb, NightlyAFlexibleBodyRunsInEveryFormulation) {
  for (const std::string scene : {"truck_crane_flexible", "truck_crane_segmented"}) {
    const CommandResult result = compare(scene + ".yaml", {"--until", "0.01s", "--repeats", "1", "--json"});
    ASSERT_EQ(result.code, 0) << result.err;
    const nlohmann::json json = nlohmann::json::parse(result.out);
    EXPECT_TRUE(json.at("is_complete").get<bool>());
    EXPECT_FALSE(json.at("rows").empty());
    for (const nlohmann::json& row : json.at("rows")) EXPECT_TRUE(row.at("has_run").get<bool>()) << scene << row;
  }
}

TEST_F(CompareVerb, ALoopClosesInEveryFormulationThatRuns) {
  const CommandResult result = compare(
      "slider_crank.yaml", {"--until", "0.5s", "--steps", "1ms", "--repeats", "1", "--json", "-o", "crank.html"});
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_TRUE(json.at("is_complete").get<bool>());
  EXPECT_EQ(json.at("energy_rule"), "from_start");
  std::size_t ran = 0;
  for (const nlohmann::json& row : json.at("rows")) {
    if (!row.at("has_run").get<bool>()) {
      EXPECT_TRUE(contains(row.at("verdict"), "cannot run: ")) << row;
      continue;
    }
    EXPECT_TRUE(row.at("is_repeatable").get<bool>());
    if (row.at("formulation") != "recursive" && row.at("formulation") != "lagrange") continue;
    ++ran;
    EXPECT_LE(row.at("joint_gap").at("position").get<double>(), 1e-8);
    EXPECT_LE(row.at("differences").at(0).at("largest").get<double>(), 1e-5);
  }
  EXPECT_EQ(ran, 2U);
  EXPECT_TRUE(contains(text_of("crank.html"), "<!DOCTYPE html>"));
}

// the compared runs equal those of a session
TEST_F(CompareVerb, ARowEndsInTheStateOfARunBitForBit) {
  const CommandResult compared = compare(
      "tipper.yaml", {"--until", "2s", "--steps", "1ms", "--repeats", "1", "--formulations", "recursive", "--json"});
  ASSERT_EQ(compared.code, 0) << compared.err;
  const CommandResult ran = run(
      "slewring", {"run", scene_file("tipper.yaml"), "--in-process", "--pace", "free", "--duration", "2s", "--json"},
      work_.path());
  ASSERT_EQ(ran.code, 0) << ran.err;
  const SampleHashes hashes = sample_hashes(work_.recording());
  const nlohmann::json hash = nlohmann::json::parse(compared.out).at("rows").at(0).at("state_hash");
  for (const wire::Role role : {wire::Role::mechanics, wire::Role::hydraulics}) {
    const char* name = role == wire::Role::mechanics ? "mechanics" : "hydraulics";
    EXPECT_EQ(hash.at(name), fmt::format("{:016x}", hashes.at({0, 2000, role}))) << name;
  }
}

TEST_F(CompareVerb, CtrlCPrintsTheRowsThatAreDone) {
  // the second row takes long: 20 million sub-steps a run
  Command command("slewring",
                  {"compare", scene_file("first_steps.yaml"), "--until", "20s", "--steps", "1ms,0.001ms",
                   "--formulations", "recursive", "--repeats", "1", "--reference", "0.5ms"},
                  work_.path());
  ASSERT_TRUE(wait_until([&] { return contains(command.err(), "0.001 ms"); })) << command.err();
  command.send(SIGINT);
  const CommandResult result = command.wait();
  EXPECT_EQ(result.code, 130);
  EXPECT_TRUE(contains(result.out, "\nrecursive ")) << result.out;
  EXPECT_TRUE(contains(result.out, "interrupted: 1 of 2 rows")) << result.out;
  EXPECT_TRUE(contains(text_of("first_steps_compare.svg"), "<svg "));
}

TEST_F(CompareVerb, WhatCannotBeIsRefusedWithCode2) {
  const auto refused = [this](const std::vector<std::string>& more, const char* sentence) {
    const CommandResult result = compare("first_steps.yaml", more);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_TRUE(contains(result.err, sentence)) << result.err << "\nexpected: " << sentence;
    EXPECT_TRUE(result.out.empty()) << result.out;
  };
  refused({"--formulations", "newton"}, "--formulations: there is no 'newton' in this version; expected all, or some");
  refused({"--steps", "0.7ms"}, "--steps: 0.7 ms neither divides the communication step 1 ms nor is a multiple of it");
  refused({"-o", "table.png"}, "-o table.png: the picture is .svg or .html; nothing was run");
  refused({"--input", "keyboard"}, "--input keyboard: every run needs the same input; nothing was run");
  refused({"--variables", "Rodd.position.x"}, "Rodd.position.x");
  refused({"--set", "Rod.mass=-1kg"}, "Rod.mass");
  refused({"--set", "session.duration=0"}, "set --until to the time to compare");
  refused({"--repeats", "0"}, "--repeats");
}

}  // namespace compare_test
}  // namespace slew::testing
