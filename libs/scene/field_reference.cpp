// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "flex/field_tables.h"
#include "scene/field_entry.h"
#include "scene/mesh_inertia.h"
#include "scene/schema.h"
#include "scene/sections.h"
#include "scene/shape_fields.h"
#include "scene/shape_inertia.h"
#include "scene/shared_keys.h"

namespace slew::scene {
namespace {

std::string items_of(std::span<const Field> fields, void* defaults) {
  return items_of(entries_of(fields, defaults));
}

// Types as they are shown: their headings, their keys and what follows them.
struct ShownType {
  std::string heading;  // "`type: hose`: hose or pipe"
  TypeOfSection type;
  std::string rest;  // lists of maps, forms of a body
};

std::string types_text(const std::vector<ShownType>& shown) {
  std::vector<TypeOfSection> types;
  for (const ShownType& one : shown) types.push_back(one.type);
  const SharedKeys shared = shared_keys(types);
  std::string text;
  if (!shared.common.empty()) {
    text += "\nCommon keys:\n\n" + items_of(shared.common);
  }
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::string& references = shared.references[i];
    text += fmt::format("\n{}.{}{}\n", shown[i].heading, references.empty() ? "" : " ", references);
    if (!shared.own[i].empty()) text += '\n' + items_of(shared.own[i]);
    text += shown[i].rest;
  }
  return text;
}

// Lists of maps, each shown at the first type that has it.
class Lists {
 public:
  std::string text_of(std::string_view type, const ListTable& list, void* defaults) {
    const std::string text =
        fmt::format("\n`{}`, a list of maps: {}.\n\n{}", list.key, list.doc, items_of(list.fields, defaults));
    const auto [first, is_new] = lists_.try_emplace(text, type);
    if (is_new) return text;
    same_[first->second].push_back(std::string(list.key));
    return {};
  }
  // "`nodes`, `signals`: as for `can_in`.", of the lists since the last call
  std::string references() {
    std::string text;
    for (const auto& [type, keys] : same_) text += fmt::format("\n{}: as for `{}`.\n", joined_keys(keys), type);
    same_.clear();
    return text;
  }

 private:
  std::map<std::string, std::string> lists_;              // by text: the type that shows it
  std::map<std::string, std::vector<std::string>> same_;  // by type that shows them
};

// Bodies from shapes: the keys of each shape, and those around it in a body and in a part.
std::string shape_texts() {
  PartDef part;
  PartsDef all;
  std::string text = fmt::format(
      "\n`inertia: {}`: mass properties of a simple solid, by `shape`. In `parts` of `inertia: {}` the keys "
      "`shape_position` and `shape_orientation` are `position` and `orientation`.\n",
      kFromShape, kFromParts);
  std::vector<ShownType> shapes;
  for (const ShapeWord& word : shape_words()) {
    shapes.push_back({fmt::format("`shape: {}`: {}", word.name, word.doc),
                      {std::string(word.name), entries_of(word.body_fields, &part)},
                      {}});
  }
  return text + types_text(shapes) +
         fmt::format(
             "\n`inertia: {}`: the sum of a list `parts` of solids. Beside the list:\n\n{}\nA part, beside the keys of "
             "its "
             "shape:\n\n{}",
             kFromParts, items_of(parts_fields(), &all), items_of(part_rows(), &part));
}

std::string body_forms() {
  MeshInertiaDef from_mesh;
  return fmt::format("\n`inertia: {}`: mass properties of the solid in a closed mesh.\n\n{}", kFromMesh,
                     items_of(mesh_inertia_fields(), &from_mesh)) +
         shape_texts();
}

std::string section_text(std::string_view section, Scene& defaults) {
  std::vector<ShownType> types;
  Lists lists;
  for (const ElementTable& table : element_tables()) {
    if (table.section != section) continue;
    void* def = table.append(defaults, "Name");
    ShownType shown{table.type.empty() ? std::string(table.doc)
                                       : fmt::format("`type: {}`{}: {}", table.type,
                                                     table.is_default ? " (or no type)" : "", table.doc),
                    {std::string(table.type), entries_of(table.fields, def)},
                    {}};
    for (const ListTable& list : table.lists) shown.rest += lists.text_of(table.type, list, list.append(def));
    shown.rest += lists.references();
    if (section == "bodies" && table.is_default) shown.rest += body_forms();
    types.push_back(std::move(shown));
  }
  return fmt::format("\n### {}\n{}", section, types_text(types));
}

}  // namespace

std::string field_reference() {
  std::string text;
  Scene defaults;
  for (const SingleTable& table : single_tables()) {
    text += fmt::format("\n### {}\n\n{}", table.section, items_of(table.fields, table.def(defaults)));
  }
  for (const std::string_view section : element_sections()) text += section_text(section, defaults);
  ScriptDef script;
  ScriptChange change;
  text +=
      fmt::format("\n### script\n\n{}\nAn entry of `parameters` (with `value`, in the parameter's dimension):\n\n{}\n",
                  items_of(script_fields(), &script), items_of(script_change_fields(), &change));
  return with_wrapped_prose(text);
}

std::string flexible_field_reference() {
  std::string text;
  const auto add = [&](const std::string& heading, std::string_view doc, std::span<const Field> fields, void* def) {
    text += fmt::format("\n### {}\n\n{}.\n\n{}", heading, doc, items_of(fields, def));
  };
  flex::FlexibleBodyDef body;
  flex::NamedMaterial material;
  flex::StressPointDef point;
  flex::ElementChainDef element;
  flex::BeamNodeDef node;
  add("At the top", "One of line, nodes and matrices gives the geometry of the body", flex::body_fields(), &body);
  add("materials", "By name", flex::material_fields(), &material);
  text += "\n### sections\n\nBy name.\n";
  for (const flex::SectionType& type : flex::section_types()) {
    flex::NamedSection section;
    text += fmt::format("\n`shape: {}`: {}.\n\n{}", type.name, type.doc, items_of(type.fields, &section));
  }
  add("stress_points", "A list in a given section", flex::stress_point_fields(), &point);
  add("line", "Nodes 1, 2, ... at equal distances", flex::line_fields(), &body.line);
  add("nodes", "By number: [x, y, z]; the first is the root, the last the tip", {&flex::node_field(), 1}, &node);
  add("elements", "A list; without it a chain through the nodes", flex::element_fields(), &element);
  add("matrices", "Files of another finite element code", flex::matrix_file_fields(), &body.matrices);
  add("reduction", "Reduction of the body", flex::reduction_fields(), &body.reduction);
  return with_wrapped_prose(text);
}

std::string with_field_reference(const std::string& document) {
  const std::size_t begin = document.find(kReferenceBegin);
  const std::size_t end = document.find(kReferenceEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  return document.substr(0, begin + kReferenceBegin.size()) + field_reference() + document.substr(end);
}

}  // namespace slew::scene
