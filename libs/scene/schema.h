// SPDX-License-Identifier: Apache-2.0
// The scene format as a JSON Schema and as text for readers, both from the field tables.
#pragma once

#include <string>
#include <string_view>

namespace slew::scene {

// JSON Schema (draft 2020-12) of a scene file, for editors and other programs. Only load_file checks dimensions of
// units, existing names and rules between fields.
[[nodiscard]] std::string json_schema();

// Markdown: an item for each field of each section and type, with unit, range, default and doc; what types have alike
// stands once (shared_keys.h).
[[nodiscard]] std::string field_reference();

// The same for descriptions of flexible bodies (flexible_model.h).
[[nodiscard]] std::string flexible_json_schema();
[[nodiscard]] std::string flexible_field_reference();

// The document with its part between the two markers replaced by field_reference(); empty when the markers are missing.
inline constexpr std::string_view kReferenceBegin = "<!-- fields: begin, written by scene_format -->\n";
inline constexpr std::string_view kReferenceEnd = "<!-- fields: end -->\n";
[[nodiscard]] std::string with_field_reference(const std::string& document);

}  // namespace slew::scene
