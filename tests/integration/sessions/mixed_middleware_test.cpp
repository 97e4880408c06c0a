// SPDX-License-Identifier: Apache-2.0
// Sessions whose nodes have different middlewares: the bits are those of one process.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <ostream>
#include <vector>

#include "build_paths.h"
#include "direct_chain.h"
#include "namespaces.h"
#include "session.h"
#include "transport/network.h"

namespace slew::testing {
namespace mixed_middleware_test {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

struct Mix {
  const char* name;
  std::vector<Role> roles;  // nodes over `middleware`, the others over Cyclone
  const char* middleware = "fastdds";
};
// in the names of tests
void PrintTo(const Mix& mix, std::ostream* out) {
  *out << mix.name;
}

void start(Session& session, Role role, const Mix& mix) {
  const bool is_other = std::ranges::find(mix.roles, role) != mix.roles.end();
  session.start(role, is_other ? std::vector<std::string>{"--middleware", mix.middleware} : std::vector<std::string>{});
}

void start_all(Session& session, const Mix& mix) {
  for (const Role role : kAllNodes) start(session, role, mix);
}

void expect_bits_of_one_process(Session& session, StepIndex steps) {
  ASSERT_EQ(session.wait_all(120'000'000'000), all_ok()) << session.errors();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_TRUE(recorded.has_all_messages);
  EXPECT_EQ(recorded.losses(), 0);
  EXPECT_EQ(recorded.last_complete_step(), steps);
  EXPECT_EQ(first_difference(recorded.chain(), undisturbed_chain(kScene, steps)), "");
}

class Mixed : public ::testing::TestWithParam<Mix> {
 protected:
  void SetUp() override {
    if (!transport::is_built(transport::Middleware::fastdds)) {
      GTEST_SKIP() << "this build has no Fast DDS: libfastrtps-dev was not there";
    }
  }
};

TEST_P(Mixed, MiddlewaresGiveTheBitsOfOneProcess) {
  Session session({"--pace", "free", "--duration", "1.6s"});
  start_all(session, GetParam());
  expect_bits_of_one_process(session, 1600);
}

TEST_P(Mixed, MiddlewaresOverACableThatLosesDatagramsToo) {
  NamespacePair cable;
  if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
  Session session({"--pace", "free", "--duration", "1.6s"});
  distribute(session, cable);
  if (!cable.lose(5)) GTEST_SKIP() << "datagrams cannot be lost here: " << cable.problem();
  start_all(session, GetParam());
  expect_bits_of_one_process(session, 1600);
  EXPECT_GT(cable.lost(cable.left()), 0u) << "nothing was lost: the test shows nothing";
  EXPECT_GT(cable.lost(cable.right()), 0u) << "nothing was lost: the test shows nothing";
}

TEST_P(Mixed, MiddlewaresWhoseMechanicsIsKilledAndReplacedToo) {
  Session session({"--pace", "real", "--duration", "1.6s", "--set", "session.rejoin=20s"});
  Observer& observer = session.observer();
  start_all(session, GetParam());
  ASSERT_TRUE(observer.wait_for_step(400)) << session.errors();
  session.node(Role::mechanics).send(SIGKILL);
  ASSERT_TRUE(observer.wait_until([&] {
    const auto& io = observer.status(Role::io);
    return io->state == wire::NodeState::holding && io->reason.find("its place is held for 20 s") != std::string::npos;
  })) << session.errors();
  start(session, Role::mechanics, GetParam());
  expect_bits_of_one_process(session, 1600);
  EXPECT_NE(session.node(Role::io).err().find("goes on in the place of"), std::string::npos) << session.errors();
}

const auto name_of = [](const auto& mix) { return std::string(mix.param.name); };
INSTANTIATE_TEST_SUITE_P(Session, Mixed, ::testing::Values(Mix{"MechanicsOnFastDds", {Role::mechanics}}), name_of);
INSTANTIATE_TEST_SUITE_P(
    NightlySession, Mixed,
    ::testing::Values(Mix{"AllButMechanicsOnFastDds", {Role::io, Role::hydraulics, Role::recorder}},
                      Mix{"AllOnFastDds", {kAllNodes.begin(), kAllNodes.end()}},
                      Mix{"PhysicsInSharedMemory", {Role::mechanics, Role::hydraulics}, "fastdds-shm"}),
    name_of);

}  // namespace mixed_middleware_test
}  // namespace slew::testing
