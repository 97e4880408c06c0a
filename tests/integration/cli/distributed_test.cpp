// SPDX-License-Identifier: Apache-2.0
// Sessions as processes, and the verbs that look at them and change them.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../../support/test_domain.h"
#include "command.h"
#include "sample_hashes.h"
#include "tests/support/nightly.h"
#include "transport/wire.h"

namespace slew::testing {
namespace distributed_test {

class Distributed : public ::testing::Test {
 protected:
  std::vector<std::string> with_domain(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--domain", std::to_string(domain_.number())});
    return arguments;
  }
  CommandResult slewring(const std::vector<std::string>& arguments) const {
    return run("slewring", with_domain(arguments), work_.path());
  }
  // a verb that reads a file and takes no domain
  CommandResult offline(const std::vector<std::string>& arguments) const {
    return run("slewring", arguments, work_.path());
  }
  // in `real` pace with a step that a sanitizer's build can keep
  std::unique_ptr<Command> start(const std::string& scene, std::vector<std::string> more = {}) const {
    if (std::find(more.begin(), more.end(), "--pace") == more.end()) more.insert(more.end(), {"--step", "10 ms"});
    more.insert(more.begin(), {"run", scene_file(scene)});
    return std::make_unique<Command>("slewring", with_domain(more), work_.path());
  }
  static bool is_running(const Command& command) { return command.out().find("  running") != std::string::npos; }
  static bool wait_until_running(Command& command) {
    return wait_until([&] { return is_running(command) || command.has_ended(); }) && !command.has_ended();
  }

