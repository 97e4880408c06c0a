// SPDX-License-Identifier: Apache-2.0
// Nodes that stand still for a while, or until the others give them up: as processes, and by their loop alone.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "build_paths.h"
#include "core/time.h"
#include "direct_chain.h"
#include "held_loop.h"
#include "node/identity.h"
#include "session.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace hung_node_test {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
constexpr const char* kDuration = "3s";  // longer than a node is waited for

std::string role_name(const ::testing::TestParamInfo<Role>& role) {
  return std::string(node::to_text(role.param));
}

std::string name_of(Role role, const Program& program) {
  return std::string(node::to_text(role)) + " (process " + std::to_string(program.pid()) + " on ";
}

const std::vector<std::string> kRealPace = {"--pace", "real", "--duration", kDuration};
constexpr const char* kFlexibleScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane_flexible.yaml";

// a session that has this role
const char* scene_with(Role role) {
  return role == Role::flex ? kFlexibleScene : kScene;
}

// One physics node stands for all in the gate.
constexpr Role kGateRoles[] = {Role::hydraulics};
constexpr Role kNightlyRoles[] = {Role::io, Role::mechanics, Role::recorder, Role::flex};

std::vector<Role> roles_with(Role role) {
  std::vector<Role> roles(kAllNodes.begin(), kAllNodes.end());
  if (role == Role::flex) roles.push_back(role);
  return roles;
}

std::map<Role, Program*> start_with(Role role, Session& session, const std::string& copy = "") {
  std::map<Role, Program*> nodes;
  for (const Role one : roles_with(role)) {
    const bool reads_files = one != Role::io && one != Role::recorder;
    const std::vector<std::string> files = {"--assets", SLEWRING_SOURCE_DIR "/scenes"};
    nodes[one] = &session.start(one, reads_files ? files : std::vector<std::string>{}, copy);
  }
  return nodes;
}

void expect_all_well(Session& session) {
  for (const auto& [role, code] : session.wait_all()) EXPECT_EQ(code, 0) << node::to_text(role) << session.errors();
}

HashChain bits_of_a_flexible_session() {
  Session session({"--pace", "free", "--duration", kDuration}, kFlexibleScene);
  start_with(Role::flex, session);
  expect_all_well(session);
  return session.recorded().chain();
}

// hashes of an undisturbed session with this role
const HashChain& undisturbed_with(Role role) {
  static const HashChain rigid = [] {
    const ScratchFolder folder;
    return run_in_one_process(load_scene(kScene, kDuration), folder.path() / "runs").chain();
  }();
  if (role != Role::flex) return rigid;
  static const HashChain flexible = bits_of_a_flexible_session();
  return flexible;
}

void expect_undisturbed_bits(Role role, const RecordedSession& recorded) {
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed_with(role)), "");
}

// by the others, with the step at which they waited
void expect_named(const RecordedSession& recorded, Role role, const Program& program) {
  std::string reasons;
  for (const PublishedStatus& published : recorded.statuses) reasons += published.status.reason + "\n";
  EXPECT_NE(reasons.find("waits for " + name_of(role, program)), std::string::npos) << reasons;
  EXPECT_NE(reasons.find(", which has been silent for 0.3 s at step "), std::string::npos) << reasons;
}

void expect_given_up_by_all(Session& session, Role hung) {
  for (const Role role : roles_with(hung)) {
    if (role == hung) continue;
    EXPECT_EQ(session.node(role).wait(), 4) << node::to_text(role) << "\n" << session.errors();
    EXPECT_NE(session.node(role).err().find(name_of(hung, session.node(hung))), std::string::npos) << session.errors();
    EXPECT_NE(session.node(role).err().find(" is gone; "), std::string::npos) << session.errors();
  }
}

// The recording that is not this one.
std::filesystem::path other_recording(const std::filesystem::path& runs, const std::filesystem::path& first) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(runs)) {
    if (entry.path().extension() == ".mcap" && entry.path() != first) return entry.path();
  }
  throw std::runtime_error("there is no second recording in " + runs.string());
}

class HungNode : public ::testing::TestWithParam<Role> {};

// Another node reports that it waits for this one.
bool is_waited_for(Session& session, Role role, const Program& program) {
  const Role other = role == Role::io ? Role::mechanics : Role::io;
  const std::string sign = "waits for " + name_of(role, program);
  return session.observer().wait_until([&] {
    const auto& status = session.observer().status(other);
    return status && status->reason.find(sign) != std::string::npos;
  });
}

