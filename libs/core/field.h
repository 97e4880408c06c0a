// SPDX-License-Identifier: Apache-2.0
// Field tables: one row for every member of a Def that a scene file may set.
//
// The table stands beside the Def in the physics library. The scene reader parses by it, `slewring schema` and the
// documentation print it, `param set` checks against it. A row binds to a member by pointer, so that a wrong name or
// type does not compile:
//
//   constexpr Field kBodyFields[] = {
//       field<&BodyDef::mass>("mass", {.dimension = Dimension::mass, .range = kPositive, .presence =
//       Presence::required,
//                                      .change = Change::live, .doc = "mass of the body"}),
//   };
//
// A Def that is composed of parts names the path to the member:
//     field<&SlewCylinderDef::common, &CylinderParameters::leak_flow>("leak_flow", {...})
//
// Member types: double, std::int64_t, bool, std::string (text or reference), Triple, Table, std::vector<double>,
// std::vector<std::string>, std::vector<Triple>, and any enum with underlying type int (with `choices`, whose order is
// the enum's).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/dimension.h"

namespace slew {

using Triple = std::array<double, 3>;              // x, y, z
using Table = std::vector<std::array<double, 2>>;  // argument, value; arguments increasing, see FieldOptions::has_jumps

enum class FieldType : std::uint8_t {
  number,
  integer,
  boolean,
  text,  // free text, or the name of an element when `reference` is not empty
  triple,
  triples,  // list of [x, y, z]
  table,    // list of [argument, value]; argument in `dimension`, value in `value_dimension`
  numbers,  // list of numbers
  texts,    // list of texts or references
  choice    // one of `choices`
};

enum class Presence : std::uint8_t { optional, required };
enum class Change : std::uint8_t { restart, live };

// Allowed interval; a NaN never lies in it.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_is_open = true;
  bool max_is_open = true;
  [[nodiscard]] constexpr bool contains(double x) const noexcept {
    return (min_is_open ? x > min : x >= min) && (max_is_open ? x < max : x <= max);
  }
};

inline constexpr Range kFinite{};
inline constexpr Range kPositive{.min = 0};
inline constexpr Range kNotNegative{.min = 0, .min_is_open = false};
inline constexpr Range kFraction{.min = 0, .max = 1, .min_is_open = false, .max_is_open = false};
inline constexpr Range kFractionAboveZero{.min = 0, .max = 1, .max_is_open = false};

// Condition for reading a field: a choice made by another field of the same table.
struct ReadBy {
  // error_in_files: an override only warns, since sweeps over choices carry such settings along
  enum class Otherwise : std::uint8_t { error, error_in_files, warning };

  std::string_view key;   // key of the other field
  std::string_view what;  // values of the other field that read this one, for messages: "rk4 or implicit_euler"
  bool (*holds)(const void* def) noexcept = nullptr;
  Otherwise otherwise = Otherwise::error;  // treatment of a field that is stated and not read
};

struct FieldOptions {
  Dimension dimension = Dimension::none;
  Dimension value_dimension = Dimension::none;  // dimension of a table's values
  Range range = kFinite;                        // range of the number, of each element, or of a table's values
  Presence presence = Presence::optional;
  Change change = Change::restart;
  double ramp = 0;                  // s: a live change is spread over this time by default
  std::string_view reference = {};  // kind of element the text must name: "body", "force", "component or force", ...
  std::span<const std::string_view> choices = {};
  bool has_jumps = false;                // two points of a table may have the same argument
  std::span<const ReadBy> read_by = {};  // conditions that must all hold; empty: always read
  std::string_view doc = {};
};

// The member is one of the values.
template <auto Member, auto... Values>
[[nodiscard]] constexpr ReadBy read_by(std::string_view key, std::string_view what,
                                       ReadBy::Otherwise otherwise = ReadBy::Otherwise::error);
// The member is set: a text or table that is not empty, a number that is not 0.
template <auto Member>
[[nodiscard]] constexpr ReadBy read_by_set(std::string_view key, std::string_view what);

struct Field : FieldOptions {
  std::string_view key;
  FieldType type = FieldType::number;
  void* (*member)(void* def) = nullptr;  // address of the member (not for choices)
  void (*set_choice)(void* def, int index) = nullptr;
  int (*get_choice)(const void* def) = nullptr;
};

namespace detail {

template <typename>
struct MemberOf;
template <typename Class, typename Value>
struct MemberOf<Value Class::*> {
  using class_type = Class;
};

template <typename Value>
constexpr FieldType field_type_of() {
  if constexpr (std::is_same_v<Value, double>) {
    return FieldType::number;
  } else if constexpr (std::is_same_v<Value, std::int64_t>) {
    return FieldType::integer;
  } else if constexpr (std::is_same_v<Value, bool>) {
    return FieldType::boolean;
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return FieldType::text;
  } else if constexpr (std::is_same_v<Value, Triple>) {
    return FieldType::triple;
  } else if constexpr (std::is_same_v<Value, std::vector<Triple>>) {
    return FieldType::triples;
  } else if constexpr (std::is_same_v<Value, Table>) {
    return FieldType::table;
  } else if constexpr (std::is_same_v<Value, std::vector<double>>) {
    return FieldType::numbers;
  } else if constexpr (std::is_same_v<Value, std::vector<std::string>>) {
    return FieldType::texts;
  } else {
    static_assert(std::is_enum_v<Value>, "a field's member must have one of the types listed in core/field.h");
    return FieldType::choice;
  }
}

// The member of a member ... of an object.
template <auto First, auto... Rest>
constexpr auto& member_at(auto& object) {
  if constexpr (sizeof...(Rest) == 0) {
    return object.*First;
  } else {
    return member_at<Rest...>(object.*First);
  }
}

}  // namespace detail

template <auto Member, auto... Values>
constexpr ReadBy read_by(std::string_view key, std::string_view what, ReadBy::Otherwise otherwise) {
  using Class = typename detail::MemberOf<decltype(Member)>::class_type;
  return {key, what,
          [](const void* def) noexcept { return ((static_cast<const Class*>(def)->*Member == Values) || ...); },
          otherwise};
}

template <auto Member>
constexpr ReadBy read_by_set(std::string_view key, std::string_view what) {
  using Class = typename detail::MemberOf<decltype(Member)>::class_type;
  return {key, what, [](const void* def) noexcept {
            const auto& value = static_cast<const Class*>(def)->*Member;
            if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>) {
              return value != 0;
            } else {
              return !value.empty();
            }
          }};
}

template <auto First, auto... Rest>
[[nodiscard]] constexpr Field field(std::string_view key, const FieldOptions& options) {
  using Class = typename detail::MemberOf<decltype(First)>::class_type;
  using Value = std::remove_reference_t<decltype(detail::member_at<First, Rest...>(std::declval<Class&>()))>;
  Field row;
  static_cast<FieldOptions&>(row) = options;
  row.key = key;
  row.type = detail::field_type_of<Value>();
  row.member = [](void* def) -> void* { return &detail::member_at<First, Rest...>(*static_cast<Class*>(def)); };
  if constexpr (std::is_enum_v<Value>) {
    row.set_choice = [](void* def, int index) {
      detail::member_at<First, Rest...>(*static_cast<Class*>(def)) = static_cast<Value>(index);
    };
    row.get_choice = [](const void* def) {
      return static_cast<int>(detail::member_at<First, Rest...>(*static_cast<const Class*>(def)));
    };
  }
  return row;
}

}  // namespace slew
