// SPDX-License-Identifier: Apache-2.0
#include "scene/element_table.h"

#include <algorithm>

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

bool is_element_section(std::string_view name) {
  const auto& names = element_sections();
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace slew::scene
