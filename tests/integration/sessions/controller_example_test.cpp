// SPDX-License-Identifier: Apache-2.0
// The example controllers, built as a user builds them (projects of their own), close their loop on a real session.
#include <gtest/gtest.h>

#include <csignal>

#include "build_paths.h"
#include "direct_chain.h"
#include "example_programs.h"
#include "session.h"

namespace slew::testing {
namespace controller_example_test {

using wire::Role;

// The example alone, without a session.
class ControllerExampleOptions : public ::testing::TestWithParam<ExampleFolder> {
 protected:
  void SetUp() override {
    if (is_left_out(GetParam())) GTEST_SKIP() << "fastddsgen and libfastrtps-dev are not there";
    path = example_program(GetParam());
  }
  std::unique_ptr<Program> controller(const std::vector<std::string>& arguments) {
    return std::make_unique<Program>(path, arguments, output.path() / "controller");
  }
  std::string path;
  ScratchFolder output;
};

TEST_P(ControllerExampleOptions, HelpHasAnExample) {
  const auto program = controller({"--help"});
  EXPECT_EQ(program->wait(), 0) << program->err();
  EXPECT_NE(program->out().find("usage: position_controller --session"), std::string::npos) << program->out();
  EXPECT_NE(program->out().find("Example"), std::string::npos) << program->out();
}

TEST_P(ControllerExampleOptions, WhatIsNoNumberMovesNothing) {
  for (const char* option : {"--target", "--tolerance", "--gain", "--overlap", "--seconds", "--domain"}) {
    for (const char* value : {"abc", "", "0.8m", "nan", "inf"}) {
      const auto program = controller({"--session", "absent", option, value});
      EXPECT_EQ(program->wait(), 2) << option << " '" << value << "' " << program->out();
      EXPECT_NE(program->err().find(std::string("position_controller: ") + option), std::string::npos)
          << program->err();
    }
  }
}

TEST_P(ControllerExampleOptions, WhatIsMissingOrUnknownIsNamed) {
  const struct {
    std::vector<std::string> arguments;
    const char* problem;
  } cases[] = {{{}, "--session: expected the name"},
               {{"--session"}, "--session: expected a value"},
               {{"--session", "absent", "--domain", "231"}, "--domain: expected a whole number, 0 to 230"},
               {{"--session", "absent", "--domain", "1.5"}, "--domain: expected a whole number, 0 to 230"},
               {{"--session", "absent", "--taget", "1"}, "--taget: unknown option"}};
  for (const auto& c : cases) {
    const auto program = controller(c.arguments);
    EXPECT_EQ(program->wait(), 2) << c.problem;
    EXPECT_NE(program->err().find(c.problem), std::string::npos) << program->err();
  }
}

class ControllerExample : public ::testing::TestWithParam<ExampleFolder> {
 protected:
  void SetUp() override {
    if (is_left_out(GetParam())) GTEST_SKIP() << "fastddsgen and libfastrtps-dev are not there";
    path = example_program(GetParam());
    session.start_all();
    ASSERT_TRUE(session.observer().wait_for_step(50)) << session.errors();
  }
  std::unique_ptr<Program> controller() {
    const std::vector<std::string> arguments = {
        "--session",   session.name(), "--domain",  std::to_string(session.domain()),
        "--target",    "0.84",         "--gain",    "80",
        "--tolerance", "0.002",        "--seconds", "25"};
    return std::make_unique<Program>(path, arguments, session.folder() / "controller");
  }
  void stop() {
    EXPECT_TRUE(session.observer().request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  }

  void expect_the_target_reached() {
    const std::optional<double> before = [this] {
      static_cast<void>(
          session.observer().wait_until([this] { return session.observer().variable("Cyl_Lift.stroke").has_value(); }));
      return session.observer().variable("Cyl_Lift.stroke");
    }();
    ASSERT_TRUE(before.has_value());
    EXPECT_GT(std::abs(*before - 0.84), 0.005) << "it is there before it has begun";
    const auto program = controller();
    EXPECT_EQ(program->wait(), 0) << program->out() << program->err();
    EXPECT_NE(program->out().find("reached"), std::string::npos) << program->out();
    stop();
    const RecordedSession recorded = session.recorded();
    const scene::Scene scene = load_scene(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml", "60s");
    EXPECT_EQ(first_difference(chain_of_ticks(scene, recorded.ticks.at(0)), physics_only(recorded.chain())), "");
  }

  std::string path;
  Session session{{"--pace", "real", "--duration", "60s", "--input", "none"}};
};

TEST_P(ControllerExample, ReachesItsTargetAndTheTicksReproduceTheRun) {
  expect_the_target_reached();
}

// in the gate; the other claims nightly
class FastDdsExample : public ControllerExample {};
TEST_P(FastDdsExample, ReachesItsTargetAndTheTicksReproduceTheRun) {
  expect_the_target_reached();
}

TEST_P(ControllerExample, NamesTheHolderOfTheChannelWhenItIsRefused) {
  ASSERT_TRUE(session.observer().acquire("other_controller", "Input_Lift").is_granted);
  const auto program = controller();
  EXPECT_EQ(program->wait(), 1) << program->out();
  EXPECT_NE(program->err().find("held by 'other_controller'"), std::string::npos) << program->err();
  stop();
}

TEST_P(ControllerExample, ASecondOneOfItsNameIsRefusedAndTheFirstGoesOn) {
  const auto start = [this](const std::string& output) {
    // a target that it does not reach
    const std::vector<std::string> arguments = {
        "--session", session.name(), "--domain",  std::to_string(session.domain()),
        "--target",  "1.4",          "--seconds", "60"};
    return std::make_unique<Program>(path, arguments, session.folder() / output);
  };
  const auto raw = [this] { return session.observer().variable("Input_Lift.raw").value_or(0); };
  const auto first = start("first");
  ASSERT_TRUE(session.observer().wait_until([&] { return raw() > 0; })) << first->err() << session.errors();
  const auto second = start("second");
  EXPECT_EQ(second->wait(), 1) << second->out();
  EXPECT_NE(second->err().find("is held by another process named 'position_controller'"), std::string::npos)
      << second->err();
  ASSERT_TRUE(session.observer().wait_for_step(session.observer().step() + 1000)) << session.errors();
  EXPECT_TRUE(first->is_running()) << first->err();
  EXPECT_GT(raw(), 0) << first->err() << session.errors();
  EXPECT_EQ(first->err(), "");
  stop();
}

// the gate has TheShortestOneWaitsThroughAPause
TEST_P(ControllerExample, NightlyAPauseDoesNotEndIt) {
  const std::vector<std::string> arguments = {
      "--session", session.name(), "--domain", std::to_string(session.domain()), "--target", "1.4", "--seconds", "60"};
  Program program(path, arguments, session.folder() / "controller");
  const auto raw = [this] { return session.observer().variable("Input_Lift.raw").value_or(0); };
  ASSERT_TRUE(session.observer().wait_until([&] { return raw() > 0; })) << program.err() << session.errors();
  ASSERT_TRUE(session.observer().request(wire::ControlAction::pause).is_accepted);
  // three times as long as it waits for a block
  ASSERT_TRUE(session.observer().wait_for_healths(Role::io, 30)) << session.errors();
  EXPECT_TRUE(program.is_running()) << program.err();
  ASSERT_TRUE(session.observer().request(wire::ControlAction::resume).is_accepted);
  ASSERT_TRUE(session.observer().wait_for_step(session.observer().step() + 1000)) << session.errors();
  EXPECT_TRUE(program.is_running()) << program.err();
  EXPECT_GT(raw(), 0) << program.err() << session.errors();
  stop();
}

// The other programs of the client library's example, on a session of their own.
class ClientExamples : public ::testing::Test {
 protected:
  void start(std::vector<std::string> arguments = {}) {
    arguments.insert(arguments.end(), {"--duration", "0", "--input", "none"});
    session = std::make_unique<Session>(arguments);
    Observer& observer = session->observer();
    session->start_all();
    // one that waits for its controller in every step does not step yet
    ASSERT_TRUE(observer.wait_until([&] { return !observer.descriptions().empty(); })) << session->errors();
  }
  void stop() {
    EXPECT_TRUE(session->observer().request(wire::ControlAction::stop).is_accepted);
    EXPECT_EQ(session->wait_all(), all_ok()) << session->errors();
  }
  [[nodiscard]] std::string domain() const { return std::to_string(session->domain()); }
  std::unique_ptr<Session> session;
};

TEST_F(ClientExamples, ThePidControllerStaysAtItsTarget) {
  const std::string path = example_program(kControllerExamples[0], "pid_controller");
  // every tick waits for it: how it settles does not depend on the load of the machine
  start({"--pace", "free", "--set", "Input_Lift.controller=lockstep", "--set", "Input_Lift.controller_wait=4 s"});
  Program pid(path, {"--session", session->name(), "--domain", domain(), "--target", "0.84", "--seconds", "8"},
              session->folder() / "pid");
  EXPECT_EQ(pid.wait(), 0) << pid.out() << pid.err();
  EXPECT_NE(pid.out().find(": reached"), std::string::npos) << pid.out();
  stop();
}

TEST_F(ClientExamples, TheShortestOneMovesTheCylinderAndGivesTheChannelBack) {
  const std::string path = example_program(kControllerExamples[0], "first_controller");
  start({"--pace", "real"});
  Program first(path, {session->name(), domain()}, session->folder() / "first");
  EXPECT_EQ(first.wait(), 0) << first.out() << first.err();
  EXPECT_NE(first.out().find("Cyl_Lift.stroke = 0.8"), std::string::npos) << first.out();
  EXPECT_TRUE(session->observer().acquire("other", "Input_Lift").is_granted);
  stop();
}

TEST_F(ClientExamples, TheShortestOneWaitsThroughAPauseAndCtrlCGivesTheChannelBack) {
  const std::string path = example_program(kControllerExamples[0], "first_controller");
  start({"--pace", "real"});
  Program first(path, {session->name(), domain()}, session->folder() / "first");
  const auto is_held = [&] { return session->observer().variable("Input_Lift.raw").value_or(0) == 0.5; };
  ASSERT_TRUE(session->observer().wait_until(is_held)) << first.err() << session->errors();
  ASSERT_TRUE(session->observer().request(wire::ControlAction::pause).is_accepted);
  ASSERT_TRUE(session->observer().wait_for_healths(Role::io, 25)) << session->errors();
  EXPECT_TRUE(first.is_running()) << first.out() << first.err();
  first.send(SIGINT);
  EXPECT_EQ(first.wait(), 0) << first.err();
  EXPECT_TRUE(session->observer().acquire("other", "Input_Lift").is_granted);
  stop();
}

TEST_F(ClientExamples, NightlyTheSameLoopInPython) {
  if (is_sanitized()) GTEST_SKIP() << "the interpreter cannot load a library with a sanitizer in it";
  start({"--pace", "real"});
  const std::string script = SLEWRING_SOURCE_DIR "/examples/python/position_controller.py";
  const std::string library = "SLEWRING_CLIENT=" SLEWRING_BINARY_DIR "/lib/libslewring_client.so";
  const std::vector<std::string> arguments = {library,    SLEWRING_PYTHON, script,     "--session", session->name(),
                                              "--domain", domain(),        "--target", "0.84",      "--gain",
                                              "80",       "--tolerance",   "0.002"};
  Program python("/usr/bin/env", arguments, session->folder() / "python");
  EXPECT_EQ(python.wait(), 0) << python.out() << python.err();
  EXPECT_NE(python.out().find(": reached"), std::string::npos) << python.out();

  std::vector<std::string> to_absent = arguments;
  to_absent[4] = "absent";
  to_absent.insert(to_absent.end(), {"--seconds", "1"});
  Program alone("/usr/bin/env", to_absent, session->folder() / "alone");
  EXPECT_EQ(alone.wait(), 1);
  EXPECT_NE(alone.err().find("timeout: no session 'absent' was found"), std::string::npos) << alone.err();

  ASSERT_TRUE(session->observer().acquire("other_controller", "Input_Lift").is_granted);
  Program refused("/usr/bin/env", arguments, session->folder() / "refused");
  EXPECT_EQ(refused.wait(), 1);
  EXPECT_NE(refused.err().find("refused: channel Input_Lift is held by 'other_controller'"), std::string::npos)
      << refused.err();
  stop();
}

const auto name_of = [](const auto& folder) { return std::string(folder.param.name); };
INSTANTIATE_TEST_SUITE_P(Examples, ControllerExampleOptions, ::testing::ValuesIn(kControllerExamples), name_of);
INSTANTIATE_TEST_SUITE_P(Examples, ControllerExample, ::testing::Values(kControllerExamples[0]), name_of);
INSTANTIATE_TEST_SUITE_P(Examples, FastDdsExample, ::testing::Values(kControllerExamples[2]), name_of);
INSTANTIATE_TEST_SUITE_P(NightlyExamples, ControllerExample,
                         ::testing::Values(kControllerExamples[1], kControllerExamples[2]), name_of);

}  // namespace controller_example_test
}  // namespace slew::testing
