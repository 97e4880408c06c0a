// Which of the nodes' messages a person gets to see.
#include "cli/run_outcome.h"

#include <gtest/gtest.h>

namespace slew::cli {
namespace {

using Messages = std::vector<std::string>;

TEST(Messages, AReasonThatWasPassedOnIsToldOnceByItsSource) {
  const Messages all = {"io_node: recorder (process 7 on vm): runs: the disk is full; nothing is kept",
                        "recorder_node: runs: the disk is full; nothing is kept"};
  EXPECT_EQ(without_echoes(all), Messages{"recorder_node: runs: the disk is full; nothing is kept"});
}

TEST(Messages, EqualOnesAreToldOnce) {
  const Messages all = {"a_node: lost", "a_node: lost"};
  EXPECT_EQ(without_echoes(all), Messages{"a_node: lost"});
}

TEST(Messages, DifferentReasonsAreAllTold) {
  const Messages all = {"io_node: mechanics is gone", "recorder_node: the disk is full"};
  EXPECT_EQ(without_echoes(all), all);
}

TEST(RunOptions, AssetsAreBesideTheScene) {
  RunOptions options;
  options.scene.file = "scenes/crane.yaml";
  EXPECT_EQ(options.assets(), "scenes");
  options.scene.file = "crane.yaml";
  EXPECT_EQ(options.assets(), ".");
}

}  // namespace
}  // namespace slew::cli
