// SPDX-License-Identifier: Apache-2.0
// Sessions in one process: run, record, look, replay.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "command.h"
#include "sample_hashes.h"
#include "tests/support/test_domain.h"

namespace slew::testing {
namespace in_process_test {

class InProcess : public ::testing::Test {
 protected:
  CommandResult slewring(const std::vector<std::string>& arguments) { return run("slewring", arguments, work_.path()); }

  CommandResult run_scene(const std::string& scene, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"run", scene_file(scene), "--in-process", "--pace", "free", "--json"});
    return slewring(more);
  }

  WorkFolder work_;
};

TEST_F(InProcess, FirstStepsAreRunRecordedDrawnAndReplayed) {
  const CommandResult result = run_scene("first_steps.yaml");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("steps"), 10'000);
  EXPECT_EQ(report.at("lost"), "none");
  EXPECT_EQ(report.at("recording"), std::filesystem::relative(work_.recording(), work_.path()).string());
  EXPECT_TRUE(std::filesystem::exists(work_.path() / report.at("plots").get<std::string>()));

  const CommandResult replayed = slewring({"replay", work_.recording().string(), "--verify", "--json"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
  const nlohmann::json replay = nlohmann::json::parse(replayed.out);
  EXPECT_EQ(replay.at("steps"), 10'000);
  EXPECT_EQ(replay.at("compared"), 10'001);
  EXPECT_EQ(replay.at("unrecorded"), 0);
}

TEST_F(InProcess, RefusesALockstepController) {
  const CommandResult result = run_scene("truck_crane.yaml", {"--set", "Input_Lift.controller=lockstep"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("slewring: a run in one process has no place for a controller, and input Input_Lift waits "
                            "for one in every step (controller: lockstep); nothing was started; run it as processes, "
                            "or without the controller: --set Input_Lift.controller=sampled"),
            std::string::npos)
      << result.err;
}

TEST_F(InProcess, EachPlotOfTheSceneHasItsHeadingAndItsOwnPanel) {
  std::ofstream(work_.path() / "rod.yaml") << "bodies:\n  Rod: {mass: 2 kg, inertia: [1, 1, 1]}\n"
                                              "joints:\n  Hinge: {type: revolute, body2: Rod}\n"
                                              "plots:\n  Swing: {title: How it swings, variables: [Rod.position.x]}\n"
                                              "  Height: {variables: [Rod.position.y, Hinge.position]}\n";
  const CommandResult result =
      slewring({"run", "rod.yaml", "--in-process", "--pace", "free", "--duration", "0.1", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string path = nlohmann::json::parse(result.out).at("plots");
  const auto expect_plots = [&] {
    std::ifstream file(work_.path() / path);
    const std::string svg{std::istreambuf_iterator<char>(file), {}};
    std::size_t panels = 0;
    for (std::size_t at = 0; (at = svg.find("<clipPath", at)) != std::string::npos; ++at) ++panels;
    EXPECT_EQ(panels, 3u);  // two metres apart, and the angle
    const std::size_t swing = svg.find(">How it swings</text>"), x = svg.find(">Rod.position.x</text>");
    const std::size_t height = svg.find(">Height</text>"), y = svg.find(">Rod.position.y</text>");
    EXPECT_TRUE(swing < x && x < height && height < y && y != std::string::npos) << svg;
  };
  expect_plots();
  std::filesystem::remove(work_.path() / path);
  EXPECT_EQ(slewring({"plot", work_.recording().string()}).code, 0);  // the same from the recording
  expect_plots();
}

TEST_F(InProcess, APlotOfAVariableThatIsNotThereIsNamedAndTheRunIsGoodAllTheSame) {
  std::ofstream(work_.path() / "rod.yaml") << "bodies:\n  Rod: {mass: 2 kg, inertia: [1, 1, 1]}\n"
                                              "joints:\n  Hinge: {type: revolute, body2: Rod}\n"
                                              "plots:\n  Swing: {variables: [Rod.nothing]}\n";
  const CommandResult result =
      slewring({"run", "rod.yaml", "--in-process", "--pace", "free", "--duration", "0.1", "--json"});
  EXPECT_EQ(result.code, 0) << result.err;
  const std::string warning =
      "rod.yaml:6:22: Swing.variables: there is no variable 'Rod.nothing'; 'slewring variables' lists all";
  EXPECT_NE(result.err.find("warning: " + warning), std::string::npos) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out).at("notes"),
            (nlohmann::json{"plot Swing: not drawn: there is no variable 'Rod.nothing'; 'slewring variables' lists "
                            "all"}));
  EXPECT_EQ(slewring({"replay", work_.recording().string(), "--verify"}).code, 0);
  const CommandResult plotted = slewring({"plot", work_.recording().string()});
  EXPECT_EQ(plotted.code, 2);
  EXPECT_NE(plotted.err.find("there is no variable 'Rod.nothing'"), std::string::npos) << plotted.err;
  // the same rule before a run
  const CommandResult checked = slewring({"check", "rod.yaml", "--json"});
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_EQ(nlohmann::json::parse(checked.out).at("warnings"), (nlohmann::json{warning}));
}

// a pump against a closed line: its pressure leaves the range of the oil's law
TEST_F(InProcess, FlagsAreReportedAlikeWithAndWithoutARecordingInOneProcessAndInMany) {
  std::ofstream(work_.path() / "closed.yaml")
      << "volumes:\n  Vol_P: {rigid_volume: 1 l}\n  Vol_T: {initial_pressure: 1 bar, fixed: true}\n"
         "components:\n  Pump: {type: ls_pump, port_a: Vol_P, port_b: Vol_T, speed: 1500 rpm, displacement: 28 cc/rev, "
         "standby_pressure: 10000 bar, time_constant: 1 ms}\n"
         "session: {duration: 0.5 s, pace: free}\n";
  const auto notes = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "closed.yaml", "--input", "none", "--json"});
    const CommandResult result = slewring(more);
    EXPECT_EQ(result.code, 0) << result.err;
    return nlohmann::json::parse(result.out).at("notes");
  };
  const nlohmann::json recorded = notes({"--in-process"});
  ASSERT_FALSE(recorded.empty());
  EXPECT_NE(recorded.dump().find("Vol_P: a pressure was beyond the range of the oil's law"), std::string::npos)
      << recorded;
  EXPECT_EQ(notes({"--in-process", "--no-record"}), recorded);
  const CommandResult info = slewring({"info", work_.recording().string(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(info.out).at("notes"), recorded);
  const TestDomain domain;
  EXPECT_EQ(notes({"--no-record", "--domain", std::to_string(domain.number())}), recorded);
}

TEST_F(InProcess, TheLastLineIsThePathOfTheRecording) {
  const CommandResult result =
      slewring({"run", scene_file("first_steps.yaml"), "--in-process", "--pace", "free", "--duration", "0.1"});
  ASSERT_EQ(result.code, 0) << result.err;
  std::istringstream lines(result.out);
  std::string last;
  for (std::string line; std::getline(lines, line);) last = line;
  EXPECT_EQ(work_.path() / last, work_.recording());
}

TEST_F(InProcess, TwoRunsOfTheCraneHaveTheSameHashAtEveryStep) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "2", "--out", "first"}).code, 0);
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "2", "--out", "second"}).code, 0);
  const SampleHashes first = sample_hashes(only_recording_below(work_.path() / "first"));
  const SampleHashes second = sample_hashes(only_recording_below(work_.path() / "second"));
  ASSERT_EQ(first.size(), 2u * 2001 + 1);
  EXPECT_EQ(first, second);
}

