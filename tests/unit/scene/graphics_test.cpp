// SPDX-License-Identifier: Apache-2.0
// Meshes for the eye: read from the section `graphics`, without effect on the physics.
#include "scene/graphics.h"

#include <gtest/gtest.h>

#include "build_paths.h"
#include "scene/scene.h"
#include "temporary_folder.h"

namespace slew::scene {
namespace graphics_test {

constexpr const char* kPendulum =
    "bodies:\n  Rod: {mass: 2 kg, inertia: [1, 1, 1]}\njoints:\n  Hinge: {type: revolute, body2: Rod}\n";
constexpr const char* kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string graphics_text(const std::string& fields) {
  return std::string(kPendulum) + "graphics:\n  Rod_View: {" + fields + "}\n";
}

std::string refusal(const TemporaryFolder& folder, const std::string& fields) {
  try {
    (void)load_file(folder.write("scene.yaml", graphics_text(fields)));
  } catch (const LoadError& error) {
    return error.what();
  }
  return "";
}

TEST(Graphics, StayInTheirFilesAndAddNothingToThePhysics) {
  const TemporaryFolder folder;
  folder.write("rod.obj", kTriangle);
  const Scene plain = load_file(folder.write("scene.yaml", kPendulum));
  const Scene drawn = load_file(folder.write(
      "scene.yaml",
      graphics_text("body: Rod, file: rod.obj, unit: 1 mm, up: z, position: [1 m, 0, 0], color: [1, 0.5, 0]")));
  ASSERT_EQ(drawn.graphics.size(), 1u);
  EXPECT_EQ(drawn.graphics[0].unit, 1e-3);
  EXPECT_EQ(drawn.graphics[0].up, contact::UpAxis::z);
  EXPECT_EQ(drawn.graphics[0].color, (Triple{1, 0.5, 0}));
  EXPECT_TRUE(drawn.assets.empty()) << "no node needs the file";
  EXPECT_FALSE(drawn.needs_files());
  // all that nodes read of the physics is the same text
  const std::size_t begin = drawn.expanded_text.find("graphics:");
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(drawn.expanded_text.substr(0, begin), plain.expanded_text.substr(0, begin));
  EXPECT_EQ(begin, plain.expanded_text.size());
  const Scene again = load_text(drawn.expanded_text, "scene");
  EXPECT_EQ(again.expanded_text, drawn.expanded_text);
}

TEST(Graphics, WithFaultsAreErrorsAtLoad) {
  const TemporaryFolder folder;
  folder.write("rod.obj", kTriangle);
  folder.write("rod.txt", kTriangle);
  const std::string rest = ", unit: 1 m, up: y";
  EXPECT_NE(refusal(folder, "body: Rod, file: none.stl" + rest).find("Rod_View.file: "), std::string::npos);
  EXPECT_NE(refusal(folder, "body: Rod, file: rod.txt" + rest).find("unknown ending"), std::string::npos);
  EXPECT_NE(refusal(folder, "body: Rod, file: ../rod.obj" + rest).find("lies outside"), std::string::npos);
  EXPECT_NE(refusal(folder, "body: Arm, file: rod.obj" + rest).find("no body 'Arm'"), std::string::npos);
  EXPECT_NE(refusal(folder, "body: Rod, file: rod.obj, up: y").find("unit"), std::string::npos);
  EXPECT_NE(refusal(folder, "body: Rod, file: ." + rest).find("Rod_View.file: "), std::string::npos);
  EXPECT_EQ(refusal(folder, "body: Rod, file: rod.obj" + rest), "");
  EXPECT_EQ(refusal(folder, "body: Ground, file: rod.obj" + rest), "");
}

TEST(Graphics, OfTheCraneCoverItsBodies) {
  const Scene crane = load_file(SLEWRING_SOURCE_DIR "/scenes/truck_crane.yaml");
  for (const auto& body : crane.mechanics.bodies) {
    const auto is_of_body = [&](const GraphicDef& graphic) { return graphic.body == body.name; };
    EXPECT_TRUE(std::any_of(crane.graphics.begin(), crane.graphics.end(), is_of_body)) << body.name;
  }
}

}  // namespace graphics_test
}  // namespace slew::scene
