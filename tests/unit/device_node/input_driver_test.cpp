// SPDX-License-Identifier: Apache-2.0
// Inputs of a device on their way into a session: neutral until enabled, repeated while they stay, neutral when silent.
#include "device_node/input_driver.h"

#include <gtest/gtest.h>

namespace slew::device_node {
namespace input_driver_test {

using wire::ControllerAction;

constexpr std::int64_t kMs = 1'000'000;

class FakeDevice final : public InputDevice {
 public:
  [[nodiscard]] const std::vector<std::string>& inputs() const noexcept override { return names; }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }
  bool take(std::int64_t) override { return false; }
  [[nodiscard]] bool is_fresh() const noexcept override { return fresh; }
  [[nodiscard]] std::span<const double> values() const noexcept override { return now; }
  [[nodiscard]] std::optional<bool> dead_man() const noexcept override { return pressed; }
  [[nodiscard]] std::int64_t event_ns() const noexcept override { return event; }
  [[nodiscard]] Json counts() const override { return {}; }
  [[nodiscard]] std::string text() const override { return ""; }

  std::vector<std::string> names{"Input_Lift", "Input_Slew"};
  bool fresh = true;
  std::vector<double> now{0, 0};
  std::optional<bool> pressed;
  std::int64_t event = 0;
};

// A driver with its session's side.
struct Pair {
  explicit Pair(const devices::EnableChainDef& enable = {})
      : driver("Stick", device.names, enable, milliseconds(50),
               [this](const wire::ControllerInput& input) { sent.push_back(input); }) {
    wire::VariableDirectory directory;
    directory.header.role = wire::Role::io;
    directory.entries = {{"Input_Lift.raw", "1"}, {"Input_Slew.raw", "1"}};
    driver.take(directory);
    directory.header.role = wire::Role::hydraulics;
    directory.entries = {{"Vol.pressure", "Pa"}};
    driver.take(directory);
  }

  void drive(std::int64_t ms, bool is_new = false) { driver.drive(device, is_new, 7, ms * kMs); }
  void grant_all() {
    for (const wire::ControllerInput& request : std::vector(sent)) {
      if (request.action != ControllerAction::acquire) continue;
      wire::ControllerLease lease;
      lease.controller = lease.holder = request.controller;
      lease.channel = request.channel;
      lease.is_granted = true;
      lease.answers = request.sequence;
      driver.take(lease);
    }
    sent.clear();
  }
  void publish(wire::Role role, const std::vector<double>& values, std::int64_t ms, std::uint32_t epoch = 0) {
    wire::VariableBlock block;
    block.header.role = role;
    block.header.epoch = epoch;
    for (const double value : values) block.values.push_back(value);
    driver.take(block, ms * kMs);
  }
  // values that were written since the last call, by input
  std::vector<double> written(const std::string& input = "Input_Lift") {
    std::vector<double> values;
    for (const wire::ControllerInput& message : sent) {
      if (message.action == ControllerAction::write && message.channel == input) values.push_back(message.value);
    }
    sent.clear();
    return values;
  }

