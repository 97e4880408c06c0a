// SPDX-License-Identifier: Apache-2.0
// Devices that move inputs, on sockets of the loopback and on recorded events.
#include <gtest/gtest.h>
#include <linux/input-event-codes.h>

#include <cstring>
#include <limits>

#include "core/failure.h"
#include "core/time.h"
#include "device_node/event_source.h"
#include "device_node/input_device.h"
#include "device_node/udp_socket.h"
#include "scene/defs.h"
#include "support/event_bytes.h"
#include "support/temporary_folder.h"

namespace slew::device_node {
namespace input_devices_test {

using slew::testing::add_event;

constexpr std::int64_t kMs = 1'000'000;

// ---- UDP ------------------------------------------------------------------------------------------------------

scene::UdpInDef rig(std::uint16_t port) {
  scene::UdpInDef def;
  def.name = "Rig";
  def.listen = "127.0.0.1:" + std::to_string(port);
  def.layout.name = "Rig";
  def.layout.most_lost = 2;
  def.layout.fields = {{.name = "count", .type = devices::ByteType::uint8, .role = devices::FieldRole::sequence},
                       {.name = "enable", .type = devices::ByteType::boolean},
                       {.name = "lift", .type = devices::ByteType::float32, .input = "Input_Lift"}};
  def.enable.dead_man = "enable";
  return def;
}

// A port that was free a moment ago.
std::uint16_t free_port() {
  static std::uint16_t next = static_cast<std::uint16_t>(20000 + monotonic_ns() / 1000 % 20000);
  for (int i = 0; i < 1000; ++i) {
    ++next;
    try {
      const UdpSocket socket({0x7F000001, next});
      return next;
    } catch (const Failure&) {
    }
  }
  throw Failure(ExitCode::resources, "no free port");
}

struct Rig {
  Rig() : port(free_port()), device(open_udp_in(rig(port), Reach::this_machine)) {}
  void send(std::uint8_t count, bool is_enabled, float lift, std::size_t size = 6) {
    std::array<std::byte, 8> bytes{};
    bytes[0] = std::byte{count};
    bytes[1] = std::byte{is_enabled};
    std::memcpy(&bytes[2], &lift, sizeof lift);
    EXPECT_TRUE(socket.send({0x7F000001, port}, std::span(bytes).first(size)));
  }
  std::int64_t refused(std::string_view cause) const { return device->counts().at("refused").at(cause).integer(); }

