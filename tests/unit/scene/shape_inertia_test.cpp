// SPDX-License-Identifier: Apache-2.0
// Bodies whose inertia comes from shapes: textbook numbers, a composite computed apart, faults with their place.
#include "scene/shape_inertia.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "build_paths.h"
#include "scene/shape_fields.h"
#include "scene_text.h"

namespace slew::scene {
namespace shape_inertia_test {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-12;

// A scene of one body with these keys, on lines of their own.
std::string scene_of(const std::string& keys) {
  return "bodies:\n  Part: {" + keys + "}\njoints:\n  Free: {type: floating, body2: Part}\n";
}
std::string from_shape(const std::string& keys) {
  return scene_of("inertia: from_shape, " + keys);
}
std::string from_parts(const std::string& keys) {
  return scene_of("inertia: from_parts, " + keys);
}
multibody::BodyDef body_of(const std::string& text) {
  return load_text(text, "test").mechanics.bodies.at(0);
}

void expect_body(const multibody::BodyDef& body, double mass, Triple centre, Triple moments, Triple products) {
  EXPECT_NEAR(body.mass, mass, kRounding * mass);
  const double trace = moments[0] + moments[1] + moments[2];
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(body.center_of_mass[i], centre[i], kRounding * 5) << i;
    EXPECT_NEAR(body.inertia[i], moments[i], kRounding * trace) << i;
    EXPECT_NEAR(body.products[i], products[i], kRounding * trace) << i;
  }
  EXPECT_EQ(body.inertia_about, multibody::InertiaPoint::center_of_mass);
}

TEST(FromShape, EveryShapeHasItsFormula) {
  const double c = 7850.0 * kPi * 0.04 * 0.04 * 0.3, across = c * (3 * 0.04 * 0.04 + 0.3 * 0.3) / 12;
  expect_body(body_of(from_shape("shape: cylinder, radius: 40 mm, length: 0.3 m, density: 7850 kg/m3")), c, {},
              {across, across, c * 0.04 * 0.04 / 2}, {});
  // its axis, and the same by an orientation
  const Triple along_x = {c * 0.04 * 0.04 / 2, across, across}, along_y = {across, c * 0.04 * 0.04 / 2, across};
  expect_body(body_of(from_shape("shape: cylinder, radius: 40 mm, length: 0.3 m, axis: x, density: 7850")), c, {},
              along_x, {});
  expect_body(body_of(from_shape("shape: cylinder, radius: 40 mm, length: 0.3 m, axis: y, density: 7850")), c, {},
              along_y, {});
  expect_body(
      body_of(from_shape("shape: cylinder, radius: 40 mm, length: 0.3 m, shape_orientation: [90 deg, 90 deg, 0],"
                         " density: 7850")),
      c, {}, along_x, {});
  expect_body(body_of(from_shape("shape: box, size: [1, 2 m, 300 cm], mass: 60 kg, shape_position: [1 m, 2 m, 3 m]")),
              60, {1, 2, 3}, {65, 50, 25}, {});
  expect_body(body_of(from_shape("shape: sphere, radius: 0.5 m, mass: 10 kg")), 10, {}, {1, 1, 1}, {});
  const double tube = 10.0 / 2 * (0.05 * 0.05 + 0.04 * 0.04), tube_across = tube / 2 + 10.0 * 4 / 12;
  for (const char* hollow : {"wall: 10 mm", "inner_diameter: 80 mm"}) {
    expect_body(body_of(from_shape(std::string("shape: tube, diameter: 100 mm, length: 2 m, mass: 10 kg, ") + hollow)),
                10, {}, {tube_across, tube_across, tube}, {});
  }
  // a quarter of the height above the base, which is at -0.5 m of the named axis
  expect_body(body_of(from_shape("shape: cone, radius: 0.2 m, length: 1 m, axis: x, mass: 10 kg")), 10, {-0.25, 0, 0},
              {10 * 0.3 * 0.04, 10 * 3.0 / 80 * (4 * 0.04 + 1), 10 * 3.0 / 80 * (4 * 0.04 + 1)}, {});
  // length 0.4 m between the centres of two half balls of 0.1 m
  const double V1 = kPi * 0.01 * 0.4, V2 = 4.0 / 3 * kPi * 0.001, rho = 1000;
  const double capsule = rho * (V1 * 0.005 + V2 * 0.004);
  // half balls: 83/320 m r^2 about their own centres, which are 3/8 r beyond the cylinder's ends
  const double capsule_across =
      rho * (V1 * (0.01 / 4 + 0.16 / 12) + V2 * (83.0 / 320 * 0.01 + (0.2 + 0.0375) * (0.2 + 0.0375)));
  expect_body(body_of(from_shape("shape: capsule, radius: 0.1 m, length: 0.4 m, density: 1 g/cm3")), rho * (V1 + V2),
              {}, {capsule_across, capsule_across, capsule}, {});
  // 2 m of 0.4 m x 0.3 m outside, walls of 20 mm all around
  const double out = 2 * 0.4 * 0.3, in = 2 * 0.36 * 0.26;
  const auto box_moment = [&](double a, double b, double ai, double bi) {
    return 7850 * (out * (a * a + b * b) - in * (ai * ai + bi * bi)) / 12;
  };
  expect_body(
      body_of(from_shape("shape: hollow_box, length: 2 m, width: 0.4 m, height: 0.3 m, wall: 20 mm, density: 7850")),
      7850 * (out - in), {},
      {box_moment(0.4, 0.3, 0.36, 0.26), box_moment(2, 0.3, 2, 0.26), box_moment(2, 0.4, 2, 0.36)}, {});
}

// numbers of an integration apart, by quadrature points of every part moved into the body
TEST(FromParts, ABoomHasTheNumbersOfAnIntegrationApart) {
  const Scene scene = load_text(from_parts(R"(density: 7850 kg/m3, parts: [
    {shape: hollow_box, length: 4 m, width: 0.3 m, height: 0.4 m, wall: 8 mm, flange: 10 mm, position: [2 m, 0, 0]},
    {shape: tube, diameter: 120 mm, wall: 15 mm, length: 340 mm, axis: y, position: [4 m, 50 mm, -0.1 m],
     orientation: [20 deg, 30 deg, -10 deg]},
    {shape: box, size: [0.4, 0.04, 0.5], position: [0, 0.3, 0], mass: 60 kg},
    {shape: cylinder, radius: 50 mm, length: 40 mm, axis: y, position: [0, 0.3, 0.1], density: 7500, hole: true},
    {shape: cone, radius: 0.1, top_radius: 0.04, length: 0.3, axis: x, position: [4.2, 0, 0], mass: 12 kg,
     orientation: [0, 0, 45 deg]},
    {shape: capsule, radius: 50 mm, length: 0.2 m, position: [1, -0.2, 0.3], density: 2700,
     orientation: [-60 deg, 80 deg, 15 deg]}])"),
                                "test");
  expect_body(scene.mechanics.bodies.at(0), 467.816906784344, {1.85363358478149, 0.035227040662346, 0.000299726521376},
              {21.9212838658327, 853.652778656511, 852.78016282755},
              {30.4379543390488, 3.85740075262415, 0.437539321733073});
  ASSERT_EQ(scene.solid_inertias.size(), 1U);
  EXPECT_EQ(scene.solid_inertias[0].shapes, "6 parts");
  EXPECT_NEAR(scene.solid_inertias[0].volume, 0.064683443242631, 1e-13);
  EXPECT_NEAR(scene.solid_inertias[0].density, 467.816906784344 / 0.064683443242631, 1e-8);
  // nodes and recordings get numbers
  const Scene again = load_text(scene.expanded_text, "test");
  EXPECT_EQ(again.mechanics.bodies[0].inertia, scene.mechanics.bodies[0].inertia);
  EXPECT_EQ(again.mechanics.bodies[0].products, scene.mechanics.bodies[0].products);
  EXPECT_EQ(again.expanded_text, scene.expanded_text);
  EXPECT_EQ(scene.expanded_text.find("shape"), std::string::npos);
  // the tube cuts the end of the hollow box
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_NE(scene.warnings[0].find("test:4:5: Part.parts[1]: about "), std::string::npos) << scene.warnings[0];
  EXPECT_NE(scene.warnings[0].find(" % of the part lies in other parts and counts twice"), std::string::npos);
}

