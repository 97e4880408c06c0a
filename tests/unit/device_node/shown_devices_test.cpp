// SPDX-License-Identifier: Apache-2.0
// Packets with variables of a session and outputs of its scene.
#include "device_node/shown_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace slew::device_node {
namespace shown_devices_test {

// 1 ms steps: mechanics has the height, hydraulics the pressure
struct Dash {
  Dash() {
    scene::OutputsDef outputs;
    scene::SwitchedDef& lamp = outputs.switched.emplace_back();
    lamp.name = lamp.output.name = "Lamp";
    lamp.condition = "Vol.pressure > 2 bar";
    lamp.output.variable = "Vol.pressure";
    lamp.output.threshold = 2e5;
    lamp.output.hysteresis = 0.5e5;
    scene::AnalogDef& gauge = outputs.analog.emplace_back();
    gauge.name = gauge.output.name = "Gauge";
    gauge.output.variable = "Vol.pressure";
    gauge.output.high = 4e5;
    gauge.output.low_output = 4;
    gauge.output.high_output = 20;
    scene::UdpOutDef def;
    def.name = "Dash";
    def.every = 0.002;
    def.layout.name = "Dash";
    def.layout.fields = {{.name = "height", .type = devices::ByteType::float64, .variable = "Ball.y"},
                         {.name = "lamp", .type = devices::ByteType::uint8, .output = "Lamp"},
                         {.name = "gauge", .type = devices::ByteType::float32, .output = "Gauge"},
                         {.name = "spare", .type = devices::ByteType::uint8}};
    def.send = "127.0.0.1:9";
    device = open_udp_out(def, outputs, Reach::this_machine, [this](std::span<const std::byte> bytes) {
      packets.emplace_back(bytes.begin(), bytes.end());
      return true;
    });
    wire::VariableDirectory directory;
    directory.header.role = wire::Role::mechanics;
    directory.entries = {{"Ball.x", "m"}, {"Ball.y", "m"}};
    device->feed().take(directory);
    directory.header.role = wire::Role::hydraulics;
    directory.entries = {{"Vol.pressure", "Pa"}};
    device->feed().take(directory);
  }

  void publish(wire::Role role, StepIndex step, const std::vector<double>& values, std::uint32_t epoch = 0) {
    wire::VariableBlock block;
    block.header.role = role;
    block.header.step = step;
    block.header.epoch = epoch;
    for (const double value : values) block.values.push_back(value);
    device->feed().take(block, static_cast<double>(step) * 1e-3);
  }
  void publish_step(StepIndex step, double height, double pressure, std::uint32_t epoch = 0) {
    publish(wire::Role::mechanics, step, {-1, height}, epoch);
    publish(wire::Role::hydraulics, step, {pressure}, epoch);
  }
  double height(std::size_t i) const {
    double value = 0;
    std::memcpy(&value, packets[i].data(), sizeof value);
    return value;
  }
  int lamp(std::size_t i) const { return std::to_integer<int>(packets[i][8]); }
  float gauge(std::size_t i) const {
    float value = 0;
    std::memcpy(&value, &packets[i][9], sizeof value);
    return value;
  }

