// SPDX-License-Identifier: Apache-2.0
#include "analysis/animation/animation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "analysis/animation/machine_drawing.h"
#include "build_paths.h"
#include "math/rotation.h"
#include "scene/scene.h"
#include "tests/support/played_page.h"

namespace slew::analysis {
namespace animation_test {

multibody::MechanicsDef arm() {
  multibody::MechanicsDef mechanics;
  mechanics.gravity = {0, -9.81, 0};
  mechanics.bodies = {{.name = "Arm", .mass = 1, .center_of_mass = {-1, 0, 0}, .inertia = {1, 1, 1}}};
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
  multibody::ShapeDef square;  // two triangles: their common edge is no edge of the shape
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

TEST(MachineDrawing, ShowsTheCentreOfMassAndACrossWhereNothingElseIsSeen) {
  multibody::MechanicsDef pendulum = arm();
  pendulum.translational_forces.clear();
  pendulum.bodies[0].center_of_mass = {0.5, 0, 0};
  EXPECT_EQ(draw_machine(pendulum).bodies[1].lines, (std::vector<Polyline>{{{-1, 0, 0}, {0.5, 0, 0}}}));
  // one that turns about its own centre of mass, and one that flies alone
  pendulum.bodies[0].center_of_mass = {-1, 0, 0};
  const std::vector<Polyline> cross = draw_machine(pendulum).bodies[1].lines;
  ASSERT_EQ(cross.size(), 3u);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double middle = (cross[axis][0][i] + cross[axis][1][i]) / 2;
      EXPECT_NEAR(middle, i == 0 ? -1 : 0, 1e-12);
      EXPECT_EQ(cross[axis][0][i] < cross[axis][1][i], i == axis);
    }
  }
  pendulum.joints.clear();
  pendulum.bodies[0].center_of_mass = {};
  const std::vector<Polyline> alone = draw_machine(pendulum).bodies[1].lines;
  EXPECT_EQ(alone.size(), 3u);
  // the ground's size is not the machine's
  multibody::ShapeDef ground;
  ground.type = contact::ShapeType::box;
  ground.body = "Ground";
  ground.size = {500, 1, 500};
  pendulum.shapes = {ground};
  EXPECT_EQ(draw_machine(pendulum).bodies[1].lines, alone);
}

TEST(MachineDrawing, OfEverySceneShowsEveryBody) {
  int drawn = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SLEWRING_SOURCE_DIR "/scenes")) {
    // problems of a flexible body alone are for 'slewring flex'
    const bool is_scene = entry.path().extension() == ".yaml" && entry.path().parent_path().filename() != "beams";
    if (!is_scene) continue;
    const scene::Scene scene = scene::load_file(entry.path().string());
    const MachineDrawing drawing = draw_machine(scene.mechanics);
    ASSERT_EQ(drawing.bodies.size(), scene.mechanics.bodies.size() + 1);
    for (std::size_t i = 1; i < drawing.bodies.size(); ++i) {
      const std::vector<Polyline>& lines = drawing.bodies[i].lines;
      const bool is_seen =
          std::any_of(lines.begin(), lines.end(), [](const Polyline& line) { return line.front() != line.back(); });
      EXPECT_TRUE(is_seen) << entry.path() << ": " << drawing.bodies[i].name;
      ++drawn;
    }
  }
  EXPECT_GT(drawn, 50);
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

TEST(Animation, LeavesOutEvenlyWhatAPageDoesNotBear) {
  EXPECT_EQ(stride_for(turning(1), 4), 1u);
  EXPECT_EQ(stride_for(turning(4), 4), 1u);
  EXPECT_EQ(stride_for(turning(5), 4), 2u);
  EXPECT_EQ(stride_for(turning(8), 4), 3u);
  EXPECT_EQ(every_nth(turning(5), 2).time, (std::vector<double>{0, 0.02, 0.04}));
  const Motion thin = every_nth(turning(8), 3);
  EXPECT_EQ(thin.time, (std::vector<double>{0, 0.03, 0.06, 0.07}));
  EXPECT_EQ(thin.poses[0].size(), 4u);
  for (std::size_t count = 2; count < 60; ++count) {
    const Motion motion = turning(count);
    EXPECT_LE(every_nth(motion, stride_for(motion, 7)).time.size(), 7u) << count;
  }
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
  for (const char* resource : {"src=", "href=", "http:", "https:"})
    EXPECT_EQ(page.find(resource), std::string::npos) << resource;
}

TEST(Animation, IsAPictureOfTheInstantsInBothViews) {
  multibody::MechanicsDef mechanics = arm();
  multibody::ShapeDef plate;  // on the ground, greater than the picture
  plate.type = contact::ShapeType::triangle_mesh;
  plate.body = "Ground";
  plate.vertices = {-9, 0, -9, 9, 0, -9, 0, 0, 9};
  plate.triangles = {0, 1, 2};
  mechanics.shapes = {plate};
  const std::string svg = animation_svg(draw_machine(mechanics), turning(3));
  const auto count = [&svg](const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<g opacity"), 6u);
  // an arm and a cylinder each, and the ground's three edges once in each view
  EXPECT_EQ(count("<polyline"), 12u + 6u);
  EXPECT_EQ(count("#b5b5b5"), 6u);
  EXPECT_EQ(count("clip-path"), 2u);
  EXPECT_EQ(count("nan"), 0u);
}

// ---- the page's script, run

// drawn points, back from px to m in the plane of the view
constexpr const char* kDriver = R"(
const W=800,H=600,s=Math.min(W,H)/2/reach;
const drawn=(id,right,up)=>page.elements[id].context.lines.map(l=>({colour:l.colour,alpha:l.alpha,points:l.points.map(
 ([x,y])=>[(x-W/2)/s+dot(middle,right),(H/2-y)/s+dot(middle,up)])}));
const slide=n=>page.elements.time.oninput({target:{value:String(n)}}),now=()=>page.elements.now.textContent;
)";

