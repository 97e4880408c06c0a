// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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

std::string unit_text(Dimension dimension) {
  const DimensionInfo& about = info(dimension);
  if (about.si_unit == "1") return std::string(about.name);
  return std::string(about.si_unit) + (dimension == Dimension::temperature_difference ? " (difference)" : "");
}

std::string with_article(std::string_view noun) {
  return (std::string_view("aeiou").find(noun.front()) == std::string_view::npos ? "a " : "an ") + std::string(noun);
}

// `number` stands for the unit, or the kind, of one number.
std::string type_text(const Field& field, const std::string& number) {
  switch (field.type) {
    case FieldType::number:
      return number;
    case FieldType::integer:
      return "integer";
    case FieldType::boolean:
      return "true or false";
    case FieldType::text:
      return field.reference.empty() ? "text" : with_article(field.reference);
    case FieldType::triple:
      return field.dimension == Dimension::none ? "three numbers" : "three, " + number;
    case FieldType::triples:
      return "list of three, " + number;
    case FieldType::table:
      return "points";
    case FieldType::numbers:
      return "list, " + number;
    case FieldType::texts:
      return "list of texts";
    case FieldType::choice:
      return expected_value(field);
  }
  return {};
}

bool has_unit(const Field& field) {
  const bool is_numeric = field.type == FieldType::number || field.type == FieldType::triple ||
                          field.type == FieldType::triples || field.type == FieldType::numbers;
  return is_numeric && info(field.dimension).si_unit != "1";
}

