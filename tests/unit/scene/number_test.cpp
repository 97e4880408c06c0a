// SPDX-License-Identifier: Apache-2.0
#include "scene/number.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

namespace slew::scene {
namespace number_test {

double value_of(std::string_view text) {
  const NumberText number = split_number(text);
  EXPECT_TRUE(number.is_number) << text << ": " << number.problem.what;
  return static_cast<double>(number.value);
}

TEST(Number, DecimalNumbersReadToTheNearestDouble) {
  EXPECT_EQ(value_of("0"), 0.0);
  EXPECT_EQ(value_of("-0.1"), -0.1);
  EXPECT_EQ(value_of("+2.5e-3"), 2.5e-3);
  EXPECT_EQ(value_of(".5"), 0.5);
  EXPECT_EQ(value_of("5."), 5.0);
  EXPECT_EQ(value_of("1e308"), 1e308);
  EXPECT_EQ(value_of("3.21922"), 3.21922);
  EXPECT_EQ(value_of("0.00036178"), 0.00036178);
}

// halfway between two doubles after the first of two roundings
TEST(Number, ADoubleThatIsPrintedIsReadBack) {
  EXPECT_EQ(value_of("0.4148797890461908"), 0.4148797890461908);
  std::mt19937_64 random(20'261'127);
  std::uniform_real_distribution<double> values(-1, 1);
  for (int i = 0; i < 50'000; ++i) {
    const double value = values(random) * (i % 3 == 0 ? 1 : i % 3 == 1 ? 1e-9 : 1e9);
    ASSERT_EQ(value_of(fmt::format("{}", value)), value) << fmt::format("{}", value);
  }
}

// the short way to a value and the long one of the C library
TEST(Number, OfAnyLengthAndPowerIsTheNearestLongDouble) {
  const auto expect_nearest = [](const std::string& text) {
    const NumberText number = split_number(text);
    ASSERT_TRUE(number.is_number) << text;
    const long double nearest = std::strtold(text.c_str(), nullptr);
    const double as_double = std::strtod(text.c_str(), nullptr);
    EXPECT_EQ(static_cast<double>(number.value), as_double) << text;
    if (static_cast<double>(nearest) == as_double) {
      EXPECT_EQ(number.value, nearest) << text;
    }
  };
  std::mt19937_64 random(20'261'126);
  for (int i = 0; i < 20'000; ++i) {
    const std::uint64_t digits = random() >> (random() % 64);
    const int exponent = static_cast<int>(random() % 64) - 32;
    const std::string text = fmt::format("{}{}.{}e{}", i % 2 == 0 ? "-" : "", digits % 1'000'000'007, digits, exponent);
    expect_nearest(text);
    expect_nearest(fmt::format("{}e{}", digits, exponent));
  }
}

TEST(Number, TheRestBehindTheNumberIsTheUnit) {
  EXPECT_EQ(split_number("250 bar").rest, "bar");
  EXPECT_EQ(split_number(" 250bar ").rest, "bar");
  EXPECT_EQ(split_number("5 eV").rest, "eV");
  EXPECT_EQ(split_number("5e3m").rest, "m");
  EXPECT_EQ(split_number("3.5e-7 1/Pa").rest, "1/Pa");
  EXPECT_EQ(split_number("32 %").rest, "%");
}

struct Refused {
  const char* text;
  const char* what;
  const char* expected;
};

const Refused kRefused[] = {Refused{"010", "'010' looks octal", "10 or 8"},
                            Refused{"-017", "'-017' looks octal", "-17 or -15"},
                            Refused{"007 m", "'007' looks octal", "7"},
                            Refused{"08", "'08' begins with a zero", "8"},
                            Refused{"01.5", "'01.5' begins with a zero", "1.5"},
                            Refused{"0x1F", "'0x1F' is hexadecimal", "31"},
                            Refused{"0o17", "'0o17' is octal", "15"},
                            Refused{"-0b101", "'-0b101' is binary", "-5"},
                            Refused{".nan", "'.nan' is not finite", "a finite number"},
                            Refused{"-.INF", "'-.INF' is not finite", "a finite number"},
                            Refused{"inf", "'inf' is not finite", "a finite number"},
                            Refused{"1e999", "'1e999' is beyond what a number can hold", "a finite number"},
                            Refused{"1,5", "'1,5' has a comma", "a decimal point"},
                            Refused{"1_000", "'1_000' has a digit separator", "digits only"},
                            Refused{"\xE2\x88\x92"
                                    "5",
                                    "'\xE2\x88\x92"
                                    "5' begins with a typographic minus sign",
                                    "'-'"},
                            Refused{"bar", "'bar' is not a number", ""},
                            Refused{"", "'' is not a number", ""},
                            Refused{"-", "'-' is not a number", ""}};

TEST(Number, IsRefusedWithAReasonAndAWayOut) {
  for (const Refused& refused : kRefused) {
    const NumberText number = split_number(refused.text);
    EXPECT_FALSE(number.is_number) << refused.text;
    EXPECT_EQ(number.problem.what, refused.what);
    EXPECT_EQ(number.problem.expected, refused.expected) << refused.text;
  }
}

}  // namespace number_test
}  // namespace slew::scene
