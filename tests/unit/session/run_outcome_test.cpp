// SPDX-License-Identifier: Apache-2.0
// Which of the nodes' messages a person gets to see.
#include "session/run.h"

#include <gtest/gtest.h>

namespace slew::session {
namespace run_outcome_test {

using Messages = std::vector<std::string>;

TEST(Messages, AForwardedReasonIsReportedOnceByItsSource) {
  const Messages all = {"io_node: recorder (process 7 on vm): runs: the disk is full; nothing is kept",
                        "recorder_node: runs: the disk is full; nothing is kept"};
  EXPECT_EQ(without_echoes(all), Messages{"recorder_node: runs: the disk is full; nothing is kept"});
}

TEST(Messages, EqualOnesAreReportedOnce) {
  const Messages all = {"a_node: lost", "a_node: lost"};
  EXPECT_EQ(without_echoes(all), Messages{"a_node: lost"});
}

TEST(Messages, DifferentReasonsAreAllReported) {
  const Messages all = {"io_node: mechanics is gone", "recorder_node: the disk is full"};
  EXPECT_EQ(without_echoes(all), all);
}

TEST(RunClock, CountsAPauseApartButNotTheStepsDoneInIt) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  RunClock clock;
  clock.measure(5 * kSecond, 1, false);
  EXPECT_EQ(clock.running(), 0);
  clock.measure(7 * kSecond, 2000, false);
  clock.measure(17 * kSecond, 2000, true);
  clock.measure(18 * kSecond, 2500, true);  // single steps
  clock.measure(21 * kSecond, 2500, true);
  clock.measure(22 * kSecond, 3500, false);
  EXPECT_DOUBLE_EQ(clock.running(), 4);
  EXPECT_DOUBLE_EQ(clock.paused(), 13);
}

TEST(RunOptions, AssetsAreBesideTheScene) {
  RunOptions options;
  options.scene.file = "scenes/crane.yaml";
  EXPECT_EQ(options.assets(), "scenes");
  options.scene.file = "crane.yaml";
  EXPECT_EQ(options.assets(), ".");
}

}  // namespace run_outcome_test
}  // namespace slew::session