class AnimationPage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::has_node()) GTEST_SKIP() << "there is no 'node' here, which runs the page's script";
    // a turn about an axis that lies in none of the views' planes, and a way
    motion_.poses.emplace_back();
    const double third = 1 / std::sqrt(3.0);
    for (int k = 0; k < 8; ++k) {
      const double half = 0.2 * k, sine = third * std::sin(half);
      motion_.time.push_back(k < 4 ? 0.01 * k : 0.1 + 0.01 * k);
      motion_.poses[0].push_back(
          {.position = {1 + 0.1 * k, 0.2 * k, -0.3 * k}, .orientation = {std::cos(half), sine, sine, sine}});
    }
    motion_.gaps = {{0.03, 0.14}};
  }
  [[nodiscard]] nlohmann::json play(const std::string& drive) const {
    const nlohmann::json result = testing::played_page(animation_html(draw_machine(arm()), motion_),
                                                       std::string(kDriver) + "function drive(){" + drive + "}");
    EXPECT_FALSE(result.is_null());
    return result;
  }
  // the arm's line from (-1, 0, 0) to (1, 0, 0), seen along an axis; turn of the view about y [rad]
  void expect_drawn_at(const nlohmann::json& lines, std::size_t instant, bool is_top, double turn = 0) const {
    const Pose& pose = motion_.poses[0][instant];
    const math::Mat3 R = math::rotation_of(pose.orientation);
    ASSERT_EQ(lines.size(), 2u) << "the arm and the cylinder";
    for (std::size_t end = 0; end < 2; ++end) {
      const math::Vec3 p = pose.position + R * math::Vec3{end == 0 ? -1.0 : 1.0, 0, 0};
      const double right = p[0] * std::cos(turn) + p[2] * std::sin(turn), up = is_top ? -p[2] : p[1];
      EXPECT_NEAR(lines[0]["points"][end][0].get<double>(), right, 2e-5) << instant;
      EXPECT_NEAR(lines[0]["points"][end][1].get<double>(), up, 2e-5) << instant;
      // the cylinder ends at the arm's far end, and begins at (0, -2, 0) of Ground
      EXPECT_NEAR(lines[1]["points"][end][0].get<double>(), end == 0 ? 0 : right, 2e-5) << instant;
      EXPECT_NEAR(lines[1]["points"][end][1].get<double>(), end == 0 ? (is_top ? 0 : -2) : up, 2e-5) << instant;
    }
  }

  Motion motion_{"arm", "test", {}, {}, {}};
};

TEST_F(AnimationPage, TheSliderShowsABodyAtItsPose) {
  const nlohmann::json result = play(R"(
    const out=[];for(const n of [0,3,7,5]){slide(n);
     out.push({now:now(),side:drawn('side',[1,0,0],[0,1,0]),top:drawn('top',[1,0,0],[0,0,-1])})}
    page.elements.turn.value='90';page.elements.turn.oninput();out.push({side:drawn('side',[0,0,1],[0,1,0])});
    return {frames:out,most:page.elements.time.max})");
  EXPECT_EQ(result["most"], 7);
  const std::size_t instants[] = {0, 3, 7, 5};
  for (std::size_t i = 0; i < 4; ++i) {
    expect_drawn_at(result["frames"][i]["side"], instants[i], false);
    expect_drawn_at(result["frames"][i]["top"], instants[i], true);
  }
  expect_drawn_at(result["frames"][4]["side"], 5, false, M_PI / 2);
  EXPECT_EQ(result["frames"][1]["now"], "0.03 s");
  EXPECT_EQ(result["frames"][2]["now"], "0.17 s");
}

TEST_F(AnimationPage, PlaysInTimeAndMarksGapsOfTheRecording) {
  const nlohmann::json result = play(R"(
    const out=[],go=ms=>{page.now=ms;page.frames.shift()(ms);
     out.push({now:now(),k:+page.elements.time.value,alpha:page.elements.side.context.lines[0].alpha})};
    page.elements.play.onclick();for(const ms of [15,60,145,171])go(ms);
    page.elements.play.onclick();page.frames.shift()(200);out.push(page.frames.length);return out)");
  EXPECT_EQ(result[0], (nlohmann::json{{"now", "0.01 s"}, {"k", 1}, {"alpha", 1}}));
  EXPECT_EQ(result[1], (nlohmann::json{{"now", "0.06 s: not recorded"}, {"k", 3}, {"alpha", 0.25}}));
  EXPECT_EQ(result[2], (nlohmann::json{{"now", "0.14 s"}, {"k", 4}, {"alpha", 1}}));
  EXPECT_EQ(result[3]["k"], 0);  // behind the end it begins again
  EXPECT_EQ(result[4], 0);       // it stands
}

}  // namespace animation_test
}  // namespace slew::analysis
