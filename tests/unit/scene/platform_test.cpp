// SPDX-License-Identifier: Apache-2.0
// Motion platforms of a scene: reading them, the published text, what is refused.
#include <gtest/gtest.h>

#include <string>

#include "scene/devices.h"
#include "scene/scene.h"
#include "scene_text.h"

namespace slew::scene {
namespace platform_test {

const std::string kBall =
    "bodies:\n  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}\njoints:\n  Free: {type: floating, body2: Ball}\n";

const std::string kJoints =
    "    base_joints: [[648 mm, 57 mm, 0], [-275 mm, 589 mm, 0], [-373 mm, 532 mm, 0], [-373 mm, -532 mm, 0], "
    "[-275 mm, -589 mm, 0], [648 mm, -57 mm, 0]]\n"
    "    platform_joints: [[287 mm, 410 mm, 0], [211 mm, 453 mm, 0], [-498 mm, 44 mm, 0], [-498 mm, -44 mm, 0], "
    "[211 mm, -453 mm, 0], [287 mm, -410 mm, 0]]\n";
const std::string kStroke = "    neutral_height: 0.75 m\n    shortest_leg: 0.72 m\n    longest_leg: 1.02 m\n";
const std::string kSeat = "    body: Ball\n    forward: [1, 0, 0]\n    up: [0, 1, 0]\n    send: 127.0.0.1:6000\n";
const std::string kFields = "    fields: [{name: leg_1, variable: Seat.leg_1}]\n";

std::string platform(const std::string& rows) {
  return "devices:\n  Seat:\n    type: motion_platform\n" + rows;
}

TEST(PlatformSection, IsPartOfThePublishedScene) {
  const Scene scene = load_text(
      kBall +
          platform(kSeat + kJoints + kStroke +
                   "    point: [0, 1 m, 0]\n    every: 10 ms\n    angle_limit: [5 deg, 10 deg, 15 deg]\n"
                   "    force_scale: [0.1, 0.2, 0.3]\n    tilt_rate: 2 deg/s\n    conditions: [Ball.position.y > 1 m]\n"
                   "    fields: [{name: n, as: uint16, is: sequence}, {name: leg, as: float32, variable: "
                   "Seat.leg_6}, {name: height, variable: Ball.position.y}]\n"),
      "test");
  const Scene again = load_text(scene.expanded_text, "again");
  for (const Scene* one : {&scene, &again}) {
    EXPECT_EQ(one->devices.names(), std::vector<std::string>{"Seat"});
    const MotionPlatformDef& seat = one->devices.platforms.at(0);
    EXPECT_EQ(seat.seat.point, (Triple{0, 1, 0}));
    EXPECT_EQ(seat.every, 0.01);
    EXPECT_EQ(seat.platform.hexapod.base_joints.at(4), (Triple{-0.275, -0.589, 0}));
    EXPECT_EQ(seat.platform.washout.force_scale, (Triple{0.1, 0.2, 0.3}));
    EXPECT_DOUBLE_EQ(seat.platform.washout.tilt_rate, 2 * M_PI / 180);
    EXPECT_DOUBLE_EQ(seat.platform.angle_limit[1], 10 * M_PI / 180);
    EXPECT_EQ(build(seat.layout).size, 14u);
    EXPECT_NE(seat.own_quantity(seat.layout.fields[1]), nullptr);
    EXPECT_EQ(seat.own_quantity(seat.layout.fields[2]), nullptr);
    // ten of the body, one condition, one of the packet
    const std::vector<NamedVariable> named = variables_of(one->devices, {});
    ASSERT_EQ(named.size(), 12u);
    EXPECT_EQ(named[0].variable, "Ball.position.y");
    EXPECT_EQ(named[1].variable, "Ball.velocity.x");
    EXPECT_EQ(named[10].variable, "Ball.angular_velocity.z");
    EXPECT_EQ(named[11].path, "Seat.height.variable");
  }
}

void expect_problem(const std::string& text, const std::string& problem) {
  EXPECT_EQ(problems_of(text), problem) << text;
}

TEST(PlatformSection, WhatCannotMoveIsRefused) {
  const std::string whole = kSeat + kJoints + kStroke;
  const std::string ball = "body: Ball", up = "up: [0, 1, 0]";
  const auto with = [&](std::string rows, const std::string& from, const std::string& to) {
    return kBall + platform(rows.replace(rows.find(from), from.size(), to) + kFields);
  };
  expect_problem(kBall + platform(whole + kFields), "");
  expect_problem(with(whole, ball, "body: Bal"), "test:8:11: Seat.body: no body 'Bal'; did you mean 'Ball'?");
  expect_problem(with(whole, up, "up: [1, 1, 0]"),
                 "test:10:9: Seat.up: the angle between forward and up is 45 deg; expected 90 deg");
  std::string of_legs;
  const char* const lengths[] = {"0.5873", "0.5871", "0.5863", "0.5863", "0.5871", "0.5873"};
  for (std::size_t leg = 0; leg < std::size(lengths); ++leg) {
    of_legs += (leg == 0 ? "" : "\n") + std::string("test:14:21: Seat.neutral_height: leg ") + std::to_string(leg + 1) +
               " is " + lengths[leg] + " m long in neutral; expected between 0.72 and 1.02 m";
  }
  expect_problem(with(whole, "0.75 m", "0.3 m"), of_legs);
  expect_problem(with(whole, "127.0.0.1:6000", "platform"),
                 "test:11:11: Seat.send: 'platform' is no address; expected IPv4 address and port, as 127.0.0.1:5005");
  expect_problem(kBall + platform(whole + "    park_height: 0.3 m\n" + kFields),
                 "test:17:18: Seat.park_height: a leg is 0.6755 m long when parked; expected 0.72 m or more");
  expect_problem(
      kBall + platform(whole + "    every: 30 ms\n" + kFields),
      "test:6:3: Seat.freeze_after: 0.05 s are less than two steps of the platform; expected 0.06 s or more, "
      "or a shorter every");
  expect_problem(kBall + platform(whole + "    conditions: [Ball]\n" + kFields),
                 "test:17:17: Seat.conditions: 'Ball' is no condition; expected a variable, > >= < or <=, and a "
                 "quantity, as 'Vol_MainPump.pressure > 250 bar'");
}

TEST(PlatformSection, APacketHasQuantitiesOfThePlatform) {
  const std::string whole = kSeat + kJoints + kStroke;
  expect_problem(
      kBall + platform(whole + "    fields: [{name: a, variable: Seat.leg1}, {name: b, variable: Seat.heave}]\n"),
      "test:17:14: Seat.a.variable: a motion platform has no quantity 'leg1'; expected leg_1 to leg_6, surge, "
      "sway, heave, roll, pitch, yaw, or another of docs/howto/motion-platform.md; did you mean 'leg_1'?");
  expect_problem(kBall + platform(whole + "    fields: [{name: a, variable: Seat.heave, unit: rad}]\n"),
                 "test:17:14: Seat.a.unit: 'Seat.heave' is in m, not in rad");
  expect_problem(kBall + platform(whole + "    fields: [{name: a, variable: Ball.position.x}]\n"),
                 "test:6:3: Seat: no field of the packet has a quantity of the platform; expected fields with "
                 "variables Seat.leg_1 to Seat.leg_6");
}

TEST(PlatformSection, TheSceneMustFitThePlatform) {
  const std::string whole = platform(kSeat + kJoints + kStroke + kFields);
  expect_problem(
      "mechanics: {gravity: [0, -1.62, 0]}\n" + kBall + whole,
      "test:9:11: Seat.body: mechanics.gravity is 1.62 m/s2, and the platform stands in 9.807 m/s2: a seat at "
      "rest would be felt as a fall; expected mechanics.gravity within 5 % of that, or no motion_platform");
  expect_problem("recording: {every: 40}\n" + kBall + whole,
                 "test:7:3: Seat.freeze_after: variables are published every 0.04 s, and 0.05 s are less than twice as "
                 "much; expected a smaller recording.every or a longer freeze_after");
}

}  // namespace platform_test
}  // namespace slew::scene
