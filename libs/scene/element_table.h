// SPDX-License-Identifier: Apache-2.0
// Keys of a scene that the loader resolves before the sections are read, and the table of an element by its type.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "scene/sections.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

inline constexpr std::string_view kIncludeKey = "include";
inline constexpr std::string_view kWithoutKey = "without";  // elements of included files that are left out
inline constexpr std::string_view kParametersKey = "parameters";
inline constexpr std::string_view kTemplatesKey = "templates";
inline constexpr std::string_view kGroupsKey = "groups";
inline constexpr std::string_view kInstancesKey = "instances";
inline constexpr std::string_view kStartKey = "start";
inline constexpr std::string_view kPayloadKey = "payload";
inline constexpr std::string_view kUseKey = "use";        // of an element: templates under it
inline constexpr std::string_view kPointsKey = "points";  // of a body: named points
inline constexpr std::string_view kFrameKey = "frame";    // frame1, frame2: a named point with its orientation

// Keys beside top_level_keys(), in the order of the schema.
[[nodiscard]] const std::vector<std::string_view>& language_keys();

// The table of an element's type; null: the type is missing or unknown.
[[nodiscard]] const ElementTable* find_element_table(std::string_view section, const Node& element);

// The texts of this key name elements: a field with a reference, a named point ("Boom.tip"), a variable or condition
// ("Cyl.force"). fields: those of the element's type.
[[nodiscard]] bool names_elements(std::string_view key, std::span<const Field> fields);

[[nodiscard]] bool is_element_section(std::string_view name);

}  // namespace slew::scene
