// SPDX-License-Identifier: Apache-2.0
#include "core/printable.h"

#include <gtest/gtest.h>

#include <string>

namespace slew {
namespace printable_test {

using namespace std::string_literals;

TEST(Printable, LeavesTextOfAnyLanguageAsItIs) {
  for (const std::string& text : {"Cyl_Lift.force"s, "Ausleger \xC3\xA4\xC3\xB6\xC3\xBC"s, "\xE6\xB2\xB9\xE5\x9C\xA7"s,
                                  "\xF0\x9F\x9A\x9C"s, ""s}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_TRUE(is_printable(text));
  }
}

TEST(Printable, ShowsEveryControlCharacterAsItsBytes) {
  for (int c = 0; c < 0x20; ++c) {
    const std::string text(1, static_cast<char>(c));
    EXPECT_EQ(printable("a" + text + "b").substr(0, 3), "a\\x") << c;
    EXPECT_FALSE(is_printable(text));
  }
  EXPECT_EQ(printable("\x7F"), "\\x7F");
  EXPECT_EQ(printable("j\x1B[31m1\x1B[2J"), "j\\x1B[31m1\\x1B[2J");
  EXPECT_EQ(printable("\x1B]0;pwn\a"), "\\x1B]0;pwn\\x07");
  for (int c = 0x80; c < 0xA0; ++c) {
    const std::string text = "\xC2"s + static_cast<char>(c);
    EXPECT_EQ(printable(text).substr(0, 6), "\\xC2\\x") << c;
  }
}

TEST(Printable, ShowsCharactersThatTurnTheDirectionAndBytesThatAreNoText) {
  EXPECT_EQ(printable("\xE2\x80\xAE"
                      "abc"),
            "\\xE2\\x80\\xAE"
            "abc");
  EXPECT_EQ(printable("\xE2\x81\xA6"), "\\xE2\\x81\\xA6");
  EXPECT_EQ(printable("\xD8\x9C"), "\\xD8\\x9C");
  EXPECT_EQ(printable("\xE2\x80\xA8"), "\\xE2\\x80\\xA8");
  EXPECT_EQ(printable("\xA0"), "\\xA0");
  EXPECT_EQ(printable("\xC3"), "\\xC3");
  EXPECT_EQ(printable("\x9B"
                      "2J"),
            "\\x9B"
            "2J");
}

TEST(Printable, KeepsLineFeedsOnRequestAlone) {
  EXPECT_EQ(printable("a\nb"), "a\\x0Ab");
  EXPECT_EQ(printable_lines("a\nb\r\x1B"), "a\nb\\x0D\\x1B");
}

}  // namespace printable_test
}  // namespace slew
