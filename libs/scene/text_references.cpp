// SPDX-License-Identifier: Apache-2.0
#include "scene/text_references.h"

#include <algorithm>
#include <span>
#include <utility>

#include "scene/element_table.h"
#include "scene/sections.h"

namespace slew::scene {
namespace {

class ReferenceSearch {
 public:
  explicit ReferenceSearch(std::string_view name) : name_(name) {}

  std::vector<TextReference> in(const Node& root) {
    in_sections(root, "");
    for (const SingleTable& table : single_tables()) {
      if (const Node::Entry* section = root.find(table.section)) in_fields(section->value, table.fields, section->key);
    }
    in_script(root);
    in_keys_of(root.find(kStartKey));
    if (const Node::Entry* payload = root.find(kPayloadKey)) in_texts(payload->value, payload->key);
    in_templates(root.find(kTemplatesKey));
    for (const std::string_view key : {kIncludeKey, kWithoutKey, kParametersKey, kInstancesKey}) {
      if (const Node::Entry* found = root.find(key)) in_texts(found->value, found->key);
    }
    if (const Node::Entry* groups = root.find(kGroupsKey)) {
      for (const Node::Entry& group : groups->value.entries) in_group(group);
    }
    return std::move(found_);
  }

 private:
  void in_sections(const Node& root, const std::string& prefix) {
    for (const std::string_view section : element_sections()) {
      const Node::Entry* found = root.find(section);
      if (found == nullptr) continue;
      for (const Node::Entry& element : found->value.entries) {
        if (!prefix.empty() || element.key != name_) in_element(section, element, prefix + element.key);
      }
    }
  }

  void in_element(std::string_view section, const Node::Entry& element, const std::string& path) {
    if (const ElementTable* table = find_element_table(section, element.value)) {
      in_fields(element.value, table->fields, path);
      for (const ListTable& list : table->lists) {
        const Node::Entry* rows = element.value.find(list.key);
        if (rows == nullptr) continue;
        for (std::size_t i = 0; i < rows->value.items.size(); ++i)
          in_fields(rows->value.items[i], list.fields, path + "." + rows->key + "[" + std::to_string(i) + "]");
      }
      return;
    }
    // its type comes from a template
    in_fields_of_any(section, element.value, path);
  }

  void in_fields(const Node& map, std::span<const Field> fields, const std::string& path) {
    for (const Node::Entry& entry : map.entries) {
      if (names_elements(entry.key, fields)) in_texts(entry.value, path + "." + entry.key);
    }
  }

  // section: empty: any
  void in_fields_of_any(std::string_view section, const Node& map, const std::string& path) {
    for (const Node::Entry& entry : map.entries) {
      const bool is_naming = std::ranges::any_of(element_tables(), [&](const ElementTable& table) {
        return (section.empty() || table.section == section) && names_elements(entry.key, table.fields);
      });
      if (is_naming) in_texts(entry.value, path + "." + entry.key);
    }
  }

  void in_templates(const Node::Entry* templates) {
    if (templates == nullptr) return;
    for (const Node::Entry& one : templates->value.entries)
      in_fields_of_any("", one.value, templates->key + "." + one.key);
  }

  // A group names its own elements first.
  void in_group(const Node::Entry& group) {
    for (const std::string_view section : element_sections()) {
      const Node::Entry* found = group.value.find(section);
      if (found != nullptr && found->value.find(name_) != nullptr) return;
    }
    in_sections(group.value, "groups." + group.key + ".");
    in_templates(group.value.find(kTemplatesKey));
    if (const Node::Entry* instances = group.value.find(kInstancesKey)) in_texts(instances->value, instances->key);
  }

  void in_script(const Node& root) {
    const Node::Entry* script = root.find("script");
    if (script == nullptr) return;
    in_keys_of(script->value.find("inputs"));
    for (const std::string_view key : {"parameters", "columns"}) {
      if (const Node::Entry* found = script->value.find(key)) in_texts(found->value, "script." + found->key);
    }
  }

  void in_keys_of(const Node::Entry* map) {
    if (map == nullptr) return;
    for (const Node::Entry& entry : map->value.entries) {
      if (entry.key == name_) found_.push_back({map->key + "." + entry.key, nullptr, &entry});
    }
  }

  void in_texts(const Node& node, const std::string& path) {
    for (const Node& item : node.items) in_texts(item, path);
    for (const Node::Entry& entry : node.entries) in_texts(entry.value, path + "." + entry.key);
    if (node.kind != Node::Kind::scalar || !node.text.starts_with(name_)) return;
    if (node.text.size() == name_.size() || node.text[name_.size()] == '.') found_.push_back({path, &node});
  }

  std::string_view name_;
  std::vector<TextReference> found_;
};

}  // namespace

std::vector<TextReference> references_to(const Node& root, std::string_view name) {
  return ReferenceSearch(name).in(root);
}

}  // namespace slew::scene
