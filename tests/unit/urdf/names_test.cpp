#include "urdf/names.h"

#include <gtest/gtest.h>

namespace slew::urdf {
namespace names_test {

TEST(SceneNames, KeepWhatASceneTakes) {
  SceneNames names;
  EXPECT_EQ(names.take("upper_arm", "_link"), "upper_arm");
  EXPECT_EQ(names.take("Arm2", "_link"), "Arm2");
}

TEST(SceneNames, ReplaceWhatItDoesNot) {
  SceneNames names;
  EXPECT_EQ(names.take("arm-1.left/end", "_link"), "arm_1_left_end");
  EXPECT_EQ(names.take("2nd link", "_link"), "_2nd_link");
  EXPECT_EQ(names.take("\xC3\xBCr", "_link"), "__r");
}

TEST(SceneNames, GiveEveryNameOnceAndNoReservedOne) {
  SceneNames names;
  EXPECT_EQ(names.take("arm", "_link"), "arm");
  EXPECT_EQ(names.take("arm", "_joint"), "arm_joint");
  EXPECT_EQ(names.take("arm", "_joint"), "arm_joint_2");
  EXPECT_EQ(names.take("arm", "_joint"), "arm_joint_3");
  EXPECT_EQ(names.take("Ground", "_link"), "Ground_link");
  EXPECT_EQ(names.take("joints", "_link"), "joints_link");
}

TEST(SceneNames, CutWhatIsTooLongAndStayDifferent) {
  SceneNames names;
  const std::string name(40, 'a');
  const std::string first = names.take(name, "_link"), second = names.take(name, "_link"),
                    third = names.take(name, "_link");
  EXPECT_EQ(first, std::string(32, 'a'));
  EXPECT_EQ(second, std::string(27, 'a') + "_link");
  EXPECT_EQ(third, std::string(25, 'a') + "_link_2");
}

}  // namespace names_test
}  // namespace slew::urdf
