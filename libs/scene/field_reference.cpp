// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flex/field_tables.h"
#include "scene/canonical.h"
#include "scene/field_reader.h"
#include "scene/mesh_inertia.h"
#include "scene/schema.h"
#include "scene/sections.h"
#include "scene/shape_fields.h"
#include "scene/shape_inertia.h"

namespace slew::scene {
namespace {

std::string type_text(const Field& field) {
  switch (field.type) {
    case FieldType::number:
      return std::string(info(field.dimension).name);
    case FieldType::integer:
      return "integer";
    case FieldType::boolean:
      return "true or false";
    case FieldType::text:
      return field.reference.empty() ? "text" : "name of a " + std::string(field.reference);
    case FieldType::triple:
      return field.dimension == Dimension::none ? "three numbers"
                                                : fmt::format("three, {}", info(field.dimension).name);
    case FieldType::triples:
      return fmt::format("list of three, {}", info(field.dimension).name);
    case FieldType::table:
      return "points";
    case FieldType::numbers:
      return fmt::format("list, {}", info(field.dimension).name);
    case FieldType::texts:
      return "list of texts";
    case FieldType::choice:
      return expected_value(field);
  }
  return {};
}

std::string unit_text(const Field& field) {
  const bool is_numeric = field.type == FieldType::number || field.type == FieldType::triple ||
                          field.type == FieldType::triples || field.type == FieldType::numbers;
  if (!is_numeric || info(field.dimension).si_unit == "1") return "";
  return std::string(info(field.dimension).si_unit);
}

std::string meaning_text(const Field& field) {
  std::string text(field.doc);
  for (const ReadBy& condition : field.read_by) text += fmt::format("; read with {}", condition.what);
  return text;
}

// Markdown tables separate cells with |
std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
  return text;
}

std::string default_text(const Field& field, void* def) {
  if (field.presence == Presence::required) return "required";
  const std::string value = value_text(field, def);
  if (value.empty()) return field.type == FieldType::number || field.type == FieldType::triple ? "none" : "";
  return value;
}

constexpr std::string_view kTableHead =
    "| key | takes | SI unit | range | default | live | meaning |\n|---|---|---|---|---|---|---|\n";

std::string row_of(const Field& field, void* defaults) {
  const bool has_range = field.type == FieldType::number || field.type == FieldType::integer ||
                         field.type == FieldType::triple || field.type == FieldType::triples ||
                         field.type == FieldType::numbers || field.type == FieldType::table;
  return fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", field.key, cell(type_text(field)), unit_text(field),
                     has_range ? range_text(field.range, Dimension::none) : "", cell(default_text(field, defaults)),
                     field.change == Change::live ? "live" : "", cell(meaning_text(field)));
}

std::string table_of(std::span<const Field> fields, void* defaults) {
  std::string text(kTableHead);
  for (const Field& field : fields) text += row_of(field, defaults);
  return text;
}

// The tables of a section's types. A field that an earlier type has alike is named beside that type instead of shown
// again, where it is one of several.
class TypeTables {
 public:
  std::string table_of(std::string_view type, std::span<const Field> fields, void* defaults) {
    std::vector<std::string> rows;
    std::map<std::string, std::string> keys_by_type;
    std::map<std::string, std::size_t> counts;
    for (const Field& field : fields) {
      rows.push_back(row_of(field, defaults));
      const auto shown = types_.find(rows.back());
      if (shown != types_.end()) ++counts[shown->second];
    }
    std::string table;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto shown = types_.find(rows[i]);
      if (shown == types_.end() || counts[shown->second] < kLeastShared) {
        table += rows[i];
        types_.try_emplace(rows[i], type);
        continue;
      }
      std::string& keys = keys_by_type[shown->second];
      keys += fmt::format("{}`{}`", keys.empty() ? "" : ", ", fields[i].key);
    }
    std::string text;
    for (const auto& [other, keys] : keys_by_type) text += fmt::format("As for `{}`: {}.\n\n", other, keys);
    return table.empty() ? text : text + std::string(kTableHead) + table;
  }

 private:
  static constexpr std::size_t kLeastShared = 3;
  std::map<std::string, std::string> types_;  // by row: the type that shows it
};