TEST_F(InProcess, ASettingChangesTheRun) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "0.1", "--out", "first"}).code, 0);
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "0.1", "--out", "second", "--set", "Bag.mass=501 kg"}).code,
            0);
  EXPECT_NE(sample_hashes(only_recording_below(work_.path() / "first")),
            sample_hashes(only_recording_below(work_.path() / "second")));
}

TEST_F(InProcess, TheScriptsParameterChangesAreReplayed) {
  std::ofstream(work_.path() / "input.yaml") << "inputs:\n  Input_Lift: [[0 s, 0], [0.2 s, 1]]\n"
                                                "parameters:\n  - {at: 0.5 s, set: Bag.mass, value: 800 kg}\n";
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "2", "--input", "input.yaml"}).code, 0);
  const CommandResult replayed = slewring({"replay", work_.recording().string(), "--verify"});
  EXPECT_EQ(replayed.code, 0) << replayed.out << replayed.err;
}

TEST_F(InProcess, AFlexibleCraneIsReplayedFromTheFilesBesideItsRecording) {
  const CommandResult run = run_scene("truck_crane_flexible.yaml", {"--duration", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(run.err.find("Truck_JibBoom"), std::string::npos) << run.err;
  const std::string recording = work_.recording().string();
  const CommandResult replayed = slewring({"replay", recording, "--verify"});
  EXPECT_EQ(replayed.code, 0) << replayed.out << replayed.err;
  // without the files, and with another one
  const std::filesystem::path assets = work_.recording().parent_path() / "assets";
  std::ofstream(assets / "truck_crane_beam_hard_Stiffness.dat") << "other";
  const CommandResult other = slewring({"replay", recording, "--verify"});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("truck_crane_beam_hard_Stiffness.dat"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("--assets"), std::string::npos) << other.err;
  const std::string scenes = std::filesystem::path(scene_file("truck_crane_flexible.yaml")).parent_path().string();
  const CommandResult named = slewring({"replay", recording, "--verify", "--assets", scenes});
  EXPECT_EQ(named.code, 0) << named.out << named.err;
}

TEST_F(InProcess, ReplayStopsAtTheEndOfACutRecording) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "2"}).code, 0);
  const std::filesystem::path recording = work_.recording();
  std::filesystem::resize_file(recording, std::filesystem::file_size(recording) * 2 / 3);
  const CommandResult result = slewring({"replay", recording.string(), "--verify", "--json"});
  const nlohmann::json replay = nlohmann::json::parse(result.out);
  EXPECT_GT(replay.at("steps"), 100);
  EXPECT_LT(replay.at("steps"), 2000);
  EXPECT_EQ(replay.at("different"), 0);
  EXPECT_NE(result.err.find("warning"), std::string::npos) << result.err;
}

