#include "io_node/load_shedding.h"

#include <gtest/gtest.h>

namespace slew::io {
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
  LoadShedding shedding{Shed::variables, View::flex};
  Steering steering = Steering::nobody;
  StepIndex n = 0;
  std::uint64_t judged = 0, overruns = 0;
};

TEST_F(Shedding, GoesLevelByLevelTheViewFirst) {
  EXPECT_EQ(go(300, 4), "");
  EXPECT_EQ(shedding.level(), Shed::none);
  EXPECT_EQ(go(100, 5),
            "session.shed: at step 399 5 of the last 100 steps overran: from now on the values of the flex node's "
            "variables are left out");
  EXPECT_EQ(shedding.level(), Shed::view);
  EXPECT_NE(go(100, 50).find("all physics nodes"), std::string::npos);
  EXPECT_EQ(shedding.level(), Shed::variables);
  EXPECT_EQ(go(1000, 100), "") << "there is nothing more";
}

TEST_F(Shedding, ComesBackLevelByLevelAfterACalmTime) {
  go(200, 10);
  ASSERT_EQ(shedding.level(), Shed::variables);
  EXPECT_EQ(go(1800, 0), "");
  EXPECT_NE(go(200, 0).find("none of the last 2000 steps overran"), std::string::npos);
  EXPECT_EQ(shedding.level(), Shed::view);
  go(1000, 1);
  EXPECT_EQ(shedding.level(), Shed::view) << "one overrun begins the calm time anew";
  EXPECT_NE(go(2100, 0).find("nothing is left out"), std::string::npos);
  EXPECT_EQ(shedding.level(), Shed::none);
}

TEST_F(Shedding, AControllerKeepsItsVariables) {
  go(200, 10);
  ASSERT_EQ(shedding.level(), Shed::variables);
  steering = Steering::controllers;
  EXPECT_NE(go(1, 0).find("a controller steers"), std::string::npos);
  EXPECT_EQ(shedding.level(), Shed::view);
  go(500, 50);
  EXPECT_EQ(shedding.level(), Shed::view);
}

TEST_F(Shedding, WithoutAFlexNodeThereIsNoView) {
  shedding = LoadShedding(Shed::variables, View::none);
  EXPECT_NE(go(100, 5).find("all physics nodes"), std::string::npos);
  EXPECT_EQ(shedding.level(), Shed::variables);
  EXPECT_NE(go(2100, 0).find("nothing is left out"), std::string::npos);
  EXPECT_EQ(shedding.level(), Shed::none);
  go(100, 5);
  ASSERT_EQ(shedding.level(), Shed::variables);
  steering = Steering::controllers;
  EXPECT_NE(go(1, 0).find("a controller steers: from now on nothing is left out"), std::string::npos);
  EXPECT_EQ(go(500, 50), "");
  shedding = LoadShedding(Shed::view, View::none);
  EXPECT_EQ(go(1000, 100), "");
}

TEST_F(Shedding, GoesNoFurtherThanItMay) {
  shedding = LoadShedding(Shed::none, View::flex);
  EXPECT_EQ(go(1000, 100), "");
  shedding = LoadShedding(Shed::view, View::flex);
  go(1000, 100);
  EXPECT_EQ(shedding.level(), Shed::view);
}

}  // namespace load_shedding_test
}  // namespace slew::io
