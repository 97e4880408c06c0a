// SPDX-License-Identifier: Apache-2.0
// SAE J1939: 29-bit identifiers, and two messages that machines need.
//
//   identifier = priority (3 bits), extended data page, data page, PDU format PF (8), PDU specific PS (8), source (8)
//   PDU1, PF < 240: PS is the destination, PGN = pages, PF, 0
//   PDU2, PF >= 240: to all, PGN = pages, PF, PS
//
// Sources: identifiers SAE J1939-21 5.2, values that are no numbers J1939-71 5.2.2 (can_message.h), EEC1 and BJM1
// J1939-71; the layout of BJM1 and the numbers of its SPNs as in Danfoss JS1-H Steer by Wire, User and Safety Manual
// AX436683569858en-000101, p. 12 to 13, and JS6000, 520L0760, p. 23 to 26.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "devices/can_message.h"
#include "devices/dbc.h"

namespace slew::devices {

inline constexpr std::uint8_t kJ1939ToAll = 0xFF;
inline constexpr std::uint32_t kPgnEec1 = 61444;
inline constexpr std::uint32_t kPgnBjm1 = 64982;

struct J1939Id {
  unsigned priority = 6;  // 0 (first) to 7
  std::uint32_t pgn = 0;  // 18 bits
  std::uint8_t source = 0;
  std::uint8_t destination = kJ1939ToAll;  // PDU1 only
};

// Pre-condition: id of 29 bits.
[[nodiscard]] J1939Id split_j1939(std::uint32_t id) noexcept;
// No value: priority above 7, PGN above 18 bits, a PGN of PDU1 whose low byte is not 0, a PDU2 with a destination.
[[nodiscard]] std::optional<std::uint32_t> join_j1939(const J1939Id& id) noexcept;

// The database's message of a PGN, from any source.
[[nodiscard]] const CanMessage* find_pgn(const CanDatabase& database, std::uint32_t pgn) noexcept;

// Electronic Engine Controller 1, 8 bytes, priority 3, source 0. Signals are named after their SPNs.
[[nodiscard]] CanMessage eec1();
// Basic Joystick Message 1, 8 bytes, priority 3, source 0.
[[nodiscard]] CanMessage bjm1();

// One axis of a joystick message: position 0 to 100 %, with a status of each side and of neutral.
// Result: -1 .. 1; no value unless all that is needed is valid and fits together (both sides at once, a side with
// neutral, or a position without a side do not).
[[nodiscard]] std::optional<double> joystick_axis(const SignalValue& position, const SignalValue& is_neutral,
                                                  const SignalValue& is_negative,
                                                  const SignalValue& is_positive) noexcept;

// Signals of a message that are an axis together, by their places in it.
struct JoystickAxis {
  std::size_t position = 0, is_neutral = 0, is_negative = 0, is_positive = 0;
};
// Axis "X" or "Y" of a message of BJM1's parameter group that has the signals of bjm1().
[[nodiscard]] std::optional<JoystickAxis> find_joystick_axis(const CanMessage& message, std::string_view axis) noexcept;
// Names of the axes that a message has.
[[nodiscard]] std::vector<std::string_view> joystick_axes(const CanMessage& message);
// values: of the message.
[[nodiscard]] std::optional<double> joystick_axis(const JoystickAxis& axis,
                                                  std::span<const SignalValue> values) noexcept;

}  // namespace slew::devices
