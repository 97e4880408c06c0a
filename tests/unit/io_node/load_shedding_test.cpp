// SPDX-License-Identifier: Apache-2.0
#include "io_node/load_shedding.h"

#include <gtest/gtest.h>

namespace slew::io_node {
namespace load_shedding_test {

class Shedding : public ::testing::Test {
 protected:
  // so many steps, the first of every hundred of them late; the events in a row
  std::string go(int steps, int late_of_hundred) {
    std::string events;
    for (int i = 0; i < steps; ++i) {
      ++judged;
      if (i % 100 < late_of_hundred) ++overruns;
      events += shedding.look(n++, judged, overruns, steering);
    }
    return events;
  }
  LoadShedding shedding{scene::ShedLoad::variables, View::flex};
  Steering steering = Steering::none;
  StepIndex n = 0;
  std::uint64_t judged = 0, overruns = 0;
};

TEST_F(Shedding, GoesLevelByLevelTheViewFirst) {
  EXPECT_EQ(go(300, 4), "");
  EXPECT_EQ(shedding.level(), scene::ShedLoad::none);
  EXPECT_EQ(go(100, 5),
            "session.shed: at step 399 5 of the last 100 steps overran: from now on the values of the flex node's "
            "variables are left out");
  EXPECT_EQ(shedding.level(), scene::ShedLoad::view);
  EXPECT_NE(go(100, 50).find("all physics nodes"), std::string::npos);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::variables);
  EXPECT_EQ(go(1000, 100), "") << "there is nothing more";
}

TEST_F(Shedding, ComesBackLevelByLevelAfterACalmTime) {
  go(200, 10);
  ASSERT_EQ(shedding.level(), scene::ShedLoad::variables);
  EXPECT_EQ(go(1800, 0), "");
  EXPECT_NE(go(200, 0).find("none of the last 2000 steps overran"), std::string::npos);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::view);
  go(1000, 1);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::view) << "one overrun restarts the calm time";
  EXPECT_NE(go(2100, 0).find("nothing is left out"), std::string::npos);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::none);
}

TEST_F(Shedding, AControllerKeepsItsVariables) {
  go(200, 10);
  ASSERT_EQ(shedding.level(), scene::ShedLoad::variables);
  steering = Steering::controllers;
  EXPECT_NE(go(1, 0).find("a controller steers"), std::string::npos);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::view);
  go(500, 50);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::view);
}

TEST_F(Shedding, WithoutAFlexNodeThereIsNoView) {
  shedding = LoadShedding(scene::ShedLoad::variables, View::none);
  EXPECT_NE(go(100, 5).find("all physics nodes"), std::string::npos);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::variables);
  EXPECT_NE(go(2100, 0).find("nothing is left out"), std::string::npos);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::none);
  go(100, 5);
  ASSERT_EQ(shedding.level(), scene::ShedLoad::variables);
  steering = Steering::controllers;
  EXPECT_NE(go(1, 0).find("a controller steers: from now on nothing is left out"), std::string::npos);
  EXPECT_EQ(go(500, 50), "");
  shedding = LoadShedding(scene::ShedLoad::view, View::none);
  EXPECT_EQ(go(1000, 100), "");
}

TEST_F(Shedding, GoesNoFurtherThanItMay) {
  shedding = LoadShedding(scene::ShedLoad::none, View::flex);
  EXPECT_EQ(go(1000, 100), "");
  shedding = LoadShedding(scene::ShedLoad::view, View::flex);
  go(1000, 100);
  EXPECT_EQ(shedding.level(), scene::ShedLoad::view);
}

}  // namespace load_shedding_test
}  // namespace slew::io_node
