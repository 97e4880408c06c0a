// SPDX-License-Identifier: Apache-2.0
// Named signals: the channels of a session's variables, and their values at one step.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/json.h"
#include "gateway/signal_channels.h"
#include "gateway/step_snapshot.h"

namespace signals_test {

using namespace slew;
using namespace slew::gateway;
using wire::Role;

wire::VariableBlock block(Role role, StepIndex step, std::initializer_list<double> values, std::uint32_t first = 0) {
  wire::VariableBlock message;
  message.header.role = role;
  message.header.step = step;
  message.header.phase = wire::Phase::running;
  message.first = first;
  for (const double value : values) message.values.push_back(value);
  return message;
}

StepSnapshot two_nodes() {
  StepSnapshot snapshot;
  snapshot.set_total(Role::mechanics, 2);
  snapshot.set_total(Role::hydraulics, 1);
  return snapshot;
}

TEST(StepSnapshot, HasTheValuesOfOneStepOfAllNodes) {
  StepSnapshot snapshot = two_nodes();
  EXPECT_FALSE(snapshot.take(block(Role::hydraulics, 10, {1})));
  snapshot.request();
  // hydraulics has published step 10 already: the first step that all publish from here on is 11
  EXPECT_FALSE(snapshot.take(block(Role::mechanics, 10, {2, 3})));
  EXPECT_FALSE(snapshot.take(block(Role::mechanics, 11, {4, 5})));
  EXPECT_FALSE(snapshot.take(block(Role::mechanics, 12, {6, 7})));
  EXPECT_TRUE(snapshot.take(block(Role::hydraulics, 11, {8})));
  EXPECT_EQ(snapshot.step(), 11);
  EXPECT_EQ(snapshot.value({Role::mechanics, 0}), 4);
  EXPECT_EQ(snapshot.value({Role::mechanics, 1}), 5);
  EXPECT_EQ(snapshot.value({Role::hydraulics, 0}), 8);
  EXPECT_FALSE(snapshot.is_requested());
}

TEST(StepSnapshot, WaitsForAllBlocksOfANode) {
  StepSnapshot snapshot = two_nodes();
  snapshot.request();
  EXPECT_FALSE(snapshot.take(block(Role::hydraulics, 1, {8})));
  EXPECT_FALSE(snapshot.take(block(Role::mechanics, 1, {4})));
  EXPECT_TRUE(snapshot.take(block(Role::mechanics, 1, {5}, 1)));
  EXPECT_EQ(snapshot.value({Role::mechanics, 1}), 5);
}

TEST(StepSnapshot, ANodeThatLeavesItsValuesOutHasNone) {
  StepSnapshot snapshot = two_nodes();
  snapshot.request();
  EXPECT_FALSE(snapshot.take(block(Role::hydraulics, 1, {})));
  EXPECT_TRUE(snapshot.take(block(Role::mechanics, 1, {4, 5})));
  EXPECT_TRUE(std::isnan(snapshot.value({Role::hydraulics, 0})));
}

TEST(StepSnapshot, AStepWithALostBlockIsGivenUpForALaterOne) {
  StepSnapshot snapshot = two_nodes();
  snapshot.request();
  bool is_whole = false;
  for (StepIndex step = 0; step < 200 && !is_whole; ++step) {
    if (step != 0) static_cast<void>(snapshot.take(block(Role::hydraulics, step, {1})));
    is_whole = snapshot.take(block(Role::mechanics, step, {2, 3}));
  }
  EXPECT_EQ(snapshot.incomplete(), 1u);
  EXPECT_GT(snapshot.step(), 60);
}

TEST(StepSnapshot, DoesNotWaitForAFollower) {
  StepSnapshot snapshot = two_nodes();
  snapshot.set_total(Role::flex, 1);
  EXPECT_FALSE(snapshot.take(block(Role::flex, 3, {42})));
  snapshot.request();
  EXPECT_FALSE(snapshot.take(block(Role::hydraulics, 9, {1})));
  EXPECT_TRUE(snapshot.take(block(Role::mechanics, 9, {2, 3})));
  EXPECT_EQ(snapshot.value({Role::flex, 0}), 42);
}

const std::vector<NamedPlace> kVariables = {{"Bag.position.x", "m", {Role::mechanics, 0}},
                                            {"Cyl.force", "N", {Role::hydraulics, 0}},
                                            {"Bag.position.y", "m", {Role::mechanics, 1}}};

TEST(SignalChannels, AreOneAnElementWithUnitsAndNestedFields) {
  const std::vector<SignalChannel> channels = signal_channels(kVariables);
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[0].topic, "/Bag");
  EXPECT_EQ(channels[1].schema_name, "slewring.Cyl");
  const Json schema = *Json::parse(channels[0].schema);
  EXPECT_EQ(schema.at("properties").at("position").at("properties").at("y").at("unit").text(), "m");
  EXPECT_EQ(schema.at("type").text(), "object");
}

TEST(SignalChannels, MessagesHaveTheValuesToTheBit) {
  StepSnapshot snapshot = two_nodes();
  snapshot.request();
  const double third = 1.0 / 3, tiny = std::numeric_limits<double>::denorm_min();
  static_cast<void>(snapshot.take(block(Role::hydraulics, 0, {std::numeric_limits<double>::infinity()})));
  ASSERT_TRUE(snapshot.take(block(Role::mechanics, 0, {third, tiny})));
  const std::vector<SignalChannel> channels = signal_channels(kVariables);
  std::string bag, cylinder;
  channels[0].encode(snapshot, bag);
  channels[1].encode(snapshot, cylinder);
  const Json message = *Json::parse(bag);
  EXPECT_EQ(message.at("position").at("x").number(), third);
  EXPECT_EQ(message.at("position").at("y").number(), tiny);
  EXPECT_EQ(cylinder, R"({"force":null})");
}

TEST(SignalChannels, ANameThatIsANumberAndAnObjectKeepsBoth) {
  const std::vector<NamedPlace> both = {{"El.torque", "N m", {Role::mechanics, 0}},
                                        {"El.torque.x", "N m", {Role::mechanics, 1}},
                                        {"time", "s", {Role::hydraulics, 0}},
                                        {"a\"b.c", "", {Role::mechanics, 0}}};
  const std::vector<SignalChannel> channels = signal_channels(both);
  ASSERT_EQ(channels.size(), 3u);
  std::string text;
  channels[0].encode(StepSnapshot(), text);
  EXPECT_EQ(text, R"({"torque":null,"torque.x":null})");
  for (const SignalChannel& channel : channels) {
    std::string message;
    channel.encode(StepSnapshot(), message);
    EXPECT_TRUE(Json::parse(message).has_value()) << message;
    EXPECT_TRUE(Json::parse(channel.schema).has_value()) << channel.schema;
  }
}

}  // namespace signals_test
