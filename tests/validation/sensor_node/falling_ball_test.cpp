// SPDX-License-Identifier: Apache-2.0
// Sensors of whole scenes: a falling ball in closed form, and the truck crane, whose physics they do not change.
#include <gtest/gtest.h>

#include <cmath>

#include "build_paths.h"
#include "scene/scene.h"
#include "session/direct_session.h"

namespace slew::session {
namespace falling_ball_test {

using wire::Role;

constexpr double kHeight = 5, kRadius = 0.5, kGravity = 10;  // m, m, m/s2

const char* const kScene = R"(
session: {step: 1 ms}
mechanics: {gravity: [0, -10, 0]}
bodies:
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1], position: [0, 5 m, 0]}
joints:
  Free: {type: floating, body2: Ball, point1: [0, 5 m, 0]}
shapes:
  Floor: {type: plane, orientation: [0, -90 deg, 0]}
  Round: {type: sphere, body: Ball, radius: 0.5 m}
  Gate: {type: box, position: [0, 3 m, 0], size: [2 m, 1 m, 2 m]}
sensors:
  Gap: {type: clearance, of: [Ball], to: [Floor], limit: 2 m}
  Door: {type: zone, zone: Gate, watch: [Ball]}
  Hit: {type: collision, of: [Ball], to: [Floor], continuous: true}
recording: {every: 10}
)";

double value(const DirectSession& session, const std::string& name) {
  const coupling::Subsystem& sensors = *session.subsystem(Role::sensor);
  std::vector<double> values(sensors.variables().size());
  sensors.read_variables(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (sensors.variables()[i].name == name) return values[i];
  }
  ADD_FAILURE() << name;
  return 0;
}

const double kSpeed = std::sqrt(2 * kGravity * (kHeight - kRadius));  // m/s, at the floor

// time of the fall by this height [s]
double time_of(double way) {
  return std::sqrt(2 * way / kGravity);
}

TEST(FallingBall, IsSeenAtTheHeightAndSpeedOfItsFall) {
  DirectSession session(scene::load_text(kScene, "ball"));
  ASSERT_TRUE(session.start().is_ok());
  std::vector<std::pair<StepIndex, coupling::SensorEvent>> events;
  const auto take_events = [&](StepIndex at) {
    for (const coupling::SensorEvent& event : session.sample(Role::sensor).sensors.events)
      events.emplace_back(at, event);
  };
  take_events(0);
  for (StepIndex n = 0; n < 1000; ++n) {
    session.step(n, {}, {});
    if ((n + 1) % 10 != 0) continue;
    take_events(n + 1);
    const double t = 1e-3 * static_cast<double>(n + 1);
    const double gap = kHeight - kRadius - 0.5 * kGravity * t * t;
    EXPECT_NEAR(value(session, "Gap.distance"), std::max(gap, 0.0), 1e-9) << t;
    EXPECT_NEAR(value(session, "Gap.closing_speed"), gap > 0 ? kGravity * t : 0, 1e-9) << t;
  }
  // each event at the first sample of 10 ms after its time
  const auto step_of = [](double t) { return static_cast<StepIndex>(std::ceil(t / 0.01)) * 10; };
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[0].first, step_of(time_of(kHeight - kRadius - 3.5)));  // the ball's lowest point at the box's top
  EXPECT_EQ(events[1].first, step_of(time_of(kHeight - kRadius - 2)));    // close
  EXPECT_EQ(events[2].first, step_of(time_of(kHeight + kRadius - 2.5)));  // its highest one leaves the box
  EXPECT_EQ(events[3].first, step_of(time_of(kHeight - kRadius)));        // the floor
  // the speed of the sample before, or of the way since: within what gravity adds in a sample
  EXPECT_NEAR(events[3].second.value, kSpeed, kGravity * 0.01);
  EXPECT_NEAR(events[3].second.place[1], 0, 1e-4);
  // the way between two samples differs from a straight line by g h^2 / 8
  const double time = 1e-3 * static_cast<double>(events[3].first) - events[3].second.before;
  EXPECT_NEAR(time, time_of(kHeight - kRadius), (1e-4 + kGravity * 1e-4 / 8) / kSpeed);
}

// half a period of the contact is 2 ms: 1.3 ms after the ball has met the floor, a sample sees it on its way up
TEST(BouncingBall, HitsAtTheSpeedOfItsFall) {
  for (const char* const is_continuous : {"false", "true"}) {
    std::string text(kScene);
    const auto set = [&](const std::string& from, const std::string& to) {
      text.replace(text.find(from), from.size(), to);
    };
    set("continuous: true", std::string("continuous: ") + is_continuous);
    set("step: 1 ms", "step: 0.1 ms");
    set("every: 10", "every: 100");
    DirectSession session(scene::load_text(
        text + "contacts: {Touch: {shape_a: Round, shape_b: Floor, spring_constant: 5e6 N/m}}\n", "ball"));
    ASSERT_TRUE(session.start().is_ok());
    for (StepIndex n = 0; n < 9500; ++n) session.step(n, {}, {});
    ASSERT_EQ(value(session, "Hit.touching"), 1);
    ASSERT_EQ(value(session, "Hit.hits"), 1);
    EXPECT_NEAR(value(session, "Hit.speed"), kSpeed, kGravity * 0.01);
    EXPECT_NEAR(value(session, "Hit.place.y"), 0, 1e-4);
  }
}

// a plane on a body that is fixed to Ground stands where that body stands
TEST(FixedPlane, HasTheHeightOfItsBody) {
  std::string text(kScene);
  text.insert(text.find("joints:"), "  Foot: {mass: 1 kg, inertia: [0.1, 0.1, 0.1], position: [0, 1 m, 0]}\n");
  text.insert(text.find("shapes:"), "  Foot_Joint: {type: fixed, body2: Foot, point1: [0, 1 m, 0]}\n");
  text.insert(text.find("type: plane") + 11, ", body: Foot");
  DirectSession session(scene::load_text(text, "ball"));
  ASSERT_TRUE(session.start().is_ok());
  EXPECT_NEAR(value(session, "Gap.distance"), kHeight - kRadius - 1, 1e-12);
}

TEST(CraneWithSensors, ComputesTheSamePhysicsAsWithout) {
  const std::string file = SLEWRING_SOURCE_DIR "/scenes/truck_crane_sensors.yaml";
  const scene::Scene with = scene::load_file(file);
  scene::Scene without = scene::load_file(file);
  without.sensors.clear();
  DirectSession one(with), other(without);
  ASSERT_TRUE(one.start().is_ok());
  ASSERT_TRUE(other.start().is_ok());
  EXPECT_EQ(other.subsystem(Role::sensor), nullptr);
  const std::vector<double> controls = {0.3, 0.8, -0.2};
  for (StepIndex n = 0; n < 300; ++n) {
    one.step(n, {}, controls);
    other.step(n, {}, controls);
    ASSERT_EQ(one.state_hash(Role::mechanics), other.state_hash(Role::mechanics)) << n;
    ASSERT_EQ(one.state_hash(Role::hydraulics), other.state_hash(Role::hydraulics)) << n;
  }
  EXPECT_NE(one.state_hash(Role::sensor), 0u);
}

}  // namespace falling_ball_test
}  // namespace slew::session