  std::vector<wire::ControllerInput> sent;
  FakeDevice device;
  InputDriver driver;
};

TEST(InputDriver, AValueIsRepeatedWhileItStays) {
  Pair pair;
  pair.device.now = {0.5, 0};
  pair.drive(1, true);
  ASSERT_EQ(pair.sent.size(), 2u);
  EXPECT_EQ(pair.sent[0].action, ControllerAction::acquire);
  EXPECT_EQ(pair.sent[0].controller, "device:Stick");
  pair.grant_all();
  for (int ms = 2; ms <= 202; ++ms) pair.drive(ms);
  EXPECT_EQ(pair.written(), (std::vector<double>{0.5, 0.5, 0.5, 0.5}));
  pair.device.now = {0.75, -0.25};
  pair.drive(203);
  EXPECT_EQ(pair.sent[0].based_on_step, 7);
  EXPECT_EQ(pair.written(), std::vector<double>{0.75});
}

TEST(InputDriver, ASilentDeviceIsNeutralOnceAndThenSilent) {
  Pair pair;
  pair.device.now = {0.5, 0.5};
  pair.drive(0, true);
  pair.grant_all();
  pair.drive(60);
  EXPECT_EQ(pair.written(), std::vector<double>{0.5});
  pair.device.fresh = false;
  for (int ms = 61; ms < 1000; ++ms) pair.drive(ms);
  EXPECT_EQ(pair.written("Input_Slew"), std::vector<double>{0});
  EXPECT_EQ(pair.driver.counts().at("silences").integer(), 1);
  pair.device.fresh = true;
  pair.drive(1000);
  EXPECT_EQ(pair.written(), std::vector<double>{0.5});
}

TEST(InputDriver, ADeadManEnablesOnlyWhenPressedAtNeutralAndConditionsAreMet) {
  Pair pair({.name = "Stick",
             .dead_man = "BTN_THUMB",
             .devices = {"Stick"},
             .conditions = {"Vol.pressure > 5 bar"},
             .neutral_band = 0.1});
  pair.device.pressed = true;
  pair.device.now = {0.5, 0};
  pair.drive(0, true);
  pair.grant_all();
  pair.drive(1, true);
  EXPECT_EQ(pair.written(), std::vector<double>{0});
  pair.publish(wire::Role::hydraulics, {6e5}, 2);
  pair.drive(3, true);
  EXPECT_EQ(pair.written(), std::vector<double>{0});  // pressed since before
  pair.device.pressed = false;
  pair.drive(4, true);
  pair.device.pressed = true;
  pair.drive(5, true);
  EXPECT_EQ(pair.written(), (std::vector<double>{0, 0}));  // deflected
  pair.device.now = {0.05, 0};
  pair.drive(6, true);
  pair.device.now = {0.5, 0};
  pair.drive(7, true);
  EXPECT_EQ(pair.written(), (std::vector<double>{0.05, 0.5}));
  pair.publish(wire::Role::hydraulics, {4e5}, 8);
  pair.drive(9, true);
  EXPECT_EQ(pair.written(), std::vector<double>{0});
  EXPECT_EQ(pair.driver.counts().at("enable_losses").integer(), 1);
  pair.publish(wire::Role::hydraulics, {6e5}, 10);
  pair.drive(11, true);
  EXPECT_EQ(pair.written(), std::vector<double>{0});
}

TEST(InputDriver, AConditionWithoutAFiniteValueIsNotMet) {
  Pair pair({.name = "Stick", .dead_man = "BTN_THUMB", .devices = {"Stick"}, .conditions = {"Vol.pressure < 5 bar"}});
  pair.publish(wire::Role::hydraulics, {std::numeric_limits<double>::quiet_NaN()}, 0);
  pair.device.pressed = false;
  pair.drive(0, true);
  pair.grant_all();
  pair.device.pressed = true;
  pair.drive(1, true);
  pair.device.now = {1, 1};
  pair.drive(2, true);
  EXPECT_EQ(pair.written(), (std::vector<double>{0, 0}));
}

TEST(InputDriver, LatencyIsThatOfTheFirstSampleWithTheValue) {
  Pair pair;
  pair.device.now = {0.25, 0};
  pair.drive(0, true);
  pair.grant_all();
  pair.device.event = 100 * kMs;
  pair.drive(101, true);
  pair.publish(wire::Role::io, {0, 0}, 102);
  pair.device.now = {0.5, 0};
  pair.device.event = 105 * kMs;
  pair.drive(106, true);
  pair.publish(wire::Role::io, {0.25, 0}, 107);
  pair.publish(wire::Role::io, {0.5, 0}, 108);
  pair.publish(wire::Role::io, {0.5, 0}, 120);
  const Json latency = pair.driver.counts().at("latency");
  // 0.25: 7 ms, 0.5: 3 ms, once each; the other input stays at neutral
  EXPECT_EQ(latency.at("count").integer(), 2);
  EXPECT_EQ(latency.at("max").number(), 7e-3);
}

TEST(InputDriver, AfterAResetItRequestsItsInputsAgain) {
  Pair pair;
  pair.publish(wire::Role::io, {0, 0}, 0, 1);
  pair.device.now = {0.5, 0};
  pair.drive(0, true);
  pair.grant_all();
  pair.publish(wire::Role::io, {0, 0}, 1, 2);
  pair.drive(300, true);
  ASSERT_FALSE(pair.sent.empty());
  EXPECT_EQ(pair.sent[0].action, ControllerAction::acquire);
}

TEST(InputDriver, ItLeavesItsInputsAtNeutral) {
  Pair pair;
  pair.device.now = {0.5, 0};
  pair.drive(0, true);
  pair.grant_all();
  pair.drive(100);
  pair.sent.clear();
  pair.driver.release(9, 101 * kMs);
  ASSERT_EQ(pair.sent.size(), 4u);
  EXPECT_EQ(pair.sent[0].action, ControllerAction::write);
  EXPECT_EQ(pair.sent[0].value, 0);
  EXPECT_EQ(pair.sent[3].action, ControllerAction::release);
}

}  // namespace input_driver_test
}  // namespace slew::device_node