TEST_F(InProcess, NoRecordLeavesNothingBehind) {
  const CommandResult result = run_scene("first_steps.yaml", {"--no-record", "--duration", "0.5"});
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  EXPECT_EQ(report.at("recording"), "");
  EXPECT_FALSE(report.at("variables").empty());
  EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs"));
}

TEST_F(InProcess, ARecordingIsShownPlottedAndExported) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "1"}).code, 0);
  const std::string recording = work_.recording().string();

  const nlohmann::json info = nlohmann::json::parse(slewring({"info", recording, "--verify", "--json"}).out);
  EXPECT_EQ(info.at("end"), "closed in order");
  EXPECT_EQ(info.at("scene"), "truck_crane");
  EXPECT_EQ(info.at("step_ns"), 1'000'000);
  EXPECT_TRUE(info.at("complete").get<bool>());
  EXPECT_EQ(info.at("topics").at("tick").at("recorded"), 1001);  // the last one has the END flag
  EXPECT_EQ(info.at("topics").at("mechanism").at("lost"), "0");
  // the recorder's counts, without reading the messages, are those of the messages
  EXPECT_EQ(slewring({"info", recording}).out + "every byte was read and every checksum fits\n",
            slewring({"info", recording, "--verify"}).out);

  const CommandResult plotted = slewring({"plot", recording, "Cyl_*.force", "Bag.position.y", "-o", "out.svg"});
  ASSERT_EQ(plotted.code, 0) << plotted.err;
  std::ostringstream svg;
  svg << std::ifstream(work_.path() / "out.svg").rdbuf();
  EXPECT_NE(svg.str().find("<svg"), std::string::npos);
  EXPECT_NE(svg.str().find("Cyl_Lift.force"), std::string::npos);
  EXPECT_NE(svg.str().find("kN"), std::string::npos);

  // without names the scene's plots, as a page where the file is one
  ASSERT_EQ(slewring({"plot", recording, "-o", "run.html"}).code, 0);
  std::ostringstream page;
  page << std::ifstream(work_.path() / "run.html").rdbuf();
  EXPECT_TRUE(page.str().starts_with("<!DOCTYPE html>"));
  EXPECT_NE(page.str().find("Height of the bag"), std::string::npos);

  // a part, of the scene's plots and of one variable; outside of the recording there is nothing to draw
  for (const std::vector<std::string>& names : std::vector<std::vector<std::string>>{{}, {"Bag.position.y"}}) {
    std::vector<std::string> arguments = {"plot", recording};
    arguments.insert(arguments.end(), names.begin(), names.end());
    arguments.insert(arguments.end(), {"-o", "part.html", "--from", "0.2 s", "--to", "300 ms"});
    ASSERT_EQ(slewring(arguments).code, 0);
    std::ostringstream part;
    part << std::ifstream(work_.path() / "part.html").rdbuf();
    const std::size_t begin = part.str().find('{', part.str().find("id=\"data\""));
    const std::size_t end = part.str().find("</script>", begin);
    const nlohmann::json data = nlohmann::json::parse(part.str().substr(begin, end - begin));
    for (const nlohmann::json& axis : data.at("times")) {
      EXPECT_EQ(axis.size(), 11u);
      EXPECT_EQ(axis.front(), 0.2);
      EXPECT_EQ(axis.back(), 0.3);
    }
    arguments.back() = "0.1 s";
    EXPECT_EQ(slewring(arguments).code, 2);
    arguments[arguments.size() - 3] = "5 s";
    arguments.back() = "6 s";
    EXPECT_EQ(slewring(arguments).code, 2);
  }

  ASSERT_EQ(slewring({"animate", recording, "-o", "crane.html"}).code, 0);
  ASSERT_EQ(slewring({"animate", recording, "-o", "crane.svg"}).code, 0);
  EXPECT_GT(std::filesystem::file_size(work_.path() / "crane.html"), 10'000u);
  EXPECT_EQ(slewring({"animate", recording, "-o", "crane.gif"}).code, 2);

  const CommandResult table = slewring({"export", recording, "Bag.position.y", "--csv"});
  ASSERT_EQ(table.code, 0) << table.err;
  EXPECT_TRUE(table.out.starts_with("time [s],Bag.position.y [m]")) << table.out.substr(0, 100);
  EXPECT_EQ(std::count(table.out.begin(), table.out.end(), '\n'), 102);  // heading, then every 10th of 1000 steps

  const CommandResult typo = slewring({"plot", recording, "Cyl_Lft.force"});
  EXPECT_EQ(typo.code, 2);
  EXPECT_NE(typo.err.find("did you mean 'Cyl_Lift.force'?"), std::string::npos) << typo.err;
}

