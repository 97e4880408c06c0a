// SPDX-License-Identifier: Apache-2.0
// A live session that is to go on from a recording: each request is answered once.
#include "view_node/taken_session.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/failure.h"

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
    taken.start({.time = 3}, [&](const gateway::Continuation::Answer& answer) { problems.push_back(answer.problem); });
  }

  // a recording whose second epoch begins at 2 s
  static TakenSession::SessionTime session_time_of(double time) {
    if (time > 4) throw Failure(ExitCode::bad_input, "the recording has no tick there");
    return time < 2 ? TakenSession::SessionTime{0, time} : TakenSession::SessionTime{1, time - 2};
  }

  TakenSession taken{options(), "winch", session_time_of};
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

TEST_F(TakenSessionTest, ATimeIsThatOfItsEpochInTheSession) {
  const auto problem_of = [&](const gateway::ContinuationRequest& request) {
    std::string problem;
    taken.start(request, [&](const gateway::Continuation::Answer& answer) { problem = answer.problem; });
    return problem;
  };
  EXPECT_EQ(problem_of({.time = 5}), "the recording has no tick there");
  // 3 s of the recording are 1 s of the session, which a duration of 1 s would end at once
  EXPECT_NE(problem_of({.time = 3, .duration = 1}).find("would go on at 1 s of its own time"), std::string::npos);
  EXPECT_EQ(problem_of({.time = 3, .duration = 1.5}), "");  // started
}

}  // namespace taken_session_test
