// SPDX-License-Identifier: Apache-2.0
// Physics nodes that are killed in mid-motion, and others that take their places: the session goes on to the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <map>
#include <random>

#include "build_paths.h"
#include "direct_chain.h"
#include "held_loop.h"
#include "node/identity.h"
#include "session.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace rejoin_test {

using wire::NodeState;
using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
constexpr const char* kDuration = "1.6s";
constexpr StepIndex kSteps = 1600;

// input within the first second, so that valves move and friction slips
std::vector<std::string> places_held(const std::string& pace, const std::string& duration = kDuration) {
  return {"--pace", pace, "--duration", duration, "--set", "session.rejoin=20s"};
}

const HashChain& undisturbed(StepIndex steps = kSteps) {
  static std::map<StepIndex, HashChain> chains;
  const auto found = chains.find(steps);
  return found != chains.end() ? found->second : chains.emplace(steps, undisturbed_chain(kScene, steps)).first->second;
}

bool holds_a_place(Observer& observer, Role role, std::size_t times = 1) {
  return observer.wait_until([&] {
    const auto& all = observer.descriptions();
    const auto count = [&](const wire::SessionDescription& session) {
      return static_cast<std::size_t>(std::count_if(session.given_up.begin(), session.given_up.end(),
                                                    [role](const wire::GivenUp& g) { return g.role == role; }));
    };
    return std::any_of(all.begin(), all.end(), [&](const auto& entry) { return count(entry.second) >= times; });
  });
}

void expect_undisturbed_bits(Session& session, StepIndex steps = kSteps) {
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(recorded.last_complete_step(), steps);
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed(steps)), "");
  Program verify(program_path("slewring"), {"replay", only_recording(session.runs()).string(), "--verify"},
                 session.folder() / "replay");
  EXPECT_EQ(verify.wait(), 0) << verify.out() << verify.err();
}

std::string role_name(const ::testing::TestParamInfo<Role>& role) {
  return std::string(node::to_text(role.param));
}

class KilledAndReplaced : public ::testing::TestWithParam<Role> {};

TEST_P(KilledAndReplaced, InMidMotionTheSessionGoesOnToTheSameBits) {
  std::mt19937_64 random(20'261'123 + static_cast<std::uint64_t>(GetParam()));
  for (int round = 0; round < testing::rounds(1, 10); ++round) {
    Session session(places_held("real"));
    Observer& observer = session.observer();
    session.start_all();
    ASSERT_TRUE(observer.wait_for_step(200 + static_cast<StepIndex>(random() % 1000))) << session.errors();
    session.node(GetParam()).send(SIGKILL);
    ASSERT_TRUE(holds_a_place(observer, GetParam())) << session.errors();
    const auto& io = observer.status(Role::io);
    EXPECT_TRUE(observer.wait_until([&] {
      return io->state == NodeState::holding && io->reason.find("its place is held for 20 s") != std::string::npos;
    })) << io->reason;
    session.start(GetParam());
    expect_undisturbed_bits(session);
    EXPECT_NE(session.node(Role::io).err().find("goes on in the place of"), std::string::npos) << session.errors();
  }
}

TEST_P(KilledAndReplaced, NightlyTwiceInFreePace) {
  // long enough for the second one to be found computing on a machine that is busy
  Session session(places_held("free", "16s"));
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(100)) << session.errors();
  session.node(GetParam()).send(SIGKILL);
  ASSERT_TRUE(holds_a_place(observer, GetParam())) << session.errors();
  session.start(GetParam());
  // as soon as it has begun to compute
  ASSERT_TRUE(observer.wait_until([&] {
    const auto& status = observer.status(GetParam());
    return status && status->pid == static_cast<std::uint32_t>(session.node(GetParam()).pid()) &&
           status->state >= NodeState::ready;
  })) << session.errors();
  session.node(GetParam()).send(SIGKILL);
  ASSERT_TRUE(holds_a_place(observer, GetParam(), 2)) << session.errors();
  session.start(GetParam());
  expect_undisturbed_bits(session, 16000);
}

INSTANTIATE_TEST_SUITE_P(Roles, KilledAndReplaced, ::testing::Values(Role::mechanics), role_name);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, KilledAndReplaced, ::testing::Values(Role::hydraulics), role_name);

