// SPDX-License-Identifier: Apache-2.0
#include "devices/canopen.h"

#include <fmt/format.h>

#include "core/check.h"
#include "core/failure.h"
#include "devices/field_rules.h"

namespace slew::devices {
namespace {

constexpr unsigned kMaxNode = kMaxCanOpenNode;
constexpr unsigned kMaxPdoBits = 64;
constexpr std::uint32_t kFirstTransmitPdo = 0x180, kFirstReceivePdo = 0x200, kPdoStep = 0x100;

constexpr Field kPdoFields[] = {
    field<&PdoDef::node>("node", {.range = {.min = 1, .max = kMaxNode, .min_is_open = false, .max_is_open = false},
                                  .doc = "number of the node"}),
    field<&PdoDef::number>("number", {.range = {.min = 1, .max = 4, .min_is_open = false, .max_is_open = false},
                                      .doc = "number of the PDO"}),
    field<&PdoDef::direction>("direction", {.choices = kPdoDirectionNames, .doc = "as the node sees it"}),
    field<&PdoDef::cob_id>("cob_id", {.range = {.min = 0, .max = 0x7FF, .min_is_open = false, .max_is_open = false},
                                      .doc = "identifier; 0: that of the predefined connection set"}),
    field<&PdoDef::is_synchronous>("synchronous", {.doc = "sent: after each SYNC, in place of at once"}),
};

constexpr Field kPdoObjectFields[] = {
    field<&PdoObjectDef::type>("as", {.choices = kByteTypeNames, .doc = "type of the object"}),
    field<&PdoObjectDef::bits>("bits", {.range = {.min = 0, .max = 64, .min_is_open = false, .max_is_open = false},
                                        .doc = "length in the PDO; 0: all of the type, 1 for bool"}),
    field<&PdoObjectDef::scale>("scale", {.doc = "value = scale * raw + offset; not 0"}),
    field<&PdoObjectDef::offset>("offset", {.doc = "value of a raw 0"}),
    field<&PdoObjectDef::unit>("unit", {.doc = "unit of the value"}),
};

unsigned bits_of_object(const PdoObjectDef& object) {
  if (object.bits != 0) return static_cast<unsigned>(object.bits);
  return object.type == ByteType::boolean ? 1 : static_cast<unsigned>(8 * size_of(object.type));
}

CanMessage message_of_pdo(const PdoDef& def) {
  CanMessage message;
  message.name = def.name;
  message.id = def.cob_id != 0
                   ? static_cast<std::uint32_t>(def.cob_id)
                   : pdo_cob_id(def.direction, static_cast<unsigned>(def.number), static_cast<unsigned>(def.node));
  unsigned bit = 0;
  for (const PdoObjectDef& object : def.objects) {
    CanSignal signal;
    signal.name = object.name;
    signal.start_bit = bit;
    signal.bits = bits_of_object(object);
    signal.is_signed = is_signed(object.type);
    if (object.type == ByteType::float32) signal.number = CanNumber::float32;
    if (object.type == ByteType::float64) signal.number = CanNumber::float64;
    signal.scale = object.scale, signal.offset = object.offset;
    signal.unit = object.unit;
    bit += signal.bits;
    if (!object.name.empty()) message.signals.push_back(std::move(signal));
  }
  message.bytes = (bit + 7) / 8;
  return message;
}

bool is_state(std::uint8_t state) {
  switch (static_cast<NmtState>(state)) {
    case NmtState::boot_up:
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::preoperational:
      return true;
  }
  return false;
}

bool is_command(std::uint8_t command) {
  switch (static_cast<NmtCommand>(command)) {
    case NmtCommand::start:
    case NmtCommand::stop:
    case NmtCommand::enter_preoperational:
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      return true;
  }
  return false;
}

}  // namespace

std::span<const Field> pdo_fields() noexcept {
  return kPdoFields;
}
std::span<const Field> pdo_object_fields() noexcept {
  return kPdoObjectFields;
}

void validate(const PdoDef& def, Problems& problems) {
  const std::size_t before = problems.size();
  check_fields(def.name, &def, kPdoFields, problems);
  unsigned bits = 0;
  for (const PdoObjectDef& object : def.objects) {
    const std::string path = def.name + "." + (object.name.empty() ? "(unused)" : object.name);
    check_fields(path, &object, kPdoObjectFields, problems);
    bits += bits_of_object(object);
    if (object.bits > static_cast<std::int64_t>(8 * size_of(object.type))) {
      problems.push_back({path + ".bits", fmt::format("{} bits are more than the type has", object.bits), "", ""});
    }
  }
  if (def.objects.empty() || bits > kMaxPdoBits) {
    problems.push_back({def.name + ".objects", fmt::format("the objects have {} bits", bits), "1 to 64", ""});
  }
  if (problems.size() == before) validate(def.name, message_of_pdo(def), problems);
}

CanMessage build(const PdoDef& def) {
  Problems problems;
  validate(def, problems);
  if (!problems.empty()) throw Failure(ExitCode::bad_input, problems[0].path + ": " + problems[0].what);
  return message_of_pdo(def);
}

std::uint32_t pdo_cob_id(PdoDirection direction, unsigned number, unsigned node) noexcept {
  SLEW_CHECK(number >= 1 && number <= 4 && node >= 1 && node <= kMaxNode);
  const std::uint32_t first = direction == PdoDirection::transmit ? kFirstTransmitPdo : kFirstReceivePdo;
  return first + (number - 1) * kPdoStep + node;
}

std::array<std::byte, 2> nmt_frame(NmtCommand command, unsigned node) noexcept {
  SLEW_CHECK(node <= kMaxNode);
  return {static_cast<std::byte>(command), static_cast<std::byte>(node)};
}

std::optional<NmtRequest> read_nmt(std::uint32_t id, std::span<const std::byte> frame) noexcept {
  if (id != kNmtCobId || frame.size() != 2) return std::nullopt;
  const auto command = std::to_integer<std::uint8_t>(frame[0]);
  const auto node = std::to_integer<unsigned>(frame[1]);
  if (!is_command(command) || node > kMaxNode) return std::nullopt;
  return NmtRequest{static_cast<NmtCommand>(command), node};
}

std::optional<Heartbeat> read_heartbeat(std::uint32_t id, std::span<const std::byte> frame) noexcept {
  if (id <= kHeartbeatCobId || id > kHeartbeatCobId + kMaxNode || frame.size() != 1) return std::nullopt;
  const auto state = std::to_integer<std::uint8_t>(frame[0]);
  if (!is_state(state)) return std::nullopt;
  return Heartbeat{id - kHeartbeatCobId, static_cast<NmtState>(state)};
}

}  // namespace slew::devices
