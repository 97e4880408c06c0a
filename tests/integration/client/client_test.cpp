// SPDX-License-Identifier: Apache-2.0
// The client library against sessions of real processes: several controllers on different channels, digital inputs,
// taking over, a reset, the end, every refusal, and controllers that stand still, die or are there twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "build_paths.h"
#include "client/slewring_client.h"
#include "client/slewring_client.hpp"
#include "node/identity.h"
#include "session.h"
#include "tests/support/test_domain.h"

namespace slew::testing {
namespace client_test {

using wire::Role;

constexpr double kSoon = 20;  // s
constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

struct Leave {
  void operator()(slewring_session* session) const { slewring_leave(session); }
};
using Client = std::unique_ptr<slewring_session, Leave>;

class ClientLibrary : public ::testing::Test {
 protected:
  void start(std::vector<std::string> arguments = {}, const std::string& scene = kScene) {
    arguments.insert(arguments.end(), {"--pace", "real", "--duration", "60s", "--input", "none"});
    session = std::make_unique<Session>(arguments, scene);
    session->start_all();
  }
  [[nodiscard]] Client join(const char* controller) const {
    Client client(slewring_join(session->name().c_str(), controller, session->domain(), "lo", "", kSoon));
    EXPECT_NE(client, nullptr) << slewring_error(nullptr) << session->errors();
    return client;
  }
  // a verb of the program on this session
  void control(const std::string& verb) {
    Program program(program_path("slewring"),
                    {"control", verb, "--session", session->name(), "--domain", std::to_string(session->domain())},
                    session->folder() / ("control_" + verb));
    EXPECT_EQ(program.wait(), 0) << program.out() << program.err();
  }
  // steps until a variable has a value
  [[nodiscard]] static bool reaches(slewring_session* client, int variable, double value) {
    for (int i = 0; i < 2000; ++i) {
      if (slewring_step(client, kSoon) != SLEWRING_OK) return false;
      if (slewring_value(client, variable) == value) return true;
    }
    return false;
  }
  // a controller in a process of its own, which prints the library's results
  [[nodiscard]] std::unique_ptr<Program> start_probe(const std::string& name, const std::string& output,
                                                     const char* timeout = "20", const char* how = "acquire") const {
    const std::vector<std::string> arguments = {
        session->name(), std::to_string(session->domain()), name, "Input_Lift", timeout, how};
    return std::make_unique<Program>(program_path("client_probe"), arguments, session->folder() / output);
  }
  // reads blocks until the step, so that a test's patience is in steps of the session
  static void read_to(slewring_session* client, long long step) {
    while (slewring_present_step(client) < step) {
      ASSERT_EQ(slewring_latest(client, kSoon), SLEWRING_OK) << slewring_error(client);
    }
  }
  // reads blocks until the program has printed the words
  [[nodiscard]] static bool comes_to_print(slewring_session* client, const Program& program, const std::string& words) {
    const auto has_printed = [&] { return program.out().find(words) != std::string::npos; };
    for (int i = 0; i < 3000 && !has_printed(); ++i) {
      if (slewring_latest(client, kSoon) != SLEWRING_OK) return false;
    }
    return has_printed();
  }
  void stop() {
    session->node(Role::io).send(SIGINT);
    for (const auto& [role, code] : session->wait_all()) {
      EXPECT_TRUE(code == 130 || (code == 0 && role != Role::io)) << node::to_text(role) << session->errors();
    }
  }