  TestDomain domain_;
  WorkFolder work_;
};

TEST_F(Distributed, CranesHaveTheSameHashesAsInOneProcess) {
  struct Case {
    std::string name;
    std::vector<std::string> settings;
    std::size_t nodes, hashes;  // mechanics and hydraulics at every step, INIT; flex at every tenth or every step,
                                // INIT; sensors at every tenth
  };
  // so that the scripts have moved the valves
  const std::size_t steps = rounds<std::size_t>(1000, 2000), samples = steps + 1;
  std::vector<Case> cases = {{"truck_crane", {"session.exchange_every=5"}, 4, 2 * samples + 1},
                             {"truck_crane_flexible", {"session.flexible=every_step"}, 5, 3 * samples + 2},
                             {"truck_crane_segmented", {}, 4, 2 * samples + 1},
                             {"truck_crane_sensors", {}, 5, 2 * samples + 1 + steps / 10 + 1}};
  if (is_nightly()) {
    cases.insert(cases.end(),
                 {{"truck_crane", {}, 4, 2 * samples + 1},
                  {"truck_crane_flexible", {"session.flexible=once"}, 5, 2 * samples + 1 + steps / 10 + 2},
                  {"truck_crane_flexible",
                   {"session.flexible=condensed", "mechanics.integrator=trapezoidal", "mechanics.max_substep=1 ms"},
                   5,
                   3 * samples + 2}});
  }
  int number = 0;
  for (const Case& one : cases) {
    const std::string folder = std::to_string(++number);
    std::vector<std::string> how = {"run",        scene_file(one.name + ".yaml"), "--pace", "free",
                                    "--duration", std::to_string(steps) + " ms",  "--json"};
    for (const std::string& setting : one.settings) how.insert(how.end(), {"--set", setting});
    how.insert(how.end(), {"--out", folder + "_apart"});
    const CommandResult apart = slewring(how);
    ASSERT_EQ(apart.code, 0) << apart.err;
    how.back() = folder + "_together";
    how.emplace_back("--in-process");
    const CommandResult together = run("slewring", how, work_.path());
    ASSERT_EQ(together.code, 0) << together.err;
    const SampleHashes hashes = sample_hashes(only_recording_below(work_.path() / (folder + "_apart")));
    EXPECT_EQ(hashes.size(), one.hashes) << "case " << folder;
    EXPECT_EQ(hashes, sample_hashes(only_recording_below(work_.path() / (folder + "_together")))) << "case " << folder;
    const nlohmann::json report = nlohmann::json::parse(apart.out);
    EXPECT_EQ(report.at("lost"), "none");
    EXPECT_EQ(report.at("nodes").size(), one.nodes);
  }
}

TEST_F(Distributed, NightlyOfTwoRunsOfOneNameStartedTogetherOneStays) {
  const auto first = start("first_steps.yaml", {"--session", "twin", "--pace", "free", "--out", "first"});
  const auto second = start("first_steps.yaml", {"--session", "twin", "--pace", "free", "--out", "second"});
  const CommandResult a = first->wait(), b = second->wait();
  EXPECT_EQ(std::minmax(a.code, b.code), std::minmax(0, 2)) << a.err << b.err;
  const std::string& refused = a.code == 2 ? a.err : b.err;
  EXPECT_NE(refused.find("session 'twin' is held by process"), std::string::npos) << refused;
}

TEST_F(Distributed, ARunWithoutTheNodesProgramsFailsWithCode7) {
  const std::filesystem::path alone = work_.path() / "slewring";
  std::filesystem::copy_file(program_file("slewring"), alone);
  const CommandResult result = run(alone.string(), with_domain({"run", scene_file("first_steps.yaml")}), work_.path());
  EXPECT_EQ(result.code, 7) << result.err;
  EXPECT_NE(result.err.find("build it, or install all programs together"), std::string::npos) << result.err;
}

TEST_F(Distributed, ANodeThatCannotBeginGivesTheRunItsCode) {
  std::filesystem::copy_file(program_file("slewring"), work_.path() / "slewring");
  for (const char* node : {"io_node", "hydraulics_node", "recorder_node"}) {
    std::filesystem::create_symlink(program_file(node), work_.path() / node);
  }
  const std::filesystem::path broken = work_.path() / "mechanics_node";
  std::ofstream(broken) << "#!/bin/sh\nsleep 1\necho 'mechanics_node: nothing works here' >&2\nexit 7\n";
  std::filesystem::permissions(broken, std::filesystem::perms::owner_all);
  const CommandResult result = run((work_.path() / "slewring").string(),
                                   with_domain({"run", scene_file("truck_crane.yaml"), "--quiet"}), work_.path());
  EXPECT_EQ(result.code, 7) << result.err;
  EXPECT_NE(result.err.find("mechanics_node: nothing works here"), std::string::npos) << result.err;
}

TEST_F(Distributed, VerbsLookAtAndChangeARunningSession) {
  const auto session = start("truck_crane.yaml", {"--duration", "0", "--session", "seen"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();

  const nlohmann::json sessions = nlohmann::json::parse(slewring({"sessions", "--json"}).out);
  ASSERT_EQ(sessions.size(), 1u);
  EXPECT_EQ(sessions.at(0).at("name"), "seen");
  EXPECT_EQ(sessions.at(0).at("nodes").size(), 4u);

  const nlohmann::json topics = nlohmann::json::parse(slewring({"topics", "--time", "0.5", "--json"}).out).at("topics");
  ASSERT_EQ(topics.size(), wire::kTopics);
  for (const nlohmann::json& topic : topics) {
    const auto name = topic.at("topic").get<std::string>();
    if (name == "slewring/tick") {
      EXPECT_GT(topic.at("rate"), 0);
      EXPECT_EQ(topic.at("writers"), 1);
      EXPECT_EQ(topic.at("written_by"), "io");
      EXPECT_EQ(topic.at("read_by"), "mechanics, hydraulics, recorder");
    } else if (name == "slewring/controller_input") {
      EXPECT_EQ(topic.at("rate"), 0);
      EXPECT_TRUE(topic.at("size").is_null());
      EXPECT_EQ(topic.at("written_by"), "observer, controller");
    }
  }

  // without --session: the only one
  const CommandResult watched = slewring({"watch", "Cyl_*.force", "--count", "2", "--json"});
  ASSERT_EQ(watched.code, 0) << watched.err;
  EXPECT_TRUE(
      nlohmann::json::parse(watched.out.substr(0, watched.out.find('\n'))).at("values").contains("Cyl_Jib.force"));
  const CommandResult typo = slewring({"watch", "Cyl_Lft.force"});
  EXPECT_EQ(typo.code, 2);
  EXPECT_NE(typo.err.find("did you mean 'Cyl_Lift.force'?"), std::string::npos) << typo.err;
  EXPECT_NE(slewring({"variables"}).out.find("Bag.position.y"), std::string::npos);

  const CommandResult set = slewring({"param", "set", "Bag.mass=1500kg", "--over", "0.1 s"});
  EXPECT_EQ(set.code, 0) << set.err;
  EXPECT_TRUE(set.out.starts_with("accepted(")) << set.out;
  const auto present = [this](const char* path) {
    const CommandResult got = slewring({"param", "get", path, "--json"});
    EXPECT_EQ(got.code, 0) << got.err;
    return nlohmann::json::parse(got.out);
  };
  EXPECT_TRUE(wait_until([&] { return present("Bag.mass").at("value") == 1500; }));
  EXPECT_EQ(present("Bag.mass").at("scene_value"), 500);
  EXPECT_EQ(present("Cyl_Lift.piston_diameter").at("value"), 0.2);
  const CommandResult listed = slewring({"param", "list", "Bag.mass", "MainPump.set_pressure"});
  EXPECT_NE(listed.out.find("1500 kg  500 kg"), std::string::npos) << listed.out;
  EXPECT_NE(listed.out.find("25 bar"), std::string::npos) << listed.out;
  EXPECT_EQ(slewring({"param", "set", "Bag.mass=-1"}).code, 2);
  // a program that reads the answer has one of a refusal too
  for (const char* const refused : {"Bag.mass=-1", "Cyl_Lift.piston_diameter=1", "Nothing.mass=1"}) {
    const CommandResult json = slewring({"param", "set", refused, "--json"});
    EXPECT_EQ(json.code, 2) << refused;
    const nlohmann::json answer = nlohmann::json::parse(json.out);
    EXPECT_FALSE(answer.at("accepted").get<bool>()) << refused;
    EXPECT_NE(answer.at("reason").get<std::string>(), "") << refused;
  }
  const CommandResult absent = slewring({"control", "load", "no_such.saved"});
  EXPECT_EQ(absent.code, 2);
  EXPECT_NE(absent.err.find("nothing was done"), std::string::npos) << absent.err;
  EXPECT_EQ(absent.err.find("started"), std::string::npos) << absent.err;
  EXPECT_EQ(slewring({"param", "set", "Cyl_Lift.piston_diameter=1"}).code, 2);

  const CommandResult early = slewring({"control", "step"});
  EXPECT_EQ(early.code, 2) << early.err;
  EXPECT_NE(early.err.find("pause the session first"), std::string::npos) << early.err;
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"pause"}, {"step", "10"}, {"resume"}, {"stop", "--session", "seen"}}) {
    std::vector<std::string> arguments = {"control"};
    arguments.insert(arguments.end(), command.begin(), command.end());
    const CommandResult answered = slewring(arguments);
    EXPECT_EQ(answered.code, 0) << command[0] << answered.err;
    EXPECT_TRUE(answered.out.starts_with("accepted(")) << answered.out;
    if (command[0] != "pause") continue;
    // the values of the last steps before the pause
    const CommandResult paused = slewring({"watch", "Bag.position.y", "--count", "1", "--json"});
    ASSERT_EQ(paused.code, 0) << paused.err;
    EXPECT_TRUE(nlohmann::json::parse(paused.out).at("values").at("Bag.position.y").is_number()) << paused.out;
  }
  const CommandResult result = session->wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(offline({"replay", work_.recording().string(), "--verify"}).code, 0);
}

TEST_F(Distributed, APauseIsNeitherRunningTimeNorSlip) {
  const auto session = start("truck_crane.yaml", {"--duration", "0", "--json"});
  const auto code_of = [this](std::vector<std::string> arguments) { return slewring(arguments).code; };
  ASSERT_TRUE(wait_until([&] { return code_of({"control", "pause"}) == 0; })) << session->err();
  EXPECT_EQ(code_of({"sessions", "--time", "4"}), 0);  // four seconds of pause, at least
  EXPECT_EQ(code_of({"control", "resume"}), 0);
  EXPECT_EQ(code_of({"watch", "Bag.position.y", "--count", "2"}), 0);
  EXPECT_EQ(code_of({"control", "stop"}), 0);
  const CommandResult result = session->wait();
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json report = nlohmann::json::parse(result.out);
  const double paused = report.at("paused_time");
  EXPECT_GT(paused, 4);
  EXPECT_GT(report.at("wall_time"), 0);
  EXPECT_LT(report.at("slip"), paused / 2);
  for (const auto& [role, node] : report.at("nodes").items()) EXPECT_EQ(node.at("refused_messages"), 0) << role;
  const std::string info = offline({"info", work_.recording().string(), "--events"}).out;
  for (const char* event : {": pause accepted", ": resume accepted", ": stop accepted"}) {
    EXPECT_NE(info.find(event), std::string::npos) << info;
  }
}

TEST_F(Distributed, WithoutFilesOrMemoryNothingIsStarted) {
  const std::string command = program_file("slewring").string() + " run " + scene_file("truck_crane.yaml") +
                              " --duration 1 --pace free --quiet --domain " + std::to_string(domain_.number());
  std::vector<std::pair<const char*, const char*>> limits = {{"ulimit -n 12; ", "more files"}};
  // a sanitizer reserves more than any machine has
  if (sanitizers().empty()) limits.emplace_back("ulimit -v 160000; ", "more memory");
  for (const auto& [limit, what] : limits) {
    const CommandResult result = run("/bin/bash", {"-c", limit + command}, work_.path());
    EXPECT_EQ(result.code, 7) << limit << result.out << result.err;
    EXPECT_NE(result.err.find(what), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("nothing was started"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(work_.path() / "runs")) << limit;
  }
}

TEST_F(Distributed, AFailedStartPrintsItsReasonAndNothingElse) {
  const CommandResult result = slewring({"run", scene_file("first_steps.yaml"), "--remote", "recorder", "--quiet",
                                         "--out", "runs", "--join-timeout", "4"});
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(result.err.starts_with("io_node: JOIN did not come about within 4 s: no recorder node")) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST_F(Distributed, ResetIsRecordedAndReplayed) {
  const auto session = start("truck_crane.yaml", {"--duration", "0"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  EXPECT_EQ(slewring({"control", "reset"}).code, 0);
  EXPECT_EQ(slewring({"watch", "Bag.position.y", "--count", "2"}).code, 0);
  EXPECT_EQ(slewring({"control", "stop"}).code, 0);
  EXPECT_EQ(session->wait().code, 0);
  const CommandResult replayed = offline({"replay", work_.recording().string(), "--verify", "--json"});
  EXPECT_EQ(replayed.code, 0) << replayed.out << replayed.err;
  EXPECT_EQ(nlohmann::json::parse(replayed.out).at("epochs"), 2);
  // no table of inputs goes over the return to the start
  const CommandResult table = offline({"export", work_.recording().string(), "--input"});
  EXPECT_EQ(table.code, 2) << table.out;
  EXPECT_EQ(table.out, "");
  EXPECT_NE(table.err.find("epoch 1 from "), std::string::npos) << table.err;
  // a state of each epoch
  for (const char* const epoch : {"0", "1"}) {
    const std::string saved = (work_.path() / (std::string("epoch") + epoch + ".saved")).string();
    const CommandResult until =
        offline({"replay", work_.recording().string(), "--until", "4 ms", "--epoch", epoch, "--save", saved});
    EXPECT_EQ(until.code, 0) << until.err;
  }
  EXPECT_EQ(offline({"replay", work_.recording().string(), "--until", "4 ms", "--epoch", "7", "--save", "x"}).code, 2);
}

// Ranges, flags, times and plots come from what was seen and what the recorder counted; a reader of the whole recording
// finds the same.
TEST_F(Distributed, TheSummaryIsThatOfTheRecordingWithoutReadingIt) {
  using nlohmann::json;
  const CommandResult result = slewring({"run", scene_file("truck_crane.yaml"), "--pace", "free", "--duration", "4 s",
                                         "--set", "hydraulics.substep_budget=2", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  const json summary = json::parse(result.out);
  EXPECT_FALSE(summary.at("read_back").get<bool>());
  EXPECT_EQ(summary.at("steps"), 4000);
  const std::string recording = summary.at("recording");
  // flags
  const json info = json::parse(offline({"info", recording, "--json"}).out);
  ASSERT_FALSE(info.at("notes").empty()) << "sub-steps that were accepted with their error";
  for (const json& note : info.at("notes")) {
    EXPECT_NE(std::find(summary.at("notes").begin(), summary.at("notes").end(), note), summary.at("notes").end())
        << note;
  }
  // ranges
  ASSERT_GT(summary.at("variables").size(), 3u);
  for (const auto& [name, range] : summary.at("variables").items()) {
    std::istringstream table(offline({"export", recording, name}).out);
    std::string line;
    std::getline(table, line);
    double least = HUGE_VAL, most = -HUGE_VAL, last = 0;
    while (std::getline(table, line)) {
      last = std::stod(line.substr(line.find(',') + 1));
      least = std::min(least, last);
      most = std::max(most, last);
    }
    EXPECT_EQ(range.at("min").get<double>(), least) << name;
    EXPECT_EQ(range.at("max").get<double>(), most) << name;
    EXPECT_EQ(range.at("last").get<double>(), last) << name;
  }
  // plots
  const auto text_of = [this](const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(work_.path() / path).rdbuf();
    return text.str();
  };
  const std::string plots = summary.at("plots");
  const std::string drawn = text_of(plots);
  EXPECT_GT(drawn.size(), 1000u);
  ASSERT_EQ(offline({"plot", recording}).code, 0);
  EXPECT_EQ(text_of(plots), drawn);
}

// What the run's process did not get it reads in the recording.
TEST_F(Distributed, TheSummaryOfASessionThatWasResetIsReadInTheRecording) {
  const auto command = start("truck_crane.yaml", {"--duration", "60 s", "--json", "--pace", "real"});
  ASSERT_TRUE(wait_until([&] { return slewring({"control", "reset"}).code == 0 || command->has_ended(); }));
  EXPECT_EQ(slewring({"control", "stop"}).code, 0);
  const CommandResult result = command->wait();
  const nlohmann::json summary = nlohmann::json::parse(result.out);
  EXPECT_TRUE(summary.at("read_back").get<bool>());
  EXPECT_GT(summary.at("variables").size(), 3u);
}

TEST_F(Distributed, ASecondSessionOfTheNameIsRefusedNamingTheFirst) {
  const auto first = start("truck_crane.yaml", {"--duration", "0", "--session", "one"});
  ASSERT_TRUE(wait_until_running(*first)) << first->err();
  const CommandResult second = slewring({"run", scene_file("first_steps.yaml"), "--session", "one"});
  EXPECT_EQ(second.code, 2);
  EXPECT_NE(second.err.find("session 'one' is held by process "), std::string::npos) << second.err;
  EXPECT_FALSE(first->has_ended());
  first->send(SIGTERM);
  EXPECT_EQ(first->wait().code, 143);
}

TEST_F(Distributed, CtrlCEndsInOrderWithAValidRecording) {
  const auto session = start("truck_crane.yaml", {"--duration", "0"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  session->send(SIGINT);
  const CommandResult result = session->wait();
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_EQ(offline({"replay", work_.recording().string(), "--verify"}).code, 0);
  const std::string end = "closed in order; the session ended with code 130: interrupted by SIGINT";
  EXPECT_NE(offline({"info", work_.recording().string()}).out.find(end), std::string::npos);
}

// a terminal that is closed, timeout(1), a key that repeats
TEST_F(Distributed, SignalsThatComeTwiceEndInOrderToo) {
  std::vector<std::vector<int>> all = {{SIGTERM, SIGTERM, SIGHUP}, {SIGINT, SIGINT}};
  if (is_nightly()) all.insert(all.end(), {{SIGHUP, SIGHUP}, {SIGHUP, SIGTERM}});
  for (const std::vector<int>& signals : all) {
    const std::string which = std::to_string(&signals - all.data());
    SCOPED_TRACE("case " + which);
    const auto session = start("truck_crane.yaml", {"--duration", "0", "--out", "runs_" + which});
    ASSERT_TRUE(wait_until_running(*session)) << session->err();
    for (const int signal : signals) session->send(signal);
    const CommandResult result = session->wait();
    const std::string code = signals[0] == SIGINT ? "130" : "143";
    EXPECT_EQ(std::to_string(result.code), code) << result.err;
    EXPECT_EQ(result.err.find("killed"), std::string::npos) << result.err;
    const std::string recording = only_recording_below(work_.path() / ("runs_" + which)).string();
    EXPECT_NE(offline({"info", recording}).out.find("closed in order; the session ended with code " + code),
              std::string::npos);
    EXPECT_EQ(offline({"replay", recording, "--verify"}).code, 0);
  }
}

// a disk that confirms the recording only after this number of seconds
class SlowDisk : public Distributed {
 protected:
  void SetUp() override {
    if (!sanitizers().empty()) GTEST_SKIP() << "the sanitizer wants to be loaded first";
  }
  std::unique_ptr<Command> start_with(const std::string& name, int seconds, const std::string& duration = "0.2") const {
    return std::make_unique<Command>(
        "/usr/bin/env",
        with_domain({"LD_PRELOAD=" SLEWRING_SLOW_DISK, "SLEWRING_SLOW_DISK=" + std::to_string(seconds),
                     program_file("slewring").string(), "run", scene_file("first_steps.yaml"), "--pace", "free",
                     "--duration", duration, "--session", name, "--out", name}),
        work_.path());
  }
  [[nodiscard]] static bool comes_to_print(const Command& session, const std::string& words) {
    return wait_until([&] { return session.err().find(words) != std::string::npos; });
  }
  void expect_whole_recording(const std::string& name) const {
    const CommandResult info = offline({"info", only_recording_below(work_.path() / name).string()});
    EXPECT_NE(info.out.find("closed in order"), std::string::npos) << info.out;
  }
};

// four sessions at once, since each of them waits for its disk
TEST_F(SlowDisk, NightlyIsWaitedForWhenTheSessionIsOverUntilCtrlCEndsTheWait) {
  const auto left_alone = start_with("left_alone", 8);
  const auto ended = start_with("ended", 8);
  const auto interrupted = start_with("interrupted", 600);
  const auto interrupted_twice = start_with("interrupted_twice", 600, "0");
  ASSERT_TRUE(wait_until_running(*interrupted_twice)) << interrupted_twice->err();
  interrupted_twice->send(SIGINT);

  // a TERM and a hangup change nothing
  ASSERT_TRUE(comes_to_print(*ended, "still writes")) << ended->err();
  for (const int signal : {SIGTERM, SIGHUP, SIGTERM}) ended->send(signal);
  CommandResult result = ended->wait();
  EXPECT_EQ(result.code, 143) << result.err;
  EXPECT_EQ(result.err.find("killed"), std::string::npos) << result.err;
  expect_whole_recording("ended");

  result = left_alone->wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("still writes to a slow disk; Ctrl-C ends it"), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("killed"), std::string::npos) << result.err;
  expect_whole_recording("left_alone");

  ASSERT_TRUE(comes_to_print(*interrupted, "still writes")) << interrupted->err();
  interrupted->send(SIGINT);
  result = interrupted->wait();
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_NE(result.err.find("was killed while it wrote; 'slewring recover' makes the recording whole"),
            std::string::npos)
      << result.err;

  // the first of two Ctrl-C ends the session
  ASSERT_TRUE(comes_to_print(*interrupted_twice, "still writes")) << interrupted_twice->err();
  EXPECT_EQ(interrupted_twice->err().find("killed"), std::string::npos) << interrupted_twice->err();
  interrupted_twice->send(SIGINT);
  result = interrupted_twice->wait();
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_NE(result.err.find("was killed while it wrote"), std::string::npos) << result.err;
}

// The loop of a recorder that closes its file stands still, and others would give it up after 3 s. The disk has to fail
// long before the session ends: the message after the session's end is another one.
TEST_F(SlowDisk, NightlyThatTakesLongToCloseAFileInMidSessionEndsNothing) {
  const CommandResult result =
      run("/bin/bash",
          {"-c", "ulimit -f 1000; LD_PRELOAD=" SLEWRING_SLOW_DISK " SLEWRING_SLOW_DISK=5 exec " +
                     program_file("slewring").string() + " run " + scene_file("truck_crane.yaml") +
                     " --pace free --duration 20 --quiet --domain " + std::to_string(domain_.number())},
          work_.path());
  EXPECT_EQ(result.code, 6) << result.err;
  EXPECT_NE(result.err.find("; the session goes on without its recording and ends with code 6"), std::string::npos)
      << result.err;
  EXPECT_EQ(result.err.find("stood still"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("20 s simulated in "), std::string::npos) << result.out;
}

TEST_F(Distributed, CtrlCBeforeTheFirstStepIsOrderlyToo) {
  // moments of the start: nothing yet, processes, JOIN, INIT
  for (const char* sign : {"", "waiting for the session", "starting"}) {
    const auto session = start("truck_crane.yaml", {"--duration", "0", "--out", std::string("runs_") + sign});
    ASSERT_TRUE(wait_until([&] {
      return is_running(*session) || session->out().find(sign) != std::string::npos || session->has_ended();
    }));
    session->send(SIGINT);
    const CommandResult result = session->wait();
    EXPECT_TRUE(result.code == 130 || result.code == -SIGINT) << result.code << result.err;
    EXPECT_EQ(result.err.find("killed"), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find("no variable"), std::string::npos) << result.err;
  }
}

TEST_F(Distributed, AKilledNodeIsNamedAndTheRecordingStaysValid) {
  std::vector<const char*> nodes = {"io_node"};
  if (is_nightly()) nodes.push_back("mechanics_node");
  for (const char* node : nodes) {
    const std::string folder = std::string("runs_") + node;
    const auto session = start("truck_crane.yaml", {"--duration", "0", "--out", folder});
    ASSERT_TRUE(wait_until_running(*session)) << session->err();
    const pid_t pid = child_of(session->pid(), node);
    ASSERT_GT(pid, 0) << node;
    kill(pid, SIGKILL);
    const CommandResult result = session->wait();
    EXPECT_EQ(result.code, 4) << result.err;
    const std::string role = std::string(node).substr(0, std::string(node).find('_'));
    EXPECT_NE(result.err.find("the " + role + " node (process " + std::to_string(pid) + ") was killed by signal 9"),
              std::string::npos)
        << result.err;
    const CommandResult replayed = offline({"replay", only_recording_below(work_.path() / folder).string(), "--json"});
    EXPECT_EQ(nlohmann::json::parse(replayed.out).at("different"), 0) << replayed.err;
  }
}

TEST_F(Distributed, ANodeThatDiesForTheFourthTimeEndsTheSessionAndItsRecordingWithCode4) {
  const auto session = start("truck_crane.yaml", {"--duration", "0", "--set", "session.rejoin=2s", "--session", "r"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  ASSERT_EQ(slewring({"watch", "Bag.position.y", "--count", "5"}).code, 0);  // a checkpoint has come
  pid_t last = 0;
  for (int death = 0; death < 4; ++death) {
    const auto comebacks = [&] {
      int count = 0;
      const std::string sentence = session->err(), sign = " goes on in the place of ";
      for (std::size_t at = sentence.find(sign); at != std::string::npos; at = sentence.find(sign, at + 1)) ++count;
      return count;
    };
    ASSERT_TRUE(wait_until([&] { return comebacks() == death || session->has_ended(); })) << session->err();
    const pid_t pid = child_of(session->pid(), "mechanics_node");
    ASSERT_GT(pid, 0) << session->err();
    ASSERT_NE(pid, last);
    kill(pid, SIGKILL);
    last = pid;
  }
  const CommandResult result = session->wait();
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_NE(result.err.find("checkpoint (3 of 3)"), std::string::npos) << result.err;
  const std::string killed =
      "the mechanics node (process " + std::to_string(last) + ") was killed by signal 9 (Killed); ";
  EXPECT_NE(result.err.find(killed +
                            "it was started again 3 times and will not be started any more; the others hold "
                            "for 2 s for another process, started with 'slewring node mechanics --session r', and then "
                            "end with code 4 and close the recording"),
            std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("is gone, and no other process took its place within 2 s"), std::string::npos)
      << result.err;
  EXPECT_EQ(result.err.find("does not end"), std::string::npos) << result.err;
  const std::string info = offline({"info", work_.recording().string()}).out;
  EXPECT_NE(info.find("closed in order; the session ended with code 4: mechanics"), std::string::npos) << info;
}

TEST_F(Distributed, ANodeThatCannotBeStartedAgainLeavesItsPlaceHeld) {
  if (!can_run_without_files()) GTEST_SKIP() << "a sanitizer cannot do without files";
  const auto session = start("truck_crane.yaml", {"--duration", "0", "--set", "session.rejoin=60s", "--session", "r"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  ASSERT_EQ(slewring({"watch", "Bag.position.y", "--count", "5"}).code, 0);  // a checkpoint has come
  // no pipe can be had from now on
  rlimit before{}, none{};
  ASSERT_EQ(prlimit(session->pid(), RLIMIT_NOFILE, nullptr, &before), 0);
  none = {STDERR_FILENO + 1, before.rlim_max};
  ASSERT_EQ(prlimit(session->pid(), RLIMIT_NOFILE, &none, nullptr), 0);
  kill(child_of(session->pid(), "mechanics_node"), SIGKILL);
  const auto has_printed = [&](const char* text) { return session->err().find(text) != std::string::npos; };
  EXPECT_TRUE(wait_until([&] { return has_printed("slewring: no pipe for mechanics (") || session->has_ended(); }));
  EXPECT_TRUE(
      has_printed("; it is not started; close other programs; the others hold, and it is tried again until one comes"))
      << session->err();
  ASSERT_FALSE(session->has_ended()) << session->err();
  ASSERT_EQ(prlimit(session->pid(), RLIMIT_NOFILE, &before, nullptr), 0);
  EXPECT_TRUE(wait_until([&] { return has_printed(" goes on in the place of ") || session->has_ended(); }))
      << session->err();
  EXPECT_EQ(slewring({"control", "stop"}).code, 0);
  EXPECT_EQ(session->wait().code, 0) << session->err();
  EXPECT_EQ(offline({"replay", work_.recording().string(), "--verify"}).code, 0);
}

TEST_F(Distributed, ANodeWhoseProgramIsGoneEndsTheSessionAtTheEndOfTheHold) {
  std::filesystem::copy_file(program_file("slewring"), work_.path() / "slewring");
  for (const char* node : {"io_node", "mechanics_node", "hydraulics_node", "recorder_node"}) {
    std::filesystem::create_symlink(program_file(node), work_.path() / node);
  }
  Command session((work_.path() / "slewring").string(),
                  with_domain({"run", scene_file("truck_crane.yaml"), "--duration", "0", "--step", "10 ms", "--set",
                               "session.rejoin=4s", "--session", "r"}),
                  work_.path());
  ASSERT_TRUE(wait_until_running(session)) << session.err();
  ASSERT_EQ(slewring({"watch", "Bag.position.y", "--count", "5"}).code, 0);  // a checkpoint has come
  const pid_t pid = child_of(session.pid(), "mechanics_node");
  ASSERT_GT(pid, 0);
  std::filesystem::remove(work_.path() / "mechanics_node");
  kill(pid, SIGKILL);
  const CommandResult result = session.wait();
  EXPECT_EQ(result.code, 4) << result.err;
  for (const char* sentence :
       {") exited with code 7; the others hold, and it is started again with the state of its last checkpoint (3 of 3)",
        ") exited with code 7; it was started again 3 times and will not be started any more; the others hold for 4 s "
        "for "
        "another process, started with 'slewring node mechanics --session r'",
        "is gone, and no other process took its place within 4 s",
        "/mechanics_node: No such file or directory; build"}) {
    EXPECT_NE(result.err.find(sentence), std::string::npos) << sentence << "\n" << result.err;
  }
  const std::string info = offline({"info", work_.recording().string()}).out;
  EXPECT_NE(info.find("closed in order; the session ended with code 4: mechanics"), std::string::npos) << info;
}

TEST_F(Distributed, NodesDieWithTheirSupervisor) {
  const auto session = start("truck_crane.yaml", {"--duration", "0"});
  ASSERT_TRUE(wait_until_running(*session)) << session->err();
  std::vector<pid_t> nodes;
  for (const char* node : {"io_node", "mechanics_node", "hydraulics_node", "recorder_node"}) {
    nodes.push_back(child_of(session->pid(), node));
    ASSERT_GT(nodes.back(), 0) << node;
  }
  session->send(SIGKILL);
  EXPECT_EQ(session->wait().code, -SIGKILL);
  for (const pid_t node : nodes) EXPECT_TRUE(wait_until([&] { return kill(node, 0) != 0; }, 20)) << node;
}

TEST_F(Distributed, ARemoteRoleIsLeftToOthers) {
  const auto session =
      start("truck_crane.yaml", {"--duration", "1", "--pace", "free", "--session", "split", "--remote", "hydraulics"});
  EXPECT_TRUE(wait_until([&] { return child_of(session->pid(), "mechanics_node") > 0; }));
  EXPECT_EQ(child_of(session->pid(), "hydraulics_node"), 0);
  const CommandResult node = slewring({"node", "hydraulics", "--session", "split"});
  EXPECT_EQ(node.code, 0) << node.err;
  const CommandResult result = session->wait();
  EXPECT_EQ(result.code, 0) << result.err;
}

TEST_F(Distributed, NodesAndControllersAreWaitedForUntilTheJoinTimeout) {
  const auto with = [&](std::vector<std::string> arguments, const char* seconds, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), {"--pace", "free", "--quiet", "--join-timeout", seconds});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return slewring(arguments);
  };
  const std::vector<std::string> lockstep = {"--set", "Input_Lift.controller=lockstep"};
  const std::vector<std::string> crane = {"run", scene_file("truck_crane.yaml"), "--duration", "1s"};
  // long enough for the nodes, which come
  CommandResult result = with(crane, "3", lockstep);
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("no controller took channel Input_Lift within 3 s"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("(--join-timeout waits longer)"), std::string::npos) << result.err;
  result = with(crane, "1", {"--remote", "hydraulics"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("did not come about within 1 s"), std::string::npos) << result.err;
  EXPECT_EQ(with(crane, "1", {"--in-process"}).code, 2);
  // behind a recording
  const std::string runs = (work_.path() / "recorded").string();
  ASSERT_EQ(offline({"run", scene_file("truck_crane.yaml"), "--duration", "0.05s", "--pace", "free", "--in-process",
                     "--out", runs})
                .code,
            0);
  std::string folder;
  for (const auto& entry : std::filesystem::directory_iterator(runs)) folder = entry.path().string();
  result = with({"replay", folder, "--until", "0.02s", "--then-live"}, "3", lockstep);
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.err.find("no controller took channel Input_Lift within 3 s"), std::string::npos) << result.err;
}

TEST_F(Distributed, ASessionThatIsNotThereIsNamed) {
  // all at once: each of them looks for as long as it takes
  const auto begin = [&](const std::vector<std::string>& arguments) {
    return std::make_unique<Command>("slewring", with_domain(arguments), work_.path());
  };
  const std::unique_ptr<Command> of_absent[] = {begin({"watch", "x", "--session", "absent"}),
                                                begin({"control", "pause", "--session", "absent"})};
  const auto of_any = begin({"control", "pause"}), list = begin({"sessions"});
  for (const auto& command : of_absent) {
    const CommandResult result = command->wait();
    EXPECT_EQ(result.code, 1);
    EXPECT_NE(result.err.find("no session 'absent' was found on domain"), std::string::npos) << result.err;
  }
  EXPECT_EQ(of_any->wait().code, 1);
  EXPECT_EQ(list->wait().code, 0);
}

}  // namespace distributed_test
}  // namespace slew::testing