TEST(Replaced, AStoppedProcessThatWakesUpReportsThatItsRoleWasGivenAway) {
  Session session(places_held("real"));
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(300)) << session.errors();
  Program& first = session.node(Role::hydraulics);
  first.send(SIGSTOP);
  ASSERT_TRUE(holds_a_place(observer, Role::hydraulics)) << session.errors();
  Program& second = session.start(Role::hydraulics, {}, "_second");
  ASSERT_TRUE(observer.wait_until([&] {
    const auto& status = observer.status(Role::hydraulics);
    return status && status->pid == static_cast<std::uint32_t>(second.pid()) && status->state >= NodeState::ready;
  })) << second.err();
  first.send(SIGCONT);
  EXPECT_EQ(first.wait(), 4) << first.err();
  EXPECT_NE(first.err().find("was given to another process"), std::string::npos) << first.err();
  EXPECT_EQ(second.wait(), 0) << second.err();
  for (const Role role : {Role::io, Role::mechanics, Role::recorder}) EXPECT_EQ(session.node(role).wait(), 0);
  EXPECT_EQ(first_difference(session.recorded().chain(), undisturbed()), "");
}

// no node waits for sensors: the session is 2 s ahead when one that hangs is given up
TEST(Replaced, NightlyASensorNodeThatHangsInRealPace) {
  Session session({"--pace", "real", "--duration", "6s", "--set", "session.rejoin=20s"},
                  SLEWRING_SOURCE_DIR "/scenes/truck_crane_sensors.yaml");
  Observer& observer = session.observer();
  session.start_all();
  Program& first = session.start(Role::sensor);
  ASSERT_TRUE(observer.wait_for_step(600)) << session.errors();
  first.send(SIGSTOP);
  ASSERT_TRUE(holds_a_place(observer, Role::sensor)) << session.errors();
  Program& second = session.start(Role::sensor, {}, "_second");
  EXPECT_EQ(second.wait(), 0) << second.err();
  for (const Role role : kAllNodes) EXPECT_EQ(session.node(role).wait(), 0) << session.errors();
  first.send(SIGKILL);
  EXPECT_EQ(session.recorded().problem, "");
  Program verify(program_path("slewring"), {"replay", only_recording(session.runs()).string(), "--verify"},
                 session.folder() / "replay");
  EXPECT_EQ(verify.wait(), 0) << verify.out() << verify.err();
}

TEST(Replaced, WithoutAReplacementInTimeTheSessionEndsWithCode4) {
  Session session({"--pace", "real", "--duration", "20s", "--set", "session.rejoin=1s"});
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(300)) << session.errors();
  session.node(Role::mechanics).send(SIGKILL);
  for (const Role role : {Role::io, Role::hydraulics, Role::recorder}) {
    EXPECT_EQ(session.node(role).wait(), 4) << session.errors();
  }
  EXPECT_NE(session.node(Role::io).err().find("no other process took its place within 1 s"), std::string::npos)
      << session.errors();
  EXPECT_EQ(session.recorded().problem, "");
}

TEST(Replaced, AKilledIoOrRecorderEndsTheSessionAsWithout) {
  for (const Role role : {Role::io, Role::recorder}) {
    Session session({"--pace", "real", "--duration", "20s", "--set", "session.rejoin=20s"});
    session.start_all();
    ASSERT_TRUE(session.observer().wait_for_step(300)) << session.errors();
    session.node(role).send(SIGKILL);
    for (const auto& [other, code] : session.wait_all()) {
      EXPECT_EQ(code, other == role ? -SIGKILL : 4) << node::to_text(other) << session.errors();
    }
  }
}

// ---- with a flex node -----------------------------------------------------------------------------------------

struct FlexLoss {
  const char* name;
  const char* exchange;  // session.flexible
  std::vector<Role> lost;
};
void PrintTo(const FlexLoss& loss, std::ostream* out) {
  *out << loss.name;
}

class ReplacedFlex : public ::testing::TestWithParam<FlexLoss> {
 protected:
  RecordedSession run_losing(const std::vector<Role>& lost) {
    Session session({"--pace", "real", "--duration", "0.8s", "--set", "session.rejoin=20s", "--set",
                     std::string("session.flexible=") + GetParam().exchange},
                    SLEWRING_SOURCE_DIR "/scenes/truck_crane_flexible.yaml");
    Observer& observer = session.observer();
    session.start(Role::io);
    session.start(Role::recorder);
    for (const Role role : {Role::mechanics, Role::hydraulics, Role::flex}) session.start(role, files_);
    EXPECT_TRUE(observer.wait_for_step(300)) << session.errors();
    for (const Role role : lost) session.node(role).send(SIGKILL);
    for (const Role role : lost) {
      EXPECT_TRUE(holds_a_place(observer, role)) << session.errors();
      session.start(role, files_);
    }
    for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 0) << node::to_text(role) << session.errors();
    RecordedSession recorded = session.recorded();
    EXPECT_EQ(recorded.problem, "");
    if (lost.empty()) return recorded;
    Program verify(program_path("slewring"),
                   {"replay", only_recording(session.runs()).string(), "--verify", files_[0], files_[1]},
                   session.folder() / "replay");
    EXPECT_EQ(verify.wait(), 0) << verify.out() << verify.err();
    return recorded;
  }
  const std::vector<std::string> files_ = {"--assets", SLEWRING_SOURCE_DIR "/scenes"};
};