TEST_F(InProcess, AnExportTakesAPartAndNeverReplacesAFileByItself) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "0.5"}).code, 0);
  const std::string recording = work_.recording().string();
  const CommandResult part =
      slewring({"export", recording, "--only", "Cyl_Lift.force", "--from", "100ms", "--to", "0.2"});
  ASSERT_EQ(part.code, 0) << part.err;
  EXPECT_EQ(std::count(part.out.begin(), part.out.end(), '\n'), 12);  // heading, then every 10 ms
  EXPECT_TRUE(part.out.starts_with("time [s],Cyl_Lift.force [N]\n0.1,")) << part.out;

  ASSERT_EQ(slewring({"export", recording, "Cyl_*", "-o", "crane.mat"}).out, "crane.mat\n");
  const auto refused = [&](std::vector<std::string> arguments, int code, const std::string& sentence) {
    arguments.insert(arguments.begin(), {"export", recording});
    const CommandResult result = slewring(arguments);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_NE(result.err.find(sentence), std::string::npos) << result.err;
  };
  const auto size = std::filesystem::file_size(work_.path() / "crane.mat");
  refused({"-o", "crane.mat"}, 2, "crane.mat: the file exists already; it was left as it is;");
  EXPECT_EQ(std::filesystem::file_size(work_.path() / "crane.mat"), size);
  ASSERT_EQ(slewring({"export", recording, "-o", "crane.mat", "--force"}).code, 0);
  EXPECT_GT(std::filesystem::file_size(work_.path() / "crane.mat"), size);
  refused({"--mat"}, 2, "a MAT-file needs a name");
  refused({"-o", "b.xlsx"}, 2, "'b.xlsx' ends neither in .csv nor in .mat, the formats of tables; nothing was written");
  refused({"-o", "b.MAT", "--csv"}, 2, "--csv does not write what 'b.MAT' ends in; nothing was written");
  refused({"-o", "b.csv", "--mat"}, 2, "--mat does not write what 'b.csv' ends in; nothing was written");
  EXPECT_EQ(slewring({"export", recording, "-o", "named.xlsx", "--csv"}).code, 0);
  EXPECT_EQ(slewring({"export", recording, "-o", "unnamed"}).code, 0);
  refused({"--mat", "--csv", "-o", "b.mat"}, 2, "--csv excludes --mat");
  refused({"Cyl_Lft.force", "-o", "b.mat"}, 2, "there is no variable 'Cyl_Lft.force'; did you mean 'Cyl_Lift.force'?");
  refused({"--from", "2s", "-o", "b.mat"}, 2, "no value of these variables in this time; it goes from 0 s to 0.5 s");
  refused({"--from", "soon", "-o", "b.mat"}, 2, "--from 'soon' is not a time of the recording");
  refused({"--from", "2s", "--to", "1s", "-o", "b.mat"}, 2, "--to 1s lies before --from 2s");
  refused({"-o", "nowhere/b.mat"}, 6, "nowhere/b.mat: the MAT-file cannot be written");
  refused({"-o", "nowhere/b.csv"}, 6, "nowhere/b.csv: cannot write the table (No such file or directory)");
  for (const auto& entry : std::filesystem::directory_iterator(work_.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("b.")) << entry.path() << " was left behind";
  }
}

