// SPDX-License-Identifier: Apache-2.0
// Parameter sweeps: a block on a rail with known motion, rows as processes, resumption, refusals, failed rows.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "command.h"

namespace slew::testing {
namespace sweep_test {

using Json = nlohmann::json;

// x(t) = a t^2 / 2 for 1 s
constexpr const char* kRail = R"(
parameters: {a: 2 m/s2, ref: 0 m}
bodies:
  Block: {mass: 10 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Rail: {type: prismatic, orientation1: [0, 90 deg, 0], body2: Block, orientation2: [0, 90 deg, 0]}
mechanics: {gravity: ["${a}", 0, 0]}
session: {duration: 1 s}
)";

class Sweep : public ::testing::Test {
 protected:
  Sweep() {
    std::ofstream(work_.path() / "rail.yaml") << kRail;
    std::filesystem::copy_file(scene_file("single_cylinder.yaml"), work_.path() / "boom.yaml");
  }
  CommandResult sweep(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "sweep");
    arguments.emplace_back("--quiet");
    return run("slewring", arguments, work_.path());
  }
  [[nodiscard]] std::string text_of(const std::string& file) const {
    std::ifstream in(work_.path() / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] Json rows(const std::string& folder) const { return Json::parse(text_of(folder + "/rows.json")); }
  // name and bytes of each row's file
  [[nodiscard]] std::map<std::string, std::string> row_files(const std::string& folder) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(work_.path() / folder / "rows")) {
      const std::string name = entry.path().filename().string();
      if (name != "job.json") files[name] = text_of(folder + "/rows/" + name);
    }
    return files;
  }

  WorkFolder work_;
};

TEST_F(Sweep, MeasuresTheKnownMotionOfABlock) {
  const CommandResult result =
      sweep({"rail.yaml", "--vary", "a=1m/s2..4m/s2:4", "--vary", "ref=0m,0.25m", "--measure",
             "final(Block.position.x)", "--measure", "at(Block.velocity.x, 0.5 s)", "--measure",
             "duration_above(Block.velocity.x, 0.5 m/s)", "--measure", "min(Block.position.x - ref)", "--measure",
             "time_of_max(Block.mass * Block.velocity.x)", "-o", "out"});
  ASSERT_EQ(result.code, 0) << result.err;
  const Json report = rows("out");
  ASSERT_EQ(report.at("rows").size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) {
    const Json& row = report["rows"][i];
    const double a = 1.0 + static_cast<double>(i / 2), ref = i % 2 == 0 ? 0 : 0.25;
    EXPECT_EQ(row["varied"][0], a);
    EXPECT_EQ(row["varied"][1], ref);
    const double expected[] = {a / 2, a / 2, 1 - 0.5 / a, -ref, 1};
    for (std::size_t m = 0; m < 5; ++m) EXPECT_NEAR(row["values"][m].get<double>(), expected[m], 1e-9) << i << ' ' << m;
  }
  EXPECT_EQ(report["measures"][0]["unit"], "m");
  // final(x) = a / 2 is a line of a
  EXPECT_NEAR(report["measures"][0]["correlations"]["a"]["value"].get<double>(), 1, 1e-12);
  EXPECT_EQ(report["measures"][0].count("mean"), 0u);
  const std::string csv = text_of("out/rows.csv");
  EXPECT_NE(csv.find("a [m/s2],ref [m],final(Block.position.x) [m]"), std::string::npos) << csv.substr(0, 300);
  const std::string page = text_of("out/index.html");
  EXPECT_NE(page.find("<svg id=\"parallel\""), std::string::npos);
  EXPECT_EQ(page.find("http://"), page.find("http://www.w3.org/2000/svg"));  // no other address
}

// every variable that `variables SCENE` lists, but for those of a controller's loop
TEST_F(Sweep, MeasuresTheInputsAsTheyAreRecorded) {
  std::ofstream(work_.path() / "source.yaml") << R"(
volumes: {V: {rigid_volume: 1 l}, T: {fixed: true}}
components: {F: {type: flow_source, port_1: T, port_2: V, flow_per_signal: 1 l/min}}
inputs: {I: {type: analog, primitive: F, scale: 2}}
script: {inputs: {I: [[0 s, 0], [0.1 s, 1]]}}
session: {duration: 0.1 s}
)";
  const CommandResult variables = run("slewring", {"variables", "source.yaml", "--json"}, work_.path());
  std::vector<std::string> arguments = {"source.yaml", "--vary", "I.scale=2,4", "-o", "out"};
  for (const char* measure : {"at(I.raw, 50 ms)", "at(I.control, 50 ms)", "final(I.raw)"})
    arguments.insert(arguments.end(), {"--measure", measure});
  std::size_t listed = 0;
  for (const Json& variable : Json::parse(variables.out)) {
    const std::string name = variable["name"];
    if (name.find(".loop_") != std::string::npos) continue;
    arguments.insert(arguments.end(), {"--measure", "final(" + name + ")"});
    ++listed;
  }
  EXPECT_GE(listed, 4u) << variables.out;
  const CommandResult result = sweep(arguments);
  ASSERT_EQ(result.code, 0) << result.err;
  // the tick at 50 ms has the mean of its step of 1 ms
  const Json report = rows("out");
  for (const double scale : {2.0, 4.0}) {
    const Json& values = report["rows"][scale == 2 ? 0 : 1]["values"];
    EXPECT_NEAR(values[0].get<double>(), 0.505, 1e-12);
    EXPECT_NEAR(values[1].get<double>(), scale * 0.505, 1e-12);
    EXPECT_NEAR(values[2].get<double>(), 1, 1e-12);
  }
  const CommandResult loop =
      sweep({"source.yaml", "--vary", "I.scale=2,4", "--measure", "max(I.loop_delay)", "-o", "no"});
  EXPECT_EQ(loop.code, 2);
  EXPECT_NE(loop.err.find("'I.loop_delay' belongs to a controller"), std::string::npos) << loop.err;
}