// "> 0", "0 to 1", ">= 0, < 1"
std::string short_range(const Range& range) {
  const bool has_min = std::isfinite(range.min), has_max = std::isfinite(range.max);
  const bool is_closed = !range.min_is_open && !range.max_is_open;
  if (has_min && has_max && is_closed) return range_text(range, Dimension::none);
  std::string text;
  if (has_min) text = fmt::format("{} {}", range.min_is_open ? ">" : ">=", range.min);
  if (has_max) text += fmt::format("{}{} {}", has_min ? ", " : "", range.max_is_open ? "<" : "<=", range.max);
  return text;
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

constexpr std::string_view kTableHead = "| key | takes | default | meaning |\n|---|---|---|---|\n";

// `number`: see type_text()
std::string row_of(const Field& field, void* defaults, const std::string& number) {
  const bool has_range = field.type == FieldType::integer || field.type == FieldType::table ||
                         field.type == FieldType::number || field.type == FieldType::triple ||
                         field.type == FieldType::triples || field.type == FieldType::numbers;
  const std::string range = has_range ? short_range(field.range) : "";
  const std::string value = default_text(field, defaults);
  const std::string live = field.change == Change::live ? "live" : "";
  const bool is_plain = field.type == FieldType::number && !has_unit(field) && !range.empty();
  const std::string type = is_plain ? "" : cell(type_text(field, number));
  return fmt::format("| `{}` | {}{}{} | {}{}{} | {} |\n", field.key, type, type.empty() || range.empty() ? "" : ", ",
                     range, cell(value), value.empty() || live.empty() ? "" : ", ", live, cell(meaning_text(field)));
}

std::string row_of(const Field& field, void* defaults) {
  return row_of(field, defaults, unit_text(field.dimension));
}

// Rows under one head; keys that are alike in all else share a row.
class Rows {
 public:
  void add(std::string_view key, const std::string& row) {
    const std::string facts = row.substr(row.find("` |") + 2);
    for (auto& [keys, other] : rows_) {
      if (other == facts) {
        keys += fmt::format(", `{}`", key);
        return;
      }
    }
    rows_.emplace_back(fmt::format("`{}`", key), facts);
  }
  [[nodiscard]] std::string text() const {
    if (rows_.empty()) return {};
    std::string text(kTableHead);
    for (const auto& [keys, facts] : rows_) text += fmt::format("| {} {}", keys, facts);
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> rows_;  // keys, and the cells behind them
};

std::string table_of(std::span<const Field> fields, void* defaults) {
  Rows rows;
  for (const Field& field : fields) rows.add(field.key, row_of(field, defaults));
  return rows.text();
}

std::string joined(const std::vector<std::string>& keys) {
  std::string text;
  for (const std::string& key : keys) text += fmt::format("{}`{}`", text.empty() ? "" : ", ", key);
  return text;
}

// The tables of a section's types. Fields that an earlier type has alike, or alike but for their unit, are named with
// that type instead of shown again, where they are several.
class TypeTables {
 public:
  std::string table_of(std::string_view type, std::span<const Field> fields, void* defaults) {
    std::map<Source, std::vector<std::string>> alike;
    std::vector<Source> sources;
    for (const Field& field : fields) {
      sources.push_back(source_of(field, defaults));
      if (!sources.back().type.empty()) alike[sources.back()].emplace_back(field.key);
    }
    keep_worthwhile(alike);
    Rows rows;
    std::vector<std::string> shown;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (alike.contains(sources[i])) continue;
      rows.add(fields[i].key, row_of(fields[i], defaults));
      shown.emplace_back(fields[i].key);
      types_.try_emplace(row_in_any_unit(fields[i], defaults), First{std::string(type), own_unit(fields[i])});
    }
    std::string text = references_to(alike, shown);
    if (!text.empty()) text += shown.empty() ? "\n" : "\n\n";
    shown_[std::string(type)] = shown;
    return text + rows.text();
  }

  // A list of maps, shown at the first type that has it.
  std::string list_of(std::string_view type, const ListTable& list, void* defaults) {
    const std::string text = fmt::format("{}.\n\n{}", list.doc, scene::table_of(list.fields, defaults));
    const auto [first, is_new] = lists_.try_emplace(fmt::format("`{}`: a list of maps. {}", list.key, text), type);
    return is_new ? first->first : fmt::format("`{}`: as for `{}`.\n", list.key, first->second);
  }

 private:
  static constexpr std::size_t kLeastShared = 2;

  struct First {
    std::string type, unit;  // type that shows the field, and its unit there
  };
  struct Source {
    std::string type, unit;  // type that shows the field, empty without one; unit if it is another one here
    auto operator<=>(const Source&) const = default;
  };

  static std::string own_unit(const Field& field) { return has_unit(field) ? unit_text(field.dimension) : ""; }

  static std::string row_in_any_unit(const Field& field, void* defaults) {
    return row_of(field, defaults, has_unit(field) ? "unit" : unit_text(field.dimension));
  }

  Source source_of(const Field& field, void* defaults) const {
    const auto found = types_.find(row_in_any_unit(field, defaults));
    if (found == types_.end()) return {};
    const std::string unit = own_unit(field);
    return {found->second.type, unit == found->second.unit ? "" : unit};
  }

  // Leaves types with several fields that are alike.
  static void keep_worthwhile(std::map<Source, std::vector<std::string>>& alike) {
    std::map<std::string, std::size_t> counts;
    for (const auto& [source, keys] : alike) counts[source.type] += keys.size();
    std::erase_if(alike, [&](const auto& entry) { return counts[entry.first.type] < kLeastShared; });
  }

  // One sentence for each type and unit of fields that are alike; `shown`: keys of the rows here.
  std::string references_to(const std::map<Source, std::vector<std::string>>& alike,
                            const std::vector<std::string>& shown) const {
    std::map<std::string, std::vector<std::string>> stated;  // by type that is referred to: rows here and keys of it
    for (const auto& [source, keys] : alike) {
      std::vector<std::string>& list = stated.try_emplace(source.type, shown).first->second;
      list.insert(list.end(), keys.begin(), keys.end());
    }
    std::string text;
    std::string_view last;
    for (const auto& [source, keys] : alike) {
      if (!text.empty()) text += ' ';
      text += source.type == last ? fmt::format("In {}: {}.", source.unit, joined(keys))
                                  : reference_to(source, keys, stated.at(source.type));
      last = source.type;
    }
    return text;
  }

  // Keys of an earlier type's table, or all of that table but those that are not stated here, whichever is shorter.
  std::string reference_to(const Source& source, const std::vector<std::string>& keys,
                           const std::vector<std::string>& stated) const {
    std::vector<std::string> missing;
    for (const std::string& key : shown_.at(source.type)) {
      if (std::find(stated.begin(), stated.end(), key) == stated.end()) missing.push_back(key);
    }
    if (!source.unit.empty()) return fmt::format("As for `{}`, in {}: {}.", source.type, source.unit, joined(keys));
    if (missing.size() >= keys.size()) return fmt::format("As for `{}`: {}.", source.type, joined(keys));
    return fmt::format("All rows of `{}`{}{}.", source.type, missing.empty() ? "" : " but ", joined(missing));
  }

  std::map<std::string, First> types_;  // by row_in_any_unit()
  std::map<std::string, std::vector<std::string>> shown_;
  std::map<std::string, std::string> lists_;  // by text: the type that shows it
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
        text += '\n' + tables.list_of(table.type, list, list.append(def));
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
