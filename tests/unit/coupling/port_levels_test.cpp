// SPDX-License-Identifier: Apache-2.0
// Levels of the ports: a port's own or the session's, changed by the paths of the scene.
#include "coupling/port_levels.h"

#include <gtest/gtest.h>

namespace slew::coupling {
namespace port_levels_test {

std::uint64_t hash_of(const PortLevels& levels) {
  StateHash hash;
  levels.add_to(hash);
  return hash.digest();
}

class Levels : public ::testing::Test {
 protected:
  PortLevels levels{Level::two, {{"Lift", PortLevel::session}, {"Jib", PortLevel::hold}, {"Slew", PortLevel::tlm}}};
};

TEST_F(Levels, AreAPortsOwnOrTheSessions) {
  EXPECT_EQ(levels[0], Level::two);
  EXPECT_EQ(levels[1], Level::hold);
  EXPECT_EQ(levels[2], Level::tlm);
  EXPECT_EQ(levels.lowest(), Level::hold);
  EXPECT_EQ(PortLevels(Level::linear, {}).lowest(), Level::linear);
}

TEST_F(Levels, ThatFollowTheSessionChangeWithIt) {
  EXPECT_TRUE(levels.change("session.coupling", 1));
  EXPECT_EQ(levels[0], Level::linear);
  EXPECT_EQ(levels[1], Level::hold);
  EXPECT_TRUE(levels.change("Jib.coupling", 0));
  EXPECT_EQ(levels[1], Level::linear);
  EXPECT_TRUE(levels.change("Jib.coupling", 4));
  EXPECT_EQ(levels[1], Level::tlm);
  levels.reset();
  EXPECT_EQ(levels[0], Level::two);
  EXPECT_EQ(levels[1], Level::hold);
}

TEST_F(Levels, StayForWhatIsNoLevelOfAPort) {
  for (const auto& [path, value] : {std::pair("session.coupling", 4.0),
                                    {"session.coupling", 0.5},
                                    {"Lift.coupling", 5.0},
                                    {"Lift.coupling", -1.0},
                                    {"Lif.coupling", 1.0},
                                    {"Lift.leak_flow", 1.0},
                                    {".coupling", 1.0},
                                    {"coupling", 1.0}}) {
    EXPECT_FALSE(levels.change(path, value)) << path << " " << value;
  }
  EXPECT_EQ(levels[0], Level::two);
}

TEST_F(Levels, AreInTheHashOnceTheyDifferFromTheScene) {
  const std::uint64_t of_scene = hash_of(levels);
  ASSERT_TRUE(levels.change("Lift.coupling", 3));  // two, as it was by the session
  const std::uint64_t own = hash_of(levels);
  EXPECT_NE(own, of_scene);
  ASSERT_TRUE(levels.change("Lift.coupling", 0));
  EXPECT_EQ(hash_of(levels), of_scene);
  ASSERT_TRUE(levels.change("session.coupling", 1));
  EXPECT_NE(hash_of(levels), of_scene);
  EXPECT_NE(hash_of(levels), own);
}

}  // namespace port_levels_test
}  // namespace slew::coupling