  std::uint16_t port;
  UdpSocket socket;
  std::unique_ptr<InputDevice> device;
};

TEST(UdpIn, TheNewestPacketIsUsedAndLossesAreCounted) {
  Rig rig;
  EXPECT_EQ(rig.device->inputs(), std::vector<std::string>{"Input_Lift"});
  EXPECT_FALSE(rig.device->take(1 * kMs));
  EXPECT_FALSE(rig.device->is_fresh());
  EXPECT_EQ(rig.device->dead_man(), std::nullopt);
  rig.send(5, true, 0.25f);
  rig.send(7, false, 0.5f);
  EXPECT_TRUE(rig.device->take(2 * kMs));
  EXPECT_TRUE(rig.device->is_fresh());
  EXPECT_EQ(rig.device->values()[0], 0.5);
  EXPECT_EQ(rig.device->dead_man(), false);
  EXPECT_EQ(rig.device->event_ns(), 2 * kMs);
  EXPECT_EQ(rig.device->counts().at("used").integer(), 2);
  EXPECT_EQ(rig.device->counts().at("lost").integer(), 1);
}

TEST(UdpIn, ItIsStaleAfterItsTimeoutAndFreshWithTheNextPacket) {
  Rig rig;
  rig.send(1, true, 0.25f);
  EXPECT_TRUE(rig.device->take(1 * kMs));
  EXPECT_FALSE(rig.device->take(101 * kMs));
  EXPECT_TRUE(rig.device->is_fresh());
  EXPECT_FALSE(rig.device->take(102 * kMs));
  EXPECT_FALSE(rig.device->is_fresh());
  rig.send(2, true, 0.75f);
  EXPECT_TRUE(rig.device->take(500 * kMs));
  EXPECT_TRUE(rig.device->is_fresh());
  EXPECT_EQ(rig.device->values()[0], 0.75);
}

TEST(UdpIn, BadPacketsAreRefusedByCauseAndKeepNothingFresh) {
  Rig rig;
  rig.send(1, true, 0.25f);
  EXPECT_TRUE(rig.device->take(1 * kMs));
  rig.send(2, true, std::numeric_limits<float>::quiet_NaN());
  rig.send(2, true, 0.5f, 5);
  rig.send(2, true, 0.5f, 8);
  rig.send(2, true, 0.5f);  // the number of the one with a NaN
  rig.send(9, true, 0.5f);
  EXPECT_FALSE(rig.device->take(60 * kMs));
  EXPECT_EQ(rig.device->values()[0], 0.25);
  EXPECT_FALSE(rig.device->take(150 * kMs));
  EXPECT_FALSE(rig.device->is_fresh());
  EXPECT_EQ(rig.refused("too short"), 1);
  EXPECT_EQ(rig.refused("too long"), 1);
  EXPECT_EQ(rig.refused("not finite"), 1);
  EXPECT_EQ(rig.refused("repeated"), 1);
  EXPECT_EQ(rig.refused("out of sequence"), 1);
}

TEST(UdpIn, OtherSendersAreRefusedAndNamed) {
  const std::uint16_t port = free_port();
  scene::UdpInDef def = rig(port);
  def.from = {"127.0.0.2"};
  const auto device = open_udp_in(def, Reach::this_machine);
  static_cast<void>(device->take_notices());
  UdpSocket socket;
  const std::array<std::byte, 6> bytes{};
  EXPECT_TRUE(socket.send({0x7F000001, port}, bytes));
  EXPECT_TRUE(socket.send({0x7F000001, port}, bytes));
  EXPECT_FALSE(device->take(kMs));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_EQ(device->counts().at("refused").at("sender not in from").integer(), 2);
  EXPECT_EQ(device->take_notices(),
            std::vector<std::string>{"packets from 127.0.0.1 are refused; to accept them, add it to Rig.from"});
}

void expect_failure(const std::function<void()>& action, ExitCode code, const std::string& part) {
  try {
    action();
    ADD_FAILURE() << "no failure";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), code);
    EXPECT_NE(std::string(failure.what()).find(part), std::string::npos) << failure.what();
  }
}

TEST(UdpIn, AnAddressBeyondThisMachineAndATakenPortAreRefused) {
  scene::UdpInDef def = rig(5005);
  def.listen = "10.0.0.7:5005";
  expect_failure([&] { static_cast<void>(open_udp_in(def, Reach::this_machine)); }, ExitCode::bad_input,
                 "Rig.listen: 10.0.0.7:5005 is beyond this machine");
  const std::uint16_t port = free_port();
  const UdpSocket other({0x7F000001, port});
  expect_failure([&] { static_cast<void>(open_udp_in(rig(port), Reach::this_machine)); }, ExitCode::resources,
                 "end the program that has the port");
}

// ---- joystick -------------------------------------------------------------------------------------------------

std::vector<scene::InputDef> inputs() {
  std::vector<scene::InputDef> all(3);
  all[0].name = "Input_Lift", all[0].block = 3, all[0].channel = 1;
  all[1].name = "Input_Horn", all[1].block = 3, all[1].channel = 7, all[1].type = scene::InputType::digital;
  all[2].name = "Input_Other", all[2].block = 4, all[2].channel = 1;
  return all;
}

scene::JoystickDef stick(const std::string& path) {
  scene::JoystickDef def;
  def.name = "Stick";
  def.path = path;
  def.block = 3;
  def.stick.name = "Stick";
  def.stick.axes = {{.code = "ABS_X", .channel = 1, .lowest = 0, .centre = 500, .highest = 1000}};
  def.stick.buttons = {{.code = "BTN_TRIGGER", .channel = 7}};
  def.enable.dead_man = "BTN_THUMB";
  return def;
}

