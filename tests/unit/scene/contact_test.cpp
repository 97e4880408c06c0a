// SPDX-License-Identifier: Apache-2.0
// Shapes, meshes, pairs and frictions of a scene: reading them, and the published text of a session.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scene/scene.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace contact_test {

const char* const kBlock = R"(
bodies:
  Block: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [0, 1 m, 0]}
joints:
  Free: {type: floating, body2: Block, point1: [0, 1 m, 0]}
)";

// one tetrahedron, in millimetres and with z up
const char* const kTetrahedron = "v 0 0 0\nv 1000 0 0\nv 0 2000 0\nv 0 0 3000\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

TEST(Mesh, BecomesPartOfThePublishedScene) {
  const TemporaryFolder folder;
  folder.write("hull.obj", kTetrahedron);
  const std::string file = folder.write("scene.yaml", std::string(kBlock) + R"(
shapes:
  Hull: {type: convex_mesh, body: Block, file: hull.obj, unit: 1 mm, up: z}
  Floor: {type: plane, orientation: [0, -90 deg, 0]}
contacts:
  Touch: {shape_a: Hull, shape_b: Floor, spring_constant: 1e6 N/m, friction: Rough}
frictions:
  Rough: {static_friction_coefficient: 0.5}
)");
  const Scene scene = load_file(file);
  const multibody::ShapeDef& hull = scene.mechanics.shapes.at(0);
  EXPECT_TRUE(hull.file.empty());
  ASSERT_EQ(hull.vertices.size(), 12u);
  ASSERT_EQ(hull.triangles.size(), 12u);
  // the file's z is up and becomes y; its y looks along -z then
  double highest = 0, back = 0, right = 0;
  for (std::size_t i = 0; i < 12; i += 3) {
    right = std::max(right, hull.vertices[i]);
    highest = std::max(highest, hull.vertices[i + 1]);
    back = std::min(back, hull.vertices[i + 2]);
  }
  EXPECT_NEAR(right, 1, 1e-6);
  EXPECT_NEAR(highest, 3, 1e-6);
  EXPECT_NEAR(back, -2, 1e-6);

  // without the folder, as a node on another machine has it
  const Scene again = load_text(scene.expanded_text, "again");
  EXPECT_EQ(again.expanded_text, scene.expanded_text);
  EXPECT_EQ(again.mechanics.shapes.at(0).vertices, hull.vertices);
  EXPECT_EQ(again.mechanics.contacts.at(0).friction, "Rough");
  EXPECT_EQ(again.mechanics.frictions.at(0).law.static_coefficient, 0.5);
}

TEST(Mesh, FileIsRefusedInASceneFromMemory) {
  try {
    (void)load_text(
        std::string(kBlock) + "shapes:\n  Hull: {type: convex_mesh, body: Block, file: a.obj, unit: 1 m, up: y}\n",
        "test");
    FAIL() << "accepted";
  } catch (const LoadError& error) {
    EXPECT_NE(std::string(error.what()).find("a scene without a folder cannot read a file"), std::string::npos)
        << error.what();
  }
}

TEST(Pair, ThatStartsDeepInsideIsWarnedAbout) {
  const Scene scene = load_text(std::string(kBlock) + R"(
shapes:
  Sides: {type: box, body: Block, position: [0, -0.6 m, 0], size: [1 m, 1 m, 1 m]}
  Floor: {type: plane, orientation: [0, -90 deg, 0]}
contacts:
  Touch: {shape_a: Sides, shape_b: Floor, spring_constant: 1e6 N/m}
)",
                                "test");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("Touch: the shapes start 0.1 m deep in each other"), std::string::npos)
      << scene.warnings[0];
}

}  // namespace contact_test
}  // namespace slew::scene
