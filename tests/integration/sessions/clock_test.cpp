// SPDX-License-Identifier: Apache-2.0
// The wall clock of the nodes is wrong by hours, differs between them, or jumps while they run: nothing changes but the
// time stamps.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <memory>

#include "build_paths.h"
#include "core/time.h"
#include "direct_chain.h"
#include "node/identity.h"
#include "session.h"
#include "shifted_clock.h"

namespace slew::testing {
namespace clock_test {

using wire::NodeState;
using wire::Role;

constexpr const char* kScene = SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml";
constexpr std::int64_t kHour = std::int64_t{3600} * 1'000'000'000;

// The wall clocks of a session's nodes.
class Clocks {
 public:
  explicit Clocks(Session& session) {
    for (const Role role : kAllNodes) {
      const std::string path = session.folder() / ("clock_of_" + std::string(node::to_text(role)));
      const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
      if (file < 0 || ftruncate(file, sizeof(ClockShift)) != 0) throw std::runtime_error("cannot write " + path);
      void* const page = mmap(nullptr, sizeof(ClockShift), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      close(file);
      if (page == MAP_FAILED) throw std::runtime_error("cannot map " + path);
      shifts_[role] = static_cast<ClockShift*>(page);
      session.run_under(role,
                        {"/usr/bin/env", std::string("LD_PRELOAD=") + SLEWRING_SHIFTED_CLOCK,
                         std::string(kClockShiftVariable) + "=" + path},
                        {});
    }
  }
  ~Clocks() {
    for (const auto& [role, shift] : shifts_) munmap(shift, sizeof(ClockShift));
  }
  Clocks(const Clocks&) = delete;
  Clocks& operator=(const Clocks&) = delete;

  void set(Role role, std::int64_t shift_ns) { shifts_.at(role)->ns = shift_ns; }
  void set_all(std::int64_t shift_ns) {
    for (const Role role : kAllNodes) set(role, shift_ns);
  }
  [[nodiscard]] bool all_are_read() const {
    for (const auto& [role, shift] : shifts_) {
      if (shift->reads == 0) return false;
    }
    return true;
  }

 private:
  std::map<Role, ClockShift*> shifts_;
};

class WallClock : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::string(SLEWRING_SANITIZER) != "") GTEST_SKIP() << "a sanitizer wants to be the first library itself";
  }

  // Ends the session here; it was as one in which nothing happens.
  void expect_an_undisturbed_session() {
    EXPECT_TRUE(session.observer().request(wire::ControlAction::stop).is_accepted);
    ASSERT_EQ(session.wait_all(), all_ok()) << session.errors();
    EXPECT_TRUE(clocks.all_are_read()) << "the clock was not in the way: the test shows nothing";
    for (const Role role : kAllNodes) EXPECT_EQ(session.node(role).err(), "") << node::to_text(role);
    recorded = session.recorded();
    EXPECT_EQ(recorded.problem, "");
    EXPECT_TRUE(recorded.has_all_messages);
    EXPECT_EQ(recorded.losses(), 0);
    for (const PublishedStatus& published : recorded.statuses) {
      EXPECT_NE(published.status.state, NodeState::holding) << published.status.reason;
      EXPECT_EQ(published.status.reason, "");
    }
    // the slips of a busy machine, and none of the hours
    EXPECT_LT(recorded.largest.at("session.slip"), 60);
    EXPECT_EQ(first_difference(recorded.chain(), undisturbed_chain(kScene, recorded.last_complete_step())), "");
  }

  // no message about a busy machine
  Session session{{"--pace", "real", "--duration", "0", "--set", "session.overrun_lag=60s"}};
  Clocks clocks{session};
  RecordedSession recorded;
};

TEST_F(WallClock, ThatDiffersByHoursBetweenTheNodesChangesNothing) {
  clocks.set(Role::mechanics, 5 * kHour);
  clocks.set(Role::hydraulics, -7 * kHour);
  clocks.set(Role::recorder, 30 * 24 * kHour);
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(1000)) << session.errors();
  expect_an_undisturbed_session();
}

struct Jump {
  const char* name;
  std::int64_t shift_ns;
  bool is_of_all;  // otherwise of one node
};
void PrintTo(const Jump& jump, std::ostream* out) {
  *out << jump.name;
}

class JumpingClock : public WallClock, public ::testing::WithParamInterface<Jump> {
 protected:
  void jump(std::int64_t shift_ns) {
    if (GetParam().is_of_all) {
      clocks.set_all(shift_ns);
    } else {
      clocks.set(Role::hydraulics, shift_ns);
    }
  }
};

// the clock of all nodes or of one
TEST_P(JumpingClock, InMidRunChangesNothing) {
  session.start_all();
  ASSERT_TRUE(session.observer().wait_for_step(300)) << session.errors();
  jump(GetParam().shift_ns);
  // a client that comes now finds the session, and is answered
  Program late(program_path("slewring"),
               {"param", "get", "Bag.mass", "--session", session.name(), "--domain", std::to_string(session.domain())},
               session.folder() / "late");
  EXPECT_EQ(late.wait(), 0) << late.err();
  ASSERT_TRUE(session.observer().wait_for_step(session.observer().step() + 1000)) << session.errors();
  jump(0);
  ASSERT_TRUE(session.observer().wait_for_step(session.observer().step() + 500)) << session.errors();
  expect_an_undisturbed_session();
}

const auto name_of = [](const ::testing::TestParamInfo<Jump>& jump) { return std::string(jump.param.name); };
INSTANTIATE_TEST_SUITE_P(Hours, JumpingClock, ::testing::Values(Jump{"one_back", -3 * kHour, false}), name_of);
INSTANTIATE_TEST_SUITE_P(NightlyHours, JumpingClock,
                         ::testing::Values(Jump{"all_ahead", 3 * kHour, true}, Jump{"all_back", -3 * kHour, true},
                                           Jump{"one_ahead", 3 * kHour, false}),
                         name_of);

}  // namespace clock_test
}  // namespace slew::testing