TEST_P(HungNode, ThatComesBackInTimeGoesOnWithTheSameBits) {
  Session session(kRealPace, scene_with(GetParam()));
  start_with(GetParam(), session);
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.errors();
  session.node(GetParam()).send(SIGSTOP);
  EXPECT_TRUE(is_waited_for(session, GetParam(), session.node(GetParam()))) << session.errors();
  session.node(GetParam()).send(SIGCONT);
  expect_all_well(session);
  const RecordedSession recorded = session.recorded();
  expect_undisturbed_bits(GetParam(), recorded);
  expect_named(recorded, GetParam(), session.node(GetParam()));
}

// For longer than the 2 s that a session without the key waits. The middleware misses it meanwhile: blocks of
// variables, and messages of the flex node for which no node waits, may be missing until it is found again; they are
// not sent again.
TEST_P(HungNode, NightlyThatComesBackWithinGiveUpAfterGoesOnWithTheSameBits) {
  std::vector<std::string> patient = kRealPace;
  patient.insert(patient.end(), {"--set", "session.give_up_after=20"});
  Session session(patient, scene_with(GetParam()));
  start_with(GetParam(), session);
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.errors();
  session.node(GetParam()).send(SIGSTOP);
  const std::int64_t stopped_ns = monotonic_ns();
  EXPECT_TRUE(is_waited_for(session, GetParam(), session.node(GetParam()))) << session.errors();
  sleep_until_monotonic(stopped_ns + 3'000'000'000);
  session.node(GetParam()).send(SIGCONT);
  const std::map<Role, int> codes = session.wait_all();
  const RecordedSession recorded = session.recorded();
  std::int64_t lost = std::stoll(recorded.summary.at("variables.lost"));
  if (GetParam() == Role::flex) lost += std::stoll(recorded.summary.at("elastic.lost"));
  for (const auto& [role, code] : codes) {
    EXPECT_EQ(code, role == Role::recorder && lost > 0 ? 3 : 0) << node::to_text(role) << session.errors();
  }
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), lost) << "no tick and no sample";
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed_with(GetParam())), "");
  // a recorder that was missed gets the last status of each node alone
  if (GetParam() != Role::recorder) expect_named(recorded, GetParam(), session.node(GetParam()));
}

