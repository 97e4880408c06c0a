// SPDX-License-Identifier: Apache-2.0
// Layout of a packet as a C struct: fields with types, in one byte order, packed as `#pragma pack` does.
//
// A field lies at the next multiple of min(its size, packing); the whole is rounded up to the largest of these
// alignments, or to `size` when that is stated. A field with `of` has no bytes of its own: it takes bits of an integer
// field, which then has no value itself. Bit 0 is the integer's least significant bit, in either byte order.
//
//   value = scale * raw + offset
//
// The sequence counts packets modulo 2^bits. The checksum covers all bytes of the packet but its own, in their order.
// Integers of 64 bits pass through double: beyond 2^53 they are rounded.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "devices/packet_checksum.h"

namespace slew::devices {

enum class ByteType : int {
  boolean,  // one byte, 0 or 1; any other number is taken as 1
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64
};
inline constexpr std::string_view kByteTypeNames[] = {"bool",   "int8",  "uint8",  "int16",   "uint16", "int32",
                                                      "uint32", "int64", "uint64", "float32", "float64"};

enum class ByteOrder : int { little, big };
inline constexpr std::string_view kByteOrderNames[] = {"little", "big"};

enum class FieldRole : int { value, sequence, sum8, xor8, crc16_ccitt, crc32 };
inline constexpr std::string_view kFieldRoleNames[] = {"value", "sequence", "sum8", "xor8", "crc16_ccitt", "crc32"};

inline constexpr std::size_t kMaxLayoutBytes = 1472;  // one Ethernet frame: a packet in pieces is lost with any of them

struct LayoutFieldDef {
  std::string name;
  ByteType type = ByteType::float64;
  FieldRole role = FieldRole::value;
  std::string of{};       // integer field of which this one takes bits
  std::int64_t bit = 0;   // lowest of them
  std::int64_t bits = 1;  // their number; two's complement when the integer is signed
  double scale = 1;       // value of one count ...
  double offset = 0;      // ... and of 0 counts, in `unit`
  std::string unit{};     // for people: header and note
  double lowest = -std::numeric_limits<double>::infinity();  // sent values are held at these bounds
  double highest = std::numeric_limits<double>::infinity();
  std::string input{};     // of a session, which a received value moves
  std::string variable{};  // of a session, whose value is sent
  std::string output{};    // of a scene, whose state is sent
};

struct LayoutDef {
  std::string name;
  ByteOrder byte_order = ByteOrder::little;
  std::int64_t packing = 1;    // 1, 4 or 8
  std::int64_t size = 0;       // bytes; 0: as the fields need
  std::int64_t most_lost = 0;  // lost packets in a row up to which the next one is used
  std::vector<LayoutFieldDef> fields{};
};

[[nodiscard]] std::span<const Field> layout_fields() noexcept;        // of LayoutDef, without `fields`
[[nodiscard]] std::span<const Field> layout_field_fields() noexcept;  // of LayoutFieldDef

// Appends every broken rule.
void validate(const LayoutDef& def, Problems& problems);

// A field with its place.
struct PlacedField {
  LayoutFieldDef def;
  std::size_t byte = 0;        // offset of the field, or of the integer whose bits it takes
  std::size_t bytes = 0;       // size of that
  ByteType type{};             // of that
  unsigned bit = 0;            // lowest bit in it ...
  unsigned bits = 0;           // ... and their number: all for a field of its own
  bool has_value = false;      // in the list of values; not sequence, checksum and integers divided into bits
  double least = 0, most = 0;  // bounds of raw numbers
};

// Immutable once built.
struct ByteLayout {
  std::string name;
  ByteOrder byte_order = ByteOrder::little;
  std::size_t size = 0;  // bytes
  std::size_t packing = 1;
  std::uint64_t most_lost = 0;
  std::vector<PlacedField> fields;                // in the definition's order
  std::vector<std::size_t> values;                // indices of the fields with a value, in the order of their values
  std::optional<std::size_t> sequence, checksum;  // their fields
};

// Pre-condition: validate() finds no problem; throws Failure (bad_input) with the first one otherwise.
[[nodiscard]] ByteLayout build(const LayoutDef& def);

[[nodiscard]] std::size_t size_of(ByteType type) noexcept;
[[nodiscard]] bool is_integer(ByteType type) noexcept;
[[nodiscard]] bool is_signed(ByteType type) noexcept;
[[nodiscard]] std::optional<Checksum> checksum_of(FieldRole role) noexcept;

}  // namespace slew::devices
