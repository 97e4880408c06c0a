// SPDX-License-Identifier: Apache-2.0
// A live session that is to go on from a recording: each request is answered once.
#include "view_node/taken_session.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace taken_session_test {

using namespace slew;
using namespace slew::view_node;

// There is no such recording: the session ends at once.
class TakenSessionTest : public ::testing::Test {
 protected:
  static WindowOptions options() {
    WindowOptions options;
    options.recording = "no_such_recording.mcap";
    return options;
  }
  void start(std::vector<std::string>& problems) {
    taken.start({}, [&](const gateway::Continuation::Answer& answer) { problems.push_back(answer.problem); });
  }

  TakenSession taken{options(), "winch"};
  std::vector<std::string> first, second;
};

TEST_F(TakenSessionTest, ARequestIsAnsweredWhenAnotherComesBehindTheEndOfItsSession) {
  start(first);
  ASSERT_TRUE(first.empty());
  siginfo_t ended{};
  ASSERT_EQ(waitid(P_ALL, 0, &ended, WEXITED | WNOWAIT), 0);  // one that is not looked at yet
  start(second);
  ASSERT_EQ(second.size(), 1u);
  EXPECT_NE(second[0].find("nothing was started"), std::string::npos) << second[0];
  while (first.empty()) static_cast<void>(taken.poll());
  EXPECT_NE(first[0], "");
  static_cast<void>(taken.poll());
  EXPECT_EQ(first.size(), 1u);
  EXPECT_EQ(second.size(), 1u);
}

TEST_F(TakenSessionTest, AWindowThatCannotBeStartedLeavesNoSession) {
  // the session's pipe takes two descriptors and keeps one: the window's finds one alone
  const int lowest = open("/dev/null", O_RDONLY | O_CLOEXEC);
  close(lowest);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit tight = before;
  tight.rlim_cur = static_cast<rlim_t>(lowest) + 2;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &tight), 0);
  start(first);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_NE(first[0].find("no pipe for window"), std::string::npos) << first[0];
  EXPECT_TRUE(taken.poll().empty());
  // the next request is not refused for the sake of this one
  start(second);
  EXPECT_TRUE(second.empty());
}

}  // namespace taken_session_test
