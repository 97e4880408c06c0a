// SPDX-License-Identifier: Apache-2.0
// Measured tables of users: long ones travel with the session, exports are played back, unusable ones are refused
// before anything starts.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../../support/test_domain.h"
#include "command.h"
#include "sample_hashes.h"

namespace slew::testing {
namespace tables_test {

namespace fs = std::filesystem;

const std::string kSlide =
    "bodies: {Slide: {mass: 100 kg, inertia: [0, 0, 0]}}\n"
    "mechanics: {gravity: [0, 0, 0]}\n"
    "joints: {Rail: {type: prismatic, body2: Slide, orientation1: [0, 90 deg, 0], orientation2: [0, 90 deg, 0], "
    "viscous_friction: 1000 Ns/m}}\n";

class Tables : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) const {
    return run("slewring", arguments, work_.path());
  }
  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((work_.path() / name).parent_path());
    std::ofstream(work_.path() / name, std::ios::binary) << text;
    return name;
  }
  // a stick and a force, both of `rows` rows at 1 kHz
  void write_sweep(std::size_t rows) const {
    std::string stick = "time,Stick\n", force = "time [ms];F [kN];other\n";
    for (std::size_t i = 0; i < rows; ++i) {
      const double t = static_cast<double>(i) * 1e-3;
      stick += fmt::format("{:.3f},{:.6f}\n", t, std::sin(t * t));
      force += fmt::format("{};{:.4f};x\n", i, std::cos(3 * t));
    }
    write("scene/sweep.csv", stick);
    write("scene/force.csv", force);
    write("scene/sweep.yaml",
          kSlide +
              "forces:\n  Drive: {type: point_force, body: Slide, direction: [1, 0, 0], force: 1 kN}\n"
              "  Push: {type: point_force, body: Slide, direction: [1, 0, 0], force_table: {file: force.csv, columns: "
              "[time, F]}}\n"
              "inputs: {Stick: {type: analog, primitive: Drive}}\n"
              "script: {file: sweep.csv}\nsession: {duration: 1 s, pace: free}\n");
  }
  [[nodiscard]] std::string recording_in(const std::string& out) const {
    return only_recording_below(work_.path() / out).string();
  }
  [[nodiscard]] static std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::string values(const std::string& recording) const {
    const CommandResult table = slewring({"export", recording, "Slide.position.x", "Stick.raw"});
    EXPECT_EQ(table.code, 0) << table.err;
    return table.out;
  }

  WorkFolder work_;
  TestDomain domain_;
};

