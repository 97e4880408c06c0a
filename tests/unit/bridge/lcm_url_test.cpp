// SPDX-License-Identifier: Apache-2.0
// LCM's address: multicast only, and nothing beyond this machine without a word for it.
#include <gtest/gtest.h>

#include "bridge/lcm_link.h"
#include "core/failure.h"

namespace lcm_url_test {

using namespace slew::bridge;

std::string problem(const std::string& text, Reach reach = Reach::this_machine) {
  try {
    static_cast<void>(read_url(text, reach));
    return "";
  } catch (const slew::Failure& failure) {
    EXPECT_EQ(failure.code(), slew::ExitCode::bad_input);
    return failure.what();
  }
}

TEST(LcmUrl, PartsThatAreLeftOutAreTheDefaults) {
  EXPECT_EQ(read_url("udpm://", Reach::this_machine).text(), "udpm://239.255.76.67:7667?ttl=0");
  EXPECT_EQ(read_url("udpm://:7700", Reach::this_machine).text(), "udpm://239.255.76.67:7700?ttl=0");
  EXPECT_EQ(read_url("udpm://239.1.2.3", Reach::this_machine).text(), "udpm://239.1.2.3:7667?ttl=0");
  EXPECT_EQ(read_url("udpm://239.1.2.3:1?recv_buf_size=2000000&ttl=0", Reach::this_machine).text(),
            "udpm://239.1.2.3:1?ttl=0&recv_buf_size=2000000");
}

TEST(LcmUrl, ATtlAboveZeroNeedsInsecureLan) {
  const std::string refusal = problem("udpm://239.255.76.67:7667?ttl=1");
  EXPECT_NE(refusal.find("ttl=1 sends to the network"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("--insecure-lan"), std::string::npos);
  EXPECT_EQ(read_url("udpm://239.255.76.67:7667?ttl=1", Reach::network).ttl, 1);
}

TEST(LcmUrl, OtherTextsAreRefused) {
  for (const char* text : {"", "tcpq://1.2.3.4", "file:///tmp/log", "memq://", "udpm:/239.255.76.67"})
    EXPECT_NE(problem(text).find("only udpm:// carries a live session"), std::string::npos) << text;
  for (const char* text : {"udpm://10.0.0.1:7667", "udpm://localhost", "udpm://239.255.76"})
    EXPECT_NE(problem(text).find("is no multicast address"), std::string::npos) << text;
  for (const char* text :
       {"udpm://239.255.76.67:", "udpm://239.255.76.67:0", "udpm://239.255.76.67:65536", "udpm://239.255.76.67:76 67"})
    EXPECT_NE(problem(text).find("the port is no number"), std::string::npos) << text;
  for (const char* text : {"udpm://239.255.76.67?ttl", "udpm://239.255.76.67?ttl=-1", "udpm://239.255.76.67?ttl=256",
                           "udpm://239.255.76.67?tll=0", "udpm://239.255.76.67?ttl=0&&"})
    EXPECT_NE(problem(text, Reach::network).find("is no option of it"), std::string::npos) << text;
}

}  // namespace lcm_url_test