constexpr std::size_t kLineWidth = 120;  // of prose in documents, in characters; tests/architecture/words_test.py

// One line of prose in lines of kLineWidth, broken at spaces outside of code spans.
std::string wrapped(std::string_view line) {
  std::string text;
  std::size_t width = 0, begin = 0;
  bool is_code = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '`') is_code = !is_code;
    if (i < line.size() && (line[i] != ' ' || is_code)) continue;
    const std::string_view word = line.substr(begin, i - begin);
    const bool fits = width + 1 + word.size() <= kLineWidth;
    if (begin > 0) text += fits ? ' ' : '\n';
    text += word;
    width = (begin > 0 && fits ? width + 1 : 0) + word.size();
    begin = i + 1;
  }
  return text;
}

// Markdown with wrapped prose. Rows of tables and headings stay on one line.
std::string with_wrapped_prose(std::string_view text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    result += line.starts_with('|') || line.starts_with('#') ? std::string(line) : wrapped(line);
    if (end < text.size()) result += '\n';
    begin = end + 1;
  }
  return result;
}

// Bodies from shapes: the keys of each shape, and those around it in a body and in a part.
std::string shape_tables() {
  PartDef part;
  PartsDef all;
  std::string text = fmt::format(
      "\n`inertia: {}`: mass, centre of mass and inertia of a simple solid, by `shape`. In a list `parts` of "
      "`inertia: {}` the keys `shape_position` and `shape_orientation` are `position` and `orientation`.\n",
      kFromShape, kFromParts);
  TypeTables tables;
  for (const ShapeWord& word : shape_words()) {
    text += fmt::format("\n`shape: {}`: {}.\n\n{}", word.name, word.doc,
                        tables.table_of(word.name, word.body_fields, &part));
  }
  text += fmt::format(
      "\n`inertia: {}`: the sum of the solids of a list `parts`. Beside the list:\n\n{}\nA part, beside the keys of "
      "its "
      "shape:\n\n{}",
      kFromParts, table_of(parts_fields(), &all), table_of(part_rows(), &part));
  return text;
}

}  // namespace

std::string field_reference() {
  std::string text;
  Scene defaults;
  for (const SingleTable& table : single_tables()) {
    text += fmt::format("\n### {}\n\n{}.\n\n{}", table.section, table.doc, table_of(table.fields, table.def(defaults)));
  }
  for (const std::string_view section : element_sections()) {
    text += fmt::format("\n### {}\n", section);
    TypeTables tables;
    for (const ElementTable& table : element_tables()) {
      if (table.section != section) continue;
      void* def = table.append(defaults, "Name");
      const std::string heading = table.type.empty() ? std::string(table.doc)
                                                     : fmt::format("`type: {}`{}: {}", table.type,
                                                                   table.is_default ? " (or no type)" : "", table.doc);
      text += fmt::format("\n{}.\n\n{}", heading, tables.table_of(table.type, table.fields, def));
      for (const ListTable& list : table.lists) {
        text += fmt::format("\n`{}`: a list of maps. {}.\n\n{}", list.key, list.doc,
                            table_of(list.fields, list.append(def)));
      }
      if (section != "bodies" || !table.is_default) continue;
      MeshInertiaDef from_mesh;
      text += fmt::format("\n`inertia: {}`: mass, centre of mass and inertia of the solid in a closed mesh.\n\n{}",
                          kFromMesh, table_of(mesh_inertia_fields(), &from_mesh));
      text += shape_tables();
    }
  }
  ScriptDef script;
  ScriptChange change;
  text +=
      fmt::format("\n### script\n\n{}\nAn entry of `parameters` (with `value`, in the parameter's dimension):\n\n{}\n",
                  table_of(script_fields(), &script), table_of(script_change_fields(), &change));
  return with_wrapped_prose(text);
}

std::string flexible_field_reference() {
  std::string text;
  const auto add = [&](const std::string& heading, std::string_view doc, std::span<const Field> fields, void* def) {
    text += fmt::format("\n### {}\n\n{}.\n\n{}", heading, doc, table_of(fields, def));
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
    text += fmt::format("\n`shape: {}`: {}.\n\n{}", type.name, type.doc, table_of(type.fields, &section));
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
