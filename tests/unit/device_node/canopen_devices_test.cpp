// SPDX-License-Identifier: Apache-2.0
// Devices of a CANopen network: PDOs in and out, and the states of nodes.
#include <gtest/gtest.h>

#include "device_node/input_device.h"
#include "memory_bus.h"

namespace slew::device_node {
namespace canopen_devices_test {

using namespace testing_can;

scene::CanBusDef canopen_bus(std::vector<scene::CanSignalDef> signals) {
  scene::CanBusDef bus;
  bus.interface = "can0";
  bus.protocol = scene::CanProtocol::canopen;
  bus.canopen.nodes = {{.node = 5, .heartbeat = 0.1}};
  bus.pdos = {{.name = "Stick", .node = 5}};
  bus.objects = {{"Stick", {.name = "lift", .type = devices::ByteType::int16, .scale = 0.001}},
                 {"Stick", {.name = "enable", .type = devices::ByteType::boolean}}};
  bus.signals = std::move(signals);
  return bus;
}

// A stick of node 5 that moves Input_Lift, on a bus in memory and a clock of its own.
struct CanOpenStick {
  explicit CanOpenStick(BusPart part = BusPart::takes_part) {
    scene::CanInDef def;
    def.name = "Stick";
    def.timeout = 60;  // the node's heartbeat is what counts
    def.bus = canopen_bus({{.signal = "Stick.lift", .input = "Input_Lift"}, {.signal = "Stick.enable"}});
    def.enable.dead_man = "Stick.enable";
    device = open_can_in(def, part, bus.opener());
    static_cast<void>(device->take_notices());
  }
  bool take(const CanFrame& frame) {
    bus.waiting.push_back(frame);
    return wait_ms(1);
  }
  bool wait_ms(int duration) {
    bool is_new = false;
    for (int i = 0; i < duration; ++i) is_new = device->take(now_ns += kMs) || is_new;
    return is_new;
  }

