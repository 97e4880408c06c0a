// SPDX-License-Identifier: Apache-2.0
// A key as the reference of the format shows it (schema.h):  - `step` (0.001 s, 1e-5..0.02): communication step
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"

namespace slew::scene {

struct FieldEntry {
  std::string_view key;
  std::string kind;   // "three", "integer", "a body", "**real** or free"; empty for a number with a unit or a range
  std::string unit;   // SI unit; empty without one
  std::string range;  // ">=0, <1"; empty for any number
  std::string value;  // default, "required", "none", or empty
  bool is_live = false;
  bool is_port = false;  // names a volume
  std::string meaning;
};

// `defaults`: a Def with its default values.
[[nodiscard]] FieldEntry entry_of(const Field& field, void* defaults);
[[nodiscard]] std::vector<FieldEntry> entries_of(std::span<const Field> fields, void* defaults);

// "0.001 s, 1e-5..0.02"; the default alone, "0.001 s, live".
[[nodiscard]] std::string facts_text(const FieldEntry& entry);
[[nodiscard]] std::string default_text(const FieldEntry& entry);

// Markdown: an item for each key. Keys that are alike in all else share an item, ports have one together.
[[nodiscard]] std::string items_of(std::span<const FieldEntry> entries);

// "`a`, `b`"
[[nodiscard]] std::string joined_keys(std::span<const std::string> keys);

// Markdown with its prose and its items in lines of 120 characters, broken at spaces outside of code spans.
[[nodiscard]] std::string with_wrapped_prose(std::string_view text);

}  // namespace slew::scene
