// SPDX-License-Identifier: Apache-2.0
// Promises of the design in wall time. Any other load counts against it: judged alone on the machine, by `--nightly`.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

#include "free_running.h"
#include "node/identity.h"
#include "session.h"

namespace slew::testing {
namespace wall_time_test {

using coupling::Quality;
using wire::Role;

// from a node's death to its name, by the time stamps of the messages themselves
constexpr std::int64_t kNamedWithinNs = 500'000'000;

class NightlyWallTime : public ::testing::TestWithParam<Role> {};

// A killed recorder closes no recording in which this could be read.
TEST_P(NightlyWallTime, AKilledNodeIsNamedWithinHalfASecond) {
  for (const char* pace : {"real", "free"}) {
    Session session({"--pace", pace, "--duration", "100s"});
    session.start_all();
    ASSERT_TRUE(session.observer().wait_for_step(300)) << session.errors();
    session.node(GetParam()).send(SIGKILL);
    static_cast<void>(session.wait_all());
    const RecordedSession recorded = session.recorded();
    std::int64_t named_ns = INT64_MAX;
    for (const PublishedStatus& published : recorded.statuses) {
      if (published.status.reason.find("is gone") != std::string::npos)
        named_ns = std::min(named_ns, published.sent_ns);
    }
    ASSERT_NE(named_ns, INT64_MAX) << session.errors();
    EXPECT_LT(named_ns - recorded.last_word_before(GetParam(), named_ns), kNamedWithinNs) << pace;
  }
}

INSTANTIATE_TEST_SUITE_P(Roles, NightlyWallTime, ::testing::Values(Role::io, Role::mechanics, Role::hydraulics),
                         [](const auto& role) { return std::string(node::to_text(role.param)); });

TEST(NightlyFreeRunning, TakesAPartnersSamplesInTimeAgainWhenItHasStoodStill) {
  EXPECT_GT(count(run_with_a_partner_that_stands_still().mechanisms, Quality::ok), 1000);
}

TEST(NightlyFreeRunning, OverACableThatLosesOnePercentIsGreenOrAmber) {
  const LossyRun run = run_over_a_lossy_cable(600);
  if (!run.problem.empty()) GTEST_SKIP() << run.problem;
  EXPECT_GT(run.late, 0) << "every sample came in time: the test shows nothing";
  EXPECT_LT(largest_eta(run.recorded), coupling::kAmberBelow);
}

}  // namespace wall_time_test
}  // namespace slew::testing