TEST_P(ReplacedFlex, TheSessionGoesOnToTheSameBits) {
  const HashChain undisturbed = run_losing({}).chain();
  EXPECT_EQ(first_difference(undisturbed, run_losing(GetParam().lost).chain()), "");
}

const auto name_of_loss = [](const ::testing::TestParamInfo<FlexLoss>& loss) { return std::string(loss.param.name); };
INSTANTIATE_TEST_SUITE_P(
    NightlyLosses, ReplacedFlex,
    ::testing::Values(FlexLoss{"flex_every_step", "every_step", {Role::flex}},
                      FlexLoss{"flex_once", "once", {Role::flex}},
                      FlexLoss{"all_every_step", "every_step", {Role::mechanics, Role::hydraulics, Role::flex}},
                      FlexLoss{"all_once", "once", {Role::mechanics, Role::hydraulics, Role::flex}}),
    name_of_loss);

// ---- `slewring run` -------------------------------------------------------------------------------------------

class RunWithRejoin : public ::testing::Test {
 protected:
  // waits for the role in a session in mid-motion
  void wait_for(Role role) {
    ASSERT_TRUE(observer_.wait_for_step(300)) << run_.out() << run_.err();
    ASSERT_TRUE(observer_.wait_until([&] { return observer_.status(role).has_value(); }));
  }
  pid_t pid_of(Role role) { return static_cast<pid_t>(observer_.status(role)->pid); }
  void send_to(Role role, int signal) {
    wait_for(role);
    if (!HasFatalFailure()) kill(pid_of(role), signal);
  }
  // a restarted node continues with the undisturbed bits
  void expect_one_restart_and_undisturbed_bits() {
    EXPECT_EQ(run_.wait(), 0) << run_.out() << run_.err();
    EXPECT_NE(run_.err().find("it is started again with the state of its last checkpoint (1 of 3)"), std::string::npos)
        << run_.err();
    const RecordedSession recorded = read_session(folder_.path() / "runs");
    EXPECT_EQ(recorded.problem, "");
    EXPECT_EQ(first_difference(recorded.chain(), undisturbed()), "");
  }

  ScratchFolder folder_;
  TestDomain domain_;
  Program run_{
      program_path("slewring"),
      {"run", kScene, "--session", "s", "--domain", std::to_string(domain_.number()), "--pace", "real", "--duration",
       kDuration, "--set", "session.rejoin=20s", "--out", (folder_.path() / "runs").string(), "--quiet"},
      folder_.path() / "run"};
  Observer observer_{domain_.number(), "s"};
};

TEST_F(RunWithRejoin, StartsAKilledNodeAgainAndEndsWellWithTheSameBits) {
  send_to(Role::mechanics, SIGKILL);
  expect_one_restart_and_undisturbed_bits();
}

TEST_F(RunWithRejoin, NightlyReplacesANodeThatHangs) {
  send_to(Role::hydraulics, SIGSTOP);
  expect_one_restart_and_undisturbed_bits();
  EXPECT_NE(run_.err().find("was silent for 2 s (session.give_up_after) and has lost its place; it is killed"),
            std::string::npos)
      << run_.err();
}

// the gate has HungLoop
TEST_F(RunWithRejoin, NightlyReplacesANodeWhoseLoopHangs) {
  wait_for(Role::mechanics);
  if (HasFatalFailure()) return;
  HeldLoop held(pid_of(Role::mechanics));
  if (!held.is_held()) GTEST_SKIP() << "no process may trace another one here";
  expect_one_restart_and_undisturbed_bits();
  EXPECT_NE(run_.err().find("mechanics: warning: the loop of this node has stood still for "), std::string::npos)
      << run_.err();
  EXPECT_NE(run_.err().find("was silent for 2 s (session.give_up_after) and has lost its place; it is killed"),
            std::string::npos)
      << run_.err();
}

// a step of which neither node has a sample is no beginning
TEST(Replaced, BothPartnersOfAnExchangeAtEveryThirdStep) {
  Session session(
      {"--pace", "real", "--duration", kDuration, "--set", "session.rejoin=20s", "--set", "session.exchange_every=3"});
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(600)) << session.errors();
  for (const Role role : {Role::mechanics, Role::hydraulics}) session.node(role).send(SIGKILL);
  for (const Role role : {Role::mechanics, Role::hydraulics}) {
    ASSERT_TRUE(holds_a_place(observer, role)) << session.errors();
    session.start(role);
  }
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  Program verify(program_path("slewring"), {"replay", only_recording(session.runs()).string(), "--verify"},
                 session.folder() / "replay");
  EXPECT_EQ(verify.wait(), 0) << verify.out() << verify.err();
}

}  // namespace rejoin_test
}  // namespace slew::testing
