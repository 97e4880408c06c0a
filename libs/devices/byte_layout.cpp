// SPDX-License-Identifier: Apache-2.0
#include "devices/byte_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/failure.h"
#include "core/suggestion.h"
#include "devices/field_rules.h"
#include "devices/raw_bits.h"

namespace slew::devices {
namespace {

constexpr Field kLayoutFields[] = {
    field<&LayoutDef::byte_order>("byte_order", {.choices = kByteOrderNames, .doc = "order of a number's bytes"}),
    field<&LayoutDef::packing>("packing", {.range = {.min = 1, .max = 8, .min_is_open = false, .max_is_open = false},
                                           .doc = "largest alignment of a field: 1 (no gaps), 4 or 8"}),
    field<&LayoutDef::size>("size",
                            {.range = {.min = 0, .max = kMaxLayoutBytes, .min_is_open = false, .max_is_open = false},
                             .doc = "bytes of the packet; 0: as its fields need"}),
    field<&LayoutDef::most_lost>("most_lost",
                                 {.range = {.min = 0, .max = 1e6, .min_is_open = false, .max_is_open = false},
                                  .doc = "lost packets in a row after which the next one is still used; after more it "
                                         "is refused and begins the sequence again"}),
};

constexpr Field kLayoutFieldFields[] = {
    field<&LayoutFieldDef::name>(
        "name", {.presence = Presence::required, .doc = "name in the generated C header: letters, digits and _"}),
    field<&LayoutFieldDef::type>("as", {.choices = kByteTypeNames, .doc = "type of the field's bytes"}),
    field<&LayoutFieldDef::role>(
        "is", {.choices = kFieldRoleNames,
               .doc = "value; sequence: an unsigned integer that counts the packets; sum8, xor8 (uint8), crc16_ccitt "
                      "(uint16, start 0xFFFF), crc32 (uint32): checksum over all other bytes"}),
    field<&LayoutFieldDef::of>("of", {.doc = "integer field of the layout of which this field takes bits"}),
    field<&LayoutFieldDef::bit>("bit", {.range = {.min = 0, .max = 63, .min_is_open = false, .max_is_open = false},
                                        .doc = "lowest bit in the integer; 0 is the least significant one"}),
    field<&LayoutFieldDef::bits>("bits", {.range = {.min = 1, .max = 64, .min_is_open = false, .max_is_open = false},
                                          .doc = "number of bits; two's complement when the integer is signed"}),
    field<&LayoutFieldDef::scale>("scale", {.doc = "value = scale * raw + offset; not 0"}),
    field<&LayoutFieldDef::offset>("offset", {.doc = "value of a raw 0"}),
    field<&LayoutFieldDef::unit>("unit", {.doc = "unit of the value for header and note; of a variable its SI unit"}),
    field<&LayoutFieldDef::lowest>("lowest", {.range = {.min_is_open = false}, .doc = "lowest value that is sent"}),
    field<&LayoutFieldDef::highest>("highest", {.range = {.max_is_open = false}, .doc = "highest value that is sent"}),
    field<&LayoutFieldDef::input>(
        "input", {.reference = "input", .doc = "received: input that the value moves (-1 to 1, digital 0 or 1)"}),
    field<&LayoutFieldDef::variable>("variable", {.doc = "sent: variable of the session, as Cyl_Lift.force, in SI"}),
    field<&LayoutFieldDef::output>(
        "output", {.reference = "output", .doc = "sent: output of the scene; without variable and output 0 is sent"}),
};

// Words that a struct in the generated header cannot have: those of C23 and C++20 with their alternative tokens, the
// types that the header uses, and names that compilers or the header define.
constexpr std::string_view kReservedWords[] = {"NULL",
                                               "alignas",
                                               "alignof",
                                               "and",
                                               "and_eq",
                                               "asm",
                                               "auto",
                                               "bitand",
                                               "bitor",
                                               "bool",
                                               "break",
                                               "case",
                                               "catch",
                                               "char",
                                               "char16_t",
                                               "char32_t",
                                               "char8_t",
                                               "class",
                                               "co_await",
                                               "co_return",
                                               "co_yield",
                                               "compl",
                                               "concept",
                                               "const",
                                               "const_cast",
                                               "consteval",
                                               "constexpr",
                                               "constinit",
                                               "continue",
                                               "contract_assert",
                                               "decltype",
                                               "default",
                                               "delete",
                                               "do",
                                               "double",
                                               "dynamic_cast",
                                               "else",
                                               "enum",
                                               "explicit",
                                               "export",
                                               "extern",
                                               "false",
                                               "float",
                                               "for",
                                               "friend",
                                               "goto",
                                               "i386",
                                               "if",
                                               "inline",
                                               "int",
                                               "int16_t",
                                               "int32_t",
                                               "int64_t",
                                               "int8_t",
                                               "linux",
                                               "long",
                                               "mutable",
                                               "namespace",
                                               "new",
                                               "noexcept",
                                               "not",
                                               "not_eq",
                                               "nullptr",
                                               "operator",
                                               "or",
                                               "or_eq",
                                               "private",
                                               "protected",
                                               "public",
                                               "register",
                                               "reinterpret_cast",
                                               "requires",
                                               "restrict",
                                               "return",
                                               "short",
                                               "signed",
                                               "sizeof",
                                               "slewring_unused",
                                               "static",
                                               "static_assert",
                                               "static_cast",
                                               "struct",
                                               "switch",
                                               "template",
                                               "this",
                                               "thread_local",
                                               "throw",
                                               "true",
                                               "try",
                                               "typedef",
                                               "typeid",
                                               "typename",
                                               "typeof",
                                               "typeof_unqual",
                                               "uint16_t",
                                               "uint32_t",
                                               "uint64_t",
                                               "uint8_t",
                                               "union",
                                               "unix",
                                               "unsigned",
                                               "using",
                                               "virtual",
                                               "void",
                                               "volatile",
                                               "wchar_t",
                                               "while",
                                               "xor",
                                               "xor_eq"};

bool is_reserved(std::string_view name) {
  // names of the compiler's own, _Bool and __int128 among them
  const bool is_of_compiler =
      name.starts_with("__") || (name.size() > 1 && name[0] == '_' && name[1] >= 'A' && name[1] <= 'Z');
  return is_of_compiler || std::ranges::find(kReservedWords, name) != std::end(kReservedWords);
}

const LayoutFieldDef* find_field(const LayoutDef& def, std::string_view name) {
  const auto found = std::find_if(def.fields.begin(), def.fields.end(), [&](const auto& f) { return f.name == name; });
  return found == def.fields.end() ? nullptr : &*found;
}

unsigned bits_of(ByteType type) {
  return static_cast<unsigned>(8 * size_of(type));
}

ByteType type_of_checksum(Checksum kind) {
  switch (checksum_size(kind)) {
    case 1:
      return ByteType::uint8;
    case 2:
      return ByteType::uint16;
    default:
      return ByteType::uint32;
  }
}

void set_bounds(PlacedField& field) {
  if (field.type == ByteType::boolean) {
    field.least = 0, field.most = 1;
  } else if (!is_integer(field.type)) {
    field.most = field.type == ByteType::float32 ? static_cast<double>(std::numeric_limits<float>::max())
                                                 : std::numeric_limits<double>::max();
    field.least = -field.most;
  } else {
    field.least = least_number(field.bits, is_signed(field.type));
    field.most = greatest_number(field.bits, is_signed(field.type));
  }
}

void check_bits(const LayoutDef& def, const LayoutFieldDef& f, const std::string& path, Problems& problems) {
  const LayoutFieldDef* whole = find_field(def, f.of);
  if (whole == nullptr) {
    std::vector<std::string_view> names;
    for (const LayoutFieldDef& other : def.fields) names.push_back(other.name);
    problems.push_back({path + ".of", fmt::format("there is no field '{}'", f.of), "an integer field of the layout",
                        closest(f.of, names)});
    return;
  }
  if (!is_integer(whole->type) || whole->role != FieldRole::value || !whole->of.empty()) {
    problems.push_back({path + ".of", fmt::format("'{}' is no integer that can be divided", f.of),
                        "an integer field, not a sequence, a checksum or bits itself", ""});
    return;
  }
  if (f.role != FieldRole::value) {
    problems.push_back({path + ".is", "bits of an integer are no sequence or checksum", "value", ""});
  }
  if (f.bit < 0 || f.bits < 1 || f.bit + f.bits > static_cast<std::int64_t>(bits_of(whole->type))) {
    problems.push_back(
        {path + ".bits",
         fmt::format("bits {} to {} are not in '{}' of {} bits", f.bit, f.bit + f.bits - 1, f.of, bits_of(whole->type)),
         "bits within the integer", ""});
  }
  for (const LayoutFieldDef& other : def.fields) {
    if (&other == &f) break;
    if (other.of == f.of && other.bit < f.bit + f.bits && f.bit < other.bit + other.bits) {
      problems.push_back({path + ".bit", fmt::format("its bits overlap those of '{}'", other.name), "", ""});
    }
  }
}

void check_field(const LayoutDef& def, const LayoutFieldDef& f, Problems& problems) {
  const std::string path = def.name + "." + f.name;
  check_fields(path, &f, layout_field_fields(), problems);
  if (!is_identifier(f.name) || is_reserved(f.name)) {
    problems.push_back(
        {path, fmt::format("'{}' is no name for a field", f.name), "letters, digits and _, no word of C or C++", ""});
  }
  if (!(f.scale != 0)) problems.push_back({path + ".scale", "0 maps every value to one number", "not 0", ""});
  if (f.lowest > f.highest) {
    problems.push_back({path + ".lowest", fmt::format("{:g} is above highest, {:g}", f.lowest, f.highest), "", ""});
  }
  if (!f.of.empty()) check_bits(def, f, path, problems);
  if (f.role == FieldRole::sequence && (!is_integer(f.type) || is_signed(f.type))) {
    problems.push_back({path + ".as", "a sequence is an unsigned integer", "uint8, uint16, uint32 or uint64", ""});
  }
  if (const auto kind = checksum_of(f.role); kind && f.type != type_of_checksum(*kind)) {
    problems.push_back({path + ".as", "the type does not fit the checksum",
                        std::string(kByteTypeNames[static_cast<std::size_t>(type_of_checksum(*kind))]), ""});
  }
}

std::size_t rounded_up(std::size_t bytes, std::size_t alignment) {
  return (bytes + alignment - 1) / alignment * alignment;
}

// Places of the fields of their own, and the size that they need.
std::size_t place_fields(const LayoutDef& def, std::vector<PlacedField>& fields) {
  std::size_t end = 0, alignment = 1;
  for (const LayoutFieldDef& f : def.fields) {
    PlacedField placed;
    placed.def = f;
    if (f.of.empty()) {
      const std::size_t own = std::min(size_of(f.type), static_cast<std::size_t>(def.packing));
      placed.type = f.type, placed.bytes = size_of(f.type), placed.bits = bits_of(f.type);
      placed.byte = rounded_up(end, own);
      end = placed.byte + placed.bytes;
      alignment = std::max(alignment, own);
    }
    fields.push_back(placed);
  }
  return rounded_up(end, alignment);
}

bool is_packing(std::int64_t packing) {
  return packing == 1 || packing == 4 || packing == 8;
}

}  // namespace

std::span<const Field> layout_fields() noexcept {
  return kLayoutFields;
}
std::span<const Field> layout_field_fields() noexcept {
  return kLayoutFieldFields;
}

std::size_t size_of(ByteType type) noexcept {
  switch (type) {
    case ByteType::boolean:
    case ByteType::int8:
    case ByteType::uint8:
      return 1;
    case ByteType::int16:
    case ByteType::uint16:
      return 2;
    case ByteType::int32:
    case ByteType::uint32:
    case ByteType::float32:
      return 4;
    case ByteType::int64:
    case ByteType::uint64:
    case ByteType::float64:
      break;
  }
  return 8;
}

bool is_integer(ByteType type) noexcept {
  return type != ByteType::boolean && type != ByteType::float32 && type != ByteType::float64;
}

bool is_signed(ByteType type) noexcept {
  return type == ByteType::int8 || type == ByteType::int16 || type == ByteType::int32 || type == ByteType::int64;
}

std::optional<Checksum> checksum_of(FieldRole role) noexcept {
  switch (role) {
    case FieldRole::sum8:
      return Checksum::sum8;
    case FieldRole::xor8:
      return Checksum::xor8;
    case FieldRole::crc16_ccitt:
      return Checksum::crc16_ccitt;
    case FieldRole::crc32:
      return Checksum::crc32;
    case FieldRole::value:
    case FieldRole::sequence:
      break;
  }
  return std::nullopt;
}

void validate(const LayoutDef& def, Problems& problems) {
  check_fields(def.name, &def, layout_fields(), problems);
  if (!is_identifier(def.name) || is_reserved(def.name)) {
    problems.push_back({def.name, "this is no name for a layout", "letters, digits and _, no word of C or C++", ""});
  }
  if (!is_packing(def.packing)) {
    problems.push_back({def.name + ".packing", fmt::format("{} is no packing", def.packing), "1, 4 or 8", ""});
    return;
  }
  if (def.fields.empty()) problems.push_back({def.name + ".fields", "the layout has no field", "one or more", ""});
  int sequences = 0, checksums = 0;
  for (const LayoutFieldDef& f : def.fields) {
    check_field(def, f, problems);
    if (find_field(def, f.name) != &f) {
      problems.push_back({def.name + "." + f.name, "the name is used twice in the layout", "names that differ", ""});
    }
    if (f.role == FieldRole::sequence) ++sequences;
    if (checksum_of(f.role)) ++checksums;
  }
  if (sequences > 1 || checksums > 1) {
    problems.push_back(
        {def.name + ".fields", "the layout has two sequences or two checksums", "at most one of each", ""});
  }
  std::vector<PlacedField> fields;
  const std::size_t needed = place_fields(def, fields);
  if (needed > kMaxLayoutBytes) {
    problems.push_back({def.name + ".fields", fmt::format("the fields need {} bytes", needed),
                        fmt::format("at most {}, the content of one frame", kMaxLayoutBytes), ""});
  } else if (def.size != 0 && def.size < static_cast<std::int64_t>(needed)) {
    problems.push_back({def.name + ".size", fmt::format("the fields need {} bytes, not {}", needed, def.size),
                        fmt::format("{} or more", needed), ""});
  }
}

ByteLayout build(const LayoutDef& def) {
  Problems problems;
  validate(def, problems);
  if (!problems.empty()) throw Failure(ExitCode::bad_input, problems[0].path + ": " + problems[0].what);

  ByteLayout layout;
  layout.name = def.name;
  layout.byte_order = def.byte_order;
  layout.packing = static_cast<std::size_t>(def.packing);
  layout.most_lost = static_cast<std::uint64_t>(def.most_lost);
  layout.size = std::max(place_fields(def, layout.fields), static_cast<std::size_t>(def.size));
  const auto is_divided = [&](std::string_view name) {
    return std::any_of(def.fields.begin(), def.fields.end(), [&](const auto& f) { return f.of == name; });
  };
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    PlacedField& field = layout.fields[i];
    if (!field.def.of.empty()) {
      const auto whole = std::find_if(layout.fields.begin(), layout.fields.end(),
                                      [&](const PlacedField& other) { return other.def.name == field.def.of; });
      field.type = whole->type, field.byte = whole->byte, field.bytes = whole->bytes;
      field.bit = static_cast<unsigned>(field.def.bit), field.bits = static_cast<unsigned>(field.def.bits);
    }
    set_bounds(field);
    if (field.def.role == FieldRole::sequence) layout.sequence = i;
    if (checksum_of(field.def.role)) layout.checksum = i;
    field.has_value = field.def.role == FieldRole::value && !is_divided(field.def.name);
    if (field.has_value) layout.values.push_back(i);
  }
  return layout;
}

}  // namespace slew::devices
