// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "core/failure.h"
#include "devices/canopen.h"
#include "devices/j1939.h"

namespace slew::devices {
namespace can_protocols_test {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::initializer_list<int> numbers) {
  Bytes bytes;
  for (const int number : numbers) bytes.push_back(static_cast<std::byte>(number));
  return bytes;
}

SignalValue value_in(const CanMessage& message, const Bytes& frame, std::string_view name) {
  std::vector<SignalValue> values(message.signals.size());
  EXPECT_TRUE(decode(message, frame, ReservedCodes::j1939, values));
  return values[*find_signal(message, name)];
}

TEST(J1939, IdentifiersAreSplitAndJoined) {
  // engine's EEC1, a request to address 0x21 (PDU1), a message on data page 1
  const J1939Id engine = split_j1939(0x0CF00400);
  EXPECT_EQ(engine.priority, 3U);
  EXPECT_EQ(engine.pgn, kPgnEec1);
  EXPECT_EQ(engine.source, 0);
  EXPECT_EQ(engine.destination, kJ1939ToAll);
  const J1939Id request = split_j1939(0x18EA21F9);
  EXPECT_EQ(request.priority, 6U);
  EXPECT_EQ(request.pgn, 0xEA00U);
  EXPECT_EQ(request.destination, 0x21);
  EXPECT_EQ(request.source, 0xF9);
  EXPECT_EQ(split_j1939(0x0DF01234).pgn, 0x1F012U);
  EXPECT_EQ(split_j1939(0x0CFDD627).pgn, kPgnBjm1);
  for (const std::uint32_t id : {0x0CF00400U, 0x18EA21F9U, 0x0DF01234U, 0x0CFDD627U, 0U, 0x1FFFFFFFU, 0x1CEFFF00U}) {
    EXPECT_EQ(join_j1939(split_j1939(id)), id);
  }
  EXPECT_FALSE(join_j1939({.priority = 8, .pgn = kPgnEec1}).has_value());
  EXPECT_FALSE(join_j1939({.pgn = 0x40000}).has_value());
  EXPECT_FALSE(join_j1939({.pgn = 0xEA21}).has_value());
  EXPECT_FALSE(join_j1939({.pgn = kPgnEec1, .destination = 0x21}).has_value());
}

TEST(J1939, Eec1HasTheEnginesFigures) {
  const CanMessage message = eec1();
  Problems problems;
  validate("EEC1", message, problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(message.id, 0x0CF00400U);
  // 1500 rpm is 12000 counts, 0x2EE0; 40 % and 25 % torque are 165 and 150
  const Bytes frame = bytes_of({0x43, 165, 150, 0xE0, 0x2E, 0x00, 0xF2, 125});
  EXPECT_EQ(value_in(message, frame, "EngineSpeed_190").value, 1500);
  EXPECT_EQ(value_in(message, frame, "DriversDemandEnginePercentTorque_512").value, 40);
  EXPECT_EQ(value_in(message, frame, "ActualEnginePercentTorque_513").value, 25);
  EXPECT_EQ(value_in(message, frame, "ActualEnginePercentTorqueHighResolution_4154").value, 0.5);
  EXPECT_EQ(value_in(message, frame, "EngineTorqueMode_899").value, 3);
  EXPECT_EQ(value_in(message, frame, "EngineStarterMode_1675").value, 2);
  EXPECT_EQ(value_in(message, frame, "EngineDemandPercentTorque_2432").value, 0);
}

TEST(J1939, ReservedCodesNeverBecomeAValue) {
  const CanMessage message = eec1();
  std::vector<SignalValue> values(message.signals.size());
  ASSERT_TRUE(decode(message, Bytes(8, std::byte{0xFF}), ReservedCodes::j1939, values));
  for (const SignalValue& value : values) {
    EXPECT_EQ(value.state, SignalState::not_available);
    EXPECT_TRUE(std::isnan(value.value));
  }
  // every code of the speed's top byte and of the torque
  for (int top = 0; top < 256; ++top) {
    const Bytes frame = bytes_of({0, 0, top, 0xFF, top, 0, 0, 0});
    const SignalState expected = top == 0xFF   ? SignalState::not_available
                                 : top == 0xFE ? SignalState::error
                                 : top >= 0xFB ? SignalState::out_of_range
                                               : SignalState::valid;
    EXPECT_EQ(value_in(message, frame, "EngineSpeed_190").state, expected) << top;
    EXPECT_EQ(value_in(message, frame, "ActualEnginePercentTorque_513").state, expected) << top;
    EXPECT_EQ(std::isfinite(value_in(message, frame, "EngineSpeed_190").value), expected == SignalState::valid);
  }
  EXPECT_EQ(value_in(message, bytes_of({0xEE, 0, 0, 0, 0, 0, 0, 0}), "EngineTorqueMode_899").state, SignalState::error);
  // without a range in the database the reserved codes are still none
  CanMessage bare = message;
  for (CanSignal& signal : bare.signals) signal.lowest = signal.highest = 0;
  for (const int top : {0xFB, 0xFC, 0xFD}) {
    EXPECT_EQ(value_in(bare, bytes_of({0, 0, top, 0, top, 0, 0, 0}), "EngineSpeed_190").state,
              SignalState::out_of_range);
  }
}

TEST(J1939, SendsNotAvailableForWhatIsNotKnown) {
  const CanMessage message = eec1();
  std::vector<double> values(message.signals.size(), NAN);
  values[*find_signal(message, "EngineSpeed_190")] = 1500;
  values[*find_signal(message, "ActualEnginePercentTorque_513")] = 1e6;
  Bytes frame(8);
  const EncodeResult result = encode(message, values, ReservedCodes::j1939, frame);
  EXPECT_EQ(result.fault, EncodeFault::none);
  EXPECT_EQ(result.held, 1U);
  EXPECT_EQ(frame, bytes_of({0xFF, 0xFF, 250, 0xE0, 0x2E, 0xFF, 0xFF, 0xFF}));
  // a value that is held never reaches a reserved code, with and without a range
  CanMessage bare = message;
  for (CanSignal& signal : bare.signals) signal.lowest = signal.highest = 0;
  values.assign(values.size(), 1e9);
  static_cast<void>(encode(bare, values, ReservedCodes::j1939, frame));
  std::vector<SignalValue> read(values.size());
  ASSERT_TRUE(decode(bare, frame, ReservedCodes::j1939, read));
  for (const SignalValue& value : read) EXPECT_EQ(value.state, SignalState::valid);
}

std::optional<double> x_axis(const Bytes& frame) {
  const CanMessage message = bjm1();
  return joystick_axis(value_in(message, frame, "XPosition_2660"), value_in(message, frame, "XNeutral_2675"),
                       value_in(message, frame, "XNegative_2670"), value_in(message, frame, "XPositive_2665"));
}

// position in counts of 0.1 %, states of two bits each
Bytes joystick(unsigned position, unsigned neutral, unsigned negative, unsigned positive) {
  Bytes frame(8, std::byte{0xFF});
  const unsigned word = neutral | (negative << 2) | (positive << 4) | (position << 6);
  frame[0] = static_cast<std::byte>(word & 0xFF);
  frame[1] = static_cast<std::byte>(word >> 8);
  return frame;
}

TEST(J1939, Bjm1IsAStickWithASide) {
  Problems problems;
  validate("BJM1", bjm1(), problems);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(bjm1().id, 0x0CFDD600U);
  EXPECT_EQ(x_axis(joystick(0, 1, 0, 0)), 0);
  EXPECT_DOUBLE_EQ(*x_axis(joystick(500, 0, 0, 1)), 0.5);
  EXPECT_DOUBLE_EQ(*x_axis(joystick(1000, 0, 1, 0)), -1);
  EXPECT_EQ(x_axis(joystick(0, 0, 0, 0)), 0);
}

TEST(J1939, ABrokenStickIsNeverFullStick) {
  EXPECT_FALSE(x_axis(joystick(1023, 3, 3, 3)).has_value());  // not available
  EXPECT_FALSE(x_axis(joystick(1022, 0, 0, 1)).has_value());  // error
  for (unsigned position = 1001; position < 1024; ++position) {
    EXPECT_FALSE(x_axis(joystick(position, 0, 0, 1)).has_value()) << position;
  }
  EXPECT_FALSE(x_axis(joystick(500, 0, 1, 1)).has_value());  // both sides
  EXPECT_FALSE(x_axis(joystick(500, 1, 0, 1)).has_value());  // a side and neutral
  EXPECT_FALSE(x_axis(joystick(500, 0, 0, 0)).has_value());  // no side
  EXPECT_FALSE(x_axis(joystick(500, 0, 2, 1)).has_value());  // a contact's error
  EXPECT_FALSE(x_axis(joystick(500, 3, 0, 1)).has_value());
}

TEST(J1939, ButtonsOfBjm1AreAtTheirPlaces) {
  const CanMessage message = bjm1();
  for (unsigned button = 1; button <= 12; ++button) {
    // the first button of each byte has the top bits
    Bytes frame(8, std::byte{0});
    frame[5 + (button - 1) / 4] = std::byte{1} << (2 * (3 - (button - 1) % 4));
    for (const CanSignal& signal : message.signals) {
      if (!signal.name.starts_with("Button")) continue;
      const bool is_it = signal.name.starts_with("Button" + std::to_string(button) + "_");
      EXPECT_EQ(value_in(message, frame, signal.name).value, is_it ? 1 : 0) << signal.name << " " << button;
      EXPECT_EQ(signal.name.ends_with("_" + std::to_string(2684 + button)), is_it) << signal.name;
    }
  }
}

TEST(CanOpen, IdentifiersOfThePredefinedConnectionSet) {
  EXPECT_EQ(pdo_cob_id(PdoDirection::transmit, 1, 1), 0x181U);
  EXPECT_EQ(pdo_cob_id(PdoDirection::receive, 1, 127), 0x27FU);
  EXPECT_EQ(pdo_cob_id(PdoDirection::transmit, 4, 0x20), 0x4A0U);
  EXPECT_EQ(pdo_cob_id(PdoDirection::receive, 4, 0x20), 0x520U);
}

TEST(CanOpen, APdoIsReadBitByBit) {
  const CanMessage message = build({.name = "Panel",
                                    .node = 5,
                                    .number = 2,
                                    .objects = {{.name = "is_on", .type = ByteType::boolean},
                                                {.type = ByteType::uint8, .bits = 3},
                                                {.name = "gear", .type = ByteType::int8, .bits = 4},
                                                {.name = "speed", .type = ByteType::int16, .scale = 0.1, .unit = "rpm"},
                                                {.name = "force", .type = ByteType::float32}}});
  EXPECT_EQ(message.id, 0x285U);
  EXPECT_EQ(message.bytes, 7U);
  std::vector<SignalValue> values(4);
  // gear -2, speed -100 counts, force 1.0
  ASSERT_TRUE(decode(message, bytes_of({0xEF, 0x9C, 0xFF, 0, 0, 0x80, 0x3F}), ReservedCodes::none, values));
  EXPECT_EQ(values[0].value, 1);
  EXPECT_EQ(values[1].value, -2);
  EXPECT_EQ(values[2].value, -10);
  EXPECT_EQ(values[3].value, 1);
  Bytes frame(7);
  static_cast<void>(encode(message, std::vector<double>{1, -2, -10, 1}, ReservedCodes::none, frame));
  EXPECT_EQ(frame, bytes_of({0xE1, 0x9C, 0xFF, 0, 0, 0x80, 0x3F}));
}

TEST(CanOpen, CommandsAndHeartbeats) {
  EXPECT_EQ(nmt_frame(NmtCommand::start, 0), (std::array<std::byte, 2>{std::byte{1}, std::byte{0}}));
  EXPECT_EQ(nmt_frame(NmtCommand::enter_preoperational, 9), (std::array<std::byte, 2>{std::byte{0x80}, std::byte{9}}));
  const auto beat = read_heartbeat(0x705, bytes_of({0x05}));
  ASSERT_TRUE(beat.has_value());
  EXPECT_EQ(beat->node, 5U);
  EXPECT_EQ(beat->state, NmtState::operational);
  EXPECT_EQ(read_heartbeat(0x77F, bytes_of({0x00}))->state, NmtState::boot_up);
  EXPECT_FALSE(read_heartbeat(0x700, bytes_of({0x05})).has_value());
  EXPECT_FALSE(read_heartbeat(0x780, bytes_of({0x05})).has_value());
  EXPECT_FALSE(read_heartbeat(0x705, bytes_of({0x06})).has_value());
  EXPECT_FALSE(read_heartbeat(0x705, bytes_of({0x85})).has_value());  // node guarding's toggle bit
  EXPECT_FALSE(read_heartbeat(0x705, bytes_of({0x05, 0})).has_value());
  EXPECT_FALSE(read_heartbeat(0x705, {}).has_value());
}

TEST(CanOpen, RefusesWrongDefinitions) {
  const auto with = [](auto change) {
    PdoDef def = {.name = "P", .objects = {{.name = "a"}, {.name = "b", .type = ByteType::int32}}};
    change(def);
    Problems problems;
    validate(def, problems);
    return problems.empty() ? "" : problems[0].path + ": " + problems[0].what;
  };
  EXPECT_EQ(with([](auto&) {}), "");
  EXPECT_EQ(with([](auto& d) { d.node = 128; }), "P.node: 128 is out of range");
  EXPECT_EQ(with([](auto& d) { d.number = 5; }), "P.number: 5 is out of range");
  EXPECT_EQ(with([](auto& d) { d.cob_id = 2048; }), "P.cob_id: 2048 is out of range");
  EXPECT_EQ(with([](auto& d) { d.objects.clear(); }), "P.objects: the objects have 0 bits");
  EXPECT_EQ(with([](auto& d) {
              d.objects.push_back({.name = "c"}), d.objects.push_back({.name = "d", .type = ByteType::uint8});
            }),
            "P.objects: the objects have 72 bits");
  EXPECT_EQ(with([](auto& d) { d.objects[0].bits = 17; }), "P.a.bits: 17 bits are more than the type has");
  EXPECT_EQ(with([](auto& d) { d.objects[0].bits = 65; }), "P.a.bits: 65 is out of range");
  EXPECT_EQ(with([](auto& d) { d.objects[0].scale = 0; }), "P.a: factor 0, offset 0");
  EXPECT_EQ(with([](auto& d) { d.objects[1].name = "a"; }), "P.a: the name is used twice in the message");
  EXPECT_EQ(with([](auto& d) { d.objects[1].type = ByteType::float32, d.objects[1].bits = 16; }),
            "P.b: a float of 16 bits");
  EXPECT_THROW(static_cast<void>(build(PdoDef{.name = "P"})), Failure);
}

}  // namespace can_protocols_test
}  // namespace slew::devices