// the numbers of the same integration apart
TEST(FromParts, TheWeldedBoomHasTheNumbersOfAnIntegrationApart) {
  const Scene scene = load_file(SLEWRING_SOURCE_DIR "/scenes/welded_boom.yaml");
  expect_body(scene.mechanics.bodies.at(0), 217.946702796814, {1.49475739461004, 0, 0},
              {4.42441567563952, 248.38491441909, 249.215644786505}, {});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(FromParts, AMassOfAllIsSpreadEvenlyAndStaysToTheBit) {
  const std::string parts = "parts: [{shape: box, size: [2, 1, 1]}, {shape: box, size: [1, 1, 1], hole: true}]";
  const multibody::BodyDef light = body_of(from_parts("density: 100, " + parts));
  EXPECT_EQ(light.mass, 100);
  const multibody::BodyDef weighed = body_of(from_parts("mass: 130.1 kg, " + parts));
  EXPECT_EQ(weighed.mass, 130.1);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(weighed.inertia[i], 1.301 * light.inertia[i], 1e-12);
  EXPECT_EQ(body_of(from_shape("shape: box, size: [1, 1, 1], mass: 130.1 kg")).mass, 130.1);
}

TEST(FromParts, OnePartIsTheShapeAlone) {
  const multibody::BodyDef one = body_of(from_shape(
      "shape: cone, radius: 0.3, length: 1, density: 2700, shape_position: [1, 2, 3], shape_orientation: [1, 2, 3]"));
  const multibody::BodyDef listed = body_of(from_parts(
      "parts: [{shape: cone, radius: 0.3, length: 1, density: 2700, position: [1, 2, 3], orientation: [1, 2, 3]}]"));
  EXPECT_EQ(one.mass, listed.mass);
  EXPECT_EQ(one.center_of_mass, listed.center_of_mass);
  EXPECT_EQ(one.inertia, listed.inertia);
  EXPECT_EQ(one.products, listed.products);
}

TEST(FromShape, SettingsAndParametersReachTheSizes) {
  const std::string pin = from_shape("shape: cylinder, radius: \"${d / 2}\", length: 1 m, density: 1000 kg/m3");
  const Scene scene = load_text("parameters: {d: 200 mm}\n" + pin, "test", {"Part.density=2000 kg/m3"});
  EXPECT_NEAR(scene.mechanics.bodies.at(0).mass, 2000 * kPi * 0.01, 1e-10);
  const Scene wider = load_text("parameters: {d: 200 mm}\n" + pin, "test", {"d=400 mm"});
  EXPECT_NEAR(wider.mechanics.bodies.at(0).mass, 1000 * kPi * 0.04, 1e-10);
}

TEST(FromShape, FaultsHaveTheirPlace) {
  const auto problem = [](const std::string& keys) { return problems_of(from_shape(keys)); };
  EXPECT_EQ(problem("shape: sphere, radius: 1 m"),
            "test:2:3: Part: neither density nor mass is given; expected one of them, for the shape");
  EXPECT_EQ(problem("shape: sphere, radius: 1 m, density: 1000, mass: 1 kg"),
            "test:2:74: Part.mass: density and mass are both given; expected one of them");
  EXPECT_EQ(
      problem("shape: sphear, radius: 1 m, mass: 1 kg"),
      "test:2:38: Part.shape: is 'sphear'; expected box, hollow_box, sphere, cylinder, tube, cone or capsule; did "
      "you mean 'sphere'?");
  EXPECT_EQ(problem("radius: 1 m, mass: 1 kg"),
            "test:2:3: Part: the key 'shape' is missing; expected box, hollow_box, sphere, cylinder, tube, cone or "
            "capsule");
  EXPECT_EQ(problem("shape: sphere, mass: 1 kg"),
            "test:2:3: Part: the key 'radius' is missing; expected a length such as '1.5 m', or a bare number in m");
  EXPECT_EQ(problem("shape: sphere, radius: 0, mass: 1 kg"),
            "test:2:54: Part.radius: '0' is out of range; expected more than 0 m");
  EXPECT_NE(problem("shape: sphere, radius: 1 m, length: 2 m, mass: 1 kg").find("Part.length: unknown key"),
            std::string::npos);
  EXPECT_NE(problem("shape: sphere, radius: 1 kg, mass: 1 kg").find("'1 kg' is a mass; expected a length"),
            std::string::npos);
  EXPECT_EQ(problem("shape: sphere, radius: 1 m, mass: 1 kg, center_of_mass: [0, 0, 0]"),
            "test:2:71: Part.center_of_mass: follows from the shape; expected no such key beside inertia: from_shape");
  EXPECT_NE(problem("shape: sphere, radius: 1 m, mass: 1 kg, hole: true").find("Part.hole: unknown key"),
            std::string::npos);
  EXPECT_NE(problem("shape: box, size: [1, 0 m, 1], mass: 1 kg").find("out of range; expected more than 0 m"),
            std::string::npos);
}

TEST(FromShape, WallsLeaveAHollow) {
  const auto problem = [](const std::string& keys) {
    return problems_of(from_shape(keys + ", length: 1 m, mass: 1 kg"));
  };
  EXPECT_EQ(problem("shape: tube, diameter: 100 mm, wall: 50 mm"),
            "test:2:68: Part.wall: two walls of 0.05 m leave no hollow; expected less than half of diameter, 0.05 m");
  EXPECT_EQ(problem("shape: tube, diameter: 100 mm, inner_diameter: 100 mm"),
            "test:2:78: Part.inner_diameter: the inner diameter of 0.1 m leaves no wall; expected less than diameter, "
            "0.1 m");
  EXPECT_EQ(problem("shape: tube, diameter: 100 mm"),
            "test:2:3: Part: the tube has no wall; expected one of inner_diameter and wall");
  EXPECT_EQ(problem("shape: tube, diameter: 100 mm, wall: 1 mm, inner_diameter: 98 mm"),
            "test:2:3: Part: inner_diameter and wall are both given; expected one of inner_diameter and wall");
  EXPECT_EQ(problem("shape: tube, diameter: 100 mm, wall: 0 mm"),
            "test:2:68: Part.wall: '0 mm' is out of range; expected more than 0 m");
  const std::string hollow = "shape: hollow_box, width: 100 mm, height: 60 mm";
  EXPECT_EQ(problem(hollow + ", wall: 49 mm, flange: 29 mm"), "");
  EXPECT_NE(problem(hollow + ", wall: 50 mm, flange: 29 mm").find("expected less than half of width, 0.05 m"),
            std::string::npos);
  EXPECT_NE(problem(hollow + ", wall: 49 mm, flange: 30 mm").find("Part.flange: two walls of 0.03 m"),
            std::string::npos);
  // the flanges are as thick as the walls
  EXPECT_NE(problem(hollow + ", wall: 30 mm")
                .find("Part.wall: two walls of 0.03 m leave no hollow; expected less than "
                      "half of height, 0.03 m"),
            std::string::npos);
}

TEST(FromParts, FaultsHaveTheirPlace) {
  const auto problem = [](const std::string& keys) { return problems_of(from_parts(keys)); };
  const std::string ball = "{shape: sphere, radius: 1 m", box = "{shape: box, size: [4, 4, 4]";
  EXPECT_EQ(problem("density: 1"), "test:2:3: Part: the key 'parts' is missing; expected a list of shapes");
  EXPECT_EQ(problem("density: 1, parts: []"), "test:2:50: Part.parts: has 0 entries; expected a list of 1 to 256 maps");
  EXPECT_EQ(problem("density: 1, parts: 3"), "test:2:50: Part.parts: is '3'; expected a list of 1 to 256 maps");
  EXPECT_EQ(problem("density: 1, parts: [3]"), "test:2:51: Part.parts[0]: is '3'; expected a map");
  EXPECT_EQ(
      problem("parts: [" + ball + "}]"),
      "test:2:39: Part.parts[0]: neither density nor mass is given; expected one of them here, or one beside parts");
  EXPECT_EQ(problem("parts: [" + ball + ", mass: 1 kg, density: 1}]"),
            "test:2:68: Part.parts[0].mass: density and mass are both given; expected one of them");
  EXPECT_EQ(problem("mass: 1, density: 1, parts: [" + ball + "}]"),
            "test:2:31: Part.mass: density and mass are both given; expected one of them");
  EXPECT_EQ(
      problem("mass: 1, parts: [" + ball + ", density: 3}]"),
      "test:2:48: Part.parts[0]: has a density or mass of its own, and the body a mass for all parts; expected one "
      "of them; the body's density is for parts without their own");
  EXPECT_EQ(problem("density: 1, parts: [" + ball + ", density: 3}]"),
            "test:2:31: Part.density: every part has a density or mass of its own; expected no density beside parts");
  EXPECT_NE(problem("density: 1, parts: [" + ball + ", shape_position: [1, 2, 3]}]").find("unknown key"),
            std::string::npos);
  EXPECT_NE(problem("density: 1, radius: 3, parts: [" + ball + "}]").find("Part.radius: unknown key"),
            std::string::npos);
  EXPECT_EQ(problem("density: 1, products: [0, 0, 0], parts: [" + ball + "}]"),
            "test:2:43: Part.products: follows from the parts; expected no such key beside inertia: from_parts");
  EXPECT_EQ(problem("density: 1, parts: [" + box + "}, " + ball + ", hole: true}]"), "");
}

TEST(FromParts, AHoleNeedsMaterial) {
  const auto problem = [](const std::string& keys) {
    return problems_of(from_parts("density: 1000, parts: [" + keys + "]"));
  };
  const std::string box = "{shape: box, size: [1, 1, 1]}, ";
  EXPECT_EQ(problem(box + "{shape: cylinder, radius: 0.2, length: 1, hole: true}"), "");
  EXPECT_EQ(
      problem(box + "{shape: cylinder, radius: 0.2, length: 2, hole: true}"),
      "test:2:85: Part.parts[1]: about 50 % of the hole lies where the parts have no material, or less than it takes "
      "away; expected a hole within the parts, of their density, that no other hole meets");
  EXPECT_NE(problem(box + "{shape: sphere, radius: 0.2, density: 2000, hole: true}").find("about 1e+02 %"),
            std::string::npos);
  EXPECT_NE(problem("{shape: sphere, radius: 0.2, hole: true}").find("no material"), std::string::npos);
  // all of it taken away
  EXPECT_EQ(problem(box + "{shape: box, size: [1, 1, 1], hole: true}"),
            "test:2:3: Part: the parts sum up to 0 m3 and 0 kg; expected parts that are larger than their holes");
}

TEST(FromParts, SizesThatNoMachineHasAreRefusedOrNamed) {
  EXPECT_NE(
      problems_of(from_shape("shape: box, size: [126, 126, 1260], density: 7850"))
          .find(
              "Part: the shape is 126 x 126 x 1.26e+03 m, 2e+07 m3, 1.57e+11 kg at 7850 kg/m3; expected sizes, density "
              "and mass with their units"),
      std::string::npos);
  EXPECT_NE(problems_of(from_shape("shape: box, size: [1, 1, 1], density: 7850000")).find("at 7.85e+06 kg/m3"),
            std::string::npos);
  EXPECT_EQ(load_text(from_shape("shape: box, size: [126, 1, 1], density: 7850"), "test").warnings.size(), 1U);
  EXPECT_TRUE(load_text(from_shape("shape: box, size: [12, 1, 1], density: 7850"), "test").warnings.empty());
}

// a shape without `inertia: from_shape` is a slip that must not pass
TEST(FromShape, AShapeBesideGivenInertiaIsAnUnknownKey) {
  EXPECT_NE(problems_of(scene_of("mass: 1, inertia: [1, 1, 1], radius: 1")).find("Part.radius: unknown key"),
            std::string::npos);
  EXPECT_NE(problems_of(scene_of("mass: 1, inertia: from_shap, shape: sphere, radius: 1")).find("Part.inertia: is "),
            std::string::npos);
}

TEST(FromShape, KeysOfShapesAreAllOfTheirFields) {
  const std::vector<std::string_view> keys = keys_of_shapes();
  for (const ShapeWord& word : shape_words()) {
    for (const Field& row : word.body_fields) {
      EXPECT_NE(std::find(keys.begin(), keys.end(), row.key), keys.end()) << row.key;
      EXPECT_FALSE(row.doc.empty()) << row.key;
    }
  }
}

}  // namespace shape_inertia_test
}  // namespace slew::scene
