// SPDX-License-Identifier: Apache-2.0
// The same scene and the same ticks give the same bits in every state at every step, however the nodes are laid out.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <csignal>
#include <thread>

#include "build_paths.h"
#include "direct_chain.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace determinism_test {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

// input within the first second, so that valves move and friction slips
const std::vector<std::string> kFree = {"--pace", "free", "--duration", "1.6s"};
constexpr StepIndex kSteps = 1600;

// the chain that all others must equal, computed once by the nodes on one thread
const RecordedSession& reference() {
  static const RecordedSession session = [] {
    const ScratchFolder folder;
    return run_in_one_process(load_scene(kScene, "1.6s"), folder.path() / "runs");
  }();
  return session;
}

RecordedSession recorded_without_losses(Session& session) {
  EXPECT_EQ(session.wait_all(), all_ok()) << session.errors();
  RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_TRUE(recorded.has_all_messages);
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(recorded.epochs.size(), 1u);
  return recorded;
}

void expect_same_as_in_one_process(Session& session) {
  const RecordedSession recorded = recorded_without_losses(session);
  EXPECT_EQ(recorded.last_complete_step(), kSteps);
  EXPECT_EQ(first_difference(recorded.chain(), reference().chain()), "");
}

TEST(Determinism, OneProcessRecordsEveryStepOfEveryNodeAndGivesTheSameBitsTwice) {
  EXPECT_EQ(reference().problem, "");
  EXPECT_EQ(reference().losses(), 0);
  ASSERT_EQ(reference().epochs.size(), 1u);
  // INIT, and samples 0 to the end; the last one has no tick after it
  ASSERT_EQ(reference().chain().size(), static_cast<std::size_t>(kSteps + 2));
  EXPECT_NE(reference().chain().at(kJoinStep).mechanics, 0u);
  for (const auto& [step, hashes] : reference().chain()) {
    if (step < 0) continue;
    EXPECT_NE(hashes.mechanics, 0u) << step;
    EXPECT_NE(hashes.hydraulics, 0u) << step;
    EXPECT_EQ(hashes.io == 0, step == kSteps) << step;
  }
  // the machine moves: no two states are alike
  EXPECT_NE(reference().chain().at(100), reference().chain().at(101));
  EXPECT_EQ(first_difference(undisturbed_chain(kScene, kSteps), reference().chain()), "");
}

TEST(Determinism, OneProcessWithoutARecorderEndsWithTheSameBits) {
  EXPECT_EQ(last_hashes_without_recorder(load_scene(kScene, "1.6s")), physics_only(reference().chain()).at(kSteps));
}

TEST(Determinism, RealPaceGivesTheSameBitsAsFreePace) {
  Session session({"--pace", "real", "--duration", "1.6s"});
  session.start_all();
  expect_same_as_in_one_process(session);
}

TEST(Determinism, SeparateProcessesAndTheirReplayGiveTheSameBits) {
  Session session(kFree);
  session.start_all();
  const RecordedSession recorded = recorded_without_losses(session);
  EXPECT_EQ(recorded.last_complete_step(), kSteps);
  EXPECT_EQ(first_difference(recorded.chain(), reference().chain()), "");
  const HashChain replayed = chain_of_ticks(load_scene(kScene, "1.6s"), recorded.ticks.at(0));
  EXPECT_EQ(first_difference(replayed, physics_only(recorded.chain())), "");
  // and as `slewring replay --verify` does it, from the scene inside the recording
  Program verify(program_path("slewring"), {"replay", only_recording(session.runs()).string(), "--verify"},
                 session.folder() / "replay");
  EXPECT_EQ(verify.wait(), 0) << verify.out() << verify.err();
}

TEST(Determinism, NightlyLoadOnEveryCoreChangesNoBit) {
  std::atomic<bool> is_done{false};
  std::vector<std::thread> burners;
  for (unsigned i = 0; i < 2 * std::thread::hardware_concurrency(); ++i) {
    burners.emplace_back([&is_done] {
      volatile std::uint64_t work = 0;
      while (!is_done.load(std::memory_order_relaxed)) work = work + 1;
    });
  }
  {
    Session session(kFree);
    session.start_all();
    expect_same_as_in_one_process(session);
  }
  is_done = true;
  for (std::thread& burner : burners) burner.join();
}

class StoppedNode : public ::testing::TestWithParam<Role> {};

TEST_P(StoppedNode, ForTwoHealthMessagesChangesNoBit) {
  Session session({"--pace", "free", "--duration", "0"});
  Observer& observer = session.observer();
  session.start_all();
  ASSERT_TRUE(observer.wait_for_step(300)) << session.errors();
  session.node(GetParam()).send(SIGSTOP);
  const Role other = GetParam() == Role::io ? Role::mechanics : Role::io;
  ASSERT_TRUE(observer.wait_for_healths(other, 2)) << session.errors();
  session.node(GetParam()).send(SIGCONT);
  ASSERT_TRUE(observer.wait_for_step(observer.step() + 300)) << session.errors();
  EXPECT_TRUE(observer.request(wire::ControlAction::stop).is_accepted);
  const RecordedSession recorded = recorded_without_losses(session);
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed_chain(kScene, recorded.last_complete_step())), "");
}

std::string name_of(const ::testing::TestParamInfo<Role>& role) {
  return std::string(node::to_text(role.param));
}

INSTANTIATE_TEST_SUITE_P(Roles, StoppedNode, ::testing::Values(Role::hydraulics), name_of);
INSTANTIATE_TEST_SUITE_P(NightlyRoles, StoppedNode, ::testing::Values(Role::io, Role::mechanics, Role::recorder),
                         name_of);

using Order = std::array<Role, 4>;
class StartOrder : public ::testing::TestWithParam<Order> {};

TEST_P(StartOrder, ChangesNoBit) {
  Session session(kFree);
  for (const Role role : GetParam()) {
    Program& program = session.start(role);
    // the next one starts when the middleware has discovered this one
    ASSERT_TRUE(session.observer().wait_for_process(program.pid())) << program.err();
  }
  expect_same_as_in_one_process(session);
}

// SeparateProcesses starts them in the usual order
INSTANTIATE_TEST_SUITE_P(Permutations, StartOrder,
                         ::testing::Values(Order{Role::recorder, Role::hydraulics, Role::mechanics, Role::io}));
INSTANTIATE_TEST_SUITE_P(NightlyPermutations, StartOrder,
                         ::testing::Values(Order{Role::io, Role::mechanics, Role::hydraulics, Role::recorder},
                                           Order{Role::hydraulics, Role::io, Role::recorder, Role::mechanics},
                                           Order{Role::mechanics, Role::recorder, Role::io, Role::hydraulics}));

}  // namespace determinism_test
}  // namespace slew::testing
