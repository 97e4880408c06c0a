// SPDX-License-Identifier: Apache-2.0
// Packets and frames with variables of a session and outputs of its scene.
#include "device_node/shown_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "support/temporary_folder.h"

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

// ---- CAN ------------------------------------------------------------------------------------------------------

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
  std::vector<CanFrame> frames;
  const auto device = open_can_out(def, {}, [&](const CanFrame& frame) {
    frames.push_back(frame);
    return true;
  });
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
  constexpr std::int64_t kMs = 1'000'000;
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
  constexpr std::int64_t kMs = 1'000'000;
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

}  // namespace shown_devices_test
}  // namespace slew::device_node