TEST_F(InProcess, WithoutRoomForARecordingNothingBeginsAndTheRemedyIsNamed) {
  const CommandResult result = run_scene("truck_crane.yaml", {"--duration", "1", "--keep-free", "1000000000"});
  EXPECT_EQ(result.code, 6) << result.out;
  EXPECT_NE((result.out + result.err)
                .find("and 1000000000 MB are to be left to others; nothing was recorded; free "
                      "space, record elsewhere with --out DIR, or leave less with --keep-free MB"),
            std::string::npos)
      << result.out << result.err;
  EXPECT_EQ(run_scene("truck_crane.yaml", {"--duration", "0.1", "--keep-free", "0"}).code, 0);
}

// as `ulimit -f` sets it for a user's shell: no signal ends the program
TEST_F(InProcess, ALimitOnTheSizeOfFilesIsAFailedWriteAndLeavesNoHalfFile) {
  const auto limited = [&](std::size_t bytes, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"--fsize=" + std::to_string(bytes), program_file("slewring").string()});
    return run("/usr/bin/prlimit", arguments, work_.path());
  };
  const CommandResult cut = limited(1'200'000, {"run", scene_file("truck_crane.yaml"), "--in-process", "--pace", "free",
                                                "--duration", "6", "--out", "cut"});
  EXPECT_EQ(cut.code, 6) << cut.err;
  EXPECT_NE(cut.err.find("(File too large); the file was cut back to "), std::string::npos) << cut.err;

  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "2"}).code, 0);
  const std::string recording = only_recording_below(work_.path() / "runs").string();
  const auto text = [&](const std::string& name) {
    std::ostringstream all;
    all << std::ifstream(work_.path() / name, std::ios::binary).rdbuf();
    return all.str();
  };
  const std::vector<std::vector<std::string>> verbs = {{"plot", recording, "Bag.*", "-o", "a.svg"},
                                                       {"plot", recording, "Bag.*", "-o", "a.html"},
                                                       {"animate", recording, "-o", "b.html"},
                                                       {"export", recording, "--force", "-o", "c.csv"},
                                                       {"export", recording, "--force", "--mat", "-o", "c.mat"},
                                                       {"export", recording, "--force", "--input", "-o", "d.csv"}};
  for (const std::vector<std::string>& verb : verbs) {
    const std::string& name = verb.back();
    for (const std::size_t bytes : {300, 500, 1100}) {
      const CommandResult none = limited(bytes, verb);
      EXPECT_EQ(none.code, 6) << name << none.err;
      EXPECT_NE(none.err.find(name + ": "), std::string::npos) << none.err;
      EXPECT_FALSE(std::filesystem::exists(work_.path() / name)) << name;
    }
    ASSERT_EQ(slewring(verb).code, 0) << name;
    const std::string whole = text(name);
    EXPECT_EQ(limited(500, verb).code, 6) << name;
    EXPECT_EQ(text(name), whole) << name << " is as it was";
    EXPECT_FALSE(std::filesystem::exists(work_.path() / (name + ".part"))) << name;
  }
}

