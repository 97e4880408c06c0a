// SPDX-License-Identifier: Apache-2.0
// Devices on CAN in a scene: CANopen's PDOs, J1939's addresses and built-in messages.
#include <gtest/gtest.h>

#include <string>

#include "devices/j1939.h"
#include "scene/devices.h"
#include "scene/scene.h"
#include "scene_text.h"

namespace slew::scene {
namespace devices_can_test {

const std::string kPushed = R"(bodies:
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Free: {type: floating, body2: Ball}
forces:
  Push: {type: point_force, body: Ball, force: 1 N, direction: [1, 0, 0]}
inputs:
  Input_Push: {type: analog, primitive: Push, block: 2, channel: 1}
outputs:
  Lamp: {type: switched, condition: Ball.center_of_mass.y > 1 m}
devices:
)";

const std::string kStick = R"(  Stick:
    type: can_in
    interface: can0
    protocol: canopen
    nodes: [{node: 5, heartbeat: 300 ms}, {node: 6, heartbeat: 0, start: false}]
    own_node: 3
    own_heartbeat: 50 ms
    sync: 10 ms
    pdos: [{name: Lever, node: 5, number: 2}, {name: Mine, node: 3}]
    objects:
      - {pdo: Lever, as: uint8, bits: 3}
      - {pdo: Lever, name: enable, as: bool}
      - {pdo: Lever, as: uint8, bits: 4}
      - {pdo: Lever, name: lift, as: int16, scale: 0.001}
      - {pdo: Mine, name: more, as: float32}
    signals: [{signal: Lever.lift, input: Input_Push}, {signal: Lever.enable}]
    dead_man: Lever.enable
)";

const std::string kLamps = R"(  Lamps:
    type: can_out
    interface: can0
    protocol: canopen
    own_node: 3
    pdos: [{name: Row, node: 6, synchronous: true}, {name: Mine, node: 3, cob_id: 419}]
    objects: [{pdo: Row, name: high, as: bool}, {pdo: Mine, name: height, as: int32}]
    signals: [{signal: Row.high, output: Lamp}, {signal: Mine.height, variable: Ball.center_of_mass.y, gain: 1000}]
)";

std::string with(std::string text, const std::string& part, const std::string& other) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), other);
}

void expect_refusal(const std::string& text, const std::string& problem) {
  EXPECT_EQ(problems_of(text), problem);
}

TEST(CanSection, CanOpenPdosAreMessagesOfTheirDirection) {
  const Scene scene = load_text(kPushed + kStick + kLamps, "test");
  const Scene again = load_text(scene.expanded_text, "again");
  for (const Scene* one : {&scene, &again}) {
    ASSERT_EQ(one->devices.can_ins.size(), 1u);
    const CanBusDef& stick = one->devices.can_ins[0].bus;
    ASSERT_EQ(stick.canopen.nodes.size(), 2u);
    EXPECT_EQ(stick.canopen.nodes[0].heartbeat, 0.3);
    EXPECT_TRUE(stick.canopen.nodes[0].is_started);
    EXPECT_FALSE(stick.canopen.nodes[1].is_started);
    EXPECT_EQ(stick.canopen.own_heartbeat, 0.05);
    EXPECT_EQ(stick.canopen.sync, 0.01);
    Problems problems;
    const std::vector<devices::CanMessage> received = can_messages(stick, CanFlow::received, problems);
    ASSERT_EQ(received.size(), 2u);
    EXPECT_EQ(received[0].id, 0x285u);  // second TPDO of node 5
    EXPECT_EQ(received[1].id, 0x203u);  // first RPDO of itself
    EXPECT_EQ(received[0].bytes, 3u);
    ASSERT_EQ(received[0].signals.size(), 2u);
    EXPECT_EQ(received[0].signals[0].start_bit, 3u);
    EXPECT_EQ(received[0].signals[1].start_bit, 8u);
    ASSERT_EQ(one->devices.can_outs.size(), 1u);
    const CanBusDef& lamps = one->devices.can_outs[0].bus;
    const std::vector<devices::CanMessage> sent = can_messages(lamps, CanFlow::sent, problems);
    ASSERT_EQ(sent.size(), 2u);
    EXPECT_EQ(sent[0].id, 0x206u);  // first RPDO of node 6
    EXPECT_TRUE(lamps.pdos[0].is_synchronous);
    EXPECT_EQ(sent[1].id, 0x1A3u);
    EXPECT_TRUE(problems.empty());
    // without an identifier of its own, the first TPDO of itself
    CanBusDef predefined = lamps;
    predefined.pdos[1].cob_id = 0;
    EXPECT_EQ(can_messages(predefined, CanFlow::sent, problems)[1].id, 0x183u);
  }
}

