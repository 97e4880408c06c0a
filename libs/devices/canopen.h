// SPDX-License-Identifier: Apache-2.0
// CANopen as far as a panel or a drive needs it: process data by layout, NMT commands, heartbeats.
//
// A PDO's objects follow each other bit by bit, each with its least significant bit first. Identifiers are those of the
// predefined connection set:
//   NMT 0x000, SYNC 0x080, TPDO1..4 0x180 0x280 0x380 0x480 + node, RPDO1..4 0x200 0x300 0x400 0x500 + node,
//   heartbeat 0x700 + node
// T and R are the node's view: it transmits a TPDO and receives an RPDO.
//
// Not covered: SDO (object dictionary), EMCY, the mapping in the node: it is configured by its own tool.
// Source: CiA 301, application layer and communication profile, 7.2.2, 7.2.5, 7.2.8, 7.3.5.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/can_message.h"

namespace slew::devices {

enum class PdoDirection : int { transmit, receive };
inline constexpr std::string_view kPdoDirectionNames[] = {"transmit", "receive"};

struct PdoObjectDef {
  std::string name{};                // empty: bits without a use
  ByteType type = ByteType::uint16;  // float32 and float64 are REAL32 and REAL64
  std::int64_t bits = 0;             // 0: all of the type, 1 for bool
  double scale = 1;
  double offset = 0;
  std::string unit{};
};

struct PdoDef {
  std::string name;
  std::int64_t node = 1;    // 1 to 127
  std::int64_t number = 1;  // 1 to 4
  PdoDirection direction = PdoDirection::transmit;
  std::int64_t cob_id = 0;      // 0: of the predefined connection set
  bool is_synchronous = false;  // sent after each SYNC, not at once
  std::vector<PdoObjectDef> objects{};
};

[[nodiscard]] std::span<const Field> pdo_fields() noexcept;
[[nodiscard]] std::span<const Field> pdo_object_fields() noexcept;
void validate(const PdoDef& def, Problems& problems);

// The PDO as a message. Pre-condition: no problem; throws Failure (bad_input) otherwise.
[[nodiscard]] CanMessage build(const PdoDef& def);

// Pre-condition: number 1 to 4, node 1 to 127.
[[nodiscard]] std::uint32_t pdo_cob_id(PdoDirection direction, unsigned number, unsigned node) noexcept;

enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_preoperational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82
};
inline constexpr std::uint32_t kNmtCobId = 0;
inline constexpr std::uint32_t kSyncCobId = 0x080;
inline constexpr std::uint32_t kHeartbeatCobId = 0x700;  // + node
inline constexpr unsigned kMaxCanOpenNode = 127;

// Frame for identifier kNmtCobId. node 0: all nodes. Pre-condition: node <= 127.
[[nodiscard]] std::array<std::byte, 2> nmt_frame(NmtCommand command, unsigned node) noexcept;

enum class NmtState : std::uint8_t { boot_up = 0x00, stopped = 0x04, operational = 0x05, preoperational = 0x7F };

struct Heartbeat {
  unsigned node = 0;
  NmtState state{};
};

struct NmtRequest {
  NmtCommand command{};
  unsigned node = 0;  // 0: all nodes
};
// No value for a frame that is no NMT command: another identifier, not two bytes, no command of the list.
[[nodiscard]] std::optional<NmtRequest> read_nmt(std::uint32_t id, std::span<const std::byte> frame) noexcept;

// No value for a frame that is no heartbeat: another identifier, not one byte, no state of the list.
[[nodiscard]] std::optional<Heartbeat> read_heartbeat(std::uint32_t id, std::span<const std::byte> frame) noexcept;

}  // namespace slew::devices