TEST_F(Sweep, RowsAreTheSameBytesWithAnyNumberOfWorkers) {
  const auto arguments = [](const char* workers, const char* folder) {
    return std::vector<std::string>{"boom.yaml",
                                    "--until",
                                    "0.1s",
                                    "--sample",
                                    "lhs",
                                    "--samples",
                                    "6",
                                    "--seed",
                                    "5",
                                    "--vary",
                                    "Cyl_Lift.seal_friction=0.5kN..3kN",
                                    "--vary",
                                    "session.coupling=hold,two",
                                    "--measure",
                                    "rms(Cyl_Lift.force - 1 kN)",
                                    "--workers",
                                    workers,
                                    "-o",
                                    folder};
  };
  ASSERT_EQ(sweep(arguments("1", "one")).code, 0);
  ASSERT_EQ(sweep(arguments("3", "three")).code, 0);
  const auto files = row_files("one");
  EXPECT_EQ(files.size(), 6u);
  EXPECT_EQ(files, row_files("three"));
  const Json report = rows("one");
  std::set<std::string> hashes;
  for (const Json& row : report["rows"]) hashes.insert(row["state_hash"]);
  EXPECT_EQ(hashes.size(), 6u);  // each row is another run
  EXPECT_EQ(report["measures"][0]["rows"], 6);
  EXPECT_TRUE(report["measures"][0]["interval"].is_array());
}

TEST_F(Sweep, ContinuesWhereItWasEndedAndRefusesOtherRows) {
  const std::vector<std::string> arguments = {
      "rail.yaml", "--vary", "a=1m/s2..4m/s2:3", "--measure", "max(Block.position.x)", "-o", "out"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  ASSERT_EQ(sweep(arguments).code, 0);
  const auto files = row_files("out");
  // the marks show that a row is not run again
  const std::filesystem::path folder = work_.path() / "out" / "rows";
  std::filesystem::remove(folder / "000001.json");
  std::ofstream(folder / "000002.json") << R"({"code":0,"message":"","values":[77],"steps":1,"not_converged":0,)"
                                        << R"("state_hash":"","build":"another","self_test":"0"})";
  const CommandResult again = sweep(arguments);
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.out.find("2 rows of an earlier sweep were kept"), std::string::npos) << again.out;
  EXPECT_NE(again.out.find("1 row is of another build or processor family"), std::string::npos) << again.out;
  EXPECT_EQ(row_files("out").at("000001.json"), files.at("000001.json"));
  EXPECT_EQ(rows("out")["rows"][2]["values"][0], 77);
  EXPECT_EQ(rows("out")["rows"][2]["is_foreign"], true);
  const CommandResult other = sweep(with({"--measure", "min(Block.position.x)"}));
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("rows of another sweep: --measure differs; nothing was run"), std::string::npos)
      << other.err;
  // a parameter that measures alone use is part of the scene too
  const CommandResult changed = sweep(with({"--set", "ref=1m"}));
  EXPECT_EQ(changed.code, 2);
  EXPECT_NE(changed.err.find("the scene has changed; nothing was run"), std::string::npos) << changed.err;
  ASSERT_EQ(sweep(with({"--anew"})).code, 0);
  EXPECT_EQ(row_files("out"), files);
}

TEST_F(Sweep, AnInterruptKeepsTheRowsThatAreDone) {
  const std::vector<std::string> arguments = {
      "sweep",     "boom.yaml",           "--until",   "1s", "--vary", "Cyl_Lift.seal_friction=0.5kN..3kN:40",
      "--measure", "max(Cyl_Lift.force)", "--workers", "1",  "-o",     "out",
      "--quiet"};
  Command command("slewring", arguments, work_.path());
  ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(work_.path() / "out" / "rows" / "000001.json"); }));
  command.send(SIGINT);
  const CommandResult result = command.wait();
  EXPECT_EQ(result.code, 130);
  EXPECT_NE(result.out.find("of 40 rows are done; the same command continues"), std::string::npos) << result.out;
  EXPECT_FALSE(rows("out")["is_complete"].get<bool>());
}

