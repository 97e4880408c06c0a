// SPDX-License-Identifier: Apache-2.0
// Effects of keys on the levers.
#include "cli/keyboard.h"

#include <gtest/gtest.h>

namespace slew::cli {
namespace keyboard_test {

Levers two_levers_and_a_button() {
  std::vector<scene::InputDef> inputs(3);
  inputs[0].name = "Slew";
  inputs[1].name = "Lift";
  inputs[2].name = "Horn";
  inputs[2].type = scene::InputType::digital;
  return Levers(inputs);
}

TEST(Levers, MoveByATenthAndStopAtTheEnds) {
  Levers levers = two_levers_and_a_button();
  levers.take_keys("qqa");
  EXPECT_DOUBLE_EQ(levers.value(0), 0.1);
  levers.take_keys("wwwwwwwwwwwwwww");
  EXPECT_DOUBLE_EQ(levers.value(1), 1.0);
  levers.take_keys("ssssssssssssssssssssssss");
  EXPECT_DOUBLE_EQ(levers.value(1), -1.0);
}

TEST(Levers, ArrowsMoveTheFirstTwo) {
  Levers levers = two_levers_and_a_button();
  levers.take_keys("\x1b[C\x1b[C\x1b[A\x1b[D");
  EXPECT_DOUBLE_EQ(levers.value(0), 0.1);
  EXPECT_DOUBLE_EQ(levers.value(1), 0.1);
  levers.take_keys("\x1b[B");
  EXPECT_DOUBLE_EQ(levers.value(1), 0.0);
}

TEST(Levers, AButtonIsToggled) {
  Levers levers = two_levers_and_a_button();
  levers.take_keys("e");
  EXPECT_DOUBLE_EQ(levers.value(2), 1.0);
  levers.take_keys("d");
  EXPECT_DOUBLE_EQ(levers.value(2), 1.0);
  levers.take_keys("e");
  EXPECT_DOUBLE_EQ(levers.value(2), 0.0);
}

TEST(Levers, SpacePutsEverythingToNeutral) {
  Levers levers = two_levers_and_a_button();
  levers.take_keys("qwe ");
  for (std::size_t i = 0; i < levers.size(); ++i) EXPECT_DOUBLE_EQ(levers.value(i), 0.0);
}

TEST(Levers, IgnoreOtherKeysAndCutSequences) {
  Levers levers = two_levers_and_a_button();
  levers.take_keys("zx\x1b[Z\x1b");
  for (std::size_t i = 0; i < levers.size(); ++i) EXPECT_DOUBLE_EQ(levers.value(i), 0.0);
}

TEST(Levers, ListTheKeysOfEachInput) {
  EXPECT_EQ(two_levers_and_a_button().help(), "keyboard: q/a Slew  w/s Lift  e/d Horn  space neutral  Ctrl-C end");
}

TEST(Levers, LeaveLockstepInputsToTheirControllers) {
  std::vector<scene::InputDef> inputs(2);
  inputs[0].name = "Slew";
  inputs[0].controller = scene::ControllerMode::lockstep;
  inputs[1].name = "Lift";
  EXPECT_EQ(Levers(inputs).help(), "keyboard: q/a Lift  space neutral  Ctrl-C end");
}

}  // namespace keyboard_test
}  // namespace slew::cli
