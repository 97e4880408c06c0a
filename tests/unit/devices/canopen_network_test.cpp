// SPDX-License-Identifier: Apache-2.0
// Nodes of a CANopen network on a clock of the test's own: start, heartbeats, restart, itself as a node, SYNC.
#include "devices/canopen_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace slew::devices {
namespace canopen_network_test {

constexpr std::int64_t kMs = 1'000'000;

CanFrame frame_of(std::uint32_t id, std::initializer_list<int> bytes) {
  CanFrame frame;
  frame.id = id;
  for (const int byte : bytes) frame.bytes[frame.size++] = static_cast<std::byte>(byte);
  return frame;
}

// Identifier and bytes, as "000#0105".
std::string text_of_frame(const CanFrame& frame) {
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string text;
  for (int shift = 8; shift >= 0; shift -= 4) text += kDigits[frame.id >> shift & 0xF];
  text += '#';
  for (const std::byte byte : frame.data()) {
    const auto number = std::to_integer<unsigned>(byte);
    text += kDigits[number >> 4];
    text += kDigits[number & 0xF];
  }
  return text;
}

// The network with its clock; frames that it sends.
struct Bus {
  explicit Bus(CanOpenDef def) : network(std::move(def)) { network.connect(now_ns, frames); }

  void take(std::uint32_t id, std::initializer_list<int> bytes) {
    network.take(frame_of(id, bytes), now_ns, frames);
    network.advance(now_ns, frames);
  }
  // In rounds of a millisecond.
  void wait_ms(int duration) {
    for (int i = 0; i < duration; ++i) {
      now_ns += kMs;
      network.advance(now_ns, frames);
    }
  }
  std::vector<std::string> sent() {
    std::vector<std::string> texts;
    for (const CanFrame& frame : frames) texts.push_back(text_of_frame(frame));
    frames.clear();
    return texts;
  }
  std::vector<std::string> events() {
    std::vector<std::string> texts;
    for (const CanOpenEvent& event : network.take_events()) texts.push_back(text_of(event));
    return texts;
  }

  std::int64_t now_ns = 1000 * kMs;
  std::vector<CanFrame> frames;
  CanOpenNetwork network;
};

using Texts = std::vector<std::string>;

TEST(CanOpenNetwork, ANodeIsStartedOnceAndIsOperationalByItsHeartbeat) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0.1}}});
  EXPECT_EQ(bus.sent(), Texts{"000#0105"});
  EXPECT_FALSE(bus.network.is_operational(5));
  EXPECT_TRUE(bus.network.is_operational(6));  // which is not watched
  bus.wait_ms(3000);
  EXPECT_EQ(bus.sent(), Texts{});  // an absent node boots by itself
  bus.take(0x705, {0x05});
  EXPECT_TRUE(bus.network.is_operational(5));
  EXPECT_EQ(bus.events(), Texts{"node 5 is operational"});
  EXPECT_EQ(bus.sent(), Texts{});
  // the same state again is no event
  bus.take(0x705, {0x05});
  EXPECT_EQ(bus.events(), Texts{});
}

TEST(CanOpenNetwork, ABootUpIsAnsweredByAStartEachTime) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0.1}}});
  static_cast<void>(bus.sent());
  for (int restart = 1; restart <= 3; ++restart) {
    bus.take(0x705, {0x00});
    EXPECT_EQ(bus.sent(), Texts{"000#0105"}) << restart;
    EXPECT_FALSE(bus.network.is_operational(5));
    EXPECT_EQ(bus.events(), Texts{"node 5 has restarted: its values from before are void"});
    bus.wait_ms(20);
    bus.take(0x705, {0x05});
    EXPECT_TRUE(bus.network.is_operational(5));
    static_cast<void>(bus.events());
    bus.wait_ms(20);
  }
  EXPECT_EQ(bus.network.nodes()[0].boot_ups, 3u);
  EXPECT_EQ(bus.network.nodes()[0].starts, 4u);
}

