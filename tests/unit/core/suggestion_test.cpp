// SPDX-License-Identifier: Apache-2.0
#include "core/suggestion.h"

#include <gtest/gtest.h>

namespace slew {
namespace suggestion_test {

TEST(Suggestion, EditDistanceCountsInsertionsDeletionsSubstitutionsAndSwaps) {
  EXPECT_EQ(edit_distance("mass", "mass"), 0u);
  EXPECT_EQ(edit_distance("mas", "mass"), 1u);
  EXPECT_EQ(edit_distance("masss", "mass"), 1u);
  EXPECT_EQ(edit_distance("moss", "mass"), 1u);
  EXPECT_EQ(edit_distance("amss", "mass"), 1u);
  EXPECT_EQ(edit_distance("Mass", "mass"), 0u);
  EXPECT_EQ(edit_distance("", "mass"), 4u);
}

TEST(Suggestion, TheNearestNameIsOfferedInAnyOrderOfTheCandidates) {
  EXPECT_EQ(closest("Vol_C", {"Vol_B", "Vol_A", "Tank"}), "Vol_A");
  EXPECT_EQ(closest("Vol_C", {"Tank", "Vol_A", "Vol_B"}), "Vol_A");
}

TEST(Suggestion, NothingIsOfferedForANameThatIsFarFromAll) {
  EXPECT_EQ(closest("damping", {"mass", "inertia"}), "");
  EXPECT_EQ(closest("", {"mass"}), "");
  EXPECT_EQ(closest(std::string(10000, 'x'), {"mass"}), "");
}

}  // namespace suggestion_test
}  // namespace slew
