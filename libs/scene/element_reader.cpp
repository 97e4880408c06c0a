// SPDX-License-Identifier: Apache-2.0
#include "scene/element_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/suggestion.h"
#include "scene/mesh_inertia.h"
#include "scene/sections.h"
#include "scene/shape_fields.h"
#include "scene/shape_inertia.h"

namespace slew::scene {
namespace {

constexpr std::string_view kTypeKey[] = {"type"};
constexpr std::size_t kMaxListRows = 1024;

}  // namespace

// A section that is one map of fields, or one of elements.
void ElementReader::read_section(std::string_view name) {
  const Node::Entry* section = root_.find(name);
  if (section == nullptr || !is_map(*section)) return;
  for (const SingleTable& table : single_tables()) {
    if (table.section != name) continue;
    read_fields(section->value, table.fields, table.def(scene_), section->key, section->mark, {}, context_);
    return;
  }
  report_duplicates(section->value, "", report_);
  for (const Node::Entry& element : section->value.entries) read_element(name, element);
}

bool ElementReader::is_map(const Node::Entry& section) {
  if (section.value.kind == Node::Kind::map) return true;
  report_.add(section.value.mark, section.key, {"is " + describe(section.value), "a map", ""});
  return false;
}

void ElementReader::read_element(std::string_view section, const Node::Entry& element) {
  places_.add(element.key, element.mark);
  if (element.value.kind != Node::Kind::map) {
    report_.add(element.value.mark, element.key, {"is " + describe(element.value), "a map", ""});
    return;
  }
  const ElementTable* table = table_of(section, element);
  if (table == nullptr) return;
  void* def = table->append(scene_, element.key);
  if (section == "bodies" && !table->is_default) return read_flexible_body(element, *table, def);
  if (section == "bodies" && takes_from_mesh(element.value)) {
    read_mesh_body(element, table->fields, load_context_, *static_cast<multibody::BodyDef*>(def), scene_, context_);
    return;
  }
  if (section == "bodies" && takes_from_shapes(element.value)) {
    read_shape_body(element, table->fields, *static_cast<multibody::BodyDef*>(def), scene_, context_);
    return;
  }
  std::vector<std::string_view> other_keys;
  if (!table->type.empty()) other_keys.push_back(kTypeKey[0]);
  for (const ListTable& list : table->lists) other_keys.push_back(list.key);
  read_fields(element.value, table->fields, def, element.key, element.mark, other_keys, context_);
  for (const ListTable& list : table->lists) read_list(element, list, def);
}

void ElementReader::read_list(const Node::Entry& element, const ListTable& list, void* def) {
  const Node::Entry* entry = element.value.find(list.key);
  if (entry == nullptr) return;
  const std::string path = fmt::format("{}.{}", element.key, list.key);
  places_.add(path, entry->value.mark);
  if (entry->value.kind != Node::Kind::sequence) {
    report_.add(entry->value.mark, path, {"is " + describe(entry->value), "a list of maps", ""});
    return;
  }
  if (entry->value.items.size() > kMaxListRows) {
    report_.add(
        entry->value.mark, path,
        {fmt::format("has {} entries", entry->value.items.size()), fmt::format("at most {}", kMaxListRows), ""});
    return;
  }
  for (std::size_t i = 0; i < entry->value.items.size(); ++i) {
    const Node& item = entry->value.items[i];
    const std::string row_path = fmt::format("{}[{}]", path, i);
    if (item.kind != Node::Kind::map) {
      report_.add(item.mark, row_path, {"is " + describe(item), "a map", ""});
      continue;
    }
    // problems that are found later name a row by its first field
    const Node::Entry* name = item.find(list.fields.front().key);
    const bool is_named = name != nullptr && name->value.kind == Node::Kind::scalar;
    if (is_named) {
      places_.add(fmt::format("{}.{}", path, name->value.text), item.mark);
      places_.add(fmt::format("{}.{}", element.key, name->value.text), item.mark);
    }
    read_fields(item, list.fields, list.append(def), row_path, item.mark, {}, context_);
  }
}

// The keys of a rigid body may stay, so that one line makes it flexible and back. They are read, and differences from
// the files give a warning (flexible_bodies.h); those of a mesh or of shapes are skipped.
void ElementReader::read_flexible_body(const Node::Entry& element, const ElementTable& table, void* def) {
  std::vector<Field> fields(table.fields.begin(), table.fields.end());
  std::vector<std::string_view> other_keys = {"type"};
  const bool has_mesh = takes_from_mesh(element.value), has_shapes = takes_from_shapes(element.value);
  for (const ElementTable& rigid : element_tables()) {
    if (rigid.section != "bodies" || !rigid.is_default) continue;
    for (Field field : rigid.fields) {
      if (std::any_of(fields.begin(), fields.end(), [&](const Field& own) { return own.key == field.key; })) continue;
      field.presence = Presence::optional;
      if (has_mesh || has_shapes) {
        other_keys.push_back(field.key);
      } else {
        fields.push_back(field);
      }
    }
  }
  refuse_keys_of_other_type(element, table, other_keys);
  if (has_mesh) {
    for (const Field& field : mesh_inertia_fields()) other_keys.push_back(field.key);
  }
  if (has_shapes) {
    const std::vector<std::string_view> keys = keys_of_shapes();
    other_keys.insert(other_keys.end(), keys.begin(), keys.end());
  }
  read_fields(element.value, fields, def, element.key, element.mark, other_keys, context_);
}

// refuses keys of modes in a body of segments, and vice versa
void ElementReader::refuse_keys_of_other_type(const Node::Entry& element, const ElementTable& table,
                                              std::vector<std::string_view>& passed_over) {
  const bool is_segmented = table.type == "segmented";
  const ValueProblem problem =
      is_segmented ? ValueProblem{"a segmented body has no modes: it bends by the beams between its segments",
                                  "no such key, or type flexible", ""}
                   : ValueProblem{"a flexible body has no segments: it bends by the modes of its files",
                                  "no such key, or type segmented", ""};
  for (const std::string_view key :
       {"flex_modes", "flex_frequency_limit", "modal_coordinates", "modal_rates", "segments"}) {
    const Node::Entry* found = element.value.find(key);
    if (found == nullptr || is_segmented == (key == "segments")) continue;
    passed_over.push_back(key);
    report_.add(found->mark, element.key + "." + std::string(key), problem);
  }
}

// The table of the element's type; null after a reported problem.
const ElementTable* ElementReader::table_of(std::string_view section, const Node::Entry& element) {
  if (const ElementTable* table = find_element_table(section, element.value)) return table;
  std::vector<std::string_view> types;
  const Node::Entry* type = element.value.find("type");
  for (const ElementTable& table : element_tables()) {
    if (table.section == section) types.push_back(table.type);
  }
  std::string list;
  for (const std::string_view name : types)
    list += (list.empty() ? "" : name == types.back() ? " or " : ", ") + std::string(name);
  if (type == nullptr) {
    report_.add(element.mark, element.key, {"the key 'type' is missing", list, ""});
  } else {
    const bool is_word = type->value.kind == Node::Kind::scalar;
    report_.add(type->value.mark, element.key + ".type",
                {"is " + describe(type->value), list, is_word ? closest(type->value.text, types) : ""});
  }
  return nullptr;
}

}  // namespace slew::scene