  MemoryBus bus;
  std::unique_ptr<InputDevice> device;
  std::int64_t now_ns = monotonic_ns();
};

const CanFrame kOperational = frame_of(0x705, {0x05}), kBootUp = frame_of(0x705, {0x00});
const CanFrame kHalfStick = frame_of(0x185, {0xF4, 0x01, 0x01});  // 500 counts, enabled

TEST(CanOpenIn, APdoMovesAnInputWhileItsNodeIsOperational) {
  CanOpenStick stick;
  // its first TPDO, sent upon the start, comes before the heartbeat that shows the start
  stick.take(kBootUp);
  EXPECT_EQ(stick.bus.texts(), (Texts{"000#0105", "000#0105"}));
  EXPECT_FALSE(stick.take(kHalfStick));
  EXPECT_FALSE(stick.device->is_fresh());
  stick.take(kOperational);
  EXPECT_TRUE(stick.device->is_fresh());
  EXPECT_TRUE(stick.take(kHalfStick));
  EXPECT_EQ(stick.device->values()[0], 0.5);
  EXPECT_EQ(stick.device->dead_man(), true);
}

TEST(CanOpenIn, AMissingNodeIsNeutralAndItsOldValueNeverReturns) {
  CanOpenStick stick;
  stick.take(kOperational);
  EXPECT_TRUE(stick.take(kHalfStick));
  stick.wait_ms(150);
  EXPECT_FALSE(stick.device->is_fresh());
  EXPECT_EQ(stick.device->dead_man(), std::nullopt);
  const std::vector<std::string> notices = stick.device->take_notices();
  ASSERT_FALSE(notices.empty());
  stick.wait_ms(1000);
  EXPECT_TRUE(stick.bus.sent.size() == 1u);
  // back and operational: without a new PDO it stays at neutral
  stick.take(kOperational);
  EXPECT_FALSE(stick.device->is_fresh());
  EXPECT_TRUE(stick.take(kHalfStick));
  EXPECT_TRUE(stick.device->is_fresh());
  const Json node = stick.device->counts().at("nodes").items()[0];
  EXPECT_EQ(node.at("losses").integer(), 1);
  EXPECT_EQ(node.at("state").text(), "operational");
}

TEST(CanOpenIn, ARestartedNodeIsStartedAgainAndItsOldValueIsVoid) {
  CanOpenStick stick;
  stick.take(kOperational);
  EXPECT_TRUE(stick.take(kHalfStick));
  static_cast<void>(stick.bus.texts());
  stick.take(kBootUp);
  EXPECT_EQ(stick.bus.texts(), Texts{"000#0105"});
  EXPECT_FALSE(stick.device->is_fresh());
  stick.take(kOperational);
  EXPECT_FALSE(stick.device->is_fresh());
}

TEST(CanOpenIn, NoticesNameTheNodeAtMostOnceASecond) {
  CanOpenStick stick;
  stick.take(kOperational);
  for (int i = 0; i < 500; ++i) stick.take(i % 2 == 0 ? kBootUp : kOperational);
  stick.wait_ms(600);
  EXPECT_EQ(stick.device->take_notices(),
            (Texts{"node 5 is operational",
                   "node 5 is missing: its heartbeat did not come in time; its values do not "
                   "count until it is operational again"}));
  EXPECT_EQ(stick.device->counts().at("nodes").items()[0].at("boot_ups").integer(), 250);
}

TEST(CanOpenIn, AnInterfaceThatReturnsBeginsAgain) {
  CanOpenStick stick;
  static_cast<void>(stick.wait_ms(1));
  static_cast<void>(stick.bus.texts());
  stick.bus.is_gone = true;
  stick.wait_ms(1);
  stick.bus.is_gone = false;
  stick.wait_ms(501);
  EXPECT_EQ(stick.bus.texts(), Texts{"000#0105"});
}

TEST(CanOpenIn, AMonitorSendsNothing) {
  CanOpenStick stick(BusPart::listens);
  stick.take(kBootUp);
  stick.take(frame_of(0x705, {0x7F}));
  stick.wait_ms(2000);
  EXPECT_TRUE(stick.bus.sent.empty());
  stick.take(kOperational);
  stick.take(kHalfStick);
  EXPECT_EQ(stick.device->values()[0], 0.5);
  EXPECT_TRUE(stick.device->text().starts_with("node 5 operational  Stick.lift 0.5  Stick.enable 1"))
      << stick.device->text();
}

// as a node of another master's network it receives its own RPDO
TEST(CanOpenIn, ItsOwnRpdoCountsWhenAMasterHasStartedIt) {
  MemoryBus bus;
  scene::CanInDef def;
  def.name = "Slave";
  def.bus = canopen_bus({{.signal = "Stick.lift", .input = "Input_Lift"}});
  def.bus.canopen = {.own_node = 3, .own_heartbeat = 0.05};
  def.bus.pdos[0].node = 3;
  const auto device = open_can_in(def, BusPart::takes_part, bus.opener());
  std::int64_t now_ns = monotonic_ns();
  const auto take = [&](const CanFrame& frame) {
    bus.waiting.push_back(frame);
    return device->take(now_ns += kMs);
  };
  EXPECT_FALSE(take(frame_of(0x203, {0x64, 0x00, 0x00})));
  EXPECT_EQ(bus.texts(), Texts{"703#00"});
  take(frame_of(0x000, {0x01, 0x03}));
  EXPECT_TRUE(take(frame_of(0x203, {0x64, 0x00, 0x00})));
  EXPECT_EQ(device->values()[0], 0.1);
  take(frame_of(0x000, {0x02, 0x00}));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_EQ(device->counts().at("own_state").text(), "stopped");
}

// Lamps of node 6 with the load's force.
scene::CanOutDef lamps_of_node_6() {
  scene::CanOutDef def;
  def.name = "Lamps";
  def.every = 0.001;
  def.bus = canopen_bus({{.signal = "Lamps.force", .variable = "Load.force"}});
  def.bus.canopen.nodes = {{.node = 6, .heartbeat = 0.1}};
  def.bus.pdos = {{.name = "Lamps", .node = 6}};
  def.bus.objects = {{"Lamps", {.name = "force", .type = devices::ByteType::int16}}};
  return def;
}

TEST(CanOpenOut, APdoIsSentAndRepeatedWhenItsNodeHasStarted) {
  ForceSender lamps(lamps_of_node_6());
  EXPECT_EQ(lamps.bus.texts(), Texts{"000#0106"});
  lamps.publish(-2);
  EXPECT_EQ(lamps.bus.texts(), Texts{"206#FEFF"});
  // a session that is paused publishes nothing: the node still gets the state that it missed
  lamps.take(frame_of(0x706, {0x00}));
  EXPECT_EQ(lamps.bus.texts(), Texts{"000#0106"});
  lamps.take(frame_of(0x706, {0x05}));
  EXPECT_EQ(lamps.bus.texts(), Texts{"206#FEFF"});
}

TEST(CanOpenOut, ASynchronousPdoFollowsEachSync) {
  scene::CanOutDef def = lamps_of_node_6();
  def.bus.pdos[0].is_synchronous = true;
  ForceSender lamps(def);
  static_cast<void>(lamps.bus.texts());
  lamps.publish(1);
  lamps.publish(2);
  EXPECT_EQ(lamps.bus.texts(), Texts{});
  EXPECT_LE(lamps.device->due_ns(), lamps.now_ns + kMs);
  lamps.take(frame_of(0x080, {}));
  EXPECT_EQ(lamps.bus.texts(), Texts{"206#0200"});
  lamps.take(frame_of(0x706, {0x05}));
  EXPECT_EQ(lamps.bus.texts(), Texts{});
  // its own SYNC
  def.bus.canopen.sync = 0.01;
  ForceSender master(def);
  static_cast<void>(master.bus.texts());
  master.publish(3);
  EXPECT_LE(master.device->due_ns(), master.now_ns + 10 * kMs);
  master.wait_ms(10);
  EXPECT_EQ(master.bus.texts(), (Texts{"080#", "206#0300"}));
}

// as a node of another master's network it sends its own TPDO
TEST(CanOpenOut, ItsOwnTpdoIsSentWhenAMasterHasStartedIt) {
  scene::CanOutDef def = lamps_of_node_6();
  def.bus.canopen = {.own_node = 6, .own_heartbeat = 1};
  ForceSender lamps(def);
  EXPECT_EQ(lamps.bus.texts(), Texts{"706#00"});
  lamps.publish(1);
  EXPECT_EQ(lamps.bus.texts(), Texts{});
  EXPECT_EQ(lamps.device->counts().at("held_back").integer(), 1);
  lamps.take(frame_of(0x000, {0x01, 0x00}));
  EXPECT_EQ(lamps.bus.texts(), Texts{"186#0100"});
  lamps.publish(2);
  EXPECT_EQ(lamps.bus.texts(), Texts{"186#0200"});
}

}  // namespace canopen_devices_test
}  // namespace slew::device_node
