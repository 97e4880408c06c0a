// SPDX-License-Identifier: Apache-2.0
// The section `sensors` of a scene: reading it, the published text, what is refused.
#include <gtest/gtest.h>

#include <string>

#include "scene/scene.h"
#include "scene/sensors.h"

namespace slew::scene {
namespace sensors_test {

const std::string kYard = R"(
bodies:
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [0, 5 m, 0]}
  Plate: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [3 m, 5 m, 0]}
joints:
  Free: {type: floating, body2: Ball, point1: [0, 5 m, 0]}
  Loose: {type: floating, body2: Plate, point1: [3 m, 5 m, 0]}
shapes:
  Floor: {type: plane, orientation: [0, -90 deg, 0]}
  Round: {type: sphere, body: Ball, radius: 0.5 m}
  Sheet: {type: triangle_mesh, body: Plate, vertices: [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5],
          triangles: [0, 1, 2, 1, 3, 2]}
  Gate: {type: box, position: [0, 1 m, 0], size: [2 m, 2 m, 2 m]}
)";

std::string problem_of(const std::string& sensors) {
  try {
    static_cast<void>(load_text(kYard + "sensors:\n" + sensors, "test"));
  } catch (const LoadError& error) {
    return error.what();
  }
  return "";
}

TEST(SensorSection, IsPartOfThePublishedScene) {
  const Scene scene = load_text(kYard + R"(
sensors:
  Gap: {type: clearance, of: [Ball], to: [Floor, Plate], limit: 100 mm, hysteresis: 1 cm}
  Door: {type: zone, zone: Gate, watch: [Ball, Sheet], stay: 1 s}
  Hits: {type: collision, of: [Round], to: [Ground], continuous: true}
recording: {every: 20}
)",
                                "test");
  const Scene again = load_text(scene.expanded_text, "again");
  for (const Scene* one : {&scene, &again}) {
    const Scene& read = *one;
    ASSERT_EQ(read.sensors.size(), 3u);
    EXPECT_EQ(read.sensors[0].limit, 0.1);
    EXPECT_EQ(read.sensors[0].to, (std::vector<std::string>{"Floor", "Plate"}));
    EXPECT_EQ(read.sensors[1].type, sensors::SensorType::zone);
    EXPECT_TRUE(read.sensors[2].is_continuous);
    const sensors::SensorsDef def = sensors_of(read);
    EXPECT_EQ(def.interval, 0.02);
    ASSERT_EQ(def.frames.size(), 3u);
    EXPECT_EQ(def.frames[1].name, "Ball");
    EXPECT_EQ(def.frames[2].name, "Plate");
    EXPECT_EQ(def.shapes.size(), 4u);
  }
  EXPECT_FALSE(load_text(kYard, "test").has_sensors());
}

TEST(SensorSection, RefusesWhatCannotWorkWithItsPlace) {
  EXPECT_NE(problem_of("  S: {type: clearance, of: [Ball], to: [Cab]}").find("S.to: no body or shape 'Cab'"),
            std::string::npos);
  EXPECT_NE(problem_of("  S: {type: clearance, of: [Ball], to: [Round]}").find("can move relative to"),
            std::string::npos);
  EXPECT_NE(problem_of("  S: {type: zone, zone: Sheet, watch: [Ball]}").find("has no inside"), std::string::npos);
  EXPECT_NE(problem_of("  S: {type: zone, zone: Gate, watch: [Ball, Ball]}").find("named twice"), std::string::npos);
  EXPECT_NE(problem_of("  S: {type: clearance, of: 3, to: [Ball]}").find("a list of names of bodies or shapes"),
            std::string::npos);
  EXPECT_NE(problem_of("  S: {type: camera}").find("camera"), std::string::npos);
}

TEST(SensorSection, HasAsManyEventsAsAMessageHolds) {
  std::string sensors;
  const auto add = [&](int i) {
    sensors += "  S" + std::to_string(i) + ": {type: clearance, of: [Ball], to: [Plate]}\n";
  };
  for (int i = 0; i < 128; ++i) add(i);
  EXPECT_EQ(problem_of(sensors), "");
  add(128);
  EXPECT_NE(problem_of(sensors).find("S128: up to here the sensors can have more events"), std::string::npos);
  EXPECT_NE(problem_of(sensors).find("at most 256: two of a clearance or a collision"), std::string::npos);
}

TEST(SensorSection, TakesAPlaneOnABodyThatIsFixedToGround) {
  const std::string foot = kYard + R"(
  Slab: {type: plane, body: Foot, position: [0, 1 m, 0], orientation: [0, -90 deg, 0]}
sensors:
  Gap: {type: clearance, of: [Ball], to: [Slab]}
)";
  const auto with = [&](const std::string& type) {
    std::string text = foot;
    text.insert(text.find("joints:"), "  Foot: {mass: 1 kg, inertia: [0.1, 0.1, 0.1], position: [0, 2 m, 0]}\n");
    text.insert(text.find("shapes:"), "  Foot_Joint: {type: " + type + ", body2: Foot, point1: [0, 2 m, 0]}\n");
    return text;
  };
  const sensors::SensorsDef def = sensors_of(load_text(with("fixed"), "test"));
  ASSERT_EQ(def.frames.size(), 3u);
  EXPECT_TRUE(def.frames[2].is_static);
  EXPECT_THROW(static_cast<void>(load_text(with("floating"), "test")), LoadError);
}

// contact needs convex pieces where sensors do not
TEST(SensorSection, OffersSensorsWhereAMeshThatMovesIsInContact) {
  const std::string pair = kYard + "contacts: {Touch: {shape_a: Sheet, shape_b: Floor, spring_constant: 1e6 N/m}}\n";
  try {
    static_cast<void>(load_text(pair, "test"));
    FAIL() << "a surface in contact moved";
  } catch (const LoadError& error) {
    EXPECT_NE(std::string(error.what()).find("sensors take it as it is"), std::string::npos) << error.what();
  }
}

}  // namespace sensors_test
}  // namespace slew::scene
