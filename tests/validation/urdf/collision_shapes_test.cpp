// SPDX-License-Identifier: Apache-2.0
// Collision geometry: where the shapes are, what becomes of meshes, and that the shapes touch.
#include <fmt/format.h>

#include "tests/validation/urdf/imported.h"

namespace slew::urdf {
namespace collision_shapes_test {

using contact::ShapeType;
using math::Vec3;
using multibody::ShapeDef;
using testing::Imported;

constexpr double kRounding = 1e-14;

std::string link(const std::string& name, const std::string& collision) {
  return fmt::format(
      "<link name=\"{}\"><inertial><mass value=\"2\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.1\"/></inertial>"
      "<collision>{}</collision></link>",
      name, collision);
}

std::string mesh(const std::string& file, const std::string& scale = "0.5 0.5 0.5") {
  return fmt::format("<geometry><mesh filename=\"{}\" scale=\"{}\"/></geometry>", file, scale);
}

// 1 along each axis
constexpr const char* kCorner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
// the same with a dent: the fourth point is inside a larger pyramid
constexpr const char* kDented =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.1 0.1 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 5\nf 3 4 5\nf 4 2 5\n";

// A robot's file in the folder `urdf` of a package, beside `meshes`.
class Package : public ::testing::Test {
 protected:
  Package() {
    for (const char* part : {"urdf", "meshes"}) std::filesystem::create_directory(folder_.path() + "/" + part);
    folder_.write("meshes/corner.obj", kCorner);
    folder_.write("meshes/dented.obj", kDented);
  }
  // as if written to the package's own folder
  [[nodiscard]] Import import(const std::string& content, RootMount mount = RootMount::floating) const {
    const std::string robot = "<robot name=\"r\">" + content + "</robot>";
    return import_file(folder_.write("urdf/robot.urdf", robot), mount, folder_.path() + "/scene.yaml");
  }
  [[nodiscard]] scene::Scene load(const Import& made) const {
    return scene::load_file(folder_.write("scene.yaml", made.text));
  }

