// SPDX-License-Identifier: Apache-2.0
// Devices on CAN: frames of a bus in memory or of a recording, values that move inputs, frames that are sent.
#include <gtest/gtest.h>

#include <cmath>

#include "core/failure.h"
#include "device_node/can_bus.h"
#include "device_node/input_device.h"
#include "devices/dbc.h"
#include "devices/j1939.h"
#include "memory_bus.h"
#include "support/temporary_folder.h"

namespace slew::device_node {
namespace can_devices_test {

using namespace testing_can;

// messages of a panel and of an engine
constexpr const char* kMessages =
    "BO_ 256 Panel: 4 X\n SG_ Lift : 0|16@1- (0.5,0) [0|0] \"%\" X\n SG_ Enable : 16|1@1+ (1,0) [0|0] \"\" X\n SG_ "
    "More : 24|8@1+ (1,0) [0|0] \"\" X\n"
    "BO_ 2364540158 EEC1: 8 X\n SG_ EngineSpeed : 24|16@1+ (0.125,0) [0|8031.875] \"rpm\" X\n";

scene::CanBusDef bus_of(scene::CanProtocol protocol, std::vector<scene::CanSignalDef> signals) {
  scene::CanBusDef bus;
  bus.interface = "can0";
  bus.definition = kMessages;
  bus.protocol = protocol;
  bus.signals = std::move(signals);
  return bus;
}

TEST(CanOut, AFrameForEachMessageHasTheValuesOfOneStep) {
  scene::CanOutDef def;
  def.name = "Cluster";
  def.every = 0.001;
  def.bus = bus_of(scene::CanProtocol::j1939, {{.signal = "EEC1.EngineSpeed", .variable = "Engine.speed", .gain = 9.5},
                                               {.signal = "Panel.Lift", .variable = "Engine.speed"}});
  MemoryBus bus;
  const auto device = open_can_out(def, {}, bus.opener());
  const std::vector<CanFrame>& frames = bus.sent;
  wire::VariableDirectory directory;
  directory.header.role = wire::Role::hydraulics;
  directory.entries = {{"Engine.speed", "rad/s"}};
  device->feed().take(directory);
  wire::VariableBlock block;
  block.header.role = wire::Role::hydraulics;
  block.values.push_back(100);
  device->feed().take(block, 0);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].id, 256u);
  EXPECT_FALSE(frames[0].is_extended);
  ASSERT_EQ(frames[0].size, 4u);
  EXPECT_EQ(frames[0].bytes[0], std::byte{200});
  // a signal without a source is not available where it has a code for that, else 0; bits of no signal are 1
  EXPECT_EQ(frames[0].bytes[2], std::byte{0xFE});
  EXPECT_EQ(frames[0].bytes[3], std::byte{0xFF});
  EXPECT_EQ(frames[1].id, 0x0CF004FEu);
  EXPECT_TRUE(frames[1].is_extended);
  // 950 rpm are 7600 counts
  EXPECT_EQ(frames[1].bytes[3], std::byte{7600 & 0xFF});
  EXPECT_EQ(frames[1].bytes[4], std::byte{7600 >> 8});
  EXPECT_EQ(device->counts().at("sent").integer(), 2);
}

// a damaged line is no frame that never came
TEST(CanLogFile, ALineThatIsNoFrameIsRefusedWithItsNumber) {
  const testing::TemporaryFolder folder("can_log");
  const std::string front = "(10.000000) can0 100#64000100\n(10.010000) can0 100#R\n\n";
  for (const char* const line : {"(10.020000) can0 1000#64", "(10.020000) can0 10#64", "(10.020000) can0 800#64",
                                 "(10.020000) can0 100#640", "(10.020000) can0 100#001122334455667788", "more"}) {
    const std::string path = folder.write("bad.log", front + line + "\n").string();
    try {
      static_cast<void>(open_can_log(path));
      ADD_FAILURE() << line;
    } catch (const Failure& failure) {
      EXPECT_NE(std::string(failure.what()).find("bad.log:4: is no line of 'candump -l'"), std::string::npos)
          << failure.what();
    }
  }
  EXPECT_NE(open_can_log(folder.write("good.log", front).string()), nullptr);
}