// For 30 s (nightly) or somewhat longer than it is waited for. Meanwhile another session has got its name.
TEST_P(HungNode, NightlyThatIsGivenUpFindsThatItsSessionIsOverAndDoesNotDisturbTheNextOne) {
  const Role hung = GetParam();
  Session session(kRealPace, scene_with(hung));
  start_with(hung, session);
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.errors();
  Program& stopped = session.node(hung);
  stopped.send(SIGSTOP);
  const std::int64_t stopped_ns = monotonic_ns();
  expect_given_up_by_all(session, hung);
  ASSERT_TRUE(stopped.is_running());
  const std::filesystem::path first = only_recording(session.runs());

  sleep_until_monotonic(stopped_ns + rounds<std::int64_t>(0, 29) * 1'000'000'000);
  const std::map<Role, Program*> next = start_with(hung, session, "_next");
  Observer& observer = session.observer();
  const std::uint64_t ticks = observer.ticks();
  ASSERT_TRUE(observer.wait_until([&] { return observer.ticks() >= ticks + 300; })) << next.at(Role::io)->err();
  stopped.send(SIGCONT);
  EXPECT_EQ(stopped.wait(), 4) << session.errors();
  const std::string errors = stopped.err();
  EXPECT_NE(errors.find(" stood still for "), std::string::npos) << errors;
  EXPECT_NE(errors.find("; look for what stopped the process (a signal, a debugger, lack of memory or of processors)"),
            std::string::npos)
      << errors;

  for (const auto& [role, program] : next) EXPECT_EQ(program->wait(), 0) << program->err();
  const RecordedSession recorded = read_session(other_recording(session.runs(), first));
  expect_undisturbed_bits(hung, recorded);
  // nothing of the one in the other's recording, and the first one's is as whole as it was
  for (const PublishedStatus& published : recorded.statuses) {
    EXPECT_NE(published.status.pid, static_cast<std::uint32_t>(stopped.pid())) << published.status.reason;
  }
  const RecordedSession before = read_session(first);
  EXPECT_EQ(before.problem, "");
  EXPECT_TRUE(before.has_all_messages);
  EXPECT_GT(before.last_complete_step(), 0);
  EXPECT_LT(before.last_complete_step(), 2900);
  for (const PublishedStatus& published : before.statuses) {
    for (const auto& [role, program] : next) {
      EXPECT_NE(published.status.pid, static_cast<std::uint32_t>(program->pid())) << node::to_text(role);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Roles, HungNode, ::testing::ValuesIn(kGateRoles), role_name);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, HungNode, ::testing::ValuesIn(kNightlyRoles), role_name);

// ---- a loop that stands still while the rest of its process goes on ---------------------------------------------

class HungLoop : public ::testing::TestWithParam<Role> {
 protected:
  void start_and_hold(const std::string& duration) {
    session_.emplace(std::vector<std::string>{"--pace", "real", "--duration", duration}, scene_with(GetParam()));
    start_with(GetParam(), *session_);
    ASSERT_TRUE(session_->observer().wait_for_step(100)) << session_->errors();
    held_.emplace(node().pid());
    if (!held_->is_held()) GTEST_SKIP() << "no process may trace another one here";
  }
  Program& node() { return session_->node(GetParam()); }
  void expect_own_word(const std::string& word) {
    EXPECT_NE(node().err().find(std::string(node::to_text(GetParam())) + ": warning: the loop of this node " + word),
              std::string::npos)
        << node().err();
  }

  std::optional<Session> session_;
  std::optional<HeldLoop> held_;
};

TEST_P(HungLoop, ThatComesBackInTimeGoesOnWithTheSameBits) {
  start_and_hold(kDuration);
  if (IsSkipped() || HasFailure()) return;
  EXPECT_TRUE(is_waited_for(*session_, GetParam(), node())) << session_->errors();
  held_->let_go();
  const bool is_recorder = GetParam() == Role::recorder;
  // in real pace no node waits for a recorder, and after so long not all can be resent: missing samples are counted
  for (const auto& [role, code] : session_->wait_all()) {
    EXPECT_TRUE(code == 0 || (code == 3 && is_recorder && role == Role::recorder)) << code << session_->errors();
  }
  const RecordedSession recorded = session_->recorded();
  EXPECT_EQ(recorded.problem, "");
  if (!is_recorder) expect_undisturbed_bits(GetParam(), recorded);
  expect_named(recorded, GetParam(), node());
  expect_own_word("has stood still for ");
  expect_own_word("goes on; it had stood still for ");
}

TEST_P(HungLoop, ThatDoesNotGoOnIsNamedAndGivenUp) {
  start_and_hold("20s");
  if (IsSkipped() || HasFailure()) return;
  expect_given_up_by_all(*session_, GetParam());
  expect_own_word("has stood still for ");
  held_->let_go();
  EXPECT_EQ(node().wait(), 4) << session_->errors();
  EXPECT_NE(node().err().find(" stood still for "), std::string::npos) << session_->errors();
  const RecordedSession recorded = session_->recorded();
  EXPECT_EQ(recorded.problem, "");
  expect_named(recorded, GetParam(), node());
}

INSTANTIATE_TEST_SUITE_P(Roles, HungLoop, ::testing::ValuesIn(kGateRoles), role_name);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, HungLoop, ::testing::ValuesIn(kNightlyRoles), role_name);

// A machine or container that is frozen and goes on. After so long the processes discover each other again, and blocks
// of variables in transit are lost: they are counted.
TEST(FrozenSession, GoesOnWithTheSameBits) {
  Session session({"--pace", "real", "--duration", kDuration});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.errors();
  for (const Role role : kAllNodes) session.node(role).send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(rounds(4, 30)));
  for (const Role role : kAllNodes) session.node(role).send(SIGCONT);
  for (const auto& [role, code] : session.wait_all()) {
    EXPECT_TRUE(code == 0 || (code == 3 && role == Role::recorder)) << code << "\n" << session.errors();
  }
  RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  for (const char* topic : {"tick", "mechanism", "actuators"}) {
    EXPECT_EQ(recorded.summary[std::string(topic) + ".lost"], "0") << topic;
  }
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed_with(Role::io)), "");
}

}  // namespace hung_node_test
}  // namespace slew::testing
