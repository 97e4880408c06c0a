// SPDX-License-Identifier: Apache-2.0
#include "scene/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace slew::scene {
namespace units_test {

constexpr double kPi = std::numbers::pi;

UnitSystem& units() {
  static UnitSystem system;
  return system;
}

struct Exact {
  const char* text;
  Dimension dimension;
  double value;
};

const Exact kExact[] = {Exact{"500 kg", Dimension::mass, 500},
                        Exact{"1.2 t", Dimension::mass, 1200},
                        Exact{"127.5618", Dimension::mass, 127.5618},
                        Exact{"1050 mm", Dimension::length, 1.05},
                        Exact{"0.1 mm", Dimension::length, 1e-4},
                        Exact{"0.75 inch", Dimension::length, 0.01905},
                        Exact{"1 inch", Dimension::length, 0.0254},
                        Exact{"250 bar", Dimension::pressure, 250e5},
                        Exact{"0.2 bar", Dimension::pressure, 0.2e5},
                        Exact{"1.5e9 Pa", Dimension::pressure, 1.5e9},
                        Exact{"0.1 l", Dimension::volume, 1e-4},
                        Exact{"60 l/min", Dimension::volume_flow, 1e-3},
                        Exact{"70 l/min", Dimension::volume_flow, 70.0 / 60000},
                        Exact{"0.01 l/min", Dimension::volume_flow, 0.01 / 60000},
                        Exact{"46 cSt", Dimension::kinematic_viscosity, 46e-6},
                        Exact{"180 deg", Dimension::angle, kPi},
                        Exact{"-90 deg", Dimension::angle, -kPi / 2},
                        Exact{"1500 rpm", Dimension::angular_velocity, 50 * kPi},
                        Exact{"1 rev", Dimension::angle, 2 * kPi},
                        Exact{"25 rev/s", Dimension::angular_velocity, 50 * kPi},
                        Exact{"1 kN", Dimension::force, 1000},
                        Exact{"800 Nm", Dimension::torque, 800},
                        Exact{"0.8 kNm", Dimension::torque, 800},
                        Exact{"2e7 Nm/rad", Dimension::rotational_stiffness, 2e7},
                        Exact{"3000 Nms/rad", Dimension::rotational_damping, 3000},
                        Exact{"5e5 Ns/m", Dimension::damping, 5e5},
                        Exact{"5e7 N/m", Dimension::stiffness, 5e7},
                        Exact{"230 kg m2", Dimension::inertia, 230},
                        Exact{"230 kg.m2", Dimension::inertia, 230},
                        Exact{"230 kg*m^2", Dimension::inertia, 230},
                        Exact{"3.5e-7 1/Pa", Dimension::pressure_gain, 3.5e-7},
                        Exact{"1 1/bar", Dimension::pressure_gain, 1e-5},
                        Exact{"870 kg/m3", Dimension::density, 870},
                        Exact{"10 ms", Dimension::time, 0.01},
                        Exact{"1 min", Dimension::time, 60},
                        Exact{"9.81 m/s2", Dimension::acceleration, 9.81},
                        Exact{"36 km/h", Dimension::velocity, 10},
                        Exact{"32 %", Dimension::none, 0.32},
                        Exact{"0.5 %", Dimension::none, 0.005},
                        Exact{"40 degC", Dimension::temperature, 313.15},
                        Exact{"32 degF", Dimension::temperature, 273.15},
                        Exact{"300 K", Dimension::temperature, 300},
                        Exact{"500", Dimension::electric_signal, 500},
                        Exact{"1.67e-13 m3/s/Pa", Dimension::leakage, 1.67e-13},
                        Exact{"10 Hz", Dimension::frequency, 10},
                        Exact{"1 bar/s", Dimension::pressure_rate, 1e5},
                        Exact{"6.2e-7", Dimension::flow_coefficient, 6.2e-7}};

TEST(Units, AQuantityIsTheNearestDoubleToWhatItsTextMeans) {
  for (const Exact& exact : kExact) {
    const QuantityResult result = read_quantity(exact.text, Writing::plain, exact.dimension, units());
    ASSERT_TRUE(result.value) << exact.text << ": " << result.problem.what;
    EXPECT_EQ(*result.value, exact.value) << exact.text;
  }
}

TEST(Units, CubicCentimetresPerRevolutionAreADisplacement) {
  for (const char* text : {"140 cc/rev", "140 cm3/rev"}) {
    const QuantityResult result = read_quantity(text, Writing::plain, Dimension::displacement_volume, units());
    ASSERT_TRUE(result.value) << result.problem.what;
    EXPECT_NEAR(*result.value, 140e-6 / (2 * kPi), 1e-16 * *result.value * 4);
  }
}

// was the short ton of UDUNITS, 2721.55 kg, without a word
TEST(Units, TheTonOfSeveralMeaningsIsRefusedByName) {
  for (const char* text : {"3 ton", "3 tons", "0.003 kiloton"}) {
    const QuantityResult result = read_quantity(text, Writing::plain, Dimension::mass, units());
    EXPECT_FALSE(result.value) << text;
    EXPECT_NE(result.problem.what.find("'ton' has several meanings"), std::string::npos) << result.problem.what;
    EXPECT_EQ(result.problem.expected, "t (1000 kg), short_ton (907.18474 kg) or long_ton (1016.0469088 kg)");
  }
  EXPECT_FALSE(read_quantity("2 ton m2", Writing::plain, Dimension::inertia, units()).value);
  EXPECT_EQ(read_quantity("3 t", Writing::plain, Dimension::mass, units()).value, 3000);
  EXPECT_EQ(read_quantity("3 tonne", Writing::plain, Dimension::mass, units()).value, 3000);
  EXPECT_NEAR(*read_quantity("1 short_ton", Writing::plain, Dimension::mass, units()).value, 907.18474, 1e-9);
  EXPECT_NEAR(*read_quantity("1 long_ton", Writing::plain, Dimension::mass, units()).value, 1016.0469088, 1e-9);
}

TEST(Units, OfHydraulicCataloguesAreAccepted) {
  const auto read = [](const char* text, Dimension dimension) {
    const QuantityResult result = read_quantity(text, Writing::plain, dimension, units());
    EXPECT_TRUE(result.value) << text << ": " << result.problem.what;
    return result.value.value_or(0);
  };
  EXPECT_EQ(read("60 lpm", Dimension::volume_flow), 1e-3);
  EXPECT_EQ(read("60 L/min", Dimension::volume_flow), 1e-3);
  EXPECT_DOUBLE_EQ(read("10 US_gal/min", Dimension::volume_flow), 10 * 231 * 0.0254 * 0.0254 * 0.0254 / 60);
  EXPECT_DOUBLE_EQ(read("10 imp_gal/min", Dimension::volume_flow), 10 * 4.54609e-3 / 60);
  EXPECT_DOUBLE_EQ(read("5 US_gal", Dimension::volume), 5 * 3.785411784e-3);
  // 0.45359237 kg, 9.80665 m/s2, 25.4 mm
  EXPECT_DOUBLE_EQ(read("3000 psi", Dimension::pressure), 3000 * 0.45359237 * 9.80665 / (0.0254 * 0.0254));
  EXPECT_DOUBLE_EQ(read("45 cc/rev", Dimension::displacement_volume), 45e-6 / (2 * kPi));
  EXPECT_DOUBLE_EQ(read("2.75 in3/rev", Dimension::displacement_volume), 2.75 * 16.387064e-6 / (2 * kPi));
}

// 'gallon' was that of the US without a word
TEST(Units, TheGallonOfTwoMeaningsIsRefusedWithItsChoices) {
  for (const auto& [text, word] : {std::pair{"10 gal/min", "'gal'"},
                                   {"10 gallon/min", "'gallon'"},
                                   {"10 gallons/min", "'gallon'"},
                                   {"10 gpm", "'gpm'"},
                                   {"10 GPM", "'GPM'"},
                                   {"10 quart/s", "'quart'"}}) {
    const QuantityResult result = read_quantity(text, Writing::plain, Dimension::volume_flow, units());
    EXPECT_FALSE(result.value) << text;
    EXPECT_NE(result.problem.what.find(std::string(word) + " has two meanings"), std::string::npos)
        << result.problem.what;
    EXPECT_NE(result.problem.expected.find("US_gal"), std::string::npos) << result.problem.expected;
    EXPECT_NE(result.problem.expected.find("imp_gal"), std::string::npos) << result.problem.expected;
  }
  EXPECT_FALSE(read_quantity("3 gallons", Writing::plain, Dimension::volume, units()).value);
}

TEST(Units, AScaleThatIsNoShortDecimalStaysAsItIs) {
  const QuantityResult result = read_quantity("1 psi", Writing::plain, Dimension::pressure, units());
  ASSERT_TRUE(result.value);
  EXPECT_NEAR(*result.value, 6894.757293168361, 1e-9);
}

// 0.5 degC is a temperature, 273.65 K, and no difference
TEST(Units, ADifferenceOfTemperaturesHasNoZeroOfItsOwn) {
  const auto read = [](const char* text) {
    return read_quantity(text, Writing::plain, Dimension::temperature_difference, units());
  };
  EXPECT_EQ(read("0.5 K").value, 0.5);
  EXPECT_EQ(read("0.5").value, 0.5);
  for (const char* text : {"0.5 degC", "0.5 degF"}) {
    EXPECT_FALSE(read(text).value) << text;
    EXPECT_EQ(read(text).problem.what, std::string("'") + text + "' is a temperature");
    EXPECT_EQ(read(text).problem.expected, "a temperature difference such as '0.5 K', or a bare number in K");
  }
}

TEST(Units, TheExampleOfEveryDimensionReadsInThatDimension) {
  for (int i = 0; i < static_cast<int>(Dimension::number_of_dimensions); ++i) {
    const auto dimension = static_cast<Dimension>(i);
    const QuantityResult result = read_quantity(info(dimension).example, Writing::plain, dimension, units());
    EXPECT_TRUE(result.value) << info(dimension).name << ": " << result.problem.what;
  }
}

TEST(Units, TheSiUnitOfEveryDimensionIsOne) {
  for (int i = 0; i < static_cast<int>(Dimension::number_of_dimensions); ++i) {
    const auto dimension = static_cast<Dimension>(i);
    if (info(dimension).si_unit == "1" || dimension == Dimension::flow_coefficient) continue;
    const Unit* unit = units().find(info(dimension).si_unit);
    ASSERT_NE(unit, nullptr) << info(dimension).si_unit;
    EXPECT_EQ(unit->scale, 1.0L) << info(dimension).si_unit;
    EXPECT_EQ(unit->exponent, info(dimension).exponent) << info(dimension).si_unit;
  }
}

struct Refused {
  const char* text;
  Writing writing;
  Dimension dimension;
  const char* what;
  const char* suggestion;
};

const Refused kRefused[] = {
    Refused{"25 Hz", Writing::plain, Dimension::angular_velocity, "'25 Hz' is a frequency", ""},
    Refused{"25 rad/s", Writing::plain, Dimension::frequency, "'25 rad/s' is an angular velocity", ""},
    Refused{"1 rad", Writing::plain, Dimension::none, "'1 rad' is an angle", ""},
    Refused{"5 %", Writing::plain, Dimension::angle, "'5 %' is a number", ""},
    Refused{"100 Nm", Writing::plain, Dimension::rotational_stiffness, "'100 Nm' is a torque or an energy", ""},
    Refused{"100 N/m", Writing::plain, Dimension::rotational_stiffness, "'100 N/m' is a stiffness", ""},
    Refused{"140 cc", Writing::plain, Dimension::displacement_volume, "'140 cc' is a volume", ""},
    Refused{"5 A", Writing::plain, Dimension::force, "'5 A' is not a force", ""},
    Refused{"40 degC", Writing::plain, Dimension::mass, "'40 degC' is a temperature", ""},
    Refused{"500 V", Writing::plain, Dimension::electric_signal, "'500 V' is not a control signal", ""},
    Refused{"250 baar", Writing::plain, Dimension::pressure, "unknown unit 'baar'", "bar"},
    Refused{"70 l/mni", Writing::plain, Dimension::volume_flow, "unknown unit 'l/mni'", "l/min"},
    Refused{"5 s since 2000-01-01", Writing::plain, Dimension::time, "unknown unit 's since 2000-01-01'", ""},
    Refused{"5 10 m", Writing::plain, Dimension::length, "unknown unit '10 m'", ""},
    Refused{"5 m @ 3", Writing::plain, Dimension::length, "unknown unit 'm @ 3'", ""},
    Refused{"5 lg(re 1 mW)", Writing::plain, Dimension::power, "unknown unit 'lg(re 1 mW)'", ""},
    Refused{"500", Writing::quoted, Dimension::mass, "'500' is in quotes and has no unit", ""},
    Refused{"0.5", Writing::quoted, Dimension::none, "'0.5' is in quotes", ""}};

TEST(Units, AQuantityIsRefusedNamingWhatItIsInstead) {
  for (const auto& [text, writing, dimension, what, suggestion] : kRefused) {
    const QuantityResult result = read_quantity(text, writing, dimension, units());
    EXPECT_FALSE(result.value) << text;
    EXPECT_EQ(result.problem.what, what);
    EXPECT_EQ(result.problem.suggestion, suggestion) << text;
    EXPECT_FALSE(result.problem.expected.empty());
  }
}

TEST(Units, AQuotedQuantityWithUnitIsTheSameAsAPlainOne) {
  EXPECT_EQ(read_quantity("250 bar", Writing::quoted, Dimension::pressure, units()).value, 250e5);
}

}  // namespace units_test
}  // namespace slew::scene
