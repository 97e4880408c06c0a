// SPDX-License-Identifier: Apache-2.0
// Loops that are closed from outside in lockstep: the same bits in every run, and the faults of a controller that never
// comes, dies or is too late.
#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <sstream>
#include <thread>

#include "build_paths.h"
#include "direct_chain.h"
#include "example_programs.h"
#include "namespaces.h"
#include "session.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace lockstep_controller_test {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

// two loops with delays of their own; from at rest, so that nothing but the controllers moves the machine
// (controllers too slow for controller_wait are in LockstepFault: these tests must not be)
std::vector<std::string> lockstep_arguments(const char* pace, const char* duration) {
  return {"--pace",     pace,
          "--duration", duration,
          "--input",    "none",
          "--set",      "Input_Lift.controller=lockstep",
          "--set",      "Input_Lift.controller_delay=2",
          "--set",      "Input_Lift.controller_wait=4 s",
          "--set",      "Input_Slew.controller=lockstep",
          "--set",      "Input_Slew.controller_wait=4 s",
          "--set",      "recording.every=1"};
}

class Burners {
 public:
  explicit Burners(unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      threads_.emplace_back([this] {
        volatile std::uint64_t work = 0;
        while (!is_done_.load(std::memory_order_relaxed)) work = work + 1;
      });
    }
  }
  ~Burners() {
    is_done_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> is_done_{false};
  std::vector<std::thread> threads_;
};

// Where a controller runs: in front of its program, and its own arguments.
struct Place {
  std::vector<std::string> command;
  std::vector<std::string> network;
};

// A controller of the examples on a session.
std::unique_ptr<Program> start_controller(const Session& session, const std::string& program, const std::string& name,
                                          const std::vector<std::string>& more, const Place& place = {}) {
  std::vector<std::string> words = place.command;
  words.insert(words.end(), {program, "--session", session.name(), "--domain", std::to_string(session.domain()),
                             "--name", name, "--seconds", "60"});
  words.insert(words.end(), place.network.begin(), place.network.end());
  words.insert(words.end(), more.begin(), more.end());
  return std::make_unique<Program>(words.front(), std::vector<std::string>(words.begin() + 1, words.end()),
                                   session.folder() / name);
}

std::string warnings_without_releases(const std::string& errors) {
  std::istringstream lines(errors);
  std::string warnings;
  for (std::string line; std::getline(lines, line);) {
    const bool is_release = line.find("has released channel") != std::string::npos;
    if (line.find("warning") != std::string::npos && !is_release) warnings += line + "\n";
  }
  return warnings;
}

struct LoopRun {
  RecordedSession recorded;
  std::string lift_words;  // output of the lifting loop
};

