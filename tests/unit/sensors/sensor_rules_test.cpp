// SPDX-License-Identifier: Apache-2.0
// What a definition of sensors is refused for.
#include <gtest/gtest.h>

#include "sensor_bench.h"

namespace slew::sensors::testing {
namespace sensor_rules_test {

using contact::testing::plane;
using contact::testing::sphere;

std::string problems_of(const SensorsDef& def) {
  Problems problems;
  validate(def, problems);
  std::string all;
  for (const Problem& problem : problems) all += problem.path + ": " + problem.what + "\n";
  return all;
}

TEST(SensorRules, SoundOnesHaveNoProblems) {
  EXPECT_EQ(problems_of(pair(sphere(1), sphere(1), clearance())), "");
  EXPECT_EQ(problems_of(pair(sphere(1), plane(), clearance())), "");
}

TEST(SensorRules, NameWhatHasNoShape) {
  SensorDef sensor = clearance();
  sensor.of = {"A", "Cab"};
  EXPECT_EQ(problems_of(pair(sphere(1), sphere(1), sensor)), "S.of: 'Cab' has no shape\n");
  sensor.of = {};
  EXPECT_EQ(problems_of(pair(sphere(1), sphere(1), sensor)), "S.of: the list is empty\n");
}

TEST(SensorRules, RefuseGroupsThatCannotMoveRelativeToEachOther) {
  SensorDef sensor = clearance();
  sensor.to = {"A"};
  EXPECT_EQ(problems_of(pair(sphere(1), sphere(1), sensor)),
            "S.to: no shape can move relative to one of the other group\n");
}

TEST(SensorRules, RefuseTwoPlanesAndPlanesThatMove) {
  SensorsDef def = pair(plane(), plane(), clearance());
  def.shapes[0].frame = "B";
  def.sensors[0].of = {"a"};
  EXPECT_EQ(problems_of(def), "S.of: the plane 'a' is fixed to 'B', which moves\nS.to: 'a' and 'b' are both planes\n");
}

TEST(SensorRules, RefuseZonesWithoutAnInside) {
  SensorDef sensor{.name = "S", .type = SensorType::zone, .zone = "b", .watch = {"A", "A"}};
  ShapeDef surface = contact::testing::box_mesh(1, 1, 1);
  surface.type = contact::ShapeType::triangle_mesh;
  EXPECT_EQ(problems_of(pair(sphere(1), surface, sensor)),
            "S.zone: 'b' is a surface of triangles and has no inside\nS.watch: 'A' is named twice\n");
  sensor.zone = "c";
  EXPECT_NE(problems_of(pair(sphere(1), surface, sensor)).find("S.zone: there is no shape 'c'"), std::string::npos);
}

}  // namespace sensor_rules_test
}  // namespace slew::sensors::testing