  scene::TemporaryFolder folder_;
};

TEST_F(Package, PrimitivesLieWhereTheyDoInTheirLinks) {
  const Import made = import(link("arm",
                                  "<origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/>"
                                  "<geometry><box size=\"0.1 0.2 0.3\"/></geometry>") +
                             "<link name=\"tool\"><collision><origin xyz=\"0 0 1\"/><geometry><capsule radius=\"0.1\" "
                             "length=\"0.4\"/></geometry></collision></link>"
                             "<joint name=\"grip\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tool\"/>"
                             "<origin xyz=\"5 0 0\" rpy=\"1.5707963267948966 0 0\"/></joint>");
  const std::vector<ShapeDef> shapes = load(made).mechanics.shapes;
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_EQ(shapes[0].name, "arm_collision");
  EXPECT_EQ(shapes[0].type, ShapeType::box);
  EXPECT_EQ(shapes[0].body, "arm");
  EXPECT_EQ(shapes[0].size, (Triple{0.1, 0.2, 0.3}));
  EXPECT_EQ(shapes[0].position, (Triple{1, 2, 3}));
  EXPECT_NEAR(shapes[0].orientation[0] + shapes[0].orientation[2], M_PI / 2, kRounding);
  EXPECT_NEAR(shapes[0].orientation[1], 0, kRounding);
  // the tool has no mass: it rides on the arm, turned by a quarter about x
  EXPECT_EQ(shapes[1].type, ShapeType::capsule);
  EXPECT_EQ(shapes[1].body, "arm");
  EXPECT_LT(norm(Vec3(shapes[1].position) - Vec3(5, -1, 0)), kRounding);
  EXPECT_EQ(shapes[1].length, 0.4);
}

TEST_F(Package, AMeshWithoutDentsIsAShapeFromItsFile) {
  for (const char* name : {"package://any/meshes/corner.obj", "../meshes/corner.obj"}) {
    const Import made = import(link("arm", mesh(name)));
    EXPECT_NE(made.text.find("file: \"meshes/corner.obj\""), std::string::npos) << made.text;
    const std::vector<ShapeDef> shapes = load(made).mechanics.shapes;
    ASSERT_EQ(shapes.size(), 1u);
    EXPECT_EQ(shapes[0].type, ShapeType::convex_mesh);
    // axes as in the file, and the scale
    std::vector<Triple> points;
    for (std::size_t i = 0; i < shapes[0].vertices.size(); i += 3) {
      points.push_back({shapes[0].vertices[i], shapes[0].vertices[i + 1], shapes[0].vertices[i + 2]});
    }
    std::sort(points.begin(), points.end());
    EXPECT_EQ(points, (std::vector<Triple>{{0, 0, 0}, {0, 0, 0.5}, {0, 0.5, 0}, {0.5, 0, 0}}));
  }
}

TEST_F(Package, AMeshThatIsNoShapeIsReportedWithItsReason) {
  const std::pair<std::string, std::string> kCases[] = {
      {mesh("package://any/meshes/dented.obj"), "dent"},
      {mesh("package://any/meshes/none.obj"), "there is no such file"},
      {mesh("package://any/meshes/corner.obj", "1 1 2"), "its scale is not one positive number"},
  };
  for (const auto& [geometry, reason] : kCases) {
    const Import made = import(link("arm", geometry));
    EXPECT_TRUE(load(made).mechanics.shapes.empty());
    ASSERT_FALSE(made.notes.empty());
    EXPECT_NE(made.notes.back().text.find("link 'arm': the collision mesh"), std::string::npos);
    EXPECT_NE(made.notes.back().text.find(reason), std::string::npos) << made.notes.back().text;
  }
}

TEST_F(Package, AMeshOutsideTheScenesFolderIsReported) {
  const std::string robot = "<robot name=\"r\">" + link("arm", mesh("../meshes/corner.obj")) + "</robot>";
  const Import made = import_file(folder_.write("urdf/robot.urdf", robot), RootMount::floating);
  ASSERT_FALSE(made.notes.empty());
  EXPECT_NE(made.notes.back().text.find("is not in the scene's folder"), std::string::npos);
  EXPECT_TRUE(scene::load_text(made.text, "imported").mechanics.shapes.empty());
}

TEST_F(Package, OnGroundAnySurfaceIsAShape) {
  const Import made =
      import("<link name=\"world\"><collision>" + mesh("package://any/meshes/dented.obj") + "</collision></link>" +
                 link("arm", "<geometry><sphere radius=\"0.1\"/></geometry>") +
                 "<joint name=\"turn\" type=\"continuous\"><parent link=\"world\"/><child link=\"arm\"/></joint>",
             RootMount::fixed);
  const std::vector<ShapeDef> shapes = load(made).mechanics.shapes;
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_EQ(shapes[0].type, ShapeType::triangle_mesh);
  EXPECT_EQ(shapes[0].body, "Ground");
}

// m g/k deep after its fall from 1 mm
TEST(CollisionShapes, AnImportedBallLiesOnTheFloorItIsGiven) {
  const scene::TemporaryFolder folder;
  const std::string robot =
      "<robot name=\"r\">" + link("ball", "<geometry><sphere radius=\"0.2\"/></geometry>") + "</robot>";
  std::string text = import_file(folder.write("robot.urdf", robot), RootMount::floating).text;
  text.insert(text.find("\nshapes:") + 9, "  Floor: {type: plane, position: [0, 0, -0.201]}\n");
  text +=
      "\ncontacts:\n  Rest: {shape_a: ball_collision, shape_b: Floor, spring_constant: 1e4 N/m, "
      "restitution_coefficient: 0.1, smallest_impact_speed: 0.1 m/s}\n";
  const scene::Scene scene = scene::load_text(text, "imported");
  multibody::testing::Mechanism mechanism(scene.mechanics, scene::row_names(scene));
  mechanism.run(3, 1e-3);
  EXPECT_NEAR(mechanism.pose("ball").position[2], -0.001 - 2 * 9.81 / 1e4, 1e-6);
}

}  // namespace collision_shapes_test
}  // namespace slew::urdf