TEST_F(Tables, LongOnesAreTheSameInOneProcessInProcessesReplayedAndContinued) {
  write_sweep(30'000);
  ASSERT_EQ(slewring({"check", "scene/sweep.yaml"}).code, 0);
  const CommandResult one =
      slewring({"run", "scene/sweep.yaml", "--in-process", "--duration", "2", "--quiet", "--out", "one"});
  ASSERT_EQ(one.code, 0) << one.err;
  const CommandResult many = slewring({"run", "scene/sweep.yaml", "--duration", "2", "--quiet", "--out", "many",
                                       "--domain", std::to_string(domain_.number())});
  ASSERT_EQ(many.code, 0) << many.err;
  EXPECT_EQ(sample_hashes(recording_in("one")), sample_hashes(recording_in("many")));

  // the recordings have both files beside them, and need no others
  fs::remove_all(work_.path() / "scene");
  for (const char* out : {"one", "many"}) {
    const CommandResult replayed = slewring({"replay", recording_in(out), "--verify", "--json"});
    ASSERT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_EQ(nlohmann::json::parse(replayed.out).at("different"), 0);
  }
  const std::string assets = (fs::path(recording_in("one")).parent_path() / "assets").string();
  ASSERT_EQ(slewring({"replay", recording_in("one"), "--until", "1s", "--save", "half.saved"}).code, 0);
  const CommandResult went_on = slewring({"run", "--from", "half.saved", "--assets", assets, "--in-process", "--pace",
                                          "free", "--quiet", "--out", "second"});
  ASSERT_EQ(went_on.code, 0) << went_on.err;
  const std::string whole = values(recording_in("one")), rest = values(recording_in("second"));
  const std::string last = whole.substr(whole.rfind("\n2,"));
  EXPECT_TRUE(rest.ends_with(last)) << last << rest.substr(rest.size() - std::min<std::size_t>(rest.size(), 80));
  EXPECT_EQ(slewring({"replay", recording_in("second"), "--verify"}).code, 0);

  // without the script's file, or with another one, nothing is started
  const CommandResult lost = slewring({"run", "--from", "half.saved", "--in-process", "--quiet", "--out", "third"});
  EXPECT_EQ(lost.code, 2);
  EXPECT_NE(lost.err.find("sweep.csv: cannot be read"), std::string::npos) << lost.err;
}

TEST_F(Tables, ALongInputOfTheCommandLineIsKeptWithItsRecording) {
  write_sweep(5'000);
  fs::rename(work_.path() / "scene/sweep.csv", work_.path() / "levers.csv");
  write("scene/force.yaml", "inputs: {Stick: [[0, 0]]}\n");
  const CommandResult again = slewring({"run", "scene/sweep.yaml", "--set", "script.file=force.yaml", "--input",
                                        "levers.csv", "--in-process", "--quiet", "--out", "out"});
  ASSERT_EQ(again.code, 0) << again.err;
  const fs::path assets = fs::path(recording_in("out")).parent_path() / "assets";
  EXPECT_EQ(text_of(assets / "levers.csv"), text_of(work_.path() / "levers.csv"));
  EXPECT_EQ(slewring({"replay", recording_in("out"), "--verify"}).code, 0);
}

TEST_F(Tables, AnExportedPartIsPlayedBackWhereItWasRecorded) {
  write("scene.yaml", kSlide +
                          "forces: {Drive: {type: point_force, body: Slide, direction: [1, 0, 0], force: 1 kN}}\n"
                          "inputs: {Stick: {type: analog, primitive: Drive}}\n"
                          "script: {inputs: {Stick: [[0, 0], [0.5 s, 0], [0.5 s, 0.75], [2 s, 0.25]]}}\n"
                          "session: {duration: 2 s, pace: free}\n");
  const std::vector<std::string> run = {"run", "scene.yaml", "--in-process", "--quiet", "--out"};
  const auto run_into = [&](const std::string& out, const std::string& input) {
    std::vector<std::string> arguments = run;
    arguments.insert(arguments.end(), {out, "--input", input});
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.err;
  };
  run_into("first", "script");
  const CommandResult part = slewring({"export", recording_in("first"), "--input", "--from", "1s", "-o", "part.csv"});
  ASSERT_EQ(part.code, 0);
  EXPECT_EQ(part.err, "the table begins at 1 s; played back, the inputs are neutral before\n");
  EXPECT_NE(run_into("part", "part.csv").find("'part.csv' begins at 1 s; Stick is neutral before"), std::string::npos);
  const CommandResult played = slewring({"export", recording_in("part"), "Stick.raw", "Slide.position.x"});
  EXPECT_NE(played.out.find("\n0,0,0\n"), std::string::npos);
  EXPECT_NE(played.out.find("\n0.999,0,0\n"), std::string::npos);
  EXPECT_NE(played.out.find("\n1,0.583166666666666"), std::string::npos) << "the mean over the step";
  const auto raw_from_1_s = [this](const std::string& out) {
    return slewring({"export", recording_in(out), "Stick.raw", "--from", "1s"}).out;
  };
  EXPECT_EQ(raw_from_1_s("part"), raw_from_1_s("first"));

  // every variable of the session, as a spreadsheet has it, is an input too
  ASSERT_EQ(slewring({"export", recording_in("first"), "-o", "all.csv"}).code, 0);
  run_into("all", "all.csv");
  EXPECT_EQ(values(recording_in("all")), values(recording_in("first")));
}

TEST_F(Tables, AScriptWithoutAValueIsRefusedByEveryVerb) {
  for (const char* content : {"", "time,Stick\n", "time,Stick\n\n\n", "time,Stick\n0,\n1,\n"}) {
    write_sweep(10);
    write("scene/sweep.csv", content);
    for (const std::vector<std::string>& verb : {std::vector<std::string>{"check", "scene/sweep.yaml"},
                                                 {"describe", "scene/sweep.yaml"},
                                                 {"run", "scene/sweep.yaml", "--in-process", "--quiet"}}) {
      const CommandResult result = slewring(verb);
      EXPECT_EQ(result.code, 2) << verb[0] << ": " << content;
      EXPECT_NE(result.err.find("sweep.csv:1:"), std::string::npos) << result.err;
    }
  }
}

TEST_F(Tables, WhatIsNoFileIsRefusedAndNotWaitedFor) {
  ASSERT_EQ(::mkfifo((work_.path() / "fifo.stl").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((work_.path() / "fifo.csv").c_str(), 0600), 0);
  write("outside.yaml", "root: secret\n");
  write("scene/secret.yaml", "include: ../outside.yaml\n" + kSlide);
  write("mesh.yaml", kSlide + "shapes: {S: {type: triangle_mesh, body: Slide, file: fifo.stl, unit: 1 m, up: y}}\n");
  write("slide.yaml", kSlide + "forces: {Drive: {type: point_force, body: Slide, force_table: fifo.csv}}\n");
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& text) {
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, 2) << arguments[0];
    EXPECT_NE((result.err + result.out).find(text), std::string::npos) << result.err << result.out;
    EXPECT_EQ((result.err + result.out).find("secret\n"), std::string::npos);
  };
  refused({"check", "mesh.yaml"}, "fifo.stl' is not a regular file");
  refused({"check", "slide.yaml"}, "fifo.csv: is not a regular file");
  refused({"check", "fifo.csv"}, "fifo.csv: is not a regular file");
  refused({"check", "scene/secret.yaml"}, "'../outside.yaml' lies outside of the scene's folder and was not read");
  refused({"run", "--from", "fifo.csv", "--in-process"}, "fifo.csv: is not a regular file");
  refused({"replay", "fifo.csv"}, "fifo.csv");
}

}  // namespace tables_test
}  // namespace slew::testing
