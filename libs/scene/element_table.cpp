// SPDX-License-Identifier: Apache-2.0
#include "scene/element_table.h"

#include <algorithm>
#include <iterator>

namespace slew::scene {

const std::vector<std::string_view>& language_keys() {
  static const std::vector<std::string_view> keys = {kParametersKey, kTemplatesKey, kGroupsKey,
                                                     kInstancesKey,  kStartKey,     kPayloadKey};
  return keys;
}

const ElementTable* find_element_table(std::string_view section, const Node& element) {
  const Node::Entry* type = element.find("type");
  for (const ElementTable& table : element_tables()) {
    if (table.section != section) continue;
    const bool is_named = type != nullptr && type->value.kind == Node::Kind::scalar && type->value.text == table.type;
    if (table.type.empty() || is_named || (type == nullptr && table.is_default)) return &table;
  }
  return nullptr;
}

bool names_elements(std::string_view key, std::span<const Field> fields) {
  // keys whose texts begin with the name of a variable, "Cyl_Lift.force", or a pattern
  constexpr std::string_view kVariableKeys[] = {"variable", "variables", "condition", "conditions"};
  if (key.starts_with(kFrameKey) ||
      std::find(std::begin(kVariableKeys), std::end(kVariableKeys), key) != std::end(kVariableKeys))
    return true;
  const auto field = std::find_if(fields.begin(), fields.end(), [key](const Field& one) { return one.key == key; });
  if (field == fields.end()) return false;
  return !field->reference.empty() || field->type == FieldType::triple || field->type == FieldType::triples;
}

bool is_element_section(std::string_view name) {
  const auto& names = element_sections();
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace slew::scene
