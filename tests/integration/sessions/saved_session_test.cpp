// SPDX-License-Identifier: Apache-2.0
// Sessions that are saved at a step and go on from there: the same bits as if they had never stopped.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "build_paths.h"
#include "direct_chain.h"
#include "io_node/saved_session.h"
#include "node/identity.h"
#include "node/sent_cache.h"
#include "session.h"

namespace slew::testing {
namespace saved_session_test {

using wire::NodeState;
using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
constexpr const char* kDuration = "2s";
constexpr StepIndex kSteps = 2000;
constexpr std::size_t kLift = 1;  // place of Input_Lift in a tick

const HashChain& undisturbed() {
  static const HashChain chain = undisturbed_chain(kScene, kSteps);
  return chain;
}

HashChain from_step(const HashChain& chain, StepIndex step) {
  return {chain.lower_bound(step), chain.end()};
}

// The chain from a step on is that of a session in which nothing happens.
void expect_undisturbed_from(StepIndex step, const HashChain& chain) {
  EXPECT_EQ(first_difference(chain, from_step(undisturbed_chain(kScene, chain.rbegin()->first), step)), "");
}

int slewring(const std::vector<std::string>& arguments, const std::filesystem::path& output,
             std::string* errors = nullptr) {
  Program program(program_path("slewring"), arguments, output);
  const int code = program.wait(4 * kSoonNs).value_or(-1000);
  if (errors != nullptr) *errors = program.out() + program.err();
  return code;
}

// a session that was saved somewhere in its middle and has ended in order
class SavedSession : public ::testing::Test {
 protected:
  void save_in_mid_motion() {
    // as long as it takes the program that saves it
    Session session({"--pace", "real", "--duration", "0"});
    Observer& observer = session.observer();
    session.start_all();
    ASSERT_TRUE(observer.wait_for_step(500)) << session.errors();
    std::string errors;
    ASSERT_EQ(slewring({"control", "save", file(), "--session", "s", "--domain", std::to_string(session.domain())},
                       folder_.path() / "save", &errors),
              0)
        << errors << session.errors();
    EXPECT_NE(errors.find("accepted("), std::string::npos) << errors;
    ASSERT_TRUE(observer.wait_for_step(observer.step() + 200)) << session.errors();
    EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
    // to save is no disturbance
    const HashChain chain = session.recorded().chain();
    expect_undisturbed_from(kJoinStep, chain);
    ASSERT_EQ(io_node::read_saved(file(), saved_).text, "");
    EXPECT_GE(saved_.step, 500);
    EXPECT_LT(saved_.step, chain.rbegin()->first);
    EXPECT_EQ(saved_.states.size(), 3u);
  }

  // the state of a session that goes on for a second
  [[nodiscard]] std::string duration() const { return std::to_string(saved_.step + 1000) + " ms"; }

  void expect_goes_on(const std::vector<std::string>& how) {
    const std::filesystem::path runs = folder_.path() / ("runs" + std::to_string(++runs_));
    const TestDomain domain;
    std::vector<std::string> arguments = {"run",     "--from",     file(),     "--pace", "free",
                                          "--quiet", "--duration", duration(), "--out",  runs.string()};
    arguments.insert(arguments.end(), how.begin(), how.end());
    if (how.empty()) arguments.insert(arguments.end(), {"--domain", std::to_string(domain.number())});
    std::string errors;
    ASSERT_EQ(slewring(arguments, folder_.path() / "run", &errors), 0) << errors;
    const RecordedSession recorded = read_session(runs);
    EXPECT_EQ(recorded.problem, "");
    EXPECT_EQ(recorded.losses(), 0);
    EXPECT_EQ(recorded.last_complete_step(), saved_.step + 1000);
    EXPECT_EQ(recorded.chain().begin()->first, saved_.step);
    expect_undisturbed_from(saved_.step, recorded.chain());
    ASSERT_EQ(slewring({"replay", only_recording(runs).string(), "--verify"}, folder_.path() / "verify", &errors), 0)
        << errors;
  }

  [[nodiscard]] std::string file() const { return (folder_.path() / "crane.saved").string(); }

