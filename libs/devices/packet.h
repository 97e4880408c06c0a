// SPDX-License-Identifier: Apache-2.0
// Packets of a layout: bytes to values and back. No allocation, no exception.
//
// A received packet is refused as a whole, for one cause, which is counted; the values are then left as they were:
//   too_short, too_long    not the layout's size
//   bad_checksum           the checksum over the other bytes differs
//   repeated               the sequence number is that of the last packet
//   out_of_sequence        more packets than `most_lost` are missing before it, or it is older than the last one. The
//                          next number goes on from either: a sender that starts again is used from its second packet
//   not_finite             a float is NaN or infinite, or scale and offset make it so
// Packets that are missing before a used one are counted as lost, up to `most_lost` at once. Where the sequence goes on
// behind an out_of_sequence the number of missing packets is not known, as the sender may have started again: a jump.
//
// A packet that is sent holds each value at its bounds (counted), rounds to the nearest number, ties to even. A value
// that is not finite refuses the packet (counted); nothing is to be sent then.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "devices/byte_layout.h"

namespace slew::devices {

enum class PacketFault : std::uint8_t {
  none,
  too_short,
  too_long,
  bad_checksum,
  repeated,
  out_of_sequence,
  not_finite,
  number_of_faults
};
[[nodiscard]] std::string_view text_of(PacketFault fault) noexcept;  // "too short"

struct PacketCounts {
  std::uint64_t used = 0;   // received and used, or encoded
  std::uint64_t lost = 0;   // missing in the sequence before used packets, without jumps
  std::uint64_t jumps = 0;  // the sequence went on at another place
  std::uint64_t held = 0;   // values held at a bound when sent
  std::array<std::uint64_t, static_cast<std::size_t>(PacketFault::number_of_faults)> refused{};

  [[nodiscard]] std::uint64_t of(PacketFault fault) const noexcept { return refused[static_cast<std::size_t>(fault)]; }
};

// One direction of one layout's traffic.
struct PacketState {
  PacketCounts counts;
  bool has_sequence = false;
  std::uint64_t sequence = 0;  // receiver: of the last used packet; sender: of the next packet
  std::uint64_t refused_sequence = 0;
  bool has_refused_sequence = false;
};

// values: one for each of layout.values, in their order. Pre-condition: values.size() == layout.values.size().
PacketFault decode(const ByteLayout& layout, std::span<const std::byte> packet, PacketState& state,
                   std::span<double> values) noexcept;

// Fills the packet and counts the sequence on. Pre-condition: packet.size() == layout.size, values as for decode.
// Result: none or not_finite; the packet's bytes are undefined with the latter.
PacketFault encode(const ByteLayout& layout, std::span<const double> values, PacketState& state,
                   std::span<std::byte> packet) noexcept;

}  // namespace slew::devices