TEST_F(Sweep, ARowThatFailsKeepsItsCodeAndMessage) {
  // a block that moves back has no square root
  const CommandResult result = sweep(
      {"rail.yaml", "--vary", "a=-1m/s2..1m/s2:3", "--measure", "mean(sqrt(Block.position.x / (1 m)))", "-o", "out"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.out.find("code 1: mean(sqrt(Block.position.x / (1 m))) has no finite value at 0.001 s"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("1 row failed"), std::string::npos) << result.out;
  const Json report = rows("out");
  EXPECT_EQ(report["rows"][0]["code"], 1);
  EXPECT_TRUE(report["rows"][0]["values"][0].is_null());
  EXPECT_EQ(report["rows"][2]["code"], 0);
}

TEST_F(Sweep, ARowWhoseValuesAreRefusedTogetherKeepsTheReason) {
  const CommandResult result =
      sweep({"boom.yaml", "--until", "0.02s", "--vary", "Cyl_Lift.piston_diameter=120mm,200mm", "--vary",
             "Cyl_Lift.rod_diameter=105mm,150mm", "--measure", "max(Cyl_Lift.force)", "-o", "out"});
  EXPECT_EQ(result.code, 1) << result.err;
  const Json report = rows("out");
  EXPECT_EQ(report["rows"][1]["code"], 2);
  EXPECT_NE(report["rows"][1]["message"].get<std::string>().find("rod_diameter"), std::string::npos);
  for (const std::size_t i : {0, 2, 3}) EXPECT_EQ(report["rows"][i]["code"], 0) << i;
}

TEST_F(Sweep, RefusesBeforeAnyRowRuns) {
  const auto refusal = [this](std::vector<std::string> more) {
    more.insert(more.end(), {"-o", "none"});
    const CommandResult result = sweep(more);
    EXPECT_EQ(result.code, 2) << result.out;
    EXPECT_FALSE(std::filesystem::exists(work_.path() / "none"));
    return result.err;
  };
  const std::string measure = "max(Block.position.x)";
  EXPECT_NE(refusal({"rail.yaml", "--vary", "a=1..2:2", "--measure", "max(Blok.position.x)"})
                .find("did you mean 'Block.position.x'?"),
            std::string::npos);
  EXPECT_NE(refusal({"rail.yaml", "--vary", "Block.mass=-1kg..2kg:3", "--measure", measure})
                .find("the scene refuses the value '-1 kg'"),
            std::string::npos);
  EXPECT_NE(refusal({"rail.yaml", "--vary", "a=1m..2m:3", "--measure", measure}).find("the scene refuses the value"),
            std::string::npos);
  EXPECT_NE(refusal({"rail.yaml", "--vary", "Blok.mass=1kg..2kg:3", "--measure", measure}).find("'Block'"),
            std::string::npos);
  EXPECT_NE(refusal({"rail.yaml", "--vary", "a=1..2", "--sample", "lhs", "--measure", measure}).find("give --samples"),
            std::string::npos);
  EXPECT_NE(refusal({"rail.yaml", "--vary", "a=1..2:3", "--samples", "4", "--measure", measure})
                .find("--samples is for --sample random and lhs"),
            std::string::npos);
  EXPECT_NE(
      refusal({"rail.yaml", "--vary", "a=1..2:3", "--vary", "a=1,2", "--measure", measure}).find("is given twice"),
      std::string::npos);
  EXPECT_NE(refusal({"rail.yaml", "--until", "0.5s", "--vary", "session.duration=0.3s,0.6s", "--measure", measure})
                .find("--vary session.duration and --until both set the duration"),
            std::string::npos);
  for (const char* seed : {"-1", "99999999999999999999"}) {
    EXPECT_NE(refusal({"rail.yaml", "--vary", "a=1..2", "--sample", "lhs", "--samples", "2", "--seed", seed,
                       "--measure", measure})
                  .find("is no whole number from 0 to 18446744073709551615"),
              std::string::npos);
  }
}

// x = a t^2/2 at the end; the heading has no duration of its own, and one row no deviation
TEST_F(Sweep, VariesTheDurationAndHasNoDeviationOfOneRow) {
  const CommandResult varied = sweep(
      {"rail.yaml", "--vary", "session.duration=0.3s,0.6s", "--measure", "final(Block.position.x)", "-o", "durations"});
  ASSERT_EQ(varied.code, 0) << varied.err;
  EXPECT_NE(varied.out.find("2 rows of the varied duration"), std::string::npos) << varied.out;
  EXPECT_NEAR(rows("durations")["rows"][1]["values"][0], 0.36, 1e-3);
  const CommandResult one = sweep({"rail.yaml", "--vary", "a=1m/s2..2m/s2", "--sample", "lhs", "--samples", "1",
                                   "--measure", "final(Block.position.x)", "-o", "one"});
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_TRUE(rows("one")["measures"][0]["deviation"].is_null());
}

}  // namespace sweep_test
}  // namespace slew::testing
