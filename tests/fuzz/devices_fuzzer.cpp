// SPDX-License-Identifier: Apache-2.0
// Bytes from devices: packets of a layout, DBC files and frames of their messages, events of input devices, conditions,
// recorded frames, addresses.
// Any bytes are refused with a reason or give finite values; what is sent is read as valid; J1939's reserved codes are
// never sent for a value.
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "devices/can_frame.h"
#include "devices/can_message.h"
#include "devices/dbc.h"
#include "devices/output_condition.h"
#include "devices/packet.h"
#include "devices/stick.h"
#include "devices/udp_address.h"
#include "tests/fuzz/bytes.h"

namespace {

using namespace slew;
using namespace slew::devices;

constexpr std::size_t kMostFrames = 64;  // of a database, so that an input stays short

std::span<const std::byte> bytes_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const std::byte*>(data), size};
}

LayoutDef layout_def(fuzz::Choices& choices) {
  LayoutDef def{.name = "Packet"};
  def.byte_order = choices.below(2) == 0 ? ByteOrder::little : ByteOrder::big;
  def.packing = std::array{1, 4, 8}[choices.below(3)];
  def.most_lost = choices.byte();
  for (int i = 0; i < 12 && choices.has_more(); ++i) {
    LayoutFieldDef field{.name = "f" + std::to_string(i)};
    field.type = static_cast<ByteType>(choices.below(std::size(kByteTypeNames)));
    field.role =
        choices.below(4) == 0 ? static_cast<FieldRole>(choices.below(std::size(kFieldRoleNames))) : FieldRole::value;
    if (choices.below(4) == 0) field.of = "f" + std::to_string(choices.below(12));
    field.bit = static_cast<std::int64_t>(choices.below(70));
    field.bits = static_cast<std::int64_t>(choices.below(70));
    field.scale = choices.usual();
    field.offset = choices.usual();
    if (choices.below(3) == 0) field.lowest = choices.usual();
    def.fields.push_back(field);
  }
  return def;
}

void try_packets(fuzz::Choices& choices) {
  const LayoutDef def = layout_def(choices);
  Problems problems;
  validate(def, problems);
  if (!problems.empty()) return;
  const ByteLayout layout = build(def);
  fuzz::require(layout.size <= kMaxLayoutBytes);
  std::vector<std::byte> packet(layout.size);
  std::vector<double> values(layout.values.size());
  PacketState sender, receiver, other_receiver;
  for (int i = 0; i < 4; ++i) {
    for (double& value : values) value = choices.usual();
    const bool is_sent = encode(layout, values, sender, packet) == PacketFault::none;
    // what is sent is received, unless scale and offset take it out of the finite numbers
    if (is_sent) {
      const PacketFault fault = decode(layout, packet, receiver, values);
      fuzz::require(fault == PacketFault::none || fault == PacketFault::not_finite);
    }
    for (std::byte& byte : packet) byte = static_cast<std::byte>(choices.byte());
    if (decode(layout, packet, other_receiver, values) == PacketFault::none) {
      for (const double value : values) fuzz::require(std::isfinite(value));
    }
  }
}

void try_message(const CanMessage& message, std::span<const std::byte> bytes) {
  Problems problems;
  validate(message.name, message, problems);
  fuzz::require(problems.empty());
  std::vector<std::byte> frame(message.bytes);
  for (std::size_t i = 0; i < frame.size() && !bytes.empty(); ++i) frame[i] = bytes[i % bytes.size()];
  std::vector<SignalValue> values(message.signals.size());
  fuzz::require(decode(message, frame, ReservedCodes::none, values));
  std::vector<double> numbers;
  for (const SignalValue& value : values) {
    fuzz::require(std::isfinite(value.value) == (value.state == SignalState::valid));
    numbers.push_back(std::isfinite(value.value) ? value.value : std::numeric_limits<double>::quiet_NaN());
  }
  check_overlaps(message.name, message, problems);
  if (!problems.empty() || encode(message, numbers, ReservedCodes::j1939, frame).fault != EncodeFault::none) return;
  std::vector<SignalValue> read(values.size());
  fuzz::require(decode(message, frame, ReservedCodes::j1939, read));
  for (std::size_t i = 0; i < read.size(); ++i) {
    const bool is_reserved = read[i].state == SignalState::not_available || read[i].state == SignalState::error;
    fuzz::require(std::isnan(numbers[i]) || !is_reserved);
  }
}

void try_database(const std::uint8_t* data, std::size_t size) {
  Problems problems;
  const CanDatabase database = read_dbc(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz", problems);
  fuzz::require(problems.size() <= 20);
  // what a scene keeps of a database reads back to the same
  Problems again;
  fuzz::require(read_dbc(write_dbc(database.messages), "again", again).messages == database.messages && again.empty());
  for (std::size_t i = 0; i < database.messages.size() && i < kMostFrames; ++i) {
    try_message(database.messages[i], bytes_of(data, size));
  }
}

void try_events(const std::uint8_t* data, std::size_t size) {
  const StickDef def{
      .name = "Stick",
      .axes = {{.code = "ABS_X", .lowest = -100, .centre = 3, .highest = 90, .dead_zone = 0.1, .expo = 0.5}},
      .buttons = {{.code = "BTN_TRIGGER", .channel = 1}}};
  const Stick stick = build_stick(def);
  StickState state = initial_state(stick);
  connect(state);
  give_state(state, std::vector<std::int32_t>{0}, std::vector<std::uint8_t>{0});
  std::vector<InputEvent> events;
  fuzz::require(size - read_events(bytes_of(data, size), events) < kInputEventBytes);
  static_cast<void>(take_events(stick, state, events));
  const auto axis = axis_value(stick, state, 0);
  fuzz::require(axis.has_value() == (state.phase == StickPhase::valid));
  fuzz::require(!axis || (*axis >= -1 && *axis <= 1));
}

void try_condition(const std::uint8_t* data, std::size_t size) {
  Problems problems;
  const auto condition = parse_condition("when", std::string_view(reinterpret_cast<const char*>(data), size), problems);
  fuzz::require(condition.has_value() == problems.empty());
  fuzz::require(!condition || (!condition->variable.empty() && !condition->quantity.empty()));
}

// Lines of candump and addresses.
void try_line(const std::uint8_t* data, std::size_t size) {
  const std::string_view line(reinterpret_cast<const char*>(data), size);
  if (const auto logged = parse_candump(line)) {
    fuzz::require(logged->time_us >= 0 && logged->frame.size <= 64);
    fuzz::require(logged->frame.id <= (logged->frame.is_extended ? 0x1FFFFFFFu : 0x7FFu));
  }
  if (const auto address = parse_udp_address(line)) {
    fuzz::require(host_text(address->host) + ":" + std::to_string(address->port) == line);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  fuzz::Choices choices(data + 1, size - 1);
  switch (data[0] % 4) {
    case 0:
      try_packets(choices);
      break;
    case 1:
      try_database(data + 1, size - 1);
      break;
    case 2:
      try_events(data + 1, size - 1);
      break;
    default:
      try_condition(data + 1, size - 1);
      try_line(data + 1, size - 1);
      break;
  }
  return 0;
}