TEST_F(InProcess, ADamagedRecordingIsRecoveredAndReplays) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "3"}).code, 0);
  const std::string recording = work_.recording().string();
  const CommandResult whole = slewring({"recover", recording});
  EXPECT_EQ(whole.code, 0) << whole.err;
  EXPECT_NE(whole.out.find("there is nothing to recover and nothing was written"), std::string::npos) << whole.out;

  // the recorder was killed in mid-write
  const auto size = std::filesystem::file_size(recording);
  std::filesystem::copy_file(recording, work_.path() / "cut.mcap");
  std::filesystem::resize_file(work_.path() / "cut.mcap", size * 2 / 3);
  const CommandResult cut = slewring({"recover", "cut.mcap", "--json"});
  EXPECT_EQ(cut.code, 3) << cut.err;
  const nlohmann::json saved = nlohmann::json::parse(cut.out);
  EXPECT_EQ(saved.at("recovered"), "cut.recovered.mcap");
  EXPECT_TRUE(saved.at("was_cut").get<bool>());
  EXPECT_EQ(saved.at("lost_steps"), 0);
  ASSERT_EQ(saved.at("lost").size(), 1u);
  EXPECT_LT(saved.at("lost").at(0).at("byte"), size * 2 / 3);
  const int last = saved.at("last_step");
  EXPECT_GT(last, 100);
  const CommandResult info = slewring({"info", "cut.recovered.mcap", "--verify"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_NE(info.out.find("recovered from cut.mcap"), std::string::npos) << info.out;
  const CommandResult replayed = slewring({"replay", "cut.recovered.mcap", "--json"});
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_EQ(nlohmann::json::parse(replayed.out).at("different"), 0);
  EXPECT_EQ(nlohmann::json::parse(replayed.out).at("steps"), last + 1);
  // an existing file is never replaced
  const CommandResult again = slewring({"recover", "cut.mcap"});
  EXPECT_EQ(again.code, 6);
  EXPECT_NE(again.err.find("cut.recovered.mcap: the file exists already"), std::string::npos) << again.err;
}

// a recording that begins in mid-run has lost nothing in front of it
TEST_F(InProcess, ADamagedRecordingOfASessionThatGoesOnIsRecoveredFromItsFirstStepOn) {
  ASSERT_EQ(run_scene("truck_crane.yaml", {"--duration", "0.8", "--out", "first"}).code, 0);
  const std::string first = only_recording_below(work_.path() / "first").string();
  ASSERT_EQ(slewring({"replay", first, "--until", "0.7s", "--save", "crane.saved"}).code, 0);
  const CommandResult went_on = slewring({"run", "--from", "crane.saved", "--in-process", "--pace", "free", "--quiet",
                                          "--duration", "4", "--out", "second"});
  ASSERT_EQ(went_on.code, 0) << went_on.err;
  const std::filesystem::path second = only_recording_below(work_.path() / "second");
  std::filesystem::copy_file(second, work_.path() / "cut.mcap");
  std::filesystem::resize_file(work_.path() / "cut.mcap", std::filesystem::file_size(second) * 2 / 3);
  const CommandResult cut = slewring({"recover", "cut.mcap", "--json"});
  ASSERT_EQ(cut.code, 3) << cut.err;
  const nlohmann::json saved = nlohmann::json::parse(cut.out);
  EXPECT_EQ(saved.at("first_step"), 700);
  EXPECT_GT(saved.at("complete_to"), 1000);
  EXPECT_LE(saved.at("complete_to"), saved.at("last_step"));
  EXPECT_EQ(saved.at("lost_steps"), 0);
  const CommandResult recovered = slewring({"recover", "cut.mcap", "-o", "again.mcap"});
  EXPECT_NE(recovered.out.find("complete from step 700 up to step "), std::string::npos) << recovered.out;
  EXPECT_EQ(recovered.out.find("ticks and samples"), std::string::npos) << recovered.out;
  const CommandResult replayed = slewring({"replay", "cut.recovered.mcap", "--json"});
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_EQ(nlohmann::json::parse(replayed.out).at("different"), 0);
}

// an operator's inputs on one crane, played back on another, and both in one picture
TEST_F(InProcess, AnInputIsTakenFromOneCraneToAnotherAndBothAreDrawnTogether) {
  const auto run_into = [&](const std::string& scene, const std::string& out, const std::string& input) {
    const CommandResult run = run_scene(scene, {"--duration", "2", "--out", out, "--input", input});
    EXPECT_EQ(run.code, 0) << run.err;
    return only_recording_below(work_.path() / out).string();
  };
  const std::string rigid = run_into("truck_crane.yaml", "rigid", "script");
  const CommandResult exported = slewring({"export", rigid, "--input", "-o", "levers.csv"});
  ASSERT_EQ(exported.code, 0) << exported.err;
  const std::string levers = (work_.path() / "levers.csv").string();
  const std::string again = run_into("truck_crane.yaml", "again", levers);
  const std::string flexible = run_into("truck_crane_flexible.yaml", "flexible", levers);

  // the same levers again: raw values at every time of the table
  const std::vector<std::string> inputs = {"Input_Slew.raw", "Input_Lift.raw", "Input_Jib.raw"};
  const auto table = [&](const std::string& recording) {
    std::vector<std::string> arguments = {"export", recording};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    return slewring(arguments).out;
  };
  EXPECT_EQ(table(again), table(rigid));
  EXPECT_EQ(table(flexible), table(rigid));
  EXPECT_NE(table(rigid).find(",1"), std::string::npos) << "a lever was moved";

  const CommandResult plotted = slewring({"plot", rigid, "Bag.center_of_mass.y", "--with", flexible, "-o", "both.svg"});
  ASSERT_EQ(plotted.code, 0) << plotted.err;
  std::ostringstream svg;
  svg << std::ifstream(work_.path() / "both.svg").rdbuf();
  EXPECT_NE(svg.str().find("Bag.center_of_mass.y (truck_crane)"), std::string::npos);
  EXPECT_NE(svg.str().find("Bag.center_of_mass.y (truck_crane_flexible)"), std::string::npos);

  const CommandResult missing = slewring({"plot", flexible, "Truck_JibBoom.strain_energy", "--with", rigid});
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.err.find(rigid + ": there is no variable 'Truck_JibBoom.strain_energy'"), std::string::npos)
      << missing.err;
  EXPECT_EQ(slewring({"plot", flexible, "--with", rigid}).code, 2);
  EXPECT_EQ(slewring({"export", rigid, "Bag.*", "--input"}).code, 2);
}