TEST(CanSection, WrongPdosAreRefused) {
  const auto refuses = [](const std::string& part, const std::string& other, const std::string& problem) {
    expect_refusal(kPushed + with(kStick, part, other), problem);
  };
  refuses("pdo: Mine", "pdo: Mime",
          "test:26:15: Stick.objects[4].pdo: there is no PDO 'Mime'; expected a name in pdos; did you mean 'Mine'?");
  refuses("name: Mine, node: 3", "name: Mine, node: 5, number: 2",
          "test:20:11: Stick.pdos[1]: identifier 0x285 is that of Lever; expected another number, node or cob_id");
  refuses("name: Mine, node: 3}]", "name: Lever, node: 3}, {name: Mine, node: 3, number: 2}]",
          "test:20:54: Stick.pdos[1].name: 'Lever' is in the list twice; expected a name of its own");
  refuses("number: 2", "synchronous: true",
          "test:20:48: Stick.pdos[0].synchronous: a received PDO is used when it arrives; expected no synchronous: its "
          "node decides");
  refuses("bits: 3", "bits: 9", "test:20:12: Stick.pdos.Lever.(unused).bits: 9 bits are more than the type has");
  refuses("signal: Lever.lift", "signal: Lever.left",
          "test:27:15: Stick.signals.Lever.left: no PDO has an object 'Lever.left'; expected PDO and object, as "
          "Panel.lift; did you mean 'Lever.lift'?");
  refuses("sync: 10 ms", "sync: 1 ms", "test:19:11: Stick.sync: 0.001 s are too short; expected 0, or at least 2 ms");
  refuses("own_node: 3", "own_node: 5",
          "test:16:20: Stick.nodes[0].node: 5 is the device itself; expected another node");
  refuses("protocol: canopen", "protocol: plain",
          "test:16:12: Stick.nodes: 'nodes' is of protocol canopen; expected protocol: canopen\n"
          "test:17:15: Stick.own_node: 'own_node' is of protocol canopen; expected protocol: canopen\n"
          "test:19:11: Stick.sync: 'sync' is of protocol canopen; expected protocol: canopen\n"
          "test:20:11: Stick.pdos: 'pdos' is of protocol canopen; expected protocol: canopen\n"
          "test:22:7: Stick.objects: 'objects' is of protocol canopen; expected protocol: canopen");
  refuses("protocol: canopen", "protocol: canopen\n    database: machine.dbc",
          "test:16:15: Stick.database: the messages of CANopen are PDOs by layout; expected pdos and objects");
  refuses("protocol: canopen", "protocol: canopen\n    address: 39",
          "test:16:14: Stick.address: 'address' is of protocol j1939; expected protocol: j1939");
}

TEST(CanSection, J1939HasItsJoystickAndItsEngineWithoutADatabase) {
  const std::string stick = R"(  Stick:
    type: can_in
    interface: can0
    protocol: j1939
    address: 39
    arbitrary_address: true
    identity: 77
    industry_group: 3
    signals: [{signal: BJM1.X, input: Input_Push}, {signal: BJM1.Button1_2685}]
    dead_man: BJM1.Button1_2685
  Engine:
    type: can_out
    interface: can0
    protocol: j1939
    signals: [{signal: EEC1.EngineSpeed_190, variable: Ball.center_of_mass.y}]
)";
  const Scene scene = load_text(kPushed + stick, "test");
  const Scene again = load_text(scene.expanded_text, "again");
  for (const Scene* one : {&scene, &again}) {
    const CanBusDef& bus = one->devices.can_ins[0].bus;
    EXPECT_EQ(devices::j1939_name(bus.unit), 0xB00000000000004DULL);
    Problems problems;
    const std::vector<devices::CanMessage> messages = can_messages(bus, CanFlow::received, problems);
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_EQ(messages[0], devices::bjm1());
    EXPECT_EQ(can_messages(one->devices.can_outs[0].bus, CanFlow::sent, problems)[0], devices::eec1());
  }
  expect_refusal(kPushed + with(stick, "BJM1.X", "BJM1.Z"),
                 "test:20:15: Stick.signals.BJM1.Z: the database has no signal 'BJM1.Z'; expected message and signal, "
                 "as Panel.Lift; did you mean 'BJM1.X'?");
  expect_refusal(
      kPushed + with(stick, "EEC1.EngineSpeed_190", "BJM1.X"),
      "test:26:15: Engine.signals.BJM1.X: an axis of several signals is only received; expected its position "
      "and its states");
}

// such a message would not fit into a frame
TEST(CanSection, AMessageIsOneFrame) {
  const auto with_bytes = [](int bytes, const std::string& protocol) {
    return problems_of(kPushed + "  Panel:\n    type: can_in\n    interface: can0\n    protocol: " + protocol +
                       "\n    definition: |\n      BO_ 2364540158 Long: " + std::to_string(bytes) +
                       " X\n       SG_ Lift : 0|16@1- (1,0) [0|0] \"\" X\n"
                       "    signals: [{signal: Long.Lift, input: Input_Push}]\n");
  };
  EXPECT_EQ(with_bytes(8, "j1939"), "");
  EXPECT_EQ(
      with_bytes(9, "j1939"),
      "test:16:17: Panel.definition: message Long has 9 bytes; expected at most 8, since longer messages of J1939 "
      "come in several frames (transport protocol), which are not supported");
  EXPECT_EQ(with_bytes(64, "plain"), "");
  EXPECT_EQ(with_bytes(65, "plain"),
            "test:16:17: Panel.definition: message Long has 65 bytes; expected at most 64, as a frame has");
}

}  // namespace devices_can_test
}  // namespace slew::scene
