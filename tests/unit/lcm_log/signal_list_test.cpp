// SPDX-License-Identifier: Apache-2.0
// Signal lists: the bytes are those of the struct that lcm-gen makes of the written types.
#include <gtest/gtest.h>

#include <slewring/crane_t.hpp>
#include <string>
#include <vector>

#include "lcm_log/signal_list.h"

namespace signal_list_test {

using namespace slew::lcm_log;

TEST(SignalList, LcmGenDecodesWhatIsEncoded) {
  SignalList list;
  ASSERT_TRUE(read_signal_list("crane=Cyl_Lift.stroke,Bag.position.y,2nd.force", list).is_ok());
  EXPECT_EQ(list.fingerprint, slewring::crane_t::getHash());
  std::string bytes;
  encode(list, 1000, 1.5, std::vector<double>{0.86, -2.5, 1e5}, bytes);
  slewring::crane_t crane{};
  ASSERT_EQ(crane.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  EXPECT_EQ(crane.step, 1000);
  EXPECT_EQ(crane.time, 1.5);
  EXPECT_EQ(crane.Cyl_Lift_stroke, 0.86);
  EXPECT_EQ(crane.Bag_position_y, -2.5);
  EXPECT_EQ(crane.v_2nd_force, 1e5);
}

TEST(SignalList, TextsThatAreNoListAreRefusedWithTheReason) {
  const auto problem = [](const std::string& text) {
    SignalList list;
    return read_signal_list(text, list).text;
  };
  EXPECT_NE(problem("crane").find("the '=' is missing"), std::string::npos);
  EXPECT_NE(problem("1crane=a.b").find("is no name of a struct"), std::string::npos);
  EXPECT_NE(problem("=a.b").find("is no name of a struct"), std::string::npos);
  EXPECT_NE(problem("crane=").find("name of a variable is missing"), std::string::npos);
  EXPECT_NE(problem("crane=a.b,").find("name of a variable is missing"), std::string::npos);
  EXPECT_NE(problem("crane=a.b,a_b").find("two members would have the name a_b"), std::string::npos);
  EXPECT_NE(problem("crane=time").find("two members would have the name time"), std::string::npos);
  EXPECT_EQ(problem("crane=a.b,a.c"), "");
}

}  // namespace signal_list_test
