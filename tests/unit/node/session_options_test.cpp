// SPDX-License-Identifier: Apache-2.0
#include "node/session_options.h"

#include <gtest/gtest.h>

namespace slew::node {
namespace session_options_test {

TEST(SessionName, IsMadeOfASceneNameByReplacingWhatIsNotAllowed) {
  EXPECT_EQ(session_name_of("truck crane/heavy"), "truck_crane_heavy");
  EXPECT_EQ(session_name_of(""), "session");
  EXPECT_TRUE(problem_of_session_name(session_name_of(std::string(200, 'x'))).empty());
}

TEST(SessionName, RefusesPartitionWildcards) {
  EXPECT_TRUE(problem_of_session_name("crane-1.test_2").empty());
  EXPECT_FALSE(problem_of_session_name("*").empty());
  EXPECT_FALSE(problem_of_session_name("a/b").empty());
  EXPECT_FALSE(problem_of_session_name("").empty());
  EXPECT_FALSE(problem_of_session_name(std::string(64, 'x')).empty());
}

}  // namespace session_options_test
}  // namespace slew::node
