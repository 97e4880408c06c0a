// Quantities, times and tables as people read them.
#include "cli/display.h"

#include <gtest/gtest.h>

namespace slew::cli {
namespace {

TEST(Display, ShowsQuantitiesInTheUnitsOfTheWorkshop) {
  EXPECT_EQ(quantity_text(250e5, "Pa"), "250 bar");
  EXPECT_EQ(quantity_text(70.0 / 60000, "m3/s"), "70 l/min");
  EXPECT_EQ(quantity_text(0.5 * 3.14159265358979, "rad"), "90 deg");
  EXPECT_EQ(quantity_text(349'680, "N"), "349.7 kN");
  EXPECT_EQ(quantity_text(0.86, "m"), "0.86 m");
  EXPECT_EQ(quantity_text(1e-4, "1"), "0.0001");
  EXPECT_EQ(quantity_text(-0.0, "N"), "0 kN");
}

TEST(Display, ShowsTimesInAUnitThatFits) {
  EXPECT_EQ(duration_text(0), "0");
  EXPECT_EQ(duration_text(9.53e-6), "9.53 us");
  EXPECT_EQ(duration_text(0.0125), "12.5 ms");
  EXPECT_EQ(duration_text(20), "20 s");
}

TEST(Display, AlignsColumnsByCharactersNotBytes) {
  EXPECT_EQ(table_text({{"a", "b"}, {"\u00e4\u00e4", "c"}}, ""), "a   b\n\u00e4\u00e4  c\n");
}

}  // namespace
}  // namespace slew::cli
