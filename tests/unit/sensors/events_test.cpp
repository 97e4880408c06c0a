// SPDX-License-Identifier: Apache-2.0
// Events and memory of sensors: limits, zones, hits, continuous search, saved state.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/rotation.h"
#include "sensor_bench.h"

namespace slew::sensors::testing {
namespace events_test {

using contact::testing::box;
using contact::testing::plane;
using contact::testing::sphere;

// Events of one sample as a word each.
std::string words(const Sensors& sensors) {
  std::string all;
  for (const Event& event : sensors.events()) {
    constexpr const char* kWords[] = {"close", "clear", "enter", "leave", "stay", "hit", "apart"};
    all += (all.empty() ? "" : " ") + std::string(kWords[static_cast<int>(event.kind)]);
  }
  return all;
}

FrameMotion at_x(double x, double v = 0) {
  return {.p_W = {x, 0, 0}, .v_W = {v, 0, 0}};
}

TEST(Clearance, IsCloseBelowItsLimitUntilItIsBeyondTheHysteresis) {
  SensorDef sensor = clearance();
  sensor.limit = 0.5;
  sensor.hysteresis = 0.25;
  Sensors sensors(pair(sphere(0.5), sphere(0.5), sensor));
  const std::pair<double, const char*> steps[] = {{2, ""},    {1.625, ""},      {1.375, "close"}, {1.625, ""},
                                                  {1.25, ""}, {1.875, "clear"}, {1.625, ""},      {1.25, "close"}};
  for (const auto& [x, expected] : steps) {
    ASSERT_TRUE(sensors.observe(at(at_x(x))));
    EXPECT_EQ(words(sensors), expected) << x;
  }
  EXPECT_EQ(event_text(sensor, sensors.events()[0]), "S: 0.25 m, below the limit of 0.5 m");
  EXPECT_EQ(value(sensors, "S.close"), 1);
}

TEST(Zone, ReportsWhatEntersStaysAndLeaves) {
  SensorDef zone{.name = "S", .type = SensorType::zone, .zone = "b", .watch = {"A"}, .stay = 0.05};
  SensorsDef def = pair(sphere(0.5), box(2, 2, 2), zone);
  def.interval = 0.02;
  Sensors sensors(def);
  const std::pair<double, const char*> steps[] = {{3, ""},     {1.4, "enter"}, {1, ""},        {0, ""},
                                                  {0, "stay"}, {0, ""},        {1.6, "leave"}, {1.4, "enter"}};
  std::vector<std::string> texts;
  for (const auto& [x, expected] : steps) {
    ASSERT_TRUE(sensors.observe(at(at_x(x))));
    EXPECT_EQ(words(sensors), expected) << x;
    for (const Event& event : sensors.events()) texts.push_back(event_text(zone, event));
  }
  const std::vector<std::string> expected = {"S: A entered", "S: A has stayed for 0.06 s", "S: A left after 0.1 s",
                                             "S: A entered"};
  EXPECT_EQ(texts, expected);
  EXPECT_EQ(value(sensors, "S.inside"), 1);
  EXPECT_EQ(value(sensors, "S.A.inside"), 1);
  EXPECT_EQ(value(sensors, "S.A.time"), 0);
}

TEST(Zone, SeesEveryShapeOfABody) {
  SensorsDef def =
      pair(box(1, 1, 1), box(2, 2, 2), {.name = "S", .type = SensorType::zone, .zone = "b", .watch = {"A"}});
  for (const auto& [name, x] : {std::pair("left", -8.0), std::pair("ball", 4.0), std::pair("right", 8.0)}) {
    contact::ShapeDef shape = in_frame(std::string(name) == "ball" ? sphere(0.2) : box(1, 1, 1), name, "A");
    shape.position = {x, 0, 0};
    def.shapes.push_back(shape);
  }
  for (const auto& [x, inside] : {std::pair(0.0, 1.0), std::pair(8.0, 1.0), std::pair(-8.0, 1.0), std::pair(-4.0, 1.0),
                                  std::pair(-2.81, 1.0), std::pair(-2.79, 0.0), std::pair(2.0, 0.0)}) {
    Sensors sensors(def);
    ASSERT_TRUE(sensors.observe(at(at_x(x))));
    EXPECT_EQ(value(sensors, "S.inside"), inside) << x;
  }
}

// a clearance to the body of a zone does not fall to 0 in the zone
TEST(Zone, IsNoPartOfItsBody) {
  SensorsDef def = pair(sphere(0.5), box(1, 1, 1), clearance());
  def.sensors[0].to = {"B"};
  def.shapes.push_back(in_frame(box(9, 9, 9), "space", "B"));
  def.sensors.push_back({.name = "Z", .type = SensorType::zone, .zone = "space", .watch = {"A"}});
  Sensors sensors(def);
  ASSERT_TRUE(sensors.observe(at(at_x(3))));
  EXPECT_NEAR(value(sensors, "S.distance"), 2, 1e-9);
  EXPECT_EQ(value(sensors, "Z.inside"), 1);
  def.sensors[0].to = {"space"};
  Sensors by_name(def);
  ASSERT_TRUE(by_name.observe(at(at_x(3))));
  EXPECT_EQ(value(by_name, "S.distance"), 0);
}

TEST(Collision, GivesSpeedAndPlaceOfAHit) {
  SensorDef sensor{.name = "S", .type = SensorType::collision, .of = {"A"}, .to = {"b"}};
  SensorsDef def = pair(sphere(0.5), plane(), sensor);
  def.interval = 0.04;
  Sensors sensors(def);
  const auto falling = [](double z) { return FrameMotion{.p_W = {1, 2, z}, .v_W = {5, 0, -3}}; };
  ASSERT_TRUE(sensors.observe(at(falling(0.6))));
  EXPECT_EQ(words(sensors), "");
  ASSERT_TRUE(sensors.observe(at(falling(0.48))));
  EXPECT_EQ(words(sensors), "hit");
  EXPECT_NEAR(value(sensors, "S.speed"), 3, 1e-12);
  EXPECT_EQ(value(sensors, "S.touching"), 1);
  EXPECT_NEAR(norm(point(sensors, "S.place") - Vec3(1, 2, 0)), 0, 1e-4);
  EXPECT_EQ(event_text(sensor, sensors.events()[0]),
            "S: hit at 3 m/s, 6.68 ms before the step, at 1.000 2.000 0.000 m");
  ASSERT_TRUE(sensors.observe(at(falling(0.48))));
  EXPECT_EQ(words(sensors), "");
  ASSERT_TRUE(sensors.observe(at(falling(0.51))));
  EXPECT_EQ(words(sensors), "apart");
  EXPECT_EQ(event_text(sensor, sensors.events()[0]), "S: apart after 0.0867 s");
  EXPECT_EQ(value(sensors, "S.hits"), 1);
}

ShapeDef surface(double x, double y, double z) {
  ShapeDef shape = contact::testing::box_mesh(x, y, z);
  shape.type = contact::ShapeType::triangle_mesh;
  return shape;
}

// The sides of both are in one plane, and meet nowhere but over each other; the ball's centre is beyond the plate's.
// The second sample is beyond a bounce, which does not change the speed of the hit.
TEST(Collision, HasTheSpeedAndThePlaceOfTheFirstContact) {
  for (const bool is_continuous : {false, true}) {
    const SensorDef sensor{
        .name = "S", .type = SensorType::collision, .of = {"A"}, .to = {"b"}, .is_continuous = is_continuous};
    for (const auto& [first, second] :
         {std::pair(surface(1, 1, 1), surface(1, 1, 1)), std::pair(box(1, 1, 1), surface(1, 1, 1)),
          std::pair(surface(1, 1, 1), box(1, 1, 1)), std::pair(box(1, 1, 1), box(1, 1, 1)),
          std::pair(sphere(0.5), box(1, 1, 1))}) {
      Sensors sensors(pair(first, second, sensor));
      ASSERT_TRUE(sensors.observe(at(at_x(-1.01, 3))));
      ASSERT_TRUE(sensors.observe(at(at_x(-0.99, -2))));
      EXPECT_EQ(words(sensors), "hit");
      EXPECT_NEAR(value(sensors, "S.speed"), 3, 1e-9);
      EXPECT_NEAR(value(sensors, "S.place.x"), -0.5, 1e-4);
      EXPECT_LE(std::fabs(value(sensors, "S.place.y")), 0.5 + 1e-4);
      EXPECT_LE(std::fabs(value(sensors, "S.place.z")), 0.5 + 1e-4);
    }
  }
}

// at rest in the sample before, or turning back there: the way since has the speed
TEST(Collision, HasTheSpeedOfTheWayWhereTheSampleBeforeHasLess) {
  for (const double before : {0.0, -1.0}) {
    Sensors sensors(pair(sphere(0.5), plane(), {.name = "S", .type = SensorType::collision, .of = {"A"}, .to = {"b"}}));
    ASSERT_TRUE(sensors.observe(at({.p_W = {0, 0, 0.51}, .v_W = {0, 0, -before}})));
    ASSERT_TRUE(sensors.observe(at({.p_W = {0, 0, 0.49}, .v_W = {0, 0, -5}})));
    EXPECT_EQ(words(sensors), "hit");
    EXPECT_NEAR(value(sensors, "S.speed"), 2, 1e-9);
  }
}

TEST(Collision, HasNoSpeedWhereShapesOverlapAtTheStart) {
  Sensors sensors(
      pair(sphere(0.5), box(1, 1, 1), {.name = "S", .type = SensorType::collision, .of = {"A"}, .to = {"b"}}));
  ASSERT_TRUE(sensors.observe(at(at_x(-0.9, -3))));
  EXPECT_EQ(words(sensors), "hit");
  EXPECT_EQ(value(sensors, "S.speed"), 0);
}

SensorDef continuous() {
  return {.name = "S", .type = SensorType::collision, .of = {"A"}, .to = {"b"}, .is_continuous = true};
}

// a ball of 10 mm at 40 m/s goes through a plate of 1 mm between two samples that are 0.4 m apart
TEST(ContinuousCollision, FindsABallThatPassesAPlateBetweenTwoSamples) {
  const SensorsDef def = pair(sphere(0.005), box(0.001, 1, 1), continuous());
  Sensors sensors(def);
  ASSERT_TRUE(sensors.observe(at(at_x(-0.13, 40))));
  ASSERT_TRUE(sensors.observe(at(at_x(0.27, 40))));
  EXPECT_EQ(words(sensors), "hit apart");
  EXPECT_NEAR(value(sensors, "S.speed"), 40, 1e-9);
  // where the ball's front meets the plate, to the 0.1 mm of the search
  EXPECT_NEAR(norm(point(sensors, "S.place") - Vec3(-0.0005, 0, 0)), 0, 1e-4);
  // and when: both events name the same time
  EXPECT_NEAR(sensors.events()[0].before, (0.27 + 0.0055) / 40, 1e-4 / 40);
  EXPECT_EQ(sensors.events()[1].value, sensors.events()[0].before);
  EXPECT_EQ(value(sensors, "S.touching"), 0);

  SensorsDef by_samples = def;
  by_samples.sensors[0].is_continuous = false;
  Sensors blind(by_samples);
  ASSERT_TRUE(blind.observe(at(at_x(-0.13, 40))));
  ASSERT_TRUE(blind.observe(at(at_x(0.27, 40))));
  EXPECT_EQ(words(blind), "");
}

// a face that meets a face in parallel, where the last stride could end in the contact
TEST(ContinuousCollision, HasTheSpeedOfFacesThatMeetFlat) {
  for (const double start : {-1.6, -1.9, -2.13}) {
    Sensors sensors(pair(box(1, 1, 1), box(1, 2, 2), continuous()));
    ASSERT_TRUE(sensors.observe(at(at_x(start, 60))));
    ASSERT_TRUE(sensors.observe(at(at_x(start + 0.6, 60))));
    ASSERT_TRUE(sensors.observe(at(at_x(start + 1.2, 60))));
    EXPECT_EQ(value(sensors, "S.hits"), 1) << start;
    EXPECT_NEAR(value(sensors, "S.speed"), 60, 1e-9) << start;
    EXPECT_NEAR(value(sensors, "S.place.x"), -0.5, 1e-4) << start;
  }
}

// a bar of 2 m turns by 1.2 rad about the origin of its frame, past a thin post
TEST(ContinuousCollision, FindsABarThatTurnsPastAPost) {
  Sensors sensors(pair(box(2, 0.01, 0.01), box(0.001, 0.001, 1), continuous()));
  const auto turned = [](double angle) { return FrameMotion{.R_W = math::rotation_z(angle), .w_W = {0, 0, 120}}; };
  const FrameMotion post{.p_W = {0.8 * std::cos(0.5), 0.8 * std::sin(0.5), 0}};
  ASSERT_TRUE(sensors.observe(at(turned(-0.1), post)));
  ASSERT_TRUE(sensors.observe(at(turned(1.1), post)));
  EXPECT_EQ(words(sensors), "hit apart");
  EXPECT_NEAR(value(sensors, "S.speed"), 0.8 * 120, 2);
  // along the post any point of the bar's edge is nearest
  EXPECT_NEAR(value(sensors, "S.place.x"), post.p_W[0], 1e-3);
  EXPECT_NEAR(value(sensors, "S.place.y"), post.p_W[1], 1e-3);
}

// from half a turn in an interval on, two poses do not show which way a body has turned, and how often
TEST(ContinuousCollision, IsNotFineWhereABodyTurnsByHalfATurnInAnInterval) {
  for (const double rate : {310.0, 320.0, 628.0}) {
    const bool is_fine = rate * 0.01 < std::numbers::pi;
    Sensors sensors(pair(box(2, 0.01, 0.01), box(0.001, 0.001, 1), continuous()));
    const auto turned = [&](double t) { return FrameMotion{.R_W = math::rotation_z(rate * t), .w_W = {0, 0, rate}}; };
    const FrameMotion post{.p_W = {0, 2, 0}};
    ASSERT_TRUE(sensors.observe(at(turned(0), post)));
    EXPECT_EQ(sensors.observe(at(turned(0.01), post)), is_fine) << rate;
    EXPECT_EQ(sensors.failed(), 0U);
    EXPECT_EQ(value(sensors, "S.touching"), 0);
    // the sample itself counts all the same
    EXPECT_EQ(sensors.observe(at(turned(0.02), {})), is_fine) << rate;
    EXPECT_EQ(value(sensors, "S.touching"), 1);
    EXPECT_EQ(value(sensors, "S.hits"), 1);
  }
}

TEST(ContinuousCollision, FindsNothingWherePathsMiss) {
  Sensors sensors(pair(sphere(0.005), box(0.001, 1, 1), continuous()));
  FrameMotion ball = at_x(-0.2, 40);
  ball.p_W += Vec3(0, 0.5052, 0);
  ASSERT_TRUE(sensors.observe(at(ball)));
  ball.p_W += Vec3(0.4, 0, 0);
  ASSERT_TRUE(sensors.observe(at(ball)));
  EXPECT_EQ(words(sensors), "");
  EXPECT_EQ(value(sensors, "S.hits"), 0);
}

TEST(SavedSensors, GoOnToTheSameValuesAndEvents) {
  SensorsDef def = pair(sphere(0.5), box(2, 2, 2), clearance());
  def.sensors[0].limit = 0.3;
  def.sensors[0].hysteresis = 0.1;
  def.sensors.push_back({.name = "Z", .type = SensorType::zone, .zone = "b", .watch = {"A"}, .stay = 0.03});
  def.sensors.push_back({.name = "C", .type = SensorType::collision, .of = {"A"}, .to = {"b"}, .is_continuous = true});
  const auto motion = [](int i) { return at(at_x(2 * std::cos(0.5 * i), 0.1 * i)); };
  Sensors one(def);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(one.observe(motion(i)));
  std::vector<std::byte> bytes;
  StateWriter writer(bytes, {1, 2});
  one.save(writer);
  writer.finish();
  Sensors other(def);
  StateReader reader(bytes, {1, 2});
  other.load(reader);
  ASSERT_TRUE(reader.finish("sensors").is_ok());
  EXPECT_EQ(one.state_hash(), other.state_hash());
  std::size_t events = 0;
  for (int i = 10; i < 40; ++i) {
    ASSERT_TRUE(one.observe(motion(i)));
    ASSERT_TRUE(other.observe(motion(i)));
    EXPECT_EQ(values(one), values(other)) << i;
    EXPECT_EQ(words(one), words(other)) << i;
    EXPECT_EQ(one.state_hash(), other.state_hash()) << i;
    events += one.events().size();
  }
  EXPECT_GT(events, 10u);
  one.reset();
  EXPECT_EQ(one.state_hash(), Sensors(def).state_hash());
}

}  // namespace events_test
}  // namespace slew::sensors::testing
