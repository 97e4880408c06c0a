// SPDX-License-Identifier: Apache-2.0
// What a session publishes, as LCM messages: values in order, lists whole or not at all.
#include <gtest/gtest.h>

#include <map>
#include <slewring/directory_t.hpp>
#include <slewring/variables_t.hpp>

#include "bridge/outgoing.h"

namespace outgoing_test {

using namespace slew;
using wire::Role;

struct Sent {
  std::string channel;
  std::string bytes;
};

struct Fixture {
  explicit Fixture(StepIndex every = 0) {
    lcm_log::SignalList list;
    EXPECT_TRUE(read_signal_list("crane=Cyl.stroke,Pump.pressure", list).is_ok());
    outgoing.emplace("X", std::vector{list}, every,
                     [this](const std::string& channel, std::string_view bytes, StepIndex) {
                       sent.push_back({channel, std::string(bytes)});
                     });
    wire::VariableDirectory directory;
    directory.header.role = Role::mechanics;
    directory.total = 2;
    directory.entries = {{"Boom.angle", "rad"}, {"Cyl.stroke", "m"}};
    outgoing->take(directory);
    directory.header.role = Role::hydraulics;
    directory.total = 1;
    directory.entries = {{"Pump.pressure", "Pa"}};
    outgoing->take(directory);
  }
  void give(Role role, StepIndex step, std::vector<double> values, std::uint32_t epoch = 0) {
    wire::VariableBlock block;
    block.header.role = role;
    block.header.step = step;
    block.header.epoch = epoch;
    for (const double value : values) block.values.push_back(value);
    outgoing->take(block, static_cast<double>(step) * 1e-3);
  }
  [[nodiscard]] std::size_t count(const std::string& channel) const {
    return static_cast<std::size_t>(
        std::count_if(sent.begin(), sent.end(), [&](const Sent& s) { return s.channel == channel; }));
  }

  std::vector<Sent> sent;
  std::optional<bridge::Outgoing> outgoing;
};

TEST(BridgeOutgoing, ABlockIsOneMessageOfItsNode) {
  Fixture fixture;
  fixture.give(Role::mechanics, 20, {0.5, 0.86}, 3);
  ASSERT_EQ(fixture.sent.size(), 1u);
  EXPECT_EQ(fixture.sent[0].channel, "X_VARIABLES");
  slewring::variables_t message;
  const std::string& bytes = fixture.sent[0].bytes;
  ASSERT_EQ(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  EXPECT_EQ(message.step, 20);
  EXPECT_EQ(message.time, 0.02);
  EXPECT_EQ(message.epoch, 3);
  EXPECT_EQ(message.role, "mechanics");
  EXPECT_EQ(message.first, 0);
  EXPECT_EQ(message.value, (std::vector<double>{0.5, 0.86}));
}

TEST(BridgeOutgoing, AListIsSentWhenEveryNodeHasPublishedTheStep) {
  Fixture fixture;
  fixture.give(Role::mechanics, 10, {0.5, 0.86});
  EXPECT_EQ(fixture.count("X_crane"), 0u);
  fixture.give(Role::mechanics, 20, {0.5, 0.87});
  fixture.give(Role::hydraulics, 20, {2e7});
  ASSERT_EQ(fixture.count("X_crane"), 1u);
  std::string expected;
  encode(fixture.outgoing->lists()[0], 20, 0.02, std::vector<double>{0.87, 2e7}, expected);
  EXPECT_EQ(fixture.sent.back().bytes, expected);
  EXPECT_EQ(fixture.outgoing->incomplete(), 1u);  // step 10
  // a block of a step that was given up
  fixture.give(Role::hydraulics, 10, {1e7});
  EXPECT_EQ(fixture.count("X_crane"), 1u);
}

TEST(BridgeOutgoing, BlocksThatWereLeftOutAreNoValues) {
  Fixture fixture;
  fixture.give(Role::mechanics, 10, {});
  fixture.give(Role::hydraulics, 10, {2e7});
  EXPECT_EQ(fixture.count("X_VARIABLES"), 1u);
  EXPECT_EQ(fixture.count("X_crane"), 0u);
}

TEST(BridgeOutgoing, OnlyStepsThatAreMultiplesAreSent) {
  Fixture fixture(20);
  for (StepIndex step = 0; step < 100; step += 10) fixture.give(Role::mechanics, step, {0, 0});
  EXPECT_EQ(fixture.count("X_VARIABLES"), 5u);
}

TEST(BridgeOutgoing, ListsOfTwoEpochsAreNotMixed) {
  Fixture fixture;
  fixture.give(Role::mechanics, 10, {0.5, 0.86}, 0);
  fixture.give(Role::hydraulics, 10, {2e7}, 1);
  EXPECT_EQ(fixture.count("X_crane"), 0u);
}

TEST(BridgeOutgoing, TheDirectoryHasEveryNameWithItsUnitInMessagesThatAreNotSplit) {
  Fixture fixture;
  wire::VariableDirectory directory;
  directory.header.role = Role::io;
  directory.total = 600;
  for (int i = 0; i < 600; ++i) directory.entries.push_back({"Variable_" + std::to_string(i), "N"});
  fixture.outgoing->take(directory);
  fixture.outgoing->publish_directory(0);
  std::map<std::string, std::string> units;
  for (const Sent& sent : fixture.sent) {
    EXPECT_EQ(sent.channel, "X_DIRECTORY");
    EXPECT_LT(sent.bytes.size(), 60'000u);
    slewring::directory_t message;
    ASSERT_GT(message.decode(sent.bytes.data(), 0, static_cast<int>(sent.bytes.size())), 0);
    for (int i = 0; i < message.count; ++i)
      units[message.name[static_cast<std::size_t>(i)]] = message.unit[static_cast<std::size_t>(i)];
  }
  EXPECT_EQ(units.size(), 603u);
  EXPECT_EQ(units["Cyl.stroke"], "m");
  EXPECT_EQ(units["Variable_599"], "N");
}

}  // namespace outgoing_test