TEST(Joystick, RecordedEventsMoveTheInputsOfItsBlockInTheirOwnTime) {
  const testing::TemporaryFolder folder("joystick");
  std::string bytes;
  constexpr std::int64_t kBegin = 1'700'000'000'000'000;
  add_event(bytes, kBegin, EV_KEY, BTN_THUMB, 1);
  add_event(bytes, kBegin, EV_SYN, SYN_REPORT, 0);
  add_event(bytes, kBegin + 20'000, EV_ABS, ABS_X, 750);
  add_event(bytes, kBegin + 20'000, EV_KEY, BTN_TRIGGER, 1);
  add_event(bytes, kBegin + 20'000, EV_SYN, SYN_REPORT, 0);
  const auto device = open_joystick(stick(folder.write("stick.events", bytes).string()), inputs());
  EXPECT_EQ(device->inputs(), (std::vector<std::string>{"Input_Lift", "Input_Horn"}));
  EXPECT_TRUE(device->is_fresh());
  EXPECT_FALSE(device->take(1000 * kMs));
  EXPECT_EQ(device->dead_man(), false);
  EXPECT_TRUE(device->take(1000 * kMs));
  EXPECT_EQ(device->dead_man(), true);
  EXPECT_EQ(device->values()[0], 0);
  EXPECT_FALSE(device->take(1019 * kMs));
  EXPECT_TRUE(device->take(1021 * kMs));
  EXPECT_EQ(device->values()[0], 0.5);
  EXPECT_EQ(device->values()[1], 1);
  EXPECT_EQ(device->event_ns(), 1020 * kMs);
  // the end of the recording is the end of the device
  static_cast<void>(device->take(1022 * kMs));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_FALSE(device->take(5000 * kMs));
  EXPECT_EQ(device->counts().at("reports").integer(), 2);
}

TEST(Joystick, RecordedEventsThatAreNotThereAreRefused) {
  const testing::TemporaryFolder folder("joystick");
  const std::string path = (folder.path() / "stick.events").string();
  expect_failure([&] { static_cast<void>(open_joystick(stick(path), inputs())); }, ExitCode::bad_input,
                 path +
                     ": No such file or directory; the device was not started; copy the recorded events there, or "
                     "name their folder with --assets");
}

TEST(Joystick, ADeviceThatIsNotThereIsAwaited) {
  const auto device = open_joystick(stick("/dev/input/no_such_event"), inputs());
  EXPECT_FALSE(device->take(kMs));
  EXPECT_FALSE(device->is_fresh());
  EXPECT_EQ(device->take_notices(),
            std::vector<std::string>{"waiting for /dev/input/no_such_event: No such file or directory"});
}

TEST(Joystick, AFileThatIsNoRecordingIsRefused) {
  const testing::TemporaryFolder folder("joystick_bad");
  const std::string path = folder.write("stick.events", "twenty-three bytes here").string();
  expect_failure([&] { static_cast<void>(open_joystick(stick(path), inputs())); }, ExitCode::bad_input,
                 "has 23 bytes, which are no whole events");
  expect_failure([&] { static_cast<void>(open_joystick(stick("/dev/null"), inputs())); }, ExitCode::bad_input,
                 "is no input device of Linux");
  expect_failure([&] { static_cast<void>(open_joystick(stick("/tmp"), inputs())); }, ExitCode::bad_input,
                 "is no input device and no file");
}

TEST(Joystick, DevicesOfThisMachineAreFound) {
  const std::vector<FoundDevice> found = find_input_devices();
  if (found.empty()) GTEST_SKIP() << "this machine has no /dev/input/event*";
  for (const FoundDevice& device : found) EXPECT_NE(device.name.empty(), device.obstacle.empty()) << device.path;
}

}  // namespace input_devices_test
}  // namespace slew::device_node
