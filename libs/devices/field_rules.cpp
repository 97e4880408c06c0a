// SPDX-License-Identifier: Apache-2.0
#include "devices/field_rules.h"

#include <fmt/format.h>

#include <algorithm>

namespace slew::devices {
namespace {

constexpr std::size_t kLongestIdentifier = 63;

// Field::member takes the Def's address without const; it is only read here.
template <typename T>
const T& member(const Field& row, const void* def) {
  return *static_cast<const T*>(row.member(const_cast<void*>(def)));
}

std::string range_text(const Field& row) {
  const Range& range = row.range;
  return fmt::format("a value in {}{:g}, {:g}{} {}", range.min_is_open ? '(' : '[', range.min, range.max,
                     range.max_is_open ? ')' : ']', info(row.dimension).si_unit);
}

}  // namespace

bool is_identifier(std::string_view name) noexcept {
  const auto is_letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && name.size() <= kLongestIdentifier && is_letter(name[0]) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || is_digit(c); });
}

void check_fields(std::string_view path, const void* def, std::span<const Field> fields, Problems& problems) {
  for (const Field& row : fields) {
    const std::string key = fmt::format("{}.{}", path, row.key);
    const auto check = [&](double value) {
      if (!row.range.contains(value)) {
        problems.push_back({key, fmt::format("{:g} is out of range", value), range_text(row), ""});
      }
    };
    switch (row.type) {
      case FieldType::number:
        check(member<double>(row, def));
        break;
      case FieldType::integer:
        check(static_cast<double>(member<std::int64_t>(row, def)));
        break;
      case FieldType::triple:
        for (const double value : member<Triple>(row, def)) check(value);
        break;
      case FieldType::triples:
        for (const Triple& triple : member<std::vector<Triple>>(row, def)) {
          for (const double value : triple) check(value);
        }
        break;
      case FieldType::numbers:
        for (const double value : member<std::vector<double>>(row, def)) check(value);
        break;
      case FieldType::text:
        if (row.presence == Presence::required && member<std::string>(row, def).empty()) {
          problems.push_back({key, "the text is missing", std::string(row.doc), ""});
        }
        break;
      case FieldType::boolean:
      case FieldType::table:
      case FieldType::texts:
      case FieldType::choice:
        break;
    }
  }
}

}  // namespace slew::devices
