// SPDX-License-Identifier: Apache-2.0
// Sections against closed forms, tables and energies computed another way.
#include "flex/section.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slew::flex {
namespace section_test {

constexpr double kNu = 0.3;

SectionDef box(double b, double h, double wall, double flange = 0) {
  SectionDef def{.shape = SectionShape::hollow_rectangle, .width = b, .height = h, .wall = wall};
  def.flange = flange;
  return def;
}

SectionDef solid(double b, double h) {
  return {.shape = SectionShape::solid_rectangle, .width = b, .height = h};
}

SectionDef i_beam(double b, double h, double web, double flange) {
  return {.shape = SectionShape::i_section, .width = b, .height = h, .wall = web, .flange = flange};
}

TEST(Section, HollowRectangleHasTheNumbersOfItsRectangles) {
  const Section s = make_section(box(0.12, 0.18, 0.008), kNu);
  EXPECT_NEAR(s.area, 0.12 * 0.18 - 0.104 * 0.164, 1e-15);
  EXPECT_NEAR(s.second_moment_y, (0.12 * std::pow(0.18, 3) - 0.104 * std::pow(0.164, 3)) / 12, 1e-18);
  EXPECT_NEAR(s.second_moment_z, (0.18 * std::pow(0.12, 3) - 0.164 * std::pow(0.104, 3)) / 12, 1e-18);
  // EN 10219-2 without its corner radii: I_t = t^3 h/3 + 2 K A_h, h the middle line, K = 2 A_h t/h
  const double length = 2 * (0.112 + 0.172), enclosed = 0.112 * 0.172;
  EXPECT_NEAR(s.torsion_constant, std::pow(0.008, 3) * length / 3 + 4 * enclosed * enclosed * 0.008 / length, 1e-15);
}

TEST(Section, JibBoomHasTheAreaAndTheMomentOfTheThesis) {
  const Section s = make_section(box(0.3, 0.3, 2.139e-3), kNu);
  EXPECT_NEAR(s.area, 25.49e-4, 0.006e-4);
  EXPECT_NEAR(s.second_moment_y, 3.769e-5, 0.0005e-5);
  EXPECT_NEAR(s.second_moment_y * 2e11, 7.54e6, 0.005e6);
  // Cowper for a thin square tube: 20 (1+nu)/(48 + 39 nu) = 0.44
  EXPECT_NEAR(s.shear_factor_y, 20 * 1.3 / (48 + 39 * 0.3), 1e-12);
  EXPECT_EQ(s.shear_factor_y, s.shear_factor_z);
}

TEST(Section, ThickBoxComesNearTheSolidSquare) {
  const Section thick = make_section(box(0.1, 0.1, 0.0499999), kNu), square = make_section(solid(0.1, 0.1), kNu);
  EXPECT_NEAR(thick.area, square.area, 1e-9);
  EXPECT_NEAR(thick.torsion_constant / square.torsion_constant, 1, 0.04)
      << "Bredt and the wall, far outside thin walls";
}

// Timoshenko & Goodier, table in art. 109: J = k1 h t^3, tau = T/(k2 h t^2) in the middle of the long side
TEST(Section, SolidRectangleTwistsAsInTheTable) {
  struct Row {
    double ratio, k1, k2;
  };
  for (const Row& row : {Row{1, 0.1406, 0.208}, Row{1.5, 0.196, 0.231}, Row{2, 0.229, 0.246}, Row{3, 0.263, 0.267},
                         Row{5, 0.291, 0.291}, Row{10, 0.312, 0.312}}) {
    const double t = 0.02, h = row.ratio * t;
    const Section s = make_section(solid(t, h), kNu);
    EXPECT_NEAR(s.torsion_constant / (h * t * t * t), row.k1, 6e-4) << row.ratio;
    EXPECT_NEAR(*s.points[4].torsion_modulus / (h * t * t), row.k2, 6e-4) << row.ratio;
    // turned by 90 degrees
    const Section turned = make_section(solid(h, t), kNu);
    EXPECT_DOUBLE_EQ(turned.torsion_constant, s.torsion_constant);
    EXPECT_NEAR(*turned.points[5].torsion_modulus / *s.points[4].torsion_modulus, 1, 1e-12) << row.ratio;
    EXPECT_GT(*s.points[5].torsion_modulus, 0.999 * *s.points[4].torsion_modulus)
        << "the long side has the most stress";
  }
}

// case B05: 12.3777 x 3.2024 mm, G J = 3.10355 N m2
TEST(Section, PrincetonBeamHasItsTorsionalStiffness) {
  const Section s = make_section(solid(3.2024e-3, 12.3777e-3), 0.31);
  EXPECT_NEAR(71.7e9 / (2 * 1.31) * s.torsion_constant, 3.10355, 1e-5);
  EXPECT_NEAR(71.7e9 * s.second_moment_z, 2.42887, 1e-5);
  EXPECT_NEAR(71.7e9 * s.second_moment_y, 36.28552, 1e-5);
}

TEST(Section, RoundSectionsAreExact) {
  const Section circle = make_section({.shape = SectionShape::solid_circle, .diameter = 0.1}, kNu);
  EXPECT_NEAR(circle.second_moment_y, M_PI * 1e-4 / 64, 1e-18);
  EXPECT_DOUBLE_EQ(circle.torsion_constant, 2 * circle.second_moment_y);
  EXPECT_NEAR(circle.shear_factor_y, 6 * 1.3 / (7 + 6 * 0.3), 1e-14);
  EXPECT_NEAR(*circle.points[0].torsion_modulus, M_PI * 1e-3 / 16, 1e-16);
  // thin tube: Cowper 2 (1+nu)/(4 + 3 nu)
  const Section tube = make_section({.shape = SectionShape::tube, .wall = 1e-6, .diameter = 0.1}, kNu);
  EXPECT_NEAR(tube.shear_factor_y, 2 * 1.3 / (4 + 3 * 0.3), 1e-5);
  EXPECT_NEAR(tube.area, M_PI * 0.1 * 1e-6, 1e-11);
}

// IPE 300 without its fillets: A 53.81 cm2 less 1.93, Iyy 8356 cm4, It 20.12 cm4 with fillets of 15 mm
TEST(Section, RolledBeamIsNearItsTable) {
  const Section s = make_section(i_beam(0.150, 0.300, 7.1e-3, 10.7e-3), kNu);
  EXPECT_NEAR(s.area, (53.81 - 1.93) * 1e-4, 0.01e-4);
  EXPECT_NEAR(s.second_moment_y / 8356e-8, 0.955, 0.005);
  EXPECT_NEAR(s.second_moment_z / 603.8e-8, 0.998, 0.003);
  EXPECT_NEAR(s.torsion_constant / 20.12e-8, 0.78, 0.04);
}

// Without Poisson's effect Cowper's factor is that of the energy of the shear flow: k = I^2/(A int (S/t)^2 dA)
TEST(Section, ShearFactorOfThinWallsIsThatOfTheShearFlow) {
  const double b = 0.15, h = 0.3, web = 1e-6, flange = 2e-6;
  const int n = 20000;
  for (const bool is_box : {false, true}) {
    const Section s = make_section(is_box ? box(b, h, web, flange) : i_beam(b, h, web, flange), 0);
    const double webs = is_box ? 2 : 1;
    double energy = 0;
    for (int i = 0; i < n; ++i) {
      // flanges: flow from the free edge (I: four halves) or from the middle (box: four halves)
      const double x = (i + 0.5) / n * b / 2, flow_flange = flange * h / 2 * x;
      energy += 4 * flow_flange * flow_flange / flange * (b / 2 / n);
      const double z = ((i + 0.5) / n - 0.5) * h;
      const double flow_web = flange * b * h / 2 / webs + web * (h * h / 8 - z * z / 2);
      energy += webs * flow_web * flow_web / web * (h / n);
    }
    const double k = s.second_moment_y * s.second_moment_y / (s.area * energy);
    EXPECT_NEAR(s.shear_factor_z, k, 1e-4 * k) << (is_box ? "box" : "I");
  }
}

TEST(Section, FactorsMayBeGivenOrLeftOut) {
  SectionDef def = solid(0.1, 0.1);
  def.shear_factor_y = 5.0 / 6;
  EXPECT_EQ(make_section(def, kNu).shear_factor_y, 5.0 / 6);
  EXPECT_NEAR(make_section(def, kNu).shear_factor_z, 10 * 1.3 / (12 + 11 * 0.3), 1e-14);
  def.shear = Shear::none;
  EXPECT_EQ(make_section(def, kNu).shear_factor_y, 0);
}

std::string problems_of(const SectionDef& def) {
  Problems problems;
  check_section("Beam.section", def, problems);
  std::string text;
  for (const Problem& p : problems) text += p.path + ": " + p.what + "; expected " + p.expected + '\n';
  return text;
}

TEST(Section, WrongDimensionsAreNamed) {
  EXPECT_EQ(problems_of(box(0.1, 0.2, 0.01)), "");
  EXPECT_EQ(problems_of(box(-0.1, 0.2, 0.01)), "Beam.section.width: -0.1 m is out of range; expected a number > 0 m\n");
  EXPECT_EQ(problems_of(box(0.1, 0.2, 0.06)),
            "Beam.section.wall: 0.06 m fills the inside; expected less than 0.05 m, the free width\n");
  EXPECT_EQ(problems_of(box(0.1, 0.2, 0.01, 0.1)),
            "Beam.section.flange: 0.1 m fills the inside; expected less than 0.1 m, half of the height\n");
  EXPECT_EQ(problems_of({.shape = SectionShape::tube, .wall = 0.06, .diameter = 0.1}),
            "Beam.section.wall: 0.06 m fills the inside; expected less than 0.05 m, half of the diameter\n");
  EXPECT_NE(problems_of(i_beam(0.1, 0.2, 0.01, 0)).find("flange"), std::string::npos);
  EXPECT_NE(problems_of({.area = 1, .second_moment_y = 0}).find("second_moment_y: 0 m4"), std::string::npos);
  // the fourth powers of these are no numbers, or none above 0
  EXPECT_NE(problems_of({.shape = SectionShape::tube, .wall = 0.06, .diameter = 6e98})
                .find("expected lengths that give positive ones"),
            std::string::npos);
  EXPECT_NE(problems_of({.shape = SectionShape::solid_circle, .diameter = 1e-90}).find("second moments 0 and 0 m4"),
            std::string::npos);
  SectionDef def = solid(0.1, 0.1);
  def.shear_factor_z = 0;
  EXPECT_NE(problems_of(def).find("shear_factor_z"), std::string::npos);
}

}  // namespace section_test
}  // namespace slew::flex