  std::vector<std::vector<std::byte>> packets;
  std::unique_ptr<ShownDevice> device;
};

TEST(UdpOut, APacketHasTheValuesOfOneStep) {
  Dash dash;
  EXPECT_EQ(dash.device->feed().variables(), (std::vector<std::string>{"Ball.y", "Vol.pressure"}));
  dash.publish(wire::Role::mechanics, 0, {-1, 5});
  dash.publish(wire::Role::mechanics, 1, {-1, 6});
  EXPECT_TRUE(dash.packets.empty());
  dash.publish(wire::Role::hydraulics, 0, {1e5});
  ASSERT_EQ(dash.packets.size(), 1u);
  EXPECT_EQ(dash.packets[0].size(), 14u);
  EXPECT_EQ(dash.height(0), 5);
}

TEST(UdpOut, PacketsKeepTheirDistance) {
  Dash dash;
  for (StepIndex step = 0; step < 10; ++step) dash.publish_step(step, static_cast<double>(step), 1e5);
  ASSERT_EQ(dash.packets.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(dash.height(i), 2.0 * static_cast<double>(i));
}

// steps of 1 and 3 ms, and an `every` of 2 ms that is no multiple of them: never less than 2 ms
TEST(UdpOut, NoTwoPacketsAreCloserThanEvery) {
  Dash dash;
  for (StepIndex step = 0; step < 31; step += 3) dash.publish_step(step, static_cast<double>(step), 1e5);
  for (StepIndex step = 31; step < 40; ++step) dash.publish_step(step, static_cast<double>(step), 1e5);
  ASSERT_GE(dash.packets.size(), 14u);
  for (std::size_t i = 1; i < dash.packets.size(); ++i) EXPECT_GE(dash.height(i) - dash.height(i - 1), 2) << i;
  // the first step behind the time is taken
  const std::vector<double> last = {30, 32, 34, 36, 38};
  for (std::size_t i = 0; i < last.size(); ++i) EXPECT_EQ(dash.height(dash.packets.size() - 5 + i), last[i]);
}

TEST(UdpOut, ABlockRateThatDoesNotDivideEveryGivesTheLongerTime) {
  Dash dash;
  // `every` 2 ms, a step published every 1.5 ms: 3 ms, not 1.5 and 3 by turns
  for (int i = 0; i < 9; ++i) {
    wire::VariableBlock block;
    block.header.step = i;
    block.header.role = wire::Role::mechanics;
    for (const double value : {-1.0, 1.5 * i}) block.values.push_back(value);
    dash.device->feed().take(block, 1.5e-3 * i);
    block.header.role = wire::Role::hydraulics;
    block.values.clear();
    block.values.push_back(1e5);
    dash.device->feed().take(block, 1.5e-3 * i);
  }
  ASSERT_EQ(dash.packets.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_DOUBLE_EQ(dash.height(i), 3.0 * static_cast<double>(i));
}

TEST(UdpOut, OutputsFollowEveryStepBetweenTwoPackets) {
  Dash dash;
  const double pressures[] = {1e5, 3e5, 1.6e5, 1.6e5, 1.4e5, 1.4e5, 1.4e5};
  for (StepIndex step = 0; step < 7; ++step) dash.publish_step(step, 0, pressures[step]);
  ASSERT_EQ(dash.packets.size(), 4u);
  EXPECT_EQ(dash.lamp(0), 0);
  EXPECT_EQ(dash.lamp(1), 1);  // went on in step 1, held by its hysteresis in step 2
  EXPECT_EQ(dash.lamp(2), 0);
  EXPECT_FLOAT_EQ(dash.gauge(1), 4 + 16 * 0.4f);
  EXPECT_EQ(dash.device->counts().at("output_changes").at("Lamp").integer(), 2);
}

// the first packet too has outputs of its own values: 1e5 Pa are a quarter of the gauge
TEST(UdpOut, TheFirstPacketHasTheOutputsOfItsValues) {
  Dash dash;
  dash.publish_step(0, 0, 1e5);
  ASSERT_EQ(dash.packets.size(), 1u);
  EXPECT_FLOAT_EQ(dash.gauge(0), 8);
  EXPECT_EQ(dash.lamp(0), 0);
  // and after a reset, where the lamp is on from the first step
  dash.publish_step(0, 0, 3e5, 1);
  ASSERT_EQ(dash.packets.size(), 2u);
  EXPECT_FLOAT_EQ(dash.gauge(1), 16);
  EXPECT_EQ(dash.lamp(1), 1);
}

TEST(UdpOut, AValueThatIsNotFiniteIsNotSent) {
  Dash dash;
  dash.publish_step(0, std::nan(""), 1e5);
  dash.publish_step(2, 7, 1e5);
  ASSERT_EQ(dash.packets.size(), 1u);
  EXPECT_EQ(dash.height(0), 7);
  EXPECT_EQ(dash.device->counts().at("not_finite").integer(), 1);
}

TEST(UdpOut, AResetBeginsAgain) {
  Dash dash;
  dash.publish_step(100, 1, 3e5);
  dash.publish_step(101, 1, 3e5);
  dash.publish_step(0, 2, 1e5, 1);
  dash.publish_step(102, 3, 1e5, 0);
  ASSERT_EQ(dash.packets.size(), 2u);
  EXPECT_EQ(dash.height(1), 2);
  EXPECT_EQ(dash.lamp(1), 0);
}

}  // namespace shown_devices_test
}  // namespace slew::device_node