  std::unique_ptr<Session> session;
};

TEST_F(ClientLibrary, LooksForNoVariableOfANodeWithAnEmptyDirectory) {
  start({"--set", "recording.variables=[Vol_*]"});  // variables of hydraulics alone
  const Client client = join("reader");
  EXPECT_GE(slewring_find(client.get(), "Vol_LiftCyl_A.pressure", kSoon), 0) << slewring_error(client.get());
  EXPECT_EQ(slewring_find(client.get(), "Bag.position.x", 3600), SLEWRING_REFUSED);
  Program variables(program_path("slewring"),
                    {"variables", "--session", session->name(), "--domain", std::to_string(session->domain())},
                    session->folder() / "variables");
  EXPECT_EQ(variables.wait(), 0) << variables.err();
  EXPECT_NE(variables.out().find("Vol_LiftCyl_A.pressure"), std::string::npos) << variables.out();
  stop();
}

TEST_F(ClientLibrary, FindsAVariableOfANodeThatPublishesItsNamesLongAfterTheOthers) {
  const TestDomain domain;
  const ScratchFolder folder;
  Program played(program_path("played_session"), {"late", std::to_string(domain.number())}, folder.path() / "played");
  const Client client(slewring_join("late", "reader", domain.number(), "lo", "", kSoon));
  ASSERT_NE(client, nullptr) << slewring_error(nullptr);
  EXPECT_GE(slewring_find(client.get(), "Input_Lift.value", kSoon), 0) << slewring_error(client.get());
  EXPECT_EQ(slewring_find(client.get(), "Bag.position.x", 0.5), SLEWRING_TIMEOUT);
  EXPECT_STREQ(
      slewring_error(client.get()),
      "session 'late' has not published all its variables within 0.5 s: 'Bag.position.x' is not among 1 so far; it "
      "is still starting, or not all of its nodes reach this process: wait longer, or see `slewring sessions`");
  played.send(SIGUSR1);
  EXPECT_GE(slewring_find(client.get(), "Bag.position.x", kSoon), 0) << slewring_error(client.get());
  EXPECT_EQ(slewring_find(client.get(), "Bag.position.y", 3600), SLEWRING_REFUSED);
  played.send(SIGTERM);
  EXPECT_EQ(played.wait(), 0);
}

TEST_F(ClientLibrary, ReadsEveryBlockInOrderWithNamesAndUnits) {
  start();
  const Client client = join("reader");
  EXPECT_DOUBLE_EQ(slewring_step_size(client.get()), 1e-3);
  const int stroke = slewring_find(client.get(), "Cyl_Lift.stroke", kSoon);
  const int slip = slewring_find(client.get(), "session.slip", kSoon);  // a variable of another node
  ASSERT_GE(stroke, 0) << slewring_error(client.get());
  ASSERT_GE(slip, 0) << slewring_error(client.get());
  EXPECT_EQ(slewring_find(client.get(), "Cyl_Lift.stroke", 0), stroke);
  EXPECT_TRUE(std::isnan(slewring_value(client.get(), stroke)));
  EXPECT_TRUE(std::isnan(slewring_value(client.get(), 77)));
  EXPECT_EQ(slewring_present_step(client.get()), -1);
  bool is_named = false;
  const int count = slewring_variable_count(client.get());
  for (int i = 0; i < count; ++i) {
    if (std::string(slewring_variable_name(client.get(), i)) != "Cyl_Lift.force") continue;
    is_named = true;
    EXPECT_STREQ(slewring_variable_unit(client.get(), i), "N");
  }
  EXPECT_TRUE(is_named);
  EXPECT_EQ(slewring_variable_name(client.get(), count), nullptr);
  EXPECT_EQ(slewring_variable_name(client.get(), -1), nullptr);
  ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
  for (int i = 0; i < 50; ++i) {
    const long long before = slewring_present_step(client.get());
    ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
    EXPECT_EQ(slewring_present_step(client.get()), before + 10);
    EXPECT_GT(slewring_value(client.get(), stroke), 0.5);
  }
  EXPECT_EQ(slewring_steps_per_block(client.get()), 10);
  EXPECT_DOUBLE_EQ(slewring_time(client.get()), static_cast<double>(slewring_present_step(client.get())) * 1e-3);
  EXPECT_EQ(slewring_blocks_missed(client.get()), 0);
  stop();
  int code = SLEWRING_OK;
  while (code == SLEWRING_OK) code = slewring_step(client.get(), kSoon);
  EXPECT_EQ(code, SLEWRING_ENDED);
  EXPECT_NE(std::string(slewring_error(client.get())).find("session 's' has ended"), std::string::npos);
}

TEST_F(ClientLibrary, TwoControllersMoveTwoChannelsOneOfThemDigital) {
  // the jib's lever as a button
  std::ifstream file(kScene);
  std::stringstream text;
  text << file.rdbuf();
  std::string scene = text.str();
  const std::string analog = "{type: analog, primitive: L90Jib";
  const std::size_t at = scene.find(analog);
  ASSERT_NE(at, std::string::npos);
  scene.replace(at, analog.size(), "{type: digital, primitive: L90Jib");
  const ScratchFolder folder;
  const std::string path = (folder.path() / "truck_crane.yaml").string();
  std::ofstream(path) << scene;
  std::filesystem::copy(SLEWRING_SOURCE_DIR "/scenes/meshes", folder.path() / "meshes");

  start({}, path);
  const Client stick = join("stick"), button = join("button");
  const int lift = slewring_acquire(stick.get(), "Input_Lift", kSoon);
  const int jib = slewring_acquire(button.get(), "Input_Jib", kSoon);
  ASSERT_GE(lift, 0) << slewring_error(stick.get());
  ASSERT_GE(jib, 0) << slewring_error(button.get());
  EXPECT_EQ(slewring_acquire(button.get(), "Input_Lift", kSoon), SLEWRING_REFUSED);
  EXPECT_NE(std::string(slewring_error(button.get())).find("is held by 'stick'"), std::string::npos)
      << slewring_error(button.get());
  const int lift_raw = slewring_find(stick.get(), "Input_Lift.raw", kSoon);
  const int jib_raw = slewring_find(button.get(), "Input_Jib.raw", kSoon);
  const auto write_until = [](slewring_session* client, int channel, double value, int variable, double wanted) {
    for (int i = 0; i < 500; ++i) {
      if (slewring_latest(client, kSoon) != SLEWRING_OK) return false;
      if (slewring_value(client, variable) == wanted) return true;
      if (slewring_write(client, channel, value) != SLEWRING_OK) return false;
    }
    return false;
  };
  EXPECT_TRUE(write_until(stick.get(), lift, 0.5, lift_raw, 0.5)) << slewring_error(stick.get());
  EXPECT_TRUE(write_until(button.get(), jib, 0.7, jib_raw, 1)) << slewring_error(button.get());
  EXPECT_TRUE(write_until(button.get(), jib, 0.3, jib_raw, 0)) << slewring_error(button.get());
  EXPECT_TRUE(write_until(stick.get(), lift, -3, lift_raw, -1)) << slewring_error(stick.get());
  EXPECT_EQ(slewring_release(stick.get(), lift), SLEWRING_OK);
  EXPECT_EQ(slewring_write(stick.get(), lift, 1), SLEWRING_LOST);
  stop();
}

TEST_F(ClientLibrary, TheSupervisorTakesOverAndTheHolderIsInformed) {
  start({"--set", "Input_Lift.supervisor=instructor"});
  const Client trainee = join("trainee"), instructor = join("instructor");
  ASSERT_EQ(slewring_step(trainee.get(), kSoon), SLEWRING_OK) << "the session runs: it can be stopped";
  const int of_trainee = slewring_acquire(trainee.get(), "Input_Lift", kSoon);
  ASSERT_GE(of_trainee, 0) << slewring_error(trainee.get());
  EXPECT_EQ(slewring_acquire(instructor.get(), "Input_Lift", kSoon), SLEWRING_REFUSED);
  const int of_instructor = slewring_take_over(instructor.get(), "Input_Lift", kSoon);
  ASSERT_GE(of_instructor, 0) << slewring_error(instructor.get());
  int code = SLEWRING_OK;
  while (code == SLEWRING_OK) code = slewring_step(trainee.get(), kSoon);
  EXPECT_EQ(code, SLEWRING_LOST);
  EXPECT_STREQ(slewring_error(trainee.get()), "'instructor' has taken over channel Input_Lift");
  EXPECT_EQ(slewring_write(trainee.get(), of_trainee, 1), SLEWRING_LOST);
  EXPECT_EQ(slewring_take_over(trainee.get(), "Input_Lift", kSoon), SLEWRING_REFUSED);
  EXPECT_STREQ(slewring_error(trainee.get()),
               "channel Input_Lift is held by 'instructor', and only 'instructor' may take it over "
               "(Input_Lift.supervisor)");
  EXPECT_EQ(slewring_write(instructor.get(), of_instructor, 0), SLEWRING_OK);
  stop();
}

// acquire() repeats its request while it is not answered, so that a refusal may arrive more than once
TEST_F(ClientLibrary, ALateAnswerToAcquireIsNoAnswerToTakeOver) {
  start({"--set", "Input_Lift.supervisor=instructor"});
  Observer& observer = session->observer();
  ASSERT_TRUE(observer.wait_for_step(1)) << session->errors();
  ASSERT_TRUE(observer.acquire("trainee", "Input_Lift").is_granted);
  const auto probe = start_probe("instructor", "instructor", "20", "take_over");
  const auto refusal = [&] {
    return std::find_if(observer.leases().begin(), observer.leases().end(),
                        [](const wire::ControllerLease& lease) { return lease.controller == "instructor"; });
  };
  const auto has_printed = [&](const char* words) { return probe->out().find(words) != std::string::npos; };
  ASSERT_TRUE(observer.wait_until([&] { return refusal() != observer.leases().end() && has_printed("refused: "); }));
  const wire::ControllerLease late = *refusal();
  session->node(Role::io).send(SIGSTOP);
  for (int i = 0; i < 20; ++i) {
    probe->send(SIGCONT);
    observer.publish(wire::Topic::controller_lease, late);
    EXPECT_FALSE(observer.wait_until([&] { return has_printed("not taken over: "); }, 20'000'000)) << probe->out();
  }
  session->node(Role::io).send(SIGCONT);
  ASSERT_TRUE(observer.wait_until([&] { return has_printed("taken over\n"); })) << probe->out();
  // nor does it take the channel away again
  observer.publish(wire::Topic::controller_lease, late);
  ASSERT_TRUE(observer.wait_for_step(observer.step() + 200)) << session->errors();
  EXPECT_EQ(observer.variable("Input_Lift.raw"), 0.375);
  EXPECT_FALSE(has_printed("lost")) << probe->out();
  stop();
}

TEST_F(ClientLibrary, WhatIsGrantedAfterItGaveUpIsGivenBack) {
  start();
  const Client hasty = join("hasty"), other = join("other");
  ASSERT_EQ(slewring_step(hasty.get(), kSoon), SLEWRING_OK) << "the session runs: it can be stopped";
  // the session receives from it
  ASSERT_GE(slewring_acquire(hasty.get(), "Input_Slew", kSoon), 0) << slewring_error(hasty.get());
  // beside other programs the answer may be there all the same
  int code = 0;
  for (int i = 0; i < 100 && code >= 0; ++i) {
    code = slewring_acquire(hasty.get(), "Input_Lift", 0);
    if (code >= 0) slewring_release(hasty.get(), code);
  }
  EXPECT_EQ(code, SLEWRING_TIMEOUT);
  EXPECT_GE(slewring_acquire(other.get(), "Input_Lift", kSoon), 0) << slewring_error(other.get());
  stop();
}

TEST_F(ClientLibrary, AfterAResetALockstepControllerAcquiresAgainAndBeginsAtStepZero) {
  start({"--set", "Input_Lift.controller=lockstep", "--set", "Input_Lift.controller_wait=4 s", "--set",
         "recording.every=1"});
  const Client client = join("pid");
  const int stroke = slewring_find(client.get(), "Cyl_Lift.stroke", kSoon);
  const int late = slewring_find(client.get(), "session.late_controllers", kSoon);
  ASSERT_GE(stroke, 0) << slewring_error(client.get());
  const auto answer = [&](int channel, long long until) {
    int code = SLEWRING_OK;
    while (code == SLEWRING_OK && slewring_present_step(client.get()) < until) {
      code = slewring_step(client.get(), kSoon);
      if (code == SLEWRING_OK) code = slewring_write(client.get(), channel, 0.5);
    }
    return code;
  };
  int lift = slewring_acquire(client.get(), "Input_Lift", kSoon);
  ASSERT_GE(lift, 0) << slewring_error(client.get());
  ASSERT_EQ(answer(lift, 0), SLEWRING_OK);
  EXPECT_EQ(slewring_present_step(client.get()), 0) << "the first block is that of step 0";
  ASSERT_EQ(answer(lift, 300), SLEWRING_OK);
  control("reset");
  ASSERT_EQ(answer(lift, 1'000'000), SLEWRING_LOST);
  EXPECT_NE(std::string(slewring_error(client.get())).find("the session was reset"), std::string::npos);
  EXPECT_EQ(slewring_present_step(client.get()), -1);
  lift = slewring_acquire(client.get(), "Input_Lift", kSoon);
  ASSERT_GE(lift, 0) << slewring_error(client.get());
  ASSERT_EQ(answer(lift, 0), SLEWRING_OK);
  EXPECT_EQ(slewring_present_step(client.get()), 0);
  ASSERT_EQ(answer(lift, 100), SLEWRING_OK);
  EXPECT_EQ(slewring_value(client.get(), late), 0);
  EXPECT_EQ(slewring_notice(client.get()), nullptr);
  stop();
}

TEST_F(ClientLibrary, WhatCannotBeIsRefusedWithASentence) {
  const TestDomain empty;
  const unsigned domain = empty.number();
  EXPECT_EQ(slewring_join_code(), SLEWRING_OK);
  EXPECT_EQ(slewring_join("absent", "pid", domain, "lo", "", 0.2), nullptr);
  EXPECT_EQ(slewring_join_code(), SLEWRING_TIMEOUT);
  EXPECT_EQ(slewring_error(nullptr),
            "no session 'absent' was found in domain " + std::to_string(domain) +
                " on lo within 0.2 s; start it first, and compare its name, domain, interface, peers and keys");
  // a caller that ignores the failure gets this sentence, and no other
  EXPECT_EQ(slewring_find(nullptr, "Cyl_Lift.stroke", 0), SLEWRING_BAD_ARGUMENT);
  EXPECT_NE(std::string(slewring_error(nullptr)).find("no session 'absent' was found"), std::string::npos);
  EXPECT_EQ(slewring_join("absent", "", domain, "lo", "", 0.2), nullptr);
  EXPECT_NE(std::string(slewring_error(nullptr)).find("is no name of a controller"), std::string::npos);
  EXPECT_EQ(slewring_join_code(), SLEWRING_BAD_ARGUMENT);
  EXPECT_EQ(slewring_join("ab*sent", "pid", domain, "lo", "", 0.2), nullptr);
  EXPECT_NE(std::string(slewring_error(nullptr)).find("is no session name"), std::string::npos);
  EXPECT_EQ(slewring_join("absent", "pid", 231, "lo", "", 0.2), nullptr);
  EXPECT_NE(std::string(slewring_error(nullptr)).find("DDS domain 231 is out of range"), std::string::npos);
  EXPECT_EQ(slewring_join_code(), SLEWRING_BAD_ARGUMENT);
  try {
    slewring::Options absent;
    absent.session = "absent";
    absent.controller = "pid";
    absent.domain = domain;
    absent.timeout = 0.2;
    const slewring::Session joined(absent);
    ADD_FAILURE() << "there is no such session";
  } catch (const slewring::Error& error) {
    EXPECT_EQ(error.code(), SLEWRING_TIMEOUT);
  }
  EXPECT_EQ(slewring_join(nullptr, nullptr, 0, nullptr, nullptr, 0), nullptr);
  EXPECT_EQ(slewring_step(nullptr, 0), SLEWRING_BAD_ARGUMENT);
  EXPECT_EQ(slewring_variable_name(nullptr, 0), nullptr);
  EXPECT_EQ(slewring_notice(nullptr), nullptr);
  slewring_leave(nullptr);

  start();
  const Client client = join("pid");
  EXPECT_EQ(slewring_find(client.get(), "Cyl_Lift.strok", kSoon), SLEWRING_REFUSED);
  EXPECT_NE(std::string(slewring_error(client.get())).find("publishes no variable 'Cyl_Lift.strok'"), std::string::npos)
      << slewring_error(client.get());
  EXPECT_EQ(slewring_acquire(client.get(), "Input_Foo", kSoon), SLEWRING_REFUSED);
  EXPECT_STREQ(slewring_error(client.get()), "the scene has no input 'Input_Foo'");
  EXPECT_EQ(slewring_acquire(client.get(), "", kSoon), SLEWRING_BAD_ARGUMENT);
  EXPECT_EQ(slewring_write(client.get(), 5, 0), SLEWRING_BAD_ARGUMENT);
  EXPECT_STREQ(slewring_error(client.get()), "5 is no handle of a channel");
  EXPECT_EQ(slewring_release(client.get(), -1), SLEWRING_BAD_ARGUMENT);
  control("pause");
  int code = SLEWRING_OK;
  while (code == SLEWRING_OK) code = slewring_step(client.get(), 0.5);
  EXPECT_EQ(code, SLEWRING_TIMEOUT);
  EXPECT_NE(std::string(slewring_error(client.get())).find("no block of variables came within 0.5 s"),
            std::string::npos)
      << slewring_error(client.get());
  control("resume");
  EXPECT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
  stop();
}

TEST_F(ClientLibrary, TheHeaderForCxxThrowsAndReleasesAtTheEnd) {
  start();
  const auto options = [this](const char* controller) {
    slewring::Options join;
    join.session = session->name();
    join.controller = controller;
    join.domain = session->domain();
    join.timeout = kSoon;
    return join;
  };
  {
    slewring::Session first(options("first"));
    static_cast<void>(first.acquire("Input_Lift"));
    slewring::Session second(options("second"));
    try {
      static_cast<void>(second.acquire("Input_Lift"));
      ADD_FAILURE() << "it was granted twice";
    } catch (const slewring::Error& error) {
      EXPECT_EQ(error.code(), SLEWRING_REFUSED);
    }
  }
  slewring::Session third(options("third"));
  const slewring::Channel lift = third.acquire("Input_Lift");
  ASSERT_TRUE(third.step());
  third.write(lift, 0);
  stop();
  while (third.step()) {
  }
}

// ---- controllers that leave, stand still, die or are there twice ----------------------------------------------

TEST_F(ClientLibrary, NoTickWaitsForAControllerThatLeavesALockstepChannelAfterReadingABlock) {
  start({"--set", "Input_Lift.controller=lockstep", "--set", "Input_Lift.controller_wait=4 s", "--set",
         "recording.every=1"});
  const Client reader = join("reader");
  const int late = slewring_find(reader.get(), "session.late_controllers", kSoon);
  ASSERT_GE(late, 0);
  {
    const Client client = join("pid");
    const int lift = slewring_acquire(client.get(), "Input_Lift", kSoon);
    ASSERT_GE(lift, 0) << slewring_error(client.get());
    while (slewring_present_step(client.get()) < 200) {
      ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
      ASSERT_EQ(slewring_write(client.get(), lift, 0.5), SLEWRING_OK) << slewring_error(client.get());
    }
    // it reads one more, finds that it is done, and leaves
    ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
  }
  read_to(reader.get(), 400);
  EXPECT_EQ(slewring_value(reader.get(), late), 0);
  const std::string errors = session->errors();
  EXPECT_EQ(errors.find("waited"), std::string::npos) << errors;
  EXPECT_NE(errors.find("warning: 'pid' has released channel Input_Lift (controller: lockstep): it is free from tick"),
            std::string::npos)
      << errors;
  stop();
}

// the gate has a standstill over a reset, and one below this time
TEST_F(ClientLibrary, NightlyAControllerThatStoodStillLongerThanItsLivelinessLeaseLosesItsChannel) {
  start();
  const Client reader = join("reader");
  const auto probe = start_probe("probe", "probe");
  ASSERT_TRUE(comes_to_print(reader.get(), *probe, "acquired")) << session->errors();
  probe->send(SIGSTOP);
  // no process receives from it for 2 s, and it has been silent for 5 s
  read_to(reader.get(), slewring_present_step(reader.get()) + 7500);
  probe->send(SIGCONT);
  EXPECT_TRUE(comes_to_print(reader.get(), *probe,
                             "lost: 'probe' does not hold channel Input_Lift: it is free; acquire it again to go on\n"
                             "acquired"))
      << probe->out() << session->errors();
  stop();
}

TEST_F(ClientLibrary, NightlyAControllerThatStoodStillOverAResetSeesIt) {
  start();
  const Client reader = join("reader");
  const auto probe = start_probe("probe", "probe");
  ASSERT_TRUE(comes_to_print(reader.get(), *probe, "acquired")) << session->errors();
  probe->send(SIGSTOP);
  control("reset");
  read_to(reader.get(), slewring_present_step(reader.get()) + 20);
  read_to(reader.get(), 3000);
  probe->send(SIGCONT);
  EXPECT_TRUE(comes_to_print(reader.get(), *probe, "lost: ")) << probe->out() << session->errors();
  EXPECT_TRUE(comes_to_print(reader.get(), *probe, "go on\nacquired")) << probe->out() << session->errors();
  stop();
}

TEST_F(ClientLibrary, ItsOwnStandstillIsNoTimeOut) {
  start();
  const Client reader = join("reader");
  const auto probe = start_probe("probe", "probe", "3");
  ASSERT_TRUE(comes_to_print(reader.get(), *probe, "acquired")) << session->errors();
  // no block comes, so that it finds none when it wakes up behind its time-out
  control("pause");
  probe->send(SIGSTOP);
  int code = SLEWRING_OK;
  while (code == SLEWRING_OK) code = slewring_step(reader.get(), 3.5);
  EXPECT_EQ(code, SLEWRING_TIMEOUT);
  probe->send(SIGCONT);
  control("resume");
  read_to(reader.get(), slewring_present_step(reader.get()) + 200);
  EXPECT_EQ(probe->out(), "acquired\n") << session->errors();
  stop();
}

TEST_F(ClientLibrary, OfTwoProcessesOfOneNameTheSecondIsRefusedUntilTheFirstIsGone) {
  start();
  const Client reader = join("reader");
  const int raw = slewring_find(reader.get(), "Input_Lift.raw", kSoon);
  ASSERT_GE(raw, 0);
  const auto first = start_probe("probe", "first");
  ASSERT_TRUE(comes_to_print(reader.get(), *first, "acquired")) << session->errors();
  const auto second = start_probe("probe", "second");
  EXPECT_EQ(second->wait(), 0);
  const std::string process = "(process " + std::to_string(first->pid()) + " on ";
  EXPECT_NE(second->out().find("refused: channel Input_Lift is held by another process named 'probe' " + process),
            std::string::npos)
      << second->out();
  // the first was not meant, and goes on
  read_to(reader.get(), slewring_present_step(reader.get()) + 500);
  EXPECT_EQ(first->out(), "acquired\n");
  EXPECT_EQ(slewring_value(reader.get(), raw), 0.375);
  first->send(SIGKILL);
  static_cast<void>(first->wait());
  // the middleware keeps it for 2 s more
  std::unique_ptr<Program> third;
  for (int i = 0; i < 100; ++i) {
    third = start_probe("probe", "third" + std::to_string(i));
    ASSERT_TRUE(comes_to_print(reader.get(), *third, "d")) << session->errors();
    if (third->out() == "acquired\n") break;
  }
  EXPECT_EQ(third->out(), "acquired\n");
  stop();
}

TEST_F(ClientLibrary, TwoSessionsOfOneProcessUnderOneNameAreTwoControllers) {
  start();
  const Client first = join("pid"), second = join("pid");
  const int lift = slewring_acquire(first.get(), "Input_Lift", kSoon);
  ASSERT_GE(lift, 0) << slewring_error(first.get());
  // a lease for the first has reached the second, which has the same name: it is no answer to a later request
  for (int blocks = 0; blocks < 3; ++blocks) ASSERT_EQ(slewring_step(second.get(), kSoon), SLEWRING_OK);
  EXPECT_EQ(slewring_acquire(second.get(), "Input_Lift", kSoon), SLEWRING_REFUSED);
  EXPECT_NE(std::string(slewring_error(second.get())).find("is held by another process named 'pid'"), std::string::npos)
      << slewring_error(second.get());
  ASSERT_EQ(slewring_step(first.get(), kSoon), SLEWRING_OK) << slewring_error(first.get());
  EXPECT_EQ(slewring_write(first.get(), lift, 0.5), SLEWRING_OK) << slewring_error(first.get());
  stop();
}

TEST_F(ClientLibrary, OneOfTwoWithOneNameThatRequestTogetherHasTheChannel) {
  start();
  const std::array<Client, 2> both = {join("pid"), join("pid")};
  const auto find = [&](std::size_t i) { return slewring_find(both[i].get(), "Input_Lift.loop_delay", kSoon); };
  const std::array<int, 2> delay = {find(0), find(1)};
  ASSERT_EQ(slewring_step(both[0].get(), kSoon), SLEWRING_OK) << "the session runs: it can be stopped";
  for (int round = 0; round < 50; ++round) {
    const auto acquire = [&](std::size_t i) { return slewring_acquire(both[i].get(), "Input_Lift", kSoon); };
    auto second = std::async(std::launch::async, acquire, 1);
    const int of_first = acquire(0), of_second = second.get();
    ASSERT_NE(of_first >= 0, of_second >= 0) << round;
    const std::size_t winner = of_first >= 0 ? 0 : 1;
    ASSERT_EQ(std::min(of_first, of_second), SLEWRING_REFUSED) << slewring_error(both[1 - winner].get());
    const int lift = std::max(of_first, of_second);
    do {
      ASSERT_EQ(slewring_latest(both[winner].get(), kSoon), SLEWRING_OK) << slewring_error(both[winner].get());
      ASSERT_EQ(slewring_write(both[winner].get(), lift, 0.5), SLEWRING_OK) << slewring_error(both[winner].get());
    } while (slewring_value(both[winner].get(), delay[winner]) < 0);
    ASSERT_EQ(slewring_release(both[winner].get(), lift), SLEWRING_OK) << slewring_error(both[winner].get());
    ASSERT_TRUE(reaches(both[winner].get(), delay[winner], -1)) << "the channel is free when it is requested again";
  }
  stop();
}

TEST_F(ClientLibrary, NightlyCountsTheBlocksThatItWasTooSlowFor) {
  start({"--set", "recording.every=1"});
  const Client reader = join("reader"), slow = join("slow");
  const int stroke = slewring_find(slow.get(), "Cyl_Lift.stroke", kSoon);
  ASSERT_GE(stroke, 0);
  const auto read = [&](int blocks) {
    for (int i = 0; i < blocks; ++i) ASSERT_EQ(slewring_step(slow.get(), kSoon), SLEWRING_OK);
  };
  read(50);
  const long long first = slewring_present_step(slow.get());
  EXPECT_EQ(slewring_blocks_missed(slow.get()), 0);
  // its computing takes longer than the kept blocks last
  read_to(reader.get(), first + 3000);
  int blocks = 0;
  while (slewring_present_step(slow.get()) < first + 3000) {
    read(1);
    ++blocks;
  }
  const long long passed = slewring_present_step(slow.get()) - first;
  EXPECT_LT(blocks, passed);
  EXPECT_EQ(slewring_blocks_missed(slow.get()), passed - blocks);
  EXPECT_EQ(slewring_steps_per_block(slow.get()), 1);
  // blocks that are passed over are not lost
  const long long before = slewring_blocks_missed(slow.get());
  read_to(reader.get(), slewring_present_step(slow.get()) + 100);
  ASSERT_EQ(slewring_latest(slow.get(), kSoon), SLEWRING_OK);
  EXPECT_EQ(slewring_blocks_missed(slow.get()), before);
  stop();
}

TEST_F(ClientLibrary, GoesOnWhenANodeIsReplacedAndTheOneThatStoodStillWakesUp) {
  start({"--set", "session.rejoin=30s"});
  const Client client = join("reader");
  const int stroke = slewring_find(client.get(), "Cyl_Lift.stroke", kSoon);
  ASSERT_GE(stroke, 0);
  // the first states are with io from the first tick on
  while (slewring_present_step(client.get()) < 200) ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK);
  Program& first = session->node(Role::hydraulics);
  first.send(SIGSTOP);
  for (int i = 0; i < 100 && session->node(Role::io).err().find("its place is held") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  session->start(Role::hydraulics, {}, "_second");
  const long long held_at = slewring_present_step(client.get());
  first.send(SIGCONT);
  EXPECT_EQ(first.wait(), 4) << first.err();
  long long before = held_at;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
    EXPECT_GT(slewring_present_step(client.get()), before) << "a step that was computed again is reported once";
    before = slewring_present_step(client.get());
  }
  control("stop");
  int result = SLEWRING_OK;
  while (result == SLEWRING_OK) result = slewring_step(client.get(), kSoon);
  EXPECT_EQ(result, SLEWRING_ENDED) << slewring_error(client.get());
}

// environment variables that the library reads
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
  ~Environment() { unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
};

TEST_F(ClientLibrary, NightlyInASessionWithKeysMovesItsChannelAndWithoutThemReceivesNothing) {
  session = std::make_unique<Session>(
      std::vector<std::string>{"--pace", "real", "--duration", "60s", "--input", "none"}, kScene);
  const std::string plant = (session->folder() / "plant").string();
  const auto slewring = [&](std::vector<std::string> arguments) {
    Program program(program_path("slewring"), arguments, session->folder() / arguments[1]);
    EXPECT_EQ(program.wait(), 0) << program.out() << program.err();
  };
  slewring({"keys", "create", plant});
  slewring({"keys", "add", plant, "--name", "joystick", "--session", session->name()});
  slewring({"keys", "add", plant, "--name", "guest", "--session", "another_*"});
  for (const Role role : kAllNodes) session->start(role, {"--keys", plant});
  const auto refused = [&](double timeout) {
    EXPECT_EQ(slewring_join(session->name().c_str(), "pid", session->domain(), "lo", "", timeout), nullptr);
    return std::string(slewring_error(nullptr));
  };
  {
    const Environment keys("SLEWRING_KEYS", plant), identity("SLEWRING_IDENTITY", "joystick");
    const Client client = join("pid");
    ASSERT_NE(client, nullptr);
    const int moved = slewring_find(client.get(), "Input_Lift.raw", kSoon);
    ASSERT_GE(moved, 0) << slewring_error(client.get());
    const int lift = slewring_acquire(client.get(), "Input_Lift", kSoon);
    ASSERT_GE(lift, 0) << slewring_error(client.get());
    ASSERT_EQ(slewring_step(client.get(), kSoon), SLEWRING_OK) << slewring_error(client.get());
    ASSERT_EQ(slewring_write(client.get(), lift, 0.25), SLEWRING_OK) << slewring_error(client.get());
    EXPECT_TRUE(reaches(client.get(), moved, 0.25)) << slewring_error(client.get());
  }
  {
    const Environment keys("SLEWRING_KEYS", plant), identity("SLEWRING_IDENTITY", "guest");
    EXPECT_NE(refused(2).find("the keys of this process do not allow it"), std::string::npos);
  }
  {
    const Environment keys("SLEWRING_KEYS", plant), identity("SLEWRING_IDENTITY", "absent");
    EXPECT_NE(refused(2).find("has no keys of 'absent'"), std::string::npos);
  }
  EXPECT_NE(refused(2).find("compare its name, domain, interface, peers and keys"), std::string::npos);
  slewring({"control", "stop", "--session", session->name(), "--domain", std::to_string(session->domain()), "--keys",
            plant});
  EXPECT_EQ(session->wait_all(), all_ok()) << session->errors();
}

}  // namespace client_test
}  // namespace slew::testing