  ScratchFolder folder_;
  io_node::SavedSession saved_;
  int runs_ = 0;
};

TEST_F(SavedSession, GoesOnToTheSameBitsAndTakesChangesOfLiveParametersAlone) {
  save_in_mid_motion();
  expect_goes_on({});
  expect_goes_on({"--in-process"});

  std::string errors;
  const std::vector<std::string> from = {"run",          "--from", file(),
                                         "--in-process", "--pace", "free",
                                         "--quiet",      "--out",  (folder_.path() / "changed").string()};
  std::vector<std::string> with = from;
  with.insert(with.end(), {"--duration", duration(), "--set", "Bag.mass=1000kg"});
  ASSERT_EQ(slewring(with, folder_.path() / "run", &errors), 0) << errors;
  const RecordedSession recorded = read_session(folder_.path() / "changed");
  ASSERT_EQ(recorded.ticks.at(0).begin()->second.commands.size(), 1u);
  EXPECT_EQ(recorded.ticks.at(0).begin()->second.commands[0].path, "Bag.mass");
  const HashChain unchanged = undisturbed_chain(kScene, recorded.last_complete_step());
  EXPECT_NE(first_difference(recorded.chain(), from_step(unchanged, saved_.step)), "");
  with = from;
  with.insert(with.end(), {"--duration", duration(), "--set", "session.exchange_every=2"});
  EXPECT_EQ(slewring(with, folder_.path() / "run", &errors), 2);
  EXPECT_NE(errors.find("accepts changes of live parameters, and of the controller"), std::string::npos) << errors;
  with = from;
  with.insert(with.end(), {"--duration", "0.1s"});
  EXPECT_EQ(slewring(with, folder_.path() / "run", &errors), 2);
  EXPECT_NE(errors.find("choose a longer --duration"), std::string::npos) << errors;
  with = {"run", kScene, "--from", file()};
  EXPECT_EQ(slewring(with, folder_.path() / "run", &errors), 2);
}

TEST_F(SavedSession, IsLoadedIntoARunningSessionOfTheSceneAndIntoNoOther) {
  save_in_mid_motion();
  {
    // the controllers of an input are not part of the machine
    Session session({"--pace", "real", "--duration", "0", "--set", "Input_Lift.supervisor=boss"});
    Observer& observer = session.observer();
    session.start_all();
    ASSERT_TRUE(observer.wait_for_step(100)) << session.errors();
    ASSERT_TRUE(observer.request(wire::ControlAction::pause).is_accepted);
    std::string errors;
    ASSERT_EQ(slewring({"control", "load", file(), "--session", "s", "--domain", std::to_string(session.domain())},
                       folder_.path() / "load", &errors),
              0)
        << errors << session.errors();
    ASSERT_TRUE(observer.request(wire::ControlAction::resume).is_accepted);
    ASSERT_TRUE(observer.wait_until([&] { return observer.epoch() == 1 && observer.step() > saved_.step + 300; }));
    EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
    const RecordedSession recorded = session.recorded();
    EXPECT_EQ(recorded.problem, "");
    EXPECT_EQ(recorded.losses(), 0);
    ASSERT_EQ(recorded.epochs.size(), 2u);
    expect_undisturbed_from(saved_.step, recorded.epochs[1]);
    ASSERT_EQ(
        slewring({"replay", only_recording(session.runs()).string(), "--verify"}, folder_.path() / "verify", &errors),
        0)
        << errors;
  }
  Session other({"--pace", "real", "--duration", "20s", "--set", "Bag.mass=1000kg"});
  other.start_all();
  ASSERT_TRUE(other.observer().wait_for_step(50)) << other.errors();
  std::string errors;
  EXPECT_EQ(slewring({"control", "load", file(), "--session", "s", "--domain", std::to_string(other.domain())},
                     folder_.path() / "load", &errors),
            2);
  EXPECT_NE(errors.find("nothing was changed"), std::string::npos) << errors;
  EXPECT_NE(errors.find("Bag"), std::string::npos) << errors;
  EXPECT_NE(errors.find("mass"), std::string::npos) << errors;
  EXPECT_EQ(other.observer().epoch(), 0u);
  EXPECT_TRUE(other.observer().request(wire::ControlAction::stop).is_accepted);
  EXPECT_EQ(other.wait_all(), all_ok()) << other.errors();
}

TEST_F(SavedSession, IsMadeOfARecordingAndGoesOnLive) {
  Session session({"--pace", "free", "--duration", kDuration});
  session.start_all();
  ASSERT_EQ(session.wait_all(), all_ok()) << session.errors();
  const std::string recording = only_recording(session.runs()).string();
  std::string errors;
  ASSERT_EQ(slewring({"replay", recording, "--until", "0.8s", "--save", file()}, folder_.path() / "until", &errors), 0)
      << errors;
  ASSERT_EQ(io_node::read_saved(file(), saved_).text, "");
  EXPECT_EQ(saved_.step, 800);
  for (const io_node::SavedState& of_role : saved_.states) {
    const StepHashes& at = undisturbed().at(800);
    if (of_role.role == Role::io) continue;
    EXPECT_EQ(of_role.state.state_hash, of_role.role == Role::mechanics ? at.mechanics : at.hydraulics);
  }
  const TestDomain domain;
  const std::filesystem::path runs = folder_.path() / "live";
  ASSERT_EQ(slewring({"replay", recording, "--until", "0.8s", "--then-live", "--pace", "free", "--duration", "2s",
                      "--quiet", "--domain", std::to_string(domain.number()), "--out", runs.string()},
                     folder_.path() / "live_run", &errors),
            0)
      << errors;
  const RecordedSession live = read_session(runs);
  EXPECT_EQ(live.problem, "");
  EXPECT_EQ(live.chain().begin()->first, 800);
  EXPECT_EQ(live.last_complete_step(), 2000);
  EXPECT_EQ(live.chain().at(800).mechanics, undisturbed().at(800).mechanics);
  EXPECT_EQ(slewring({"replay", only_recording(runs).string(), "--verify"}, folder_.path() / "verify", &errors), 0)
      << errors;
  // a time that the recording does not have
  EXPECT_EQ(slewring({"replay", recording, "--until", "8s", "--then-live"}, folder_.path() / "late", &errors), 2);
  EXPECT_NE(errors.find("the recording ends before"), std::string::npos) << errors;
}

TEST_F(SavedSession, NightlyBehindARecordingIsSteeredByAController) {
  Session session({"--pace", "free", "--duration", kDuration});
  session.start_all();
  ASSERT_EQ(session.wait_all(), all_ok()) << session.errors();
  const TestDomain domain;
  const std::filesystem::path runs = folder_.path() / "live";
  Program live(program_path("slewring"),
               {"replay", only_recording(session.runs()).string(), "--until", "0.8s", "--then-live", "--pace", "real",
                "--duration", "30s", "--input", "none", "--session", "live", "--quiet", "--domain",
                std::to_string(domain.number()), "--out", runs.string()},
               folder_.path() / "live_run");
  Observer observer(domain.number(), "live");
  ASSERT_TRUE(observer.wait_for_step(800)) << live.err();
  EXPECT_GE(observer.step(), 800);
  ASSERT_TRUE(observer.acquire("a", "Input_Lift").is_granted);
  const auto is_moved = [&] {
    return observer.tick().controls.size() > kLift && observer.tick().controls[kLift] == 500;
  };
  std::uint64_t sequence = 0;
  const std::int64_t deadline_ns = monotonic_ns() + kSoonNs;
  do {
    observer.send({"live", "a", "Input_Lift", wire::ControllerAction::write, 1.0, ++sequence, observer.step()});
  } while (!observer.wait_until(is_moved, 10'000'000) && monotonic_ns() < deadline_ns);
  EXPECT_TRUE(is_moved());
  EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
  EXPECT_EQ(live.wait(), 0) << live.err();
  const std::string recording = only_recording(runs).string();
  EXPECT_EQ(read_session(recording).chain().begin()->first, 800);
  std::string errors;
  EXPECT_EQ(slewring({"replay", recording, "--verify"}, folder_.path() / "verify", &errors), 0) << errors;
}

// A state saved with a controller that every tick waits for can go on without it: the script or no controller moves the
// input.
TEST_F(SavedSession, NightlyOfALockstepControllerIsHandedOver) {
  Session session({"--pace", "free", "--duration", kDuration, "--set", "Input_Lift.controller=lockstep"});
  session.start_all();
  // a controller that takes its channel and is silent: the channel is held, then put to neutral
  ASSERT_TRUE(session.observer().acquire("a", "Input_Lift").is_granted) << session.errors();
  ASSERT_EQ(session.wait_all(), all_ok()) << session.errors();
  const std::string recording = only_recording(session.runs()).string();
  std::string errors;
  const auto replay_on = [&](const std::string& name, const std::vector<std::string>& how) {
    const std::filesystem::path runs = folder_.path() / name;
    std::vector<std::string> arguments = {"replay", recording, "--until",    "0.8s", "--then-live", "--pace",
                                          "free",   "--quiet", "--duration", "2s",   "--out",       runs.string()};
    arguments.insert(arguments.end(), how.begin(), how.end());
    ASSERT_EQ(slewring(arguments, folder_.path() / (name + "_run"), &errors), 0) << errors;
    const RecordedSession recorded = read_session(runs);
    EXPECT_EQ(recorded.problem, "");
    EXPECT_EQ(recorded.chain().begin()->first, 800);
    EXPECT_EQ(recorded.last_complete_step(), 2000);
    const bool has_moved = std::any_of(recorded.ticks.at(0).begin(), recorded.ticks.at(0).end(), [](const auto& tick) {
      return tick.second.controls.size() > kLift && tick.second.controls[kLift] != 0;
    });
    EXPECT_EQ(has_moved, name == "script");
    EXPECT_EQ(slewring({"replay", only_recording(runs).string(), "--verify"}, folder_.path() / "verify", &errors), 0)
        << errors;
  };
  const TestDomain domain;
  replay_on("script", {"--set", "Input_Lift.controller=sampled", "--input", "script", "--domain",
                       std::to_string(domain.number())});
  replay_on("no_controller", {"--set", "Input_Lift.controller=sampled", "--set", "Input_Lift.supervisor=boss",
                              "--input", "none", "--in-process"});
  // a saved state alike
  ASSERT_EQ(slewring({"replay", recording, "--until", "0.8s", "--save", file()}, folder_.path() / "save", &errors), 0)
      << errors;
  std::vector<std::string> from = {"run",          "--from",  file(),
                                   "--in-process", "--quiet", "--pace",
                                   "free",         "--out",   (folder_.path() / "from").string()};
  EXPECT_EQ(slewring(from, folder_.path() / "from_run", &errors), 2);
  EXPECT_NE(errors.find("--set Input_Lift.controller=sampled"), std::string::npos) << errors;
  from.insert(from.end(), {"--set", "Input_Lift.controller=sampled"});
  EXPECT_EQ(slewring(from, folder_.path() / "from_run", &errors), 0) << errors;
}

// A recorder that comes when the session has begun.
class LateRecording : public ::testing::Test {
 protected:
  LateRecording() {
    for (const Role role : {Role::io, Role::mechanics, Role::hydraulics}) session_.start(role);
  }

