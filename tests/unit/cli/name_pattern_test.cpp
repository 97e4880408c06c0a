// Choosing variables by names and patterns, and names of sessions.
#include "cli_support/name_pattern.h"

#include <gtest/gtest.h>

#include "cli_support/failure.h"
#include "cli_support/session_options.h"

namespace slew::cli_support {
namespace {

const std::vector<std::string> kNames = {"Cyl_Lift.force", "Cyl_Jib.force", "Cyl_Lift.stroke", "Bag.position.y"};

TEST(Choose, KeepsTheOrderOfTheWishesAndGivesNoNameTwice) {
  const std::vector<std::string> wishes = {"Bag.position.y", "Cyl_*.force", "Cyl_Lift.*"};
  EXPECT_EQ(choose(wishes, kNames),
            (std::vector<std::string>{"Bag.position.y", "Cyl_Lift.force", "Cyl_Jib.force", "Cyl_Lift.stroke"}));
}

TEST(Choose, NamesTheVariableThatWasProbablyMeant) {
  const std::vector<std::string> wishes = {"Cyl_Lft.force"};
  try {
    static_cast<void>(choose(wishes, kNames));
    FAIL() << "the misspelt name was taken";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::bad_input);
    EXPECT_STREQ(failure.what(), "there is no variable 'Cyl_Lft.force'; did you mean 'Cyl_Lift.force'?");
  }
}

TEST(Matching, GivesIndicesAscending) {
  const std::vector<std::string> patterns = {"*.stroke", "Cyl_J*"};
  EXPECT_EQ(matching(patterns, kNames), (std::vector<std::uint32_t>{1, 2}));
}

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

}  // namespace
}  // namespace slew::cli_support