// a start may be lost: it is repeated once a second while the node stays pre-operational
TEST(CanOpenNetwork, AStartIsRepeatedWhileANodeIsPreOperational) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0.3}}});
  static_cast<void>(bus.sent());
  for (int i = 0; i < 25; ++i) {
    bus.take(0x705, {0x7F});
    bus.wait_ms(100);
  }
  EXPECT_EQ(bus.sent(), (Texts{"000#0105", "000#0105", "000#0105"}));
  EXPECT_EQ(bus.events(), Texts{"node 5 is pre-operational: its values do not count"});
}

TEST(CanOpenNetwork, AMissingHeartbeatIsAnEventAndAReturnIsAStart) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0.1}}});
  bus.take(0x705, {0x05});
  static_cast<void>(bus.sent());
  static_cast<void>(bus.events());
  bus.wait_ms(100);
  EXPECT_TRUE(bus.network.is_operational(5));
  bus.wait_ms(1);
  EXPECT_FALSE(bus.network.is_operational(5));
  EXPECT_EQ(bus.events(), Texts{"node 5 is missing: its heartbeat did not come in time; its values do not count until "
                                "it is operational again"});
  EXPECT_EQ(bus.network.nodes()[0].losses, 1u);
  bus.wait_ms(5000);
  EXPECT_EQ(bus.sent(), Texts{});
  // stopped, as a node may be that has lost the heartbeat of its master: it is started, since it was away
  bus.take(0x705, {0x04});
  EXPECT_EQ(bus.sent(), Texts{"000#0105"});
  bus.take(0x705, {0x05});
  EXPECT_TRUE(bus.network.is_operational(5));
}

TEST(CanOpenNetwork, ANodeThatAnotherMasterStoppedIsLeftStopped) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0.1}}});
  bus.take(0x705, {0x05});
  static_cast<void>(bus.sent());
  static_cast<void>(bus.events());
  for (int i = 0; i < 50; ++i) {
    bus.take(0x705, {0x04});
    bus.wait_ms(50);
  }
  EXPECT_EQ(bus.sent(), Texts{});
  EXPECT_FALSE(bus.network.is_operational(5));
  EXPECT_EQ(bus.events(), Texts{"node 5 is stopped: its values do not count"});
}

TEST(CanOpenNetwork, ANodeThatIsOnlyWatchedIsNotStarted) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0.1, .is_started = false}}});
  bus.take(0x705, {0x00});
  bus.take(0x705, {0x7F});
  bus.wait_ms(3000);
  EXPECT_EQ(bus.sent(), Texts{});
}

TEST(CanOpenNetwork, ANodeWithoutHeartbeatsIsStartedAndTakenForOperational) {
  Bus bus({.nodes = {{.node = 5, .heartbeat = 0}}});
  EXPECT_EQ(bus.sent(), Texts{"000#0105"});
  bus.wait_ms(5000);
  EXPECT_TRUE(bus.network.is_operational(5));
  bus.take(0x705, {0x00});
  EXPECT_EQ(bus.sent(), Texts{"000#0105"});
}

TEST(CanOpenNetwork, AsANodeItBootsBeatsAndObeys) {
  Bus bus({.own_node = 3, .own_heartbeat = 0.05});
  EXPECT_EQ(bus.sent(), Texts{"703#00"});
  EXPECT_FALSE(bus.network.is_operational(3));
  bus.wait_ms(100);
  EXPECT_EQ(bus.sent(), (Texts{"703#7F", "703#7F"}));
  bus.take(0, {0x01, 0x04});  // to another node
  EXPECT_FALSE(bus.network.is_operational(3));
  bus.take(0, {0x01, 0x03});
  EXPECT_TRUE(bus.network.is_operational(3));
  EXPECT_EQ(bus.events(), Texts{"this device, node 3, is operational"});
  bus.wait_ms(50);
  EXPECT_EQ(bus.sent(), Texts{"703#05"});
  bus.take(0, {0x02, 0x00});  // to all
  bus.wait_ms(50);
  EXPECT_EQ(bus.sent(), Texts{"703#04"});
  bus.take(0, {0x81, 0x03});
  EXPECT_EQ(bus.sent(), Texts{"703#00"});
  EXPECT_EQ(bus.network.own_state(), NmtState::preoperational);
  bus.take(0, {0x01, 0x00});
  bus.take(0, {0x80, 0x03});
  EXPECT_EQ(bus.network.own_state(), NmtState::preoperational);
  // no commands: an unknown one, three bytes, a node number that does not exist
  bus.take(0, {0x01, 0x03, 0x00});
  bus.take(0, {0x11, 0x03});
  bus.take(0, {0x01, 0x80});
  EXPECT_EQ(bus.network.own_state(), NmtState::preoperational);
}

