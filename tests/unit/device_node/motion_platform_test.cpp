// SPDX-License-Identifier: Apache-2.0
// A motion platform as a device: packets by the wall clock, from variables of a session.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "device_node/shown_device.h"

namespace slew::device_node {
namespace motion_platform_test {

constexpr double kG = devices::kStandardGravity;
constexpr std::int64_t kMs = 1'000'000;
constexpr std::size_t kValues = 15;  // of a packet: six legs, six coordinates, phase, time, a variable of the session
enum Value : std::size_t { surge = 6, sway, heave, roll, pitch, yaw, phase, sample_time, height };
enum Phase : int { parked, rising, ramping_in, active, frozen, washing_back, lowering };

scene::MotionPlatformDef seat_def() {
  scene::MotionPlatformDef def;
  def.name = "Seat";
  def.body = "Cab";
  def.seat = {.point = {}, .forward = {1, 0, 0}, .up = {0, 0, 1}};
  def.send = "127.0.0.1:9";
  def.every = 0.005;
  def.conditions = {"Enable.value > 0.5"};
  def.platform.name = "Seat";
  devices::HexapodDef& hexapod = def.platform.hexapod;
  for (const double angle : {5, 115, 125, 235, 245, 355})
    hexapod.base_joints.push_back({1.2 * std::cos(angle * M_PI / 180), 1.2 * std::sin(angle * M_PI / 180), 0});
  for (const double angle : {55, 65, 175, 185, 295, 305})
    hexapod.platform_joints.push_back({0.9 * std::cos(angle * M_PI / 180), 0.9 * std::sin(angle * M_PI / 180), -0.05});
  hexapod.neutral_height = 1.1;
  hexapod.shortest_leg = 1.1;
  hexapod.longest_leg = 1.8;
  def.platform.rise_time = 0.5;
  def.platform.ramp_time = 0.25;
  def.layout.name = "Seat";
  const auto add = [&](const std::string& name, const std::string& variable) {
    def.layout.fields.push_back({.name = name, .variable = variable});
  };
  for (const char* leg : {"leg_1", "leg_2", "leg_3", "leg_4", "leg_5", "leg_6"}) add(leg, std::string("Seat.") + leg);
  for (const char* coordinate : {"surge", "sway", "heave", "roll", "pitch", "yaw"})
    add(coordinate, std::string("Seat.") + coordinate);
  add("phase", "Seat.phase");
  add("sample_time", "Seat.time");
  add("height", "Cab.position.y");
  return def;
}

// A session of 1 ms steps with a cab that moves along its own x, beside a wall clock that the test turns.
struct Session {
  explicit Session(const scene::MotionPlatformDef& def) {
    device = open_motion_platform(def, {}, {0, 0, -kG}, Reach::this_machine, [this](std::span<const std::byte> bytes) {
      EXPECT_EQ(bytes.size(), kValues * sizeof(double));
      std::memcpy(packet.data(), bytes.data(), bytes.size());
      ++packets;
      return true;
    });
    wire::VariableDirectory directory;
    directory.header.role = wire::Role::mechanics;
    for (const std::string& name : def.body_variables()) directory.entries.push_back({name, "1"});
    directory.entries.push_back({"Cab.position.y", "m"});
    device->feed().take(directory);
    directory.header.role = wire::Role::io;
    directory.entries = {{"Enable.value", "1"}};
    device->feed().take(directory);
  }

  void publish() {
    wire::VariableBlock block;
    block.header.step = step;
    block.header.epoch = epoch;
    const double time = 0.001 * static_cast<double>(step);
    block.header.role = wire::Role::mechanics;
    for (const double value : {speed, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, rate, 7.0}) block.values.push_back(value);
    device->feed().take(block, time);
    block.header.role = wire::Role::io;
    block.values.clear();
    block.values.push_back(enable);
    device->feed().take(block, time);
    ++step;
  }
  // The session runs with the acceleration.
  void run(double seconds, double acceleration = 0) {
    for (int i = 0; i < std::lround(seconds * 1000); ++i) {
      publish();
      speed += acceleration * 0.001;
      now_ns += kMs;
      device->look_after(now_ns);
    }
  }
  // It stands, and the clock goes on.
  void stand(double seconds) {
    for (int i = 0; i < std::lround(seconds * 1000); ++i) device->look_after(now_ns += kMs);
  }
  int phase() const { return static_cast<int>(packet[Value::phase]); }

