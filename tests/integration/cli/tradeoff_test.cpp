// SPDX-License-Identifier: Apache-2.0
// Error against cost of a small scene: rows as processes, refusals, resumption, questions.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command.h"

namespace slew::testing {
namespace tradeoff_test {

class Tradeoff : public ::testing::Test {
 protected:
  Tradeoff() { std::filesystem::copy_file(scene_file("single_cylinder.yaml"), work_.path() / "boom.yaml"); }
  CommandResult tradeoff(std::vector<std::string> more) {
    more.insert(more.begin(), {"tradeoff", "boom.yaml", "--until", "0.5s", "--quiet", "--repeats", "1"});
    return run("slewring", more, work_.path());
  }
  static nlohmann::json parsed(const CommandResult& result) {
    return nlohmann::json::parse(result.out, nullptr, false);
  }
  static double worst_error(const nlohmann::json& report, const std::string& label) {
    for (const nlohmann::json& row : report.at("rows")) {
      if (row.at("label") == label) return row.at("worst_error");
    }
    ADD_FAILURE() << "no row " << label;
    return 0;
  }
  std::size_t results() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(work_.path() / "runs" / "tradeoff-single_cylinder")) {
      count += entry.path().extension() == ".json" ? 1 : 0;
    }
    return count;
  }

  WorkFolder work_;
};

TEST_F(Tradeoff, ShowsLevelTwoCloserThanHoldAndShortStepsCloserThanLongOnes) {
  const CommandResult result = tradeoff({"--axis", "session.step=1ms,2ms,4ms", "--axis", "session.coupling=two,hold",
                                         "--json", "--csv", "rows.csv", "-o", "page.html"});
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json report = parsed(result);
  EXPECT_TRUE(report.at("is_complete").get<bool>());
  // step 1 ms with level two is the scene as it is
  EXPECT_EQ(report.at("rows").size(), 6u);
  EXPECT_EQ(report.at("rows").at(0).at("label"), "as it is");
  const double now = worst_error(report, "as it is");
  EXPECT_LT(now, 5e-3);
  EXPECT_GT(now, 1e-7);
  EXPECT_GT(worst_error(report, "step 4ms, coupling two"), 4 * now);
  EXPECT_GT(worst_error(report, "step 1ms, coupling hold"), 10 * now);
  for (const nlohmann::json& variable : report.at("variables")) {
    const double range = variable.at("range");
    EXPECT_LE(variable.at("spread").get<double>(), 1e-4 * range) << variable;
  }
  EXPECT_TRUE(std::filesystem::exists(work_.path() / "page.html"));
  EXPECT_GT(std::filesystem::file_size(work_.path() / "rows.csv"), 500u);
}

TEST_F(Tradeoff, KeepsRefusedRowsWithTheReason) {
  const CommandResult result = tradeoff({"--axis", "mechanics.max_substep=1ms,3", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json rows = parsed(result).at("rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NE(rows.at(1).at("refusal").get<std::string>().find("out of range"), std::string::npos) << rows;
  EXPECT_FALSE(rows.at(1).at("is_stable").get<bool>());
}

TEST_F(Tradeoff, AnswersWithASceneThatChecks) {
  const std::vector<std::string> axis = {"--axis", "session.step=1ms,2ms,4ms,10ms"};
  const auto tradeoff_with = [&](const std::vector<std::string>& question) {
    std::vector<std::string> more = axis;
    more.insert(more.end(), question.begin(), question.end());
    return tradeoff(more);
  };
  const CommandResult loose = tradeoff_with({"--error", "Cyl_Lift.force 20%"});
  ASSERT_EQ(loose.code, 0) << loose.err;
  ASSERT_NE(loose.out.find("boom_tradeoff.yaml"), std::string::npos) << loose.out;
  const CommandResult checked = run("slewring", {"check", "boom_tradeoff.yaml"}, work_.path());
  EXPECT_EQ(checked.code, 0) << checked.err;
  std::ifstream file(work_.path() / "boom_tradeoff.yaml");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(text.find("boom.yaml"), std::string::npos) << text;
  EXPECT_NE(text.find("  step: "), std::string::npos) << text;
  const std::size_t before = results();
  const CommandResult impossible = tradeoff_with({"--error", "Cyl_Lift.force 0.001 N"});
  EXPECT_EQ(impossible.code, 1);
  EXPECT_NE(impossible.out.find("no stable row meets this"), std::string::npos) << impossible.out;
  EXPECT_EQ(results(), before);  // nothing was computed again
  EXPECT_EQ(tradeoff_with({"--error", "Cyl_Lft.force 1%"}).code, 2);
  EXPECT_EQ(tradeoff_with({"--budget", "20 s"}).code, 2);
}

TEST_F(Tradeoff, RefusesAPlaceForTheAnswerBeforeAnythingRuns) {
  const CommandResult result =
      tradeoff({"--axis", "session.step=1ms,2ms", "--budget", "1 us/ms", "--overlay", "/tmp/elsewhere.yaml"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("would not lie beside its scene"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs"));
}

TEST_F(Tradeoff, GoesOnAfterAnInterruption) {
  const std::vector<std::string> arguments = {
      "tradeoff",  "boom.yaml", "--until",   "2s",
      "--quiet",   "--json",    "--repeats", "3",
      "--workers", "1",         "--axis",    "session.step=0.5ms,0.6ms,0.7ms,0.8ms,0.9ms,1.1ms,1.2ms,1.3ms,1.4ms"};
  Command first("slewring", arguments, work_.path());
  const auto folder = work_.path() / "runs" / "tradeoff-single_cylinder";
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder) && results() >= 12; }));
  first.send(SIGINT);
  const CommandResult ended = first.wait();
  EXPECT_EQ(ended.code, 130) << ended.err;
  const nlohmann::json part = parsed(ended);
  EXPECT_FALSE(part.at("is_complete").get<bool>());
  const CommandResult second = run("slewring", arguments, work_.path());
  ASSERT_EQ(second.code, 0) << second.err;
  const nlohmann::json all = parsed(second);
  EXPECT_TRUE(all.at("is_complete").get<bool>());
  EXPECT_GE(all.at("kept").get<int>(), 1);
  // the kept results are unchanged
  for (std::size_t i = 0; i < part.at("rows").size(); ++i) {
    if (!part.at("rows").at(i).at("is_done").get<bool>()) continue;
    EXPECT_EQ(all.at("rows").at(i).at("us_per_ms"), part.at("rows").at(i).at("us_per_ms"));
  }
}

TEST_F(Tradeoff, TakesAFinelySplitReferenceWhereShapesTouch) {
  const CommandResult result = run("slewring",
                                   {"tradeoff", scene_file("contact/bouncing_ball.yaml"), "--until", "1s", "--quiet",
                                    "--json", "--repeats", "1", "--axis", "session.contact=off", "--folder", "ball"},
                                   work_.path());
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json report = parsed(result);
  EXPECT_NE(report.at("reference").get<std::string>().find("touch"), std::string::npos) << report.at("reference");
  // without contact the ball falls through
  EXPECT_GT(report.at("rows").at(1).value("worst_error", 10.0), report.at("rows").at(0).value("worst_error", 0.0));
}

}  // namespace tradeoff_test
}  // namespace slew::testing
