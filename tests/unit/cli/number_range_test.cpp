// What an option that is a number takes.
#include "cli_support/number_range.h"

#include <gtest/gtest.h>

namespace slew::cli_support {
namespace {

TEST(NumberRange, TakesItsBoundsAndWhatIsBetween) {
  const CLI::Validator range = number_range(0.5, 100);
  for (const char* text : {"0.5", "100", "3e1", "7"}) EXPECT_EQ(range(text), "") << text;
  EXPECT_EQ(range("101"), "'101' is no number from 0.5 to 100");
  EXPECT_EQ(range("0.4"), "'0.4' is no number from 0.5 to 100");
}

TEST(NumberRange, TakesNoNumberThatIsNotFinite) {
  const CLI::Validator range = number_range(0, 1e9);
  for (const char* text : {"nan", "-nan", "NAN", "nan(1)", "inf", "-inf", "infinity", "1e999", "x", ""}) {
    EXPECT_NE(range(text), "") << text;
  }
  EXPECT_EQ(range("nan"), "'nan' is no number from 0 to 1000000000");
}

}  // namespace
}  // namespace slew::cli_support
