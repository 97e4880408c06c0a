// Nodes that stand still for a while, or so long that the others give them up.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "build_paths.h"
#include "core/time.h"
#include "direct_chain.h"
#include "node/identity.h"
#include "session.h"
#include "tests/support/nightly.h"

namespace slew::testing {
namespace {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
constexpr const char* kDuration = "3s";  // longer than a node is waited for

std::string role_name(const ::testing::TestParamInfo<Role>& role) {
  return std::string(node::to_text(role.param));
}

std::string name_of(Role role, const Program& program) {
  return std::string(node::to_text(role)) + " (process " + std::to_string(program.pid()) + " on ";
}

const HashChain& bits_of_one_process() {
  static const ScratchFolder folder;
  static const RecordedSession reference = run_in_one_process(load_scene(kScene, kDuration), folder.path() / "runs");
  return reference.chain();
}

// The recording that is not this one.
std::filesystem::path other_recording(const std::filesystem::path& runs, const std::filesystem::path& first) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(runs)) {
    if (entry.path().extension() == ".mcap" && entry.path() != first) return entry.path();
  }
  throw std::runtime_error("there is no second recording in " + runs.string());
}

class HungNode : public ::testing::TestWithParam<Role> {};

TEST_P(HungNode, ThatComesBackInTimeGoesOnWithTheSameBits) {
  Session session({"--pace", "real", "--duration", kDuration});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.said();
  session.node(GetParam()).send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  session.node(GetParam()).send(SIGCONT);
  ASSERT_EQ(session.wait_all(), all_ok()) << session.said();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(first_difference(recorded.chain(), bits_of_one_process()), "");
  // it was named, with the step at which the others waited
  std::string told;
  for (const SaidStatus& said : recorded.statuses) told += said.status.reason + "\n";
  EXPECT_NE(told.find("waits for " + name_of(GetParam(), session.node(GetParam()))), std::string::npos) << told;
  EXPECT_NE(told.find(", which has been silent for 0.3 s at step "), std::string::npos) << told;
}

// For 30 s (nightly) or somewhat longer than it is waited for. Meanwhile another session has got its name.
TEST_P(HungNode, ThatIsGivenUpFindsThatItsSessionIsOverAndDoesNotDisturbTheNextOne) {
  const Role hung = GetParam();
  Session session({"--pace", "real", "--duration", kDuration});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.said();
  Program& stopped = session.node(hung);
  stopped.send(SIGSTOP);
  const std::int64_t stopped_ns = monotonic_ns();
  for (const Role role : kAllNodes) {
    if (role == hung) continue;
    EXPECT_EQ(session.node(role).wait(), 4) << node::to_text(role) << "\n" << session.said();
    EXPECT_NE(session.node(role).err().find(name_of(hung, stopped)), std::string::npos) << session.said();
    EXPECT_NE(session.node(role).err().find(" is gone; "), std::string::npos) << session.said();
  }
  ASSERT_TRUE(stopped.is_running());
  const std::filesystem::path first = only_recording(session.runs());

  sleep_until_monotonic(stopped_ns + rounds<std::int64_t>(0, 29) * 1'000'000'000);
  std::map<Role, Program*> next;
  for (const Role role : kAllNodes) next[role] = &session.start(role, {}, "_next");
  Observer& observer = session.observer();
  const std::uint64_t ticks = observer.ticks();
  ASSERT_TRUE(observer.wait_until([&] { return observer.ticks() >= ticks + 300; })) << next[Role::io]->err();
  stopped.send(SIGCONT);
  EXPECT_EQ(stopped.wait(), 4) << session.said();
  const std::string said = stopped.err();
  EXPECT_NE(said.find(" stood still for "), std::string::npos) << said;
  EXPECT_NE(said.find("; look for what stopped the process (a signal, a debugger, lack of memory or of processors)"),
            std::string::npos)
      << said;

  for (const auto& [role, program] : next) EXPECT_EQ(program->wait(), 0) << program->err();
  const RecordedSession recorded = read_session(other_recording(session.runs(), first));
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(first_difference(recorded.chain(), bits_of_one_process()), "");
  // nothing of the one in the other's recording, and the first one's is as whole as it was
  for (const SaidStatus& said_there : recorded.statuses) {
    EXPECT_NE(said_there.status.pid, static_cast<std::uint32_t>(stopped.pid())) << said_there.status.reason;
  }
  const RecordedSession before = read_session(first);
  EXPECT_EQ(before.problem, "");
  EXPECT_TRUE(before.has_all_messages);
  EXPECT_GT(before.last_complete_step(), 0);
  EXPECT_LT(before.last_complete_step(), 2900);
  for (const SaidStatus& said_there : before.statuses) {
    for (const auto& [role, program] : next) {
      EXPECT_NE(said_there.status.pid, static_cast<std::uint32_t>(program->pid())) << node::to_text(role);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Roles, HungNode, ::testing::ValuesIn(kAllNodes), role_name);

// A machine or container that is frozen and goes on. After so long the processes meet anew, and blocks of variables
// that were on their way are nobody's any more: they are counted.
TEST(FrozenSession, GoesOnWithTheSameBits) {
  Session session({"--pace", "real", "--duration", kDuration});
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(100)) << session.said();
  for (const Role role : kAllNodes) session.node(role).send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::seconds(rounds(4, 30)));
  for (const Role role : kAllNodes) session.node(role).send(SIGCONT);
  for (const auto& [role, code] : session.wait_all()) {
    EXPECT_TRUE(code == 0 || (code == 3 && role == Role::recorder)) << code << "\n" << session.said();
  }
  RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  for (const char* topic : {"tick", "mechanism", "actuators"}) {
    EXPECT_EQ(recorded.summary[std::string(topic) + ".lost"], "0") << topic;
  }
  EXPECT_EQ(first_difference(recorded.chain(), bits_of_one_process()), "");
}

}  // namespace
}  // namespace slew::testing