TEST(CanIn, RecordedFramesMoveInputsWhileAllSignalsAreThere) {
  const testing::TemporaryFolder folder("can_in");
  scene::CanInDef def;
  def.name = "Panel";
  def.timeout = 0.1;
  def.bus = bus_of(scene::CanProtocol::j1939,
                   {{.signal = "Panel.Lift", .input = "Input_Lift", .gain = 0.01}, {.signal = "Panel.Enable"}});
  def.bus.interface = "";
  def.enable.dead_man = "Panel.Enable";
  // 100 counts are 50 %
  def.path = folder
                 .write("panel.log",
                        "(10.000000) can0 100#64000100\n(10.010000) can0 101#FF\n(10.020000) can0 100#9CFF0100\n"
                        "(10.020001) can0 100#64\n(10.300000) can0 100#64000000\n")
                 .string();
  const auto device = open_can_in(def);
  EXPECT_FALSE(device->is_fresh());
  EXPECT_TRUE(device->take(1000 * kMs));
  EXPECT_TRUE(device->is_fresh());
  EXPECT_EQ(device->values()[0], 0.5);
  EXPECT_EQ(device->dead_man(), true);
  EXPECT_FALSE(device->take(1011 * kMs));  // of another identifier
  EXPECT_TRUE(device->take(1020 * kMs));
  EXPECT_EQ(device->values()[0], -0.5);
  EXPECT_FALSE(device->take(1021 * kMs));  // too short
  EXPECT_FALSE(device->take(1150 * kMs));
  EXPECT_FALSE(device->is_fresh());  // silent
  EXPECT_EQ(device->dead_man(), std::nullopt);
  EXPECT_TRUE(device->take(1300 * kMs));
  EXPECT_EQ(device->dead_man(), false);
  EXPECT_EQ(device->counts().at("used").integer(), 3);
  EXPECT_EQ(device->counts().at("too_short").integer(), 1);
  EXPECT_EQ(device->counts().at("other_identifiers").integer(), 1);
}

TEST(CanIn, AnErrorOrNotAvailableIsNoValue) {
  const testing::TemporaryFolder folder("can_error");
  scene::CanInDef def;
  def.name = "Engine";
  def.bus = bus_of(scene::CanProtocol::j1939, {{.signal = "EEC1.EngineSpeed", .input = "Input_Lift", .gain = 0.001}});
  def.bus.interface = "";
  // from another source, with another priority; then not available, then an error
  def.path = folder
                 .write("engine.log",
                        "(1.000000) can0 18F00405#000000401F000000\n(1.010000) can0 18F00405#000000FFFF000000\n"
                        "(1.020000) can0 18F00405#000000401F000000\n(1.030000) can0 18F00405#00000000FE000000\n")
                 .string();
  const auto device = open_can_in(def);
  EXPECT_TRUE(device->take(1000 * kMs));
  EXPECT_EQ(device->values()[0], 1.0);
  static_cast<void>(device->take(1011 * kMs));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_TRUE(device->take(1021 * kMs));
  static_cast<void>(device->take(1031 * kMs));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_EQ(device->counts().at("without_value").at("not available").integer(), 1);
  EXPECT_EQ(device->counts().at("without_value").at("error").integer(), 1);
}

TEST(CanBus, AnInterfaceThatIsNotThereIsAwaited) {
  std::string reason;
  EXPECT_EQ(open_can("slewcan9", reason), nullptr);
  EXPECT_TRUE(reason.starts_with("interface slewcan9: ")) << reason;
}

// ---- J1939 ----------------------------------------------------------------------------------------------------

scene::CanOutDef engine() {
  scene::CanOutDef def;
  def.name = "Engine";
  def.every = 0.001;
  def.bus = bus_of(scene::CanProtocol::j1939, {{.signal = "EEC1.EngineSpeed", .variable = "Load.force"}});
  def.bus.unit = {.address = 0x27, .identity = 5};
  return def;
}

