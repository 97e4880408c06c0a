// SPDX-License-Identifier: Apache-2.0
#include "devices/j1939.h"

#include <initializer_list>

namespace slew::devices {
namespace {

constexpr unsigned kFirstPdu2Format = 240;

bool is_pdu1(std::uint32_t pgn) {
  return ((pgn >> 8) & 0xFF) < kFirstPdu2Format;
}

// Parameter at byte.bit as the standard counts them, from 1.1.
struct Parameter {
  const char* name;
  unsigned byte, bit, bits;
  double scale, offset, lowest, highest;
  const char* unit;
};

CanMessage message_of(const char* name, std::uint32_t pgn, std::initializer_list<Parameter> parameters) {
  CanMessage message;
  message.name = name;
  message.is_extended = true;
  message.id = *join_j1939({.priority = 3, .pgn = pgn});
  for (const Parameter& p : parameters) {
    CanSignal signal;
    signal.name = p.name;
    signal.start_bit = 8 * (p.byte - 1) + p.bit - 1;
    signal.bits = p.bits;
    signal.scale = p.scale, signal.offset = p.offset;
    signal.lowest = p.lowest, signal.highest = p.highest;
    signal.unit = p.unit;
    message.signals.push_back(std::move(signal));
  }
  return message;
}

constexpr std::string_view kJoystickAxes[] = {"X", "Y"};

bool is_valid(const SignalValue& value) {
  return value.state == SignalState::valid;
}

}  // namespace

J1939Id split_j1939(std::uint32_t id) noexcept {
  J1939Id result;
  result.priority = (id >> 26) & 7;
  result.source = static_cast<std::uint8_t>(id & 0xFF);
  result.pgn = (id >> 8) & 0x3FFFF;
  if (is_pdu1(result.pgn)) {
    result.destination = static_cast<std::uint8_t>(result.pgn & 0xFF);
    result.pgn &= 0x3FF00;
  }
  return result;
}

std::optional<std::uint32_t> join_j1939(const J1939Id& id) noexcept {
  if (id.priority > 7 || id.pgn > 0x3FFFF) return std::nullopt;
  std::uint32_t pgn = id.pgn;
  if (is_pdu1(pgn)) {
    if ((pgn & 0xFF) != 0) return std::nullopt;
    pgn |= id.destination;
  } else if (id.destination != kJ1939ToAll) {
    return std::nullopt;
  }
  return (static_cast<std::uint32_t>(id.priority) << 26) | (pgn << 8) | id.source;
}

const CanMessage* find_pgn(const CanDatabase& database, std::uint32_t pgn) noexcept {
  for (const CanMessage& message : database.messages) {
    if (message.is_extended && split_j1939(message.id).pgn == pgn) return &message;
  }
  return nullptr;
}

CanMessage eec1() {
  return message_of("EEC1", kPgnEec1,
                    {{"EngineTorqueMode_899", 1, 1, 4, 1, 0, 0, 13, ""},
                     {"ActualEnginePercentTorqueHighResolution_4154", 1, 5, 4, 0.125, 0, 0, 0.875, "%"},
                     {"DriversDemandEnginePercentTorque_512", 2, 1, 8, 1, -125, -125, 125, "%"},
                     {"ActualEnginePercentTorque_513", 3, 1, 8, 1, -125, -125, 125, "%"},
                     {"EngineSpeed_190", 4, 1, 16, 0.125, 0, 0, 8031.875, "rpm"},
                     {"SourceAddressOfControllingDevice_1483", 6, 1, 8, 1, 0, 0, 253, ""},
                     {"EngineStarterMode_1675", 7, 1, 4, 1, 0, 0, 13, ""},
                     {"EngineDemandPercentTorque_2432", 8, 1, 8, 1, -125, -125, 125, "%"}});
}

CanMessage bjm1() {
  return message_of(
      "BJM1", kPgnBjm1,
      {{"XNeutral_2675", 1, 1, 2, 1, 0, 0, 1, ""},        {"XNegative_2670", 1, 3, 2, 1, 0, 0, 1, ""},  // left
       {"XPositive_2665", 1, 5, 2, 1, 0, 0, 1, ""},                                                     // right
       {"XPosition_2660", 1, 7, 10, 0.1, 0, 0, 100, "%"}, {"YNeutral_2676", 3, 1, 2, 1, 0, 0, 1, ""},
       {"YNegative_2671", 3, 3, 2, 1, 0, 0, 1, ""},  // back
       {"YPositive_2666", 3, 5, 2, 1, 0, 0, 1, ""},  // forward
       {"YPosition_2661", 3, 7, 10, 0.1, 0, 0, 100, "%"}, {"YDetent_2681", 5, 5, 2, 1, 0, 0, 1, ""},
       {"XDetent_2680", 5, 7, 2, 1, 0, 0, 1, ""},         {"Button4_2688", 6, 1, 2, 1, 0, 0, 1, ""},
       {"Button3_2687", 6, 3, 2, 1, 0, 0, 1, ""},         {"Button2_2686", 6, 5, 2, 1, 0, 0, 1, ""},
       {"Button1_2685", 6, 7, 2, 1, 0, 0, 1, ""},         {"Button8_2692", 7, 1, 2, 1, 0, 0, 1, ""},
       {"Button7_2691", 7, 3, 2, 1, 0, 0, 1, ""},         {"Button6_2690", 7, 5, 2, 1, 0, 0, 1, ""},
       {"Button5_2689", 7, 7, 2, 1, 0, 0, 1, ""},         {"Button12_2696", 8, 1, 2, 1, 0, 0, 1, ""},
       {"Button11_2695", 8, 3, 2, 1, 0, 0, 1, ""},        {"Button10_2694", 8, 5, 2, 1, 0, 0, 1, ""},
       {"Button9_2693", 8, 7, 2, 1, 0, 0, 1, ""}});
}

std::optional<double> joystick_axis(const SignalValue& position, const SignalValue& is_neutral,
                                    const SignalValue& is_negative, const SignalValue& is_positive) noexcept {
  constexpr double kFullPosition = 100;  // %
  if (!is_valid(position) || !is_valid(is_neutral) || !is_valid(is_negative) || !is_valid(is_positive)) {
    return std::nullopt;
  }
  const bool negative = is_negative.value != 0, positive = is_positive.value != 0, neutral = is_neutral.value != 0;
  if ((negative && positive) || (neutral && (negative || positive))) return std::nullopt;
  if (!negative && !positive) return position.value == 0 || neutral ? std::optional(0.0) : std::nullopt;
  return (negative ? -1 : 1) * position.value / kFullPosition;
}

std::optional<JoystickAxis> find_joystick_axis(const CanMessage& message, std::string_view axis) noexcept {
  if (!message.is_extended || split_j1939(message.id).pgn != kPgnBjm1) return std::nullopt;
  const bool is_x = axis == kJoystickAxes[0];
  if (!is_x && axis != kJoystickAxes[1]) return std::nullopt;
  const auto position = find_signal(message, is_x ? "XPosition_2660" : "YPosition_2661");
  const auto neutral = find_signal(message, is_x ? "XNeutral_2675" : "YNeutral_2676");
  const auto negative = find_signal(message, is_x ? "XNegative_2670" : "YNegative_2671");
  const auto positive = find_signal(message, is_x ? "XPositive_2665" : "YPositive_2666");
  if (!position || !neutral || !negative || !positive) return std::nullopt;
  return JoystickAxis{*position, *neutral, *negative, *positive};
}

std::vector<std::string_view> joystick_axes(const CanMessage& message) {
  std::vector<std::string_view> axes;
  for (const std::string_view axis : kJoystickAxes) {
    if (find_joystick_axis(message, axis)) axes.push_back(axis);
  }
  return axes;
}

std::optional<double> joystick_axis(const JoystickAxis& axis, std::span<const SignalValue> values) noexcept {
  return joystick_axis(values[axis.position], values[axis.is_neutral], values[axis.is_negative],
                       values[axis.is_positive]);
}

}  // namespace slew::devices
