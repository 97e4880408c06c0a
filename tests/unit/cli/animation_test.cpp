#include "cli/animation/animation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/animation/machine_drawing.h"

namespace slew::cli {
namespace {

multibody::MechanicsDef arm() {
  multibody::MechanicsDef mechanics;
  mechanics.gravity = {0, -9.81, 0};
  mechanics.bodies = {{.name = "Arm", .mass = 1, .inertia = {1, 1, 1}}};
  multibody::JointDef hinge;
  hinge.name = "Hinge";
  hinge.body1 = "Ground";
  hinge.body2 = "Arm";
  hinge.point2 = {-1, 0, 0};
  mechanics.joints = {hinge};
  multibody::TranslationalForceDef cylinder;
  cylinder.name = "Cylinder";
  cylinder.body1 = "Ground";
  cylinder.point1 = {0, -2, 0};
  cylinder.body2 = "Arm";
  cylinder.point2 = {1, 0, 0};
  mechanics.translational_forces = {cylinder};
  return mechanics;
}

TEST(MachineDrawing, IsAStarFromTheJointAndALineForEachCylinder) {
  const MachineDrawing drawing = draw_machine(arm());
  ASSERT_EQ(drawing.bodies.size(), 2u);
  EXPECT_EQ(drawing.bodies[0].name, "Ground");
  EXPECT_EQ(drawing.bodies[1].lines, (std::vector<Polyline>{{{-1, 0, 0}, {1, 0, 0}}}));
  ASSERT_EQ(drawing.links.size(), 1u);
  EXPECT_EQ(drawing.links[0].body1, 0u);
  EXPECT_EQ(drawing.links[0].body2, 1u);
  EXPECT_EQ(drawing.axes, (std::array<Triple, 3>{{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}}));
}

TEST(MachineDrawing, ShowsTheEdgesOfShapesWhereTheyAre) {
  multibody::MechanicsDef mechanics = arm();
  multibody::ShapeDef box;
  box.type = contact::ShapeType::box;
  box.body = "Arm";
  box.position = {5, 0, 0};
  box.orientation = {M_PI / 2, 0, 0};
  box.size = {2, 4, 6};
  multibody::ShapeDef square;  // of two triangles: their common edge is no edge of it
  square.type = contact::ShapeType::triangle_mesh;
  square.vertices = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  square.triangles = {0, 1, 2, 0, 2, 3};
  mechanics.shapes = {box, square};
  const MachineDrawing drawing = draw_machine(mechanics);
  EXPECT_EQ(drawing.bodies[0].lines.size(), 4u);
  ASSERT_EQ(drawing.bodies[1].lines.size(), 1u + 12u);
  double reach_x = 0, reach_y = 0;
  for (std::size_t i = 1; i < drawing.bodies[1].lines.size(); ++i) {
    for (const Triple& point : drawing.bodies[1].lines[i]) {
      reach_x = std::max(reach_x, std::fabs(point[0] - 5));
      reach_y = std::max(reach_y, std::fabs(point[1]));
    }
  }
  EXPECT_NEAR(reach_x, 2, 1e-12);  // turned by a right angle
  EXPECT_NEAR(reach_y, 1, 1e-12);
}

Motion turning(std::size_t instants) {
  Motion motion{"<arm>", "test", {}, {{}}};
  for (std::size_t k = 0; k < instants; ++k) {
    const double angle = 0.1 * static_cast<double>(k);
    motion.time.push_back(0.01 * static_cast<double>(k));
    motion.poses[0].push_back({.position = {1, 0, 0}, .orientation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}});
  }
  return motion;
}

TEST(Animation, KeepsTheFirstAndTheLastInstant) {
  const Motion thin = thinned(turning(101), 5);
  EXPECT_EQ(thin.time, (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  EXPECT_EQ(thin.poses[0].size(), 5u);
  EXPECT_EQ(thinned(turning(3), 5).time.size(), 3u);
}

TEST(Animation, IsAPageOfItsOwn) {
  const std::string page = animation_html(draw_machine(arm()), turning(3));
  const std::string begin = "id=\"data\">";
  const std::size_t from = page.find(begin) + begin.size();
  const nlohmann::json data = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  EXPECT_EQ(data["time"].size(), 3u);
  EXPECT_EQ(data["bodies"][1]["pose"].size(), 3u * 7u);
  EXPECT_EQ(data["bodies"][1]["pose"][0], 1);
  EXPECT_FALSE(data["bodies"][0].contains("pose"));
  EXPECT_EQ(data["links"][0]["p1"], (nlohmann::json{0, -2, 0}));
  EXPECT_EQ(page.find("<arm>"), std::string::npos);
  for (const char* asked : {"src=", "href=", "http:", "https:"})
    EXPECT_EQ(page.find(asked), std::string::npos) << asked;
}

TEST(Animation, IsAPictureOfTheInstantsInBothViews) {
  const std::string svg = animation_svg(draw_machine(arm()), turning(3));
  const auto count = [&svg](const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<g opacity"), 6u);
  EXPECT_EQ(count("<polyline"), 12u);  // an arm and a cylinder each
  EXPECT_EQ(count("nan"), 0u);
}

}  // namespace
}  // namespace slew::cli