  std::array<double, kValues> packet{};
  int packets = 0;
  std::unique_ptr<ShownDevice> device;
  StepIndex step = 0;
  std::uint32_t epoch = 0;
  std::int64_t now_ns = 1'000'000'000;
  double speed = 0, rate = 0, enable = 1;
};

// |p_0 + x + R b - a| by rotations of single axes, as the card writes it
void expect_legs_of_the_pose(const Session& session, const devices::HexapodDef& hexapod) {
  const auto& p = session.packet;
  for (std::size_t i = 0; i < 6; ++i) {
    auto [x, y, z] = hexapod.platform_joints[i];
    const auto turn = [](double& a, double& b, double angle) {
      const double c = std::cos(angle), s = std::sin(angle), a0 = a;
      a = c * a0 - s * b;
      b = s * a0 + c * b;
    };
    turn(y, z, p[roll]);
    turn(z, x, p[pitch]);
    turn(x, y, p[yaw]);
    const auto& base = hexapod.base_joints[i];
    EXPECT_NEAR(
        p[i],
        std::hypot(p[surge] + x - base[0], p[sway] + y - base[1], hexapod.neutral_height + p[heave] + z - base[2]),
        1e-12)
        << "leg " << i + 1;
  }
}

TEST(MotionPlatform, ParksUntilASessionPublishesAndConditionsAreMet) {
  Session session(seat_def());
  session.stand(1);
  EXPECT_EQ(session.phase(), parked);
  EXPECT_EQ(session.packets, 200);  // 1 ms to the first look, then one every 5 ms
  EXPECT_EQ(session.packet[heave], -0.1);
  session.enable = 0;
  session.run(1);
  EXPECT_EQ(session.phase(), parked);
  session.enable = 1;
  session.run(0.25);
  EXPECT_EQ(session.phase(), rising);
  session.run(1);
  EXPECT_EQ(session.phase(), active);
  EXPECT_NEAR(session.packet[heave], 0, 1e-12);
  EXPECT_EQ(session.packet[height], 7);
  EXPECT_NEAR(session.packet[sample_time], 2.249, 0.0051);
  const std::vector<std::string> notices = session.device->take_notices();
  EXPECT_EQ(notices, (std::vector<std::string>{"rising", "ramping in", "active"}));
  session.enable = 0;
  session.run(2);
  EXPECT_EQ(session.phase(), parked);
}

TEST(MotionPlatform, AStepOfAccelerationGoesBackToNeutral) {
  const scene::MotionPlatformDef def = seat_def();
  Session session(def);
  session.run(1);
  session.run(0.5, 2);
  EXPECT_GT(session.packet[surge], 0.02);
  expect_legs_of_the_pose(session, def.platform.hexapod);
  session.run(60, 2);
  EXPECT_NEAR(session.packet[surge], 0, 1e-6);
  EXPECT_NEAR(session.packet[heave], 0, 1e-9);
}

TEST(MotionPlatform, ASustainedAccelerationTilts) {
  const scene::MotionPlatformDef def = seat_def();
  for (const double a : {2.0, -3.0}) {
    Session session(def);
    session.run(1);
    session.run(30, a);
    EXPECT_NEAR(session.packet[pitch], -std::asin(0.5 * a / kG), 1e-9);  // forward: nose up
    EXPECT_NEAR(session.packet[roll], 0, 1e-12);
    expect_legs_of_the_pose(session, def.platform.hexapod);
  }
}

TEST(MotionPlatform, ATurnIsShownAndWashedOut) {
  const scene::MotionPlatformDef def = seat_def();
  Session session(def);
  session.run(1);
  session.rate = 0.3;
  session.run(1);
  // B/R = s/(s + w_n)^2 with w_n = 1: a step of the rate gives t e^-t, here at 0.5 of its size
  EXPECT_NEAR(session.packet[yaw], 0.5 * 0.3 * std::exp(-1), 2e-4);
  expect_legs_of_the_pose(session, def.platform.hexapod);
  session.run(30);
  EXPECT_NEAR(session.packet[yaw], 0, 1e-9);
}

TEST(MotionPlatform, SilenceFreezesThenGoesBackAndReturns) {
  Session session(seat_def());
  session.run(1);
  session.run(0.5, 2);
  const double held = session.packet[surge];
  ASSERT_GT(held, 0.02);
  session.stand(0.1);
  EXPECT_EQ(session.phase(), frozen);
  const double frozen_at = session.packet[surge];
  session.stand(0.3);
  EXPECT_EQ(session.packet[surge], frozen_at);
  session.stand(0.2);
  EXPECT_EQ(session.phase(), washing_back);
  session.stand(1);
  EXPECT_NEAR(session.packet[surge], 0, 1e-15);
  session.run(0.4);
  EXPECT_EQ(session.phase(), active);
  EXPECT_EQ(session.device->counts().at("platform").at("freezes").number(), 1);
}

TEST(MotionPlatform, AResetIsNoAcceleration) {
  Session session(seat_def());
  session.run(1);
  session.speed = 50;
  session.step = 0;
  session.epoch = 1;
  session.run(0.5);
  EXPECT_NEAR(session.packet[surge], 0, 1e-12);
  EXPECT_NEAR(session.packet[pitch], 0, 1e-12);
}

TEST(MotionPlatform, ASampleThatIsNotFiniteIsCounted) {
  Session session(seat_def());
  session.run(1);
  session.speed = std::nan("");
  session.run(0.01);
  session.speed = 0;
  session.run(0.5);
  EXPECT_EQ(session.phase(), active);
  EXPECT_NEAR(session.packet[surge], 0, 1e-12);
  EXPECT_GE(session.device->counts().at("platform").at("not_finite").number(), 1);
}

TEST(MotionPlatform, ParksAfterTheSession) {
  Session session(seat_def());
  session.run(1);
  EXPECT_FALSE(session.device->is_at_rest());
  session.device->leave_session();
  session.stand(0.5);
  EXPECT_FALSE(session.device->is_at_rest());
  session.stand(0.5);
  EXPECT_TRUE(session.device->is_at_rest());
  EXPECT_EQ(session.packet[heave], -0.1);
}

TEST(MotionPlatform, AStoppedProcessCatchesUpALittleAndLeavesOutMore) {
  Session session(seat_def());
  session.stand(0.1);
  const int before = session.packets;
  session.device->look_after(session.now_ns += 60 * kMs);
  EXPECT_EQ(session.packets, before + 12);
  session.device->look_after(session.now_ns += 500 * kMs);
  EXPECT_EQ(session.packets, before + 13);
  EXPECT_EQ(session.device->counts().at("platform").at("time_losses").integer(), 1);
  EXPECT_GT(session.device->due_ns(), session.now_ns);
}

}  // namespace motion_platform_test
}  // namespace slew::device_node
