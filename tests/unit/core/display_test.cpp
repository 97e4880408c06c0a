// SPDX-License-Identifier: Apache-2.0
// Quantities and times as people read them.
#include "core/display.h"

#include <gtest/gtest.h>

#include <limits>

namespace slew {
namespace display_test {

TEST(Display, ShowsQuantitiesInTheUnitsOfTheWorkshop) {
  EXPECT_EQ(quantity_text(250e5, "Pa"), "250 bar");
  EXPECT_EQ(quantity_text(70.0 / 60000, "m3/s"), "70 l/min");
  EXPECT_EQ(quantity_text(0.5 * 3.14159265358979, "rad"), "90 deg");
  EXPECT_EQ(quantity_text(349'680, "N"), "349.7 kN");
  EXPECT_EQ(quantity_text(-3.75e-18, "rad"), "0 deg");  // what rounding leaves of it
  EXPECT_EQ(quantity_text(-1.745e-11, "rad"), "-9.998e-10 deg");
  EXPECT_EQ(quantity_text(-3.75e-18, "m"), "-3.75e-18 m");
  EXPECT_EQ(quantity_text(0.86, "m"), "0.86 m");
  EXPECT_EQ(quantity_text(1e-4, "1"), "0.0001");
  EXPECT_EQ(quantity_text(-0.0, "N"), "0 kN");
}

TEST(Display, ShowsEveryUnitOfTheWorkshopByItsDefinition) {
  EXPECT_EQ(quantity_text(2e5, "Pa/s"), "2 bar/s");
  EXPECT_EQ(quantity_text(0.25, "m3"), "250 l");
  EXPECT_EQ(quantity_text(1234, "N m"), "1.234 kN m");
  EXPECT_EQ(quantity_text(5e7, "N/m"), "50 kN/mm");
  EXPECT_EQ(quantity_text(4.2e6, "J"), "4200 kJ");
  EXPECT_EQ(quantity_text(7500, "W"), "7.5 kW");
  EXPECT_EQ(quantity_text(3.14159265358979323846, "rad/s2"), "180 deg/s2");
}

// by their names: speeds of joints and bodies, of ports and of cylinders are no shafts
TEST(Display, ShowsTheSpeedOfAShaftInRevolutionsPerMinute) {
  constexpr double kSpeed = 1500 * 3.14159265358979323846 / 30;
  EXPECT_EQ(quantity_text(kSpeed, "rad/s", "Engine.speed"), "1500 rpm");
  EXPECT_EQ(quantity_text(kSpeed, "rad/s", "Engine.speed_setting"), "1500 rpm");
  EXPECT_EQ(quantity_text(-kSpeed, "rad/s", "Left_Motor.speed"), "-1500 rpm");
  EXPECT_EQ(quantity_text(kSpeed, "rad/s", "Ring.velocity"), "9000 deg/s");
  EXPECT_EQ(quantity_text(kSpeed, "rad/s", "Slew_Axis.rate"), "9000 deg/s");
  EXPECT_EQ(quantity_text(kSpeed, "rad/s", "Bag.angular_velocity.x"), "9000 deg/s");
  EXPECT_EQ(quantity_text(kSpeed, "rad/s"), "9000 deg/s");
  EXPECT_EQ(quantity_text(0.2, "m/s", "Cyl_Lift.speed"), "0.2 m/s");
}

TEST(Display, WritesAChosenValueAsAPersonWould) {
  EXPECT_EQ(chosen_text(30 * 3.14159265358979323846 / 180, "rad"), "30 deg");
  EXPECT_EQ(chosen_text(0.1 / 60000, "m3/s"), "0.1 l/min");
  EXPECT_EQ(chosen_text(1500 * 3.14159265358979323846 / 30, "rad/s"), "1500 rpm");
  EXPECT_EQ(chosen_text(500, "kg"), "500 kg");
  EXPECT_EQ(chosen_text(0.1 + 0.2, "kg"), "0.3 kg");
  EXPECT_EQ(chosen_text(250e5, "Pa"), "250 bar");
  EXPECT_EQ(chosen_text(500, "N"), "500 N");
  EXPECT_EQ(chosen_text(0.063, "m"), "63 mm");
  EXPECT_EQ(chosen_text(3.14e-4, "m2"), "3.14 cm2");
  EXPECT_EQ(chosen_text(2.5e-6, "m3"), "2.5 cm3");
  EXPECT_EQ(chosen_text(46e-6, "m2/s"), "46 cSt");
  EXPECT_EQ(chosen_text(140e-6 / (2 * 3.14159265358979323846), "m3/rad"), "140 cm3/rev");
  EXPECT_EQ(chosen_text(2.1e6, "kg"), "2100000 kg");
  EXPECT_EQ(chosen_text(-9.80665, "m/s2"), "-9.80665 m/s2");
  EXPECT_EQ(chosen_text(1.0 / 3, "1"), "0.333333") << "no person writes more digits";
  EXPECT_EQ(chosen_text(0, "rad"), "0 deg");
  EXPECT_EQ(chosen_text(0, "rad/s"), "0 deg/s");
  EXPECT_EQ(chosen_text(-0.0, "1"), "0");
  EXPECT_EQ(chosen_text(std::numeric_limits<double>::infinity(), "rad"), "none");
}

TEST(Display, AZeroHasNoSign) {
  EXPECT_EQ(digits_text(-0.0, 4), "0");
  EXPECT_EQ(digits_text(-1e-9, 4), "-1e-09");
  EXPECT_EQ(decimals_text(-0.0, 0), "0");
  EXPECT_EQ(decimals_text(-1e-3, 2), "0.00");
  EXPECT_EQ(decimals_text(-0.012, 2), "-0.01");
  EXPECT_EQ(digits_text(-std::numeric_limits<double>::infinity(), 3), "-inf");
  EXPECT_EQ(quantity_text(-0.0, "N"), "0 kN");
  EXPECT_EQ(chosen_text(-0.0, "N"), "0 kN");
}

TEST(Display, CountsInTheRightNumber) {
  EXPECT_EQ(counted(0, "body", "bodies"), "0 bodies");
  EXPECT_EQ(counted(1, "body", "bodies"), "1 body");
  EXPECT_EQ(counted(2, "body", "bodies"), "2 bodies");
}

TEST(Display, ShowsTimesInAUnitThatFits) {
  EXPECT_EQ(duration_text(0), "0");
  EXPECT_EQ(duration_text(9.53e-6), "9.53 us");
  EXPECT_EQ(duration_text(0.0125), "12.5 ms");
  EXPECT_EQ(duration_text(20), "20 s");
}

TEST(Display, NamesNoBoundAboveItself) {
  EXPECT_DOUBLE_EQ(rounded_down(1.986e-4, 2), 1.9e-4);
  EXPECT_DOUBLE_EQ(rounded_down(1.9999e-4), 1.99e-4);
  EXPECT_DOUBLE_EQ(rounded_down(0.1004 / 2 - 0.05, 2), 2e-4);  // 2e-4 less its rounding
  EXPECT_DOUBLE_EQ(rounded_down(98700, 2), 98000);
}

}  // namespace display_test
}  // namespace slew