  // Starts the recorder while the session pauses, and lets it go on to its end. The recording is complete and replays.
  RecordedSession record_the_rest() {
    Observer& observer = session_.observer();
    const wire::ControlReply paused = observer.request(wire::ControlAction::pause);
    EXPECT_TRUE(paused.is_accepted);
    paused_at_ = paused.header.step;
    session_.start(Role::recorder);
    EXPECT_TRUE(observer.wait_until([&] { return observer.status(Role::recorder).has_value(); })) << session_.errors();
    EXPECT_TRUE(observer.request(wire::ControlAction::resume).is_accepted);
    EXPECT_TRUE(observer.wait_for_step(paused_at_ + 500)) << session_.errors();
    EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session_.wait_all(), all_ok()) << session_.errors();
    RecordedSession recorded = session_.recorded();
    EXPECT_EQ(recorded.problem, "");
    EXPECT_EQ(recorded.losses(), 0);
    EXPECT_GE(recorded.last_complete_step(), paused_at_ + 500);
    Program verify(program_path("slewring"), {"replay", only_recording(session_.runs()).string(), "--verify"},
                   session_.folder() / "verify");
    EXPECT_EQ(verify.wait(), 0) << verify.out() << verify.err();
    return recorded;
  }

  Session session_{{"--pace", "real", "--duration", "0", "--no-record"}};
  StepIndex paused_at_ = 0;
};

TEST_F(LateRecording, BeginsWithTheStatesOfAStepAndReplays) {
  ASSERT_TRUE(session_.observer().wait_for_step(700)) << session_.errors();
  const RecordedSession recorded = record_the_rest();
  const StepIndex begin = recorded.chain().begin()->first;
  EXPECT_GE(begin, 700);
  EXPECT_LT(begin, recorded.last_complete_step());
  expect_undisturbed_from(begin, recorded.chain());
}

TEST_F(LateRecording, OfASessionThatCanResendAllIsWhole) {
  ASSERT_TRUE(session_.observer().wait_for_step(20)) << session_.errors();
  const RecordedSession recorded = record_the_rest();
  // INIT was published before the recorder came; on a slow machine where the pause came late the recording begins with
  // states
  const StepIndex begin =
      paused_at_ < static_cast<StepIndex>(node::kSentDepth / 4) ? 0 : recorded.chain().begin()->first;
  expect_undisturbed_from(begin, recorded.chain());
}

TEST_F(LateRecording, OfASessionThatWasResetBeginsWithItsStatesToo) {
  Observer& observer = session_.observer();
  for (std::uint32_t epoch = 0; epoch < 2; ++epoch) {
    ASSERT_TRUE(observer.wait_until([&] { return observer.epoch() == epoch && observer.step() >= 100; }));
    ASSERT_TRUE(observer.request(wire::ControlAction::reset).is_accepted);
  }
  ASSERT_TRUE(observer.wait_until([&] { return observer.epoch() == 2 && observer.step() >= 600; }))
      << session_.errors();
  record_the_rest();
}

TEST_F(SavedSession, IsNeverHalfAFileAndReplacesOneOnRequestOnly) {
  Session session({"--pace", "real", "--duration", "20s"});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(50)) << session.errors();
  std::ofstream(file()) << "mine";
  std::string errors;
  const std::vector<std::string> save = {
      "control", "save", file(), "--session", "s", "--domain", std::to_string(session.domain())};
  EXPECT_EQ(slewring(save, folder_.path() / "save", &errors), 2);
  EXPECT_NE(errors.find("the file exists already; it was left as it is"), std::string::npos) << errors;
  EXPECT_EQ(std::filesystem::file_size(file()), 4u);
  // a disk that takes nothing
  std::vector<std::string> full = save;
  full[2] = "/dev/full/crane.saved";
  EXPECT_EQ(slewring(full, folder_.path() / "save", &errors), 6);
  EXPECT_NE(errors.find("cannot be saved"), std::string::npos) << errors;
  std::vector<std::string> forced = save;
  forced.emplace_back("--force");
  EXPECT_EQ(slewring(forced, folder_.path() / "save", &errors), 0) << errors;
  EXPECT_EQ(io_node::read_saved(file(), saved_).text, "");
  EXPECT_TRUE(session.observer().request(wire::ControlAction::stop).is_accepted);
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  // cut and changed files are reported
  for (const bool is_cut : {true, false}) {
    std::ifstream whole(file(), std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(whole)), {});
    if (is_cut) bytes.resize(bytes.size() / 2);
    if (!is_cut) bytes[bytes.size() / 2] ^= 1;
    const std::string bad = file() + ".bad";
    std::ofstream(bad, std::ios::binary) << bytes;
    EXPECT_EQ(slewring({"run", "--from", bad, "--in-process"}, folder_.path() / "bad", &errors), 2);
    EXPECT_NE(errors.find("is cut or damaged"), std::string::npos) << errors;
  }
  EXPECT_EQ(slewring({"run", "--from", kScene, "--in-process"}, folder_.path() / "bad", &errors), 2);
  EXPECT_NE(errors.find("is no saved session"), std::string::npos) << errors;
}

}  // namespace saved_session_test
}  // namespace slew::testing
