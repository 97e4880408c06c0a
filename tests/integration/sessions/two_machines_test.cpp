// SPDX-License-Identifier: Apache-2.0
// A session over a cable: mechanics and recorder in one network namespace, hydraulics and io in another.
#include <gtest/gtest.h>

#include <csignal>

#include "build_paths.h"
#include "direct_chain.h"
#include "namespaces.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace two_machines_test {

using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";

class TwoMachines : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!cable.problem().empty()) GTEST_SKIP() << "network namespaces are not possible here: " << cable.problem();
  }
  NamespacePair cable;
};

TEST_F(TwoMachines, GiveTheSameBitsAsOneProcess) {
  Session session({"--pace", "free", "--duration", "1.6s"});
  distribute(session, cable);
  session.start_all();
  ASSERT_EQ(session.wait_all(), all_ok()) << session.errors();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_EQ(recorded.losses(), 0);
  const ScratchFolder folder;
  const RecordedSession reference = run_in_one_process(load_scene(kScene, "1.6s"), folder.path() / "runs");
  EXPECT_EQ(first_difference(recorded.chain(), reference.chain()), "");
}

TEST_F(TwoMachines, WhoseCableBreaksNameEachOtherAndEndWithCode4) {
  Session session({"--pace", "real", "--duration", "20s"});
  distribute(session, cable);
  session.start_all();
  ASSERT_TRUE(session.wait_for_recorded_step()) << session.errors();
  cable.unplug();
  for (const auto& [role, code] : session.wait_all())
    EXPECT_EQ(code, 4) << node::to_text(role) << "\n" << session.errors();
  EXPECT_NE(session.node(Role::io).err().find(" is gone"), std::string::npos) << session.errors();
  EXPECT_NE(session.node(Role::mechanics).err().find(" is gone"), std::string::npos) << session.errors();
  const RecordedSession recorded = session.recorded();
  EXPECT_EQ(recorded.problem, "");
  EXPECT_GT(recorded.last_complete_step(), 0);
}

}  // namespace two_machines_test
}  // namespace slew::testing