TEST(J1939Out, NothingIsSentBeforeTheAddressIsClaimedAndThenFromThere) {
  ForceSender engine_out(engine());
  EXPECT_EQ(engine_out.bus.texts(), Texts{"18EEFF27#0500000000000000"});
  engine_out.publish(1000);
  EXPECT_EQ(engine_out.bus.texts(), Texts{"100#0000FEFF"});  // which is no J1939 message
  EXPECT_EQ(engine_out.device->counts().at("held_back").integer(), 1);
  engine_out.wait_ms(251);
  engine_out.publish(1000);
  EXPECT_EQ(engine_out.bus.texts(), (Texts{"100#0000FEFF", "0CF00427#FFFFFF401FFFFFFF"}));
  EXPECT_EQ(engine_out.device->take_notices().back(), "has claimed address 39");
  // a smaller NAME takes it
  engine_out.take(frame_of(0x18EEFF27, {1, 0, 0, 0, 0, 0, 0, 0}, true));
  engine_out.publish(1000);
  engine_out.wait_ms(1000);
  EXPECT_EQ(engine_out.bus.texts(), (Texts{"100#0000FEFF", "18EEFFFE#0500000000000000"}));
  EXPECT_TRUE(engine_out.device->take_notices().back().starts_with("the claim of address 39 is lost to the unit"));
  EXPECT_EQ(engine_out.device->counts().at("address").at("phase").text(), "lost");
}

// BJM1: neutral, right of 50 %, both sides at once, not available
TEST(J1939In, AJoystickMessageIsAnAxisWithASide) {
  MemoryBus bus;
  scene::CanInDef def;
  def.name = "Stick";
  def.bus.interface = "can0";
  def.bus.protocol = scene::CanProtocol::j1939;
  def.bus.definition = devices::write_dbc(std::vector{devices::bjm1()});
  def.bus.signals = {{.signal = "BJM1.X", .input = "Input_Slew"}, {.signal = "BJM1.Y", .input = "Input_Lift"}};
  const auto device = open_can_in(def, BusPart::takes_part, bus.opener());
  std::int64_t now_ns = monotonic_ns();
  // x: counts of 0.1 %, states of two bits: neutral, negative, positive; y stays at neutral
  const auto take = [&](unsigned position, unsigned neutral, unsigned negative, unsigned positive) {
    const unsigned x = neutral | negative << 2 | positive << 4 | position << 6;
    bus.waiting.push_back(frame_of(
        0x0CFDD633, {static_cast<int>(x & 0xFF), static_cast<int>(x >> 8), 0x01, 0x00, 0xFF, 0xFF, 0xFF, 0xFF}, true));
    return device->take(now_ns += kMs);
  };
  EXPECT_TRUE(take(0, 1, 0, 0));
  EXPECT_EQ(device->values()[0], 0);
  EXPECT_TRUE(take(500, 0, 0, 1));
  EXPECT_EQ(device->values()[0], 0.5);
  EXPECT_EQ(device->values()[1], 0);
  EXPECT_TRUE(take(1000, 0, 1, 0));
  EXPECT_EQ(device->values()[0], -1);
  EXPECT_FALSE(take(1000, 0, 1, 1));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_TRUE(take(500, 0, 0, 1));
  EXPECT_FALSE(take(1023, 3, 3, 3));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_FALSE(take(1022, 0, 0, 1));
  EXPECT_EQ(device->counts().at("without_value").at("out of range").integer(), 1);
}

TEST(J1939In, AMessageToAnotherAddressIsOfOthers) {
  MemoryBus bus;
  scene::CanInDef def;
  def.name = "Panel";
  // PDU1 of format 0xEF, to its destination alone
  def.bus.definition = "BO_ 2565865470 Own: 8 X\n SG_ Lift : 0|16@1- (0.001,0) [0|0] \"\" X\n";
  def.bus.interface = "can0";
  def.bus.protocol = scene::CanProtocol::j1939;
  def.bus.signals = {{.signal = "Own.Lift", .input = "Input_Lift"}};
  def.bus.unit = {.address = 0x27};
  const auto device = open_can_in(def, BusPart::takes_part, bus.opener());
  std::int64_t now_ns = monotonic_ns();
  const auto take = [&](std::uint32_t id) {
    bus.waiting.push_back(frame_of(id, {0xF4, 0x01, 0, 0, 0, 0, 0, 0}, true));
    return device->take(now_ns += kMs);
  };
  EXPECT_FALSE(take(0x18EF2733));  // before the address is claimed
  EXPECT_TRUE(take(0x18EFFF33));
  now_ns += 300 * kMs;
  static_cast<void>(device->take(now_ns));
  EXPECT_TRUE(take(0x18EF2733));
  EXPECT_FALSE(take(0x18EF2833));
  EXPECT_EQ(device->counts().at("other_identifiers").integer(), 2);
  EXPECT_EQ(device->counts().at("address").at("phase").text(), "claimed");
}

}  // namespace can_devices_test
}  // namespace slew::device_node