TEST_F(InProcess, TheSummaryHasTheReasonWhyALoadCannotBeLiftedAndTheLargestLoad) {
  const CommandResult heavy = run_scene("truck_crane_heavy.yaml", {"--out", "heavy"});
  ASSERT_EQ(heavy.code, 0) << heavy.err;
  const nlohmann::json notes = nlohmann::json::parse(heavy.out).at("notes");
  ASSERT_EQ(notes.size(), 1u);
  const std::string note = notes.at(0);
  EXPECT_NE(note.find("Cyl_Lift did not extend"), std::string::npos) << note;
  EXPECT_NE(note.find("maximum_ls_pressure_a"), std::string::npos) << note;
  const std::size_t at = note.find("up to ", note.find("Bag weighs 1500 kg"));
  ASSERT_NE(at, std::string::npos) << note;
  const int most = std::stoi(note.substr(at + 6));
  EXPECT_GT(most, 1100);
  EXPECT_LT(most, 1400);

  // a load a little below the predicted one is lifted
  std::ofstream(work_.path() / "less.yaml")
      << "interpolation: step\ninputs:\n  Input_Lift: [[0 s, 0], [8 s, 1], [14 s, 0]]\n"
      << "parameters:\n  - {at: 1 s, set: Bag.mass, value: " << most * 0.97 << " kg, over: 1 s}\n";
  const CommandResult less = run_scene("truck_crane_heavy.yaml", {"--out", "less", "--input", "less.yaml"});
  ASSERT_EQ(less.code, 0) << less.err;
  const nlohmann::json report = nlohmann::json::parse(less.out);
  const nlohmann::json& angle = report.at("variables").at("Pillar_LiftBoom.position");
  EXPECT_GT(angle.at("last").get<double>(), angle.at("min").get<double>() + 0.02) << angle;
}