// One run with both loops closed by this program.
LoopRun run_loops(Session& session, const std::string& program, const Place& place = {}) {
  session.start_all();
  const auto lift = start_controller(session, program, "lift_loop",
                                     {"--target", "0.84", "--gain", "80", "--tolerance", "0.002"}, place);
  const auto slew = start_controller(
      session, program, "slew_loop",
      {"--variable", "Body_Pillar.position", "--channel", "Input_Slew", "--target", "-0.2", "--gain", "8"}, place);
  EXPECT_EQ(session.wait_all(60'000'000'000), all_ok()) << session.errors();
  EXPECT_TRUE(lift->wait().has_value());
  // a loop that has reached its target leaves, with this one message
  EXPECT_EQ(warnings_without_releases(session.errors()), "") << session.errors();
  return {session.recorded(), lift->out() + lift->err()};
}

LoopRun run_loops(const std::string& program) {
  Session session(lockstep_arguments("free", "3s"));
  return run_loops(session, program);
}

class LockstepLoop : public ::testing::TestWithParam<ExampleFolder> {};

TEST_P(LockstepLoop, GivesTheSameBitsInEveryRunUnderLoadToo) {
  const std::string program = example_program(GetParam());
  const LoopRun first_run = run_loops(program);
  const RecordedSession& first = first_run.recorded;
  ASSERT_EQ(first.problem, "");
  ASSERT_EQ(first.ticks.at(0).size(), 3001u);  // and the last one, with the END flag
  EXPECT_NE(first.ticks.at(0).at(2000).controls[0], 0) << "the slewing loop does not move";
  EXPECT_NE(first.ticks.at(0).at(300).controls[1], 0) << "the lifting loop does not move";
  EXPECT_EQ(first.ticks.at(0).at(300).age[1], 2u);
  EXPECT_EQ(first.ticks.at(0).at(300).age[0], 1u);
  EXPECT_NE(first_run.lift_words.find(": reached"), std::string::npos) << first_run.lift_words;

  const scene::Scene scene = load_scene(kScene, "3s", {"recording.every=1"});
  EXPECT_EQ(first_difference(chain_of_ticks(scene, first.ticks.at(0)), physics_only(first.chain())), "");

  // the first one had the machine to itself; these share it
  const int runs = rounds(1, 20);
  for (int i = 1; i <= runs; ++i) {
    const Burners burners(2 * std::thread::hardware_concurrency());
    const LoopRun again = run_loops(program);
    ASSERT_EQ(first_difference(again.recorded.chain(), first.chain()), "") << "run " << i;
  }
}

// the gate has the bits of both in LockstepLoops
const auto name_of = [](const auto& folder) { return std::string(folder.param.name); };
INSTANTIATE_TEST_SUITE_P(NightlyExamples, LockstepLoop, ::testing::ValuesIn(kControllerExamples), name_of);

TEST(LockstepLoops, TheLibraryAndTheExampleWithoutItGiveTheSameBits) {
  const LoopRun by_library = run_loops(example_program(kControllerExamples[0]));
  const LoopRun by_hand = run_loops(example_program(kControllerExamples[1]));
  EXPECT_EQ(first_difference(by_library.recorded.chain(), by_hand.recorded.chain()), "");
}

TEST(LockstepLoops, NightlyOverACableThatLosesPacketsGiveTheSameBits) {
  NamespacePair cable;
  if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
  const std::string program = example_program(kControllerExamples[0]);
  Session session(lockstep_arguments("free", "3s"));
  const auto network = [](const NamespacePair::Side& here, const NamespacePair::Side& there, const char* peer) {
    return std::vector<std::string>{"--interface", here.interface, peer, there.address};
  };
  for (const Role role : kAllNodes) {
    const bool is_left = role == Role::mechanics || role == Role::recorder;
    const NamespacePair::Side& here = is_left ? cable.left() : cable.right();
    std::vector<std::string> more = network(here, is_left ? cable.right() : cable.left(), "--peer");
    more.emplace_back("--insecure-lan");
    session.run_under(role, here.command(), more);
  }
  if (!cable.lose(1)) GTEST_SKIP() << "packets cannot be lost here: " << cable.problem();
  Place left{cable.left().command(), network(cable.left(), cable.right(), "--peers")};
  left.command.insert(left.command.end(), {"/usr/bin/env", "SLEWRING_INSECURE_LAN=1"});
  const LoopRun over_the_cable = run_loops(session, program, left);
  const LoopRun here = run_loops(program);
  EXPECT_EQ(first_difference(over_the_cable.recorded.chain(), here.recorded.chain()), "");
}

class LockstepFault : public ::testing::Test {
 protected:
  void SetUp() override { program_ = example_program(kControllerExamples[0]); }
  // the lift loop alone, in real pace
  static std::vector<std::string> arguments() {
    return {"--pace",     "real",
            "--duration", "30s",
            "--input",    "none",
            "--set",      "Input_Lift.controller=lockstep",
            "--set",      "Input_Lift.controller_wait=400 ms",
            "--set",      "recording.every=1"};
  }
  [[nodiscard]] std::unique_ptr<Program> lift_loop(const Session& session) const {
    // a target that it does not reach: it goes on as long as the session
    return start_controller(session, program_, "lift_loop", {"--target", "1.4"});
  }
  static void stop(Session& session) {
    EXPECT_TRUE(session.observer().request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  }
  // reasons that the recording has for a controller, in order
  static std::vector<std::string> reasons_for(const Session& session, const std::string& controller) {
    std::vector<std::string> reasons;
    for (const wire::ControllerLease& lease : session.recorded().leases) {
      if (lease.controller == controller && !lease.reason.empty()) reasons.push_back(lease.reason);
    }
    return reasons;
  }
  std::string program_;
};

TEST_F(LockstepFault, AControllerThatNeverComesEndsTheSessionByName) {
  std::vector<std::string> with_timeout = arguments();
  with_timeout.insert(with_timeout.end(), {"--join-timeout", "2"});
  Session session(with_timeout);
  session.start_all();
  const auto codes = session.wait_all();
  EXPECT_EQ(codes.at(Role::io), 1);
  EXPECT_NE(session.errors().find("no controller took channel Input_Lift within 2 s"), std::string::npos)
      << session.errors();
}

TEST_F(LockstepFault, AControllerThatIsKilledIsHeldPutToNeutralAndNamed) {
  Session session(arguments());
  session.start_all();
  const auto controller = lift_loop(session);
  ASSERT_TRUE(session.observer().wait_for_step(700)) << session.errors();
  controller->send(SIGKILL);
  const auto is_neutral = [&] { return session.observer().tick().controls[1] == 0; };
  EXPECT_GT(session.observer().tick().controls[1], 0);
  ASSERT_TRUE(session.observer().wait_until(is_neutral)) << session.errors();
  stop(session);
  const std::vector<std::string> reasons = reasons_for(session, "lift_loop");
  ASSERT_EQ(reasons.size(), 2u);
  EXPECT_NE(reasons[0].find("waited 400 ms for the value of 'lift_loop' from step"), std::string::npos) << reasons[0];
  EXPECT_EQ(reasons[1], "'lift_loop' has been out of step for 500 ms: channel Input_Lift goes to neutral");
  EXPECT_NE(session.errors().find("warning: " + reasons[1]), std::string::npos) << session.errors();
}

TEST_F(LockstepFault, AControllerThatStoodStillIsInStepAgain) {
  Session session(arguments());
  session.start_all();
  const auto controller = lift_loop(session);
  ASSERT_TRUE(session.observer().wait_for_step(300)) << session.errors();
  controller->send(SIGSTOP);
  const auto is_late = [&] { return session.observer().variable("session.late_controllers").value_or(0) > 0; };
  ASSERT_TRUE(session.observer().wait_until(is_late)) << session.errors();
  controller->send(SIGCONT);
  const auto is_back = [&] { return session.observer().variable("Input_Lift.loop_delay").value_or(0) == 1; };
  ASSERT_TRUE(session.observer().wait_until(is_back)) << session.errors();
  stop(session);
  const std::vector<std::string> reasons = reasons_for(session, "lift_loop");
  ASSERT_GE(reasons.size(), 2u);
  EXPECT_NE(reasons.back().find("'lift_loop' is in step from tick"), std::string::npos) << reasons.back();
}

}  // namespace lockstep_controller_test
}  // namespace slew::testing
