// SPDX-License-Identifier: Apache-2.0
#include "scene/renaming.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "scene/element_table.h"
#include "scene/name_pattern.h"
#include "scene/names.h"
#include "scene/sections.h"

namespace slew::scene {
namespace {

class Renaming {
 public:
  Renaming(const std::string& prefix, int level) : prefix_(prefix), level_(level) {}

  void rename(Node& tree) {
    for (const std::string_view section : element_sections()) {
      const Node::Entry* entry = tree.find(section);
      if (entry == nullptr) continue;
      for (const Node::Entry& element : entry->value.entries) names_.insert(element.key);
    }
    for (const std::string_view section : element_sections()) {
      Node::Entry* entry = tree.find(section);
      if (entry == nullptr) continue;
      for (Node::Entry& element : entry->value.entries) {
        rename_references(section, element.value);
        element.key = prefix_ + element.key;
      }
    }
    if (Node::Entry* payload = tree.find(kPayloadKey)) rename_texts(payload->value);
    if (Node::Entry* start = tree.find(kStartKey)) {
      for (Node::Entry& joint : start->value.entries) {
        if (names_.contains(joint.key)) joint.key = prefix_ + joint.key;
      }
    }
  }

 private:
  void rename_references(std::string_view section, Node& element) {
    const ElementTable* table = find_element_table(section, element);
    if (table == nullptr) return;
    rename_fields(table->fields, element);
    for (const ListTable& list : table->lists) {
      Node::Entry* rows = element.find(list.key);
      if (rows == nullptr) continue;
      for (Node& row : rows->value.items) rename_fields(list.fields, row);
    }
  }

  void rename_fields(std::span<const Field> fields, Node& map) {
    for (Node::Entry& entry : map.entries) {
      if (names_elements(entry.key, fields)) rename_texts(entry.value);
    }
  }

  void rename_texts(Node& node) {
    for (Node& item : node.items) rename_texts(item);
    if (node.kind != Node::Kind::scalar || node.level < level_) return;
    const std::string_view name = std::string_view(node.text).substr(0, node.text.find('.'));
    const bool is_own =
        names_.contains(name) ||
        (name.find_first_of("*?") != std::string_view::npos &&
         std::any_of(names_.begin(), names_.end(), [&](const std::string& own) { return fits_pattern(own, name); }));
    if (is_own) node.text = prefix_ + node.text;
  }

  const std::string& prefix_;
  const int level_;
  std::set<std::string, std::less<>> names_;
};

}  // namespace

void put_prefix(Node& tree, const std::string& prefix, int level) {
  Renaming(prefix, level).rename(tree);
}

}  // namespace slew::scene
