// SPDX-License-Identifier: Apache-2.0
#include "devices/packet.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/check.h"
#include "devices/raw_bits.h"

namespace slew::devices {
namespace {

std::uint64_t read_number(ByteOrder order, std::span<const std::byte> bytes) noexcept {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t place = order == ByteOrder::big ? i : bytes.size() - 1 - i;  // most significant first
    number = (number << 8) | std::to_integer<std::uint64_t>(bytes[place]);
  }
  return number;
}

void write_number(ByteOrder order, std::uint64_t number, std::span<std::byte> bytes) noexcept {
  for (std::size_t i = 0; i < bytes.size(); ++i, number >>= 8) {
    const std::size_t place = order == ByteOrder::big ? bytes.size() - 1 - i : i;  // least significant first
    bytes[place] = static_cast<std::byte>(number & 0xFF);
  }
}

std::uint64_t read_bits(const ByteLayout& layout, const PlacedField& field,
                        std::span<const std::byte> packet) noexcept {
  const std::uint64_t number = read_number(layout.byte_order, packet.subspan(field.byte, field.bytes));
  return (number >> field.bit) & mask_of(field.bits);
}

// the raw number that the bits mean
double raw_of(const PlacedField& field, std::uint64_t bits) noexcept {
  switch (field.type) {
    case ByteType::boolean:
      return bits != 0 ? 1 : 0;
    case ByteType::float32:
      return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    case ByteType::float64:
      return std::bit_cast<double>(bits);
    default:
      break;
  }
  return number_of(bits, field.bits, is_signed(field.type));
}

// Pre-condition: raw within the field's bounds, a whole number for integers.
std::uint64_t bits_of_raw(const PlacedField& field, double raw) noexcept {
  if (field.type == ByteType::float32) return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
  if (field.type == ByteType::float64) return std::bit_cast<std::uint64_t>(raw);
  return word_of(raw, field.bits);
}

std::uint32_t checksum_of_packet(const ByteLayout& layout, std::span<const std::byte> packet) noexcept {
  const PlacedField& field = layout.fields[*layout.checksum];
  return checksum_of(*checksum_of(field.def.role), packet.first(field.byte), packet.subspan(field.byte + field.bytes));
}

// Judges the packet's number, and counts the lost ones before it.
PacketFault take_sequence(const ByteLayout& layout, std::span<const std::byte> packet, PacketState& state) noexcept {
  const PlacedField& field = layout.fields[*layout.sequence];
  const std::uint64_t mask = mask_of(field.bits), number = read_bits(layout, field, packet);
  if (state.has_sequence) {
    const std::uint64_t ahead = (number - state.sequence) & mask;
    if (ahead == 0) return PacketFault::repeated;
    const bool continues_refused = state.has_refused_sequence && number == ((state.refused_sequence + 1) & mask);
    const bool is_next = ahead - 1 <= layout.most_lost && ahead <= mask / 2 + 1;
    if (!is_next && !continues_refused) {
      state.refused_sequence = number;
      state.has_refused_sequence = true;
      return PacketFault::out_of_sequence;
    }
    is_next ? state.counts.lost += ahead - 1 : ++state.counts.jumps;
  }
  state.sequence = number;
  state.has_sequence = true;
  state.has_refused_sequence = false;
  return PacketFault::none;
}

PacketFault find_fault(const ByteLayout& layout, std::span<const std::byte> packet, PacketState& state) noexcept {
  if (packet.size() < layout.size) return PacketFault::too_short;
  if (packet.size() > layout.size) return PacketFault::too_long;
  if (layout.checksum &&
      read_bits(layout, layout.fields[*layout.checksum], packet) != checksum_of_packet(layout, packet)) {
    return PacketFault::bad_checksum;
  }
  if (layout.sequence) {
    if (const PacketFault fault = take_sequence(layout, packet, state); fault != PacketFault::none) return fault;
  }
  return PacketFault::none;
}

}  // namespace

std::string_view text_of(PacketFault fault) noexcept {
  switch (fault) {
    case PacketFault::none:
      return "used";
    case PacketFault::too_short:
      return "too short";
    case PacketFault::too_long:
      return "too long";
    case PacketFault::bad_checksum:
      return "wrong checksum";
    case PacketFault::repeated:
      return "repeated";
    case PacketFault::out_of_sequence:
      return "out of sequence";
    case PacketFault::not_finite:
      return "not finite";
    case PacketFault::number_of_faults:
      break;
  }
  return "";
}

PacketFault decode(const ByteLayout& layout, std::span<const std::byte> packet, PacketState& state,
                   std::span<double> values) noexcept {
  SLEW_ASSERT(values.size() == layout.values.size());
  PacketFault fault = find_fault(layout, packet, state);
  const auto value_of = [&](std::size_t i) {
    const PlacedField& field = layout.fields[layout.values[i]];
    return field.def.scale * raw_of(field, read_bits(layout, field, packet)) + field.def.offset;
  };
  for (std::size_t i = 0; i < values.size() && fault == PacketFault::none; ++i) {
    if (!std::isfinite(value_of(i))) fault = PacketFault::not_finite;
  }
  if (fault != PacketFault::none) {
    ++state.counts.refused[static_cast<std::size_t>(fault)];
    return fault;
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = value_of(i);
  ++state.counts.used;
  return PacketFault::none;
}

PacketFault encode(const ByteLayout& layout, std::span<const double> values, PacketState& state,
                   std::span<std::byte> packet) noexcept {
  SLEW_ASSERT(values.size() == layout.values.size() && packet.size() == layout.size);
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) {
    ++state.counts.refused[static_cast<std::size_t>(PacketFault::not_finite)];
    return PacketFault::not_finite;
  }
  std::fill(packet.begin(), packet.end(), std::byte{0});
  const auto put = [&](const PlacedField& field, std::uint64_t bits) {
    const auto bytes = packet.subspan(field.byte, field.bytes);
    write_number(layout.byte_order, read_number(layout.byte_order, bytes) | (bits << field.bit), bytes);
  };
  for (std::size_t i = 0; i < values.size(); ++i) {
    const PlacedField& field = layout.fields[layout.values[i]];
    const double allowed = std::clamp(values[i], field.def.lowest, field.def.highest);
    double raw = (allowed - field.def.offset) / field.def.scale;
    if (field.type != ByteType::float32 && field.type != ByteType::float64) raw = std::nearbyint(raw);
    const double sent = std::clamp(raw, field.least, field.most);
    if (allowed != values[i] || sent != raw) ++state.counts.held;
    put(field, bits_of_raw(field, sent));
  }
  if (layout.sequence) {
    const PlacedField& field = layout.fields[*layout.sequence];
    put(field, state.sequence & mask_of(field.bits));
    ++state.sequence;
  }
  if (layout.checksum) put(layout.fields[*layout.checksum], checksum_of_packet(layout, packet));
  ++state.counts.used;
  return PacketFault::none;
}

}  // namespace slew::devices