TEST_F(InProcess, ALoadThatIsLiftedNeedsNoNote) {
  const CommandResult result = run_scene("truck_crane.yaml");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(nlohmann::json::parse(result.out).at("notes").empty()) << result.out;
}

TEST_F(InProcess, TheSummaryNamesTheFlaggedSteps) {
  const CommandResult result = run_scene("truck_crane.yaml", {"--duration", "1", "--set", "hydraulics.substep_budget=3",
                                                              "--set", "hydraulics.relative_tolerance=1e-8"});
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json notes = nlohmann::json::parse(result.out).at("notes");
  ASSERT_EQ(notes.size(), 1u) << result.out;
  EXPECT_NE(notes.at(0).get<std::string>().find("hydraulics: the sub-step budget was used up"), std::string::npos);
  const CommandResult info = slewring({"info", work_.recording().string(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(info.out).at("notes"), notes);
}

TEST_F(InProcess, AnUnstableHoldIsFlagged) {
  const CommandResult result =
      run_scene("single_cylinder.yaml", {"--set", "session.coupling=hold", "--step", "5ms", "--duration", "2"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("the coupling created energy"), std::string::npos) << result.out;
}

TEST_F(InProcess, CouplingThatDivergesEndsTheSessionByItsPort) {
  const std::string excavator = scene_file("../tests/validation/coupling/mini_excavator.yaml");
  const CommandResult ended =
      slewring({"run", excavator, "--in-process", "--pace", "free", "--step", "10ms", "--set",
                "session.coupling=linear", "--set", "Cyl_Boom.cylinder_coefficient=1", "--set",
                "Cyl_Stick.cylinder_coefficient=1", "--set", "Cyl_Bucket.cylinder_coefficient=1"});
  EXPECT_EQ(ended.code, 5) << ended.out << ended.err;
  EXPECT_NE(ended.err.find("the coupling diverges"), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("coupling: two"), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("session.coupling_alarm: warn"), std::string::npos) << ended.err;
  const CommandResult replayed = slewring({"replay", work_.recording().string(), "--verify"});
  EXPECT_NE(replayed.out.find(" 0 different"), std::string::npos) << replayed.out << replayed.err;
}

TEST_F(InProcess, AValveThatJumpsEndsNoSessionOfLevelTwo) {
  for (const char* step : {"2ms", "5ms", "10ms"}) {
    const CommandResult result = run_scene("two_dof_crane.yaml", {"--step", step});
    EXPECT_EQ(result.code, 0) << step << result.out << result.err;
    EXPECT_EQ(result.out.find("created energy"), std::string::npos) << step << result.out;
  }
}

TEST_F(InProcess, CtrlCEndsTheSessionInOrder) {
  Command command("slewring", {"run", scene_file("truck_crane.yaml"), "--in-process", "--duration", "0"}, work_.path());
  ASSERT_TRUE(wait_until([&] { return command.out().find(" running") != std::string::npos; })) << command.err();
  command.send(SIGINT);
  const CommandResult result = command.wait();
  EXPECT_EQ(result.code, 130) << result.err;
  const CommandResult replayed = slewring({"replay", work_.recording().string(), "--verify"});
  EXPECT_EQ(replayed.code, 0) << replayed.out << replayed.err;
}

}  // namespace in_process_test
}  // namespace slew::testing
