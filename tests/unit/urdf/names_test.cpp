// SPDX-License-Identifier: Apache-2.0
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
}

TEST(SceneNames, StayRecognisableInAnyScript) {
  SceneNames names;
  EXPECT_EQ(names.take("T\xC3\xBCr_Gro\xC3\x9F", "_link"), "Tuer_Gross");
  EXPECT_EQ(names.take("\xD0\xB1\xD1\x83\xD0\xBC", "_link"), "bum");              // Cyrillic
  EXPECT_EQ(names.take("\xCE\xB2\xCF\x81\xCE\xB1\xCF\x87", "_link"), "vrach");    // Greek
  EXPECT_EQ(names.take("\xE3\x82\xA2\xE3\x83\xBC\xE3\x83\xA0", "_link"), "amu");  // katakana
  EXPECT_EQ(names.take("\xE3\x81\x86\xE3\x81\xA7", "_link"), "ude");              // hiragana
  EXPECT_EQ(names.take("\xED\x8C\x94", "_link"), "pal");                          // Hangul
  EXPECT_EQ(names.take("\xE8\x87\x82_1", "_link"), "u81C2_1");                    // no letters
  EXPECT_EQ(names.take("e\xCC\x81", "_link"), "e");                               // combining accent
  EXPECT_EQ(names.take("a\xFF", "_link"), "a_");                                  // no UTF-8
  EXPECT_EQ(names.take("\xE8\x87", "_link"), "__") << "cut within a character";
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

TEST(SceneNames, AreNoValuesOfYaml) {
  SceneNames names;
  for (const std::string word : {"null", "True", "NO", "on", "y"}) EXPECT_EQ(names.take(word, "_link"), word + "_link");
  EXPECT_EQ(names.take("~", "_link"), "_");
  EXPECT_EQ(names.take("1.0", "_link"), "_1_0");
}

TEST(SceneNames, LoseTheirMiddleWhenTheyAreTooLong) {
  SceneNames names;
  const std::string part = "camera_mount_linear_actuator_housing_";
  EXPECT_EQ(names.take(part + "left", "_link"), "camera_mount_li_tor_housing_left");
  EXPECT_EQ(names.take(part + "right", "_link"), "camera_mount_li_or_housing_right");
  EXPECT_EQ(names.take("left_" + part + "a", "_link"), "left_camera_mou_tuator_housing_a");
}

TEST(SceneNames, StayDifferentWhenTheyAreCut) {
  SceneNames names;
  const std::string name(40, 'a');
  const std::string first = names.take(name, "_link"), second = names.take(name, "_link"),
                    third = names.take(name, "_link");
  EXPECT_EQ(first, std::string(15, 'a') + "_" + std::string(16, 'a'));
  EXPECT_EQ(second, std::string(13, 'a') + "_" + std::string(13, 'a') + "_link");
  EXPECT_EQ(third, std::string(12, 'a') + "_" + std::string(12, 'a') + "_link_2");
}

}  // namespace names_test
}  // namespace slew::urdf
