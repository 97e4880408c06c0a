// SPDX-License-Identifier: Apache-2.0
// Choosing variables by names and patterns.
#include "scene/name_pattern.h"

#include <gtest/gtest.h>

#include "core/failure.h"

namespace slew::scene {
namespace name_pattern_test {

const std::vector<std::string> kNames = {"Cyl_Lift.force", "Cyl_Jib.force", "Cyl_Lift.stroke", "Bag.position.y"};

TEST(Choose, KeepsTheOrderOfTheNamesAndGivesNoNameTwice) {
  const std::vector<std::string> patterns = {"Bag.position.y", "Cyl_*.force", "Cyl_Lift.*"};
  EXPECT_EQ(choose(patterns, kNames),
            (std::vector<std::string>{"Bag.position.y", "Cyl_Lift.force", "Cyl_Jib.force", "Cyl_Lift.stroke"}));
}

TEST(Choose, NamesTheVariableThatWasProbablyMeant) {
  const std::vector<std::string> patterns = {"Cyl_Lft.force"};
  try {
    static_cast<void>(choose(patterns, kNames));
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

TEST(Patterns, MeetWhereANameMayFitBoth) {
  EXPECT_TRUE(can_meet("Cyl_*.force", "Cyl_Lift.*"));
  EXPECT_TRUE(can_meet("*", ""));
  EXPECT_TRUE(can_meet("*.y", "Bag.*"));
  EXPECT_TRUE(can_meet("Bag.position.y", "Bag.*.?"));
  EXPECT_TRUE(can_meet("a*c", "*b*"));
  EXPECT_FALSE(can_meet("Bag.position.y", "Cyl_*"));
  EXPECT_FALSE(can_meet("Vol_*.pressure", "Cyl_*"));
  EXPECT_FALSE(can_meet("*.y", "*.x"));
  EXPECT_FALSE(can_meet("a?", "a"));
  EXPECT_FALSE(can_meet("", "?"));
  const std::vector<std::string> patterns = {"Vol_*", "*.stroke", "Bag.position.x"};
  EXPECT_EQ(unmatched(patterns, kNames), (std::vector<std::string>{"Vol_*", "Bag.position.x"}));
}

}  // namespace name_pattern_test
}  // namespace slew::scene