TEST(CanOpenNetwork, AMasterThatIsANodeStartsItself) {
  Bus bus({.nodes = {{.node = 5}}, .own_node = 3});
  EXPECT_EQ(bus.sent(), (Texts{"703#00", "000#0105"}));
  EXPECT_TRUE(bus.network.is_operational(3));
}

TEST(CanOpenNetwork, ASecondNodeOfItsNumberIsReportedOnce) {
  Bus bus({.own_node = 3});
  bus.take(0x703, {0x05});
  bus.take(0x703, {0x05});
  EXPECT_EQ(bus.events(), Texts{"another node sends heartbeats with the number of this device, 3; give one of the two "
                                "another number (own_node)"});
}

TEST(CanOpenNetwork, SyncKeepsItsGrid) {
  Bus bus({.sync = 0.01});
  bus.wait_ms(105);
  EXPECT_EQ(bus.sent(), Texts(10, "080#"));
  // a process that was stopped sends one, not all that it missed
  bus.now_ns += 1000 * kMs;
  bus.wait_ms(1);
  EXPECT_EQ(bus.sent(), Texts{"080#"});
  EXPECT_EQ(bus.network.due_ns() % (10 * kMs), 0);
  EXPECT_EQ(bus.network.syncs(), 11u);
  bus.take(0x80, {});
  EXPECT_EQ(bus.network.syncs(), 12u);
}

// the identifiers of 29 bits are others
TEST(CanOpenNetwork, ExtendedFramesAreOfOthers) {
  Bus bus({.nodes = {{.node = 5}}, .own_node = 3});
  static_cast<void>(bus.sent());
  for (CanFrame frame : {frame_of(0x705, {0x05}), frame_of(0, {0x02, 0x03}), frame_of(0x80, {})}) {
    frame.is_extended = true;
    bus.network.take(frame, bus.now_ns, bus.frames);
  }
  EXPECT_FALSE(bus.network.is_operational(5));
  EXPECT_TRUE(bus.network.is_operational(3));
  EXPECT_EQ(bus.network.syncs(), 0u);
}

TEST(CanOpenNetwork, RefusesWrongDefinitions) {
  const auto problem_of = [](const CanOpenDef& def) {
    Problems problems;
    validate("Panel", def, problems);
    return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
  };
  EXPECT_EQ(problem_of({.nodes = {{.node = 5}, {.node = 6}}, .own_node = 3, .sync = 0.002}), "");
  EXPECT_EQ(problem_of({.sync = 0.001}), "Panel.sync: 0.001 s are too short");
  EXPECT_EQ(problem_of({.own_node = 128}), "Panel.own_node: 128 is out of range");
  EXPECT_EQ(problem_of({.own_heartbeat = 0}), "Panel.own_heartbeat: 0 is out of range");
  EXPECT_EQ(problem_of({.nodes = {{.node = 0}}, .own_node = 3}), "Panel.nodes[0].node: 0 is out of range");
  EXPECT_EQ(problem_of({.nodes = {{.node = 5, .heartbeat = -1}}}), "Panel.nodes[0].heartbeat: -1 is out of range");
  EXPECT_EQ(problem_of({.nodes = {{.node = 5}, {.node = 5}}}), "Panel.nodes[1].node: 5 is in the list twice");
  EXPECT_EQ(problem_of({.nodes = {{.node = 5}}, .own_node = 5}), "Panel.nodes[0].node: 5 is the device itself");
}

}  // namespace canopen_network_test
}  // namespace slew::devices
