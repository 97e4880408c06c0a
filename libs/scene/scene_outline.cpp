// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/failure.h"
#include "scene/canonical.h"
#include "scene/edited_scene.h"
#include "scene/element_table.h"
#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/graphics.h"
#include "scene/scene_text.h"
#include "scene/sections.h"
#include "scene/text_references.h"

namespace slew::scene {
namespace {

std::string_view name_of(FieldType type) {
  switch (type) {
    case FieldType::number:
      return "number";
    case FieldType::integer:
      return "integer";
    case FieldType::boolean:
      return "boolean";
    case FieldType::text:
      return "text";
    case FieldType::triple:
      return "triple";
    case FieldType::triples:
      return "triples";
    case FieldType::table:
      return "table";
    case FieldType::numbers:
      return "numbers";
    case FieldType::texts:
      return "texts";
    case FieldType::choice:
      return "choice";
  }
  return "";
}

bool has_numbers(FieldType type) {
  return type != FieldType::boolean && type != FieldType::text && type != FieldType::texts && type != FieldType::choice;
}

Json field_json(const Field& field, void* def) {
  const std::string_view unit = info(field.dimension).si_unit;
  Json json = {{"key", field.key}, {"type", name_of(field.type)}, {"doc", field.doc}};
  if (has_numbers(field.type)) {
    if (unit != "1" && field.type != FieldType::integer) json["unit"] = unit;
    const std::string range = range_text(field.range, Dimension::none);
    if (!range.empty()) json["range"] = range;
  }
  if (field.presence == Presence::required) {
    json["required"] = true;
  } else if (const std::string value = value_text(field, def); !value.empty()) {
    json["default"] = value;
  }
  if (field.change == Change::live) json["live"] = true;
  if (!field.reference.empty()) json["reference"] = field.reference;
  if (field.type == FieldType::choice) json["choices"] = field.choices;
  for (const ReadBy& condition : field.read_by)
    json["read_with"].push_back(fmt::format("{}: {}", condition.key, condition.what));
  return json;
}

Json fields_json(std::span<const Field> fields, void* def) {
  Json list = Json::array();
  for (const Field& field : fields) list.push_back(field_json(field, def));
  return list;
}

// A value that is not in the text, in one line.
std::string in_one_line(const Node& node) {
  std::string text;
  for (const Node& item : node.items) text += (text.empty() ? "" : ", ") + in_one_line(item);
  for (const Node::Entry& entry : node.entries)
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", entry.key, in_one_line(entry.value));
  switch (node.kind) {
    case Node::Kind::empty:
      return "";
    case Node::Kind::scalar:
      return node.text;
    case Node::Kind::sequence:
      return "[" + text + "]";
    case Node::Kind::map:
      break;
  }
  return "{" + text + "}";
}

std::string place_of(const Report& report, const Mark& mark) {
  const Diagnostic at = report.at(mark, "", {});
  return fmt::format("{}:{}", at.file, at.line);
}

// The scene's tree with includes, templates and instances written out, as far as they can be; places in its report.
struct WrittenOut {
  Report report{};
  std::optional<Node> root{};
  std::vector<NamedPoint> points{};

  WrittenOut(const std::string& path, const std::string& text) {
    root = read_with_includes(path, report, Includes::with_prefix, &text);
    std::vector<ParameterText> values;
    if (root && !expand(*root, {}, report, nullptr, values, &points)) root.reset();
  }
  [[nodiscard]] const Node::Entry* find(std::string_view section, std::string_view name) const {
    const Node::Entry* found = root ? root->find(section) : nullptr;
    return found == nullptr ? nullptr : found->value.find(name);
  }
  // Of an element; empty: there is none, or the scene cannot be written out.
  [[nodiscard]] std::string place_of_element(std::string_view name) const {
    for (const std::string_view section : element_sections()) {
      if (const Node::Entry* element = find(section, name)) return place_of(report, element->mark);
    }
    return {};
  }
};

class Outline {
 public:
  Outline(const SceneText& text, const WrittenOut& whole) : text_(text), whole_(whole) {}

  Json json() {
    for (const SingleTable& table : single_tables()) add_section(table.section);
    add_section(kParametersKey);
    for (const std::string_view section : element_sections()) add_elements(section);
    return std::move(elements_);
  }

 private:
  // Also one that the text does not have: its first field makes it.
  void add_section(std::string_view section) {
    const Node::Entry* own = text_.root().find(section);
    if (own == nullptr && section == kParametersKey) return;
    const Node::Entry* whole = whole_.root ? whole_.root->find(section) : nullptr;
    add(section, section, own, whole);
  }

  void add_elements(std::string_view section) {
    const Node::Entry* own = text_.root().find(section);
    if (own != nullptr) {
      for (const Node::Entry& element : own->value.entries)
        add(section, element.key, &element, whole_.find(section, element.key));
    }
    const Node::Entry* whole = whole_.root ? whole_.root->find(section) : nullptr;
    if (whole == nullptr) return;
    for (const Node::Entry& element : whole->value.entries) {
      if (own == nullptr || own->value.find(element.key) == nullptr) add(section, element.key, nullptr, &element);
    }
  }

  // own: null: the text does not have it. whole: null: the scene cannot be written out.
  void add(std::string_view section, std::string_view name, const Node::Entry* own, const Node::Entry* whole) {
    Json element = {{"name", name}, {"section", section}};
    const Node::Entry* typed = whole != nullptr ? whole : own;
    const ElementTable* table = typed == nullptr ? nullptr : find_element_table(section, typed->value);
    element["type"] = table == nullptr ? "" : table->type;
    Json fields = Json::object(), given = Json::object();
    if (own != nullptr) {
      element["line"] = own->mark.line;
      for (const Node::Entry& field : own->value.entries) {
        fields[field.key] = {
            {"text", text_.written(field.value)}, {"line", field.value.mark.line}, {"column", field.value.mark.column}};
      }
    } else if (whole != nullptr && name != section) {
      element["place"] = place_of(whole_.report, whole->mark);
    }
    if (whole != nullptr) {
      for (const Node::Entry& field : whole->value.entries) {
        if (field.key == "type" || (own != nullptr && own->value.find(field.key) != nullptr)) continue;
        given[field.key] = {{"text", in_one_line(field.value)}, {"place", place_of(whole_.report, field.value.mark)}};
      }
    }
    element["fields"] = std::move(fields);
    element["given"] = std::move(given);
    elements_.push_back(std::move(element));
  }

  const SceneText& text_;
  const WrittenOut& whole_;
  Json elements_ = Json::array();
};

// A point whose position has a problem is left out: the loader reports it. report: of the points' sources.
Json points_json(const std::vector<NamedPoint>& points, Report report) {
  Json list = Json::array();
  if (points.empty()) return list;
  const std::span<const Field> fields = graphic_fields();
  const auto position = std::ranges::find(fields, "position", &Field::key);
  UnitSystem units;
  PlaceMap places;
  std::vector<Reference> references;
  for (const NamedPoint& point : points) {
    const std::size_t problems = report.size();
    GraphicDef at;  // has a position in a body's frame as well
    read_value(point.position, *position, &at, point.name, {units, report, places, references});
    if (report.size() == problems)
      list.push_back({{"name", point.name}, {"body", point.body}, {"position", Json(at.position)}});
  }
  return list;
}

// Where included files name an element, or have a part of it: "J.body1 (side.yaml:12)". Files with a prefix name their
// own elements alone.
std::vector<std::string> places_in_included_files(const std::string& path, const std::string& text,
                                                  std::string_view name) {
  Report report;
  const std::optional<Node> root = read_with_includes(path, report, Includes::with_prefix, &text);
  std::vector<std::string> places;
  if (!root) return places;
  const auto add = [&](const std::string& what, const Mark& mark) {
    const Diagnostic at = report.at(mark, "", {});
    if (at.file != path) places.push_back(fmt::format("{} ({}:{})", what, at.file, at.line));
  };
  for (const std::string_view section : element_sections()) {
    const Node::Entry* found = root->find(section);
    const Node::Entry* element = found == nullptr ? nullptr : found->value.find(name);
    if (element == nullptr) continue;
    for (const Node::Entry& field : element->value.entries)
      add(fmt::format("{}.{}", name, field.key), field.value.mark);
  }
  for (const TextReference& reference : references_to(*root, name)) add(reference.path, reference.mark());
  return places;
}

std::optional<SceneText> read_text(const std::string& path, const std::string& text) {
  Report report;
  return SceneText::read(text, report.add_source(path), report);
}

TextEdit edit_of(const SceneText& text, const Json& request) {
  const auto member = [&request](std::string_view name) { return request.at(name).text(); };
  if (request.find("set") != nullptr) return text.set(member("set"), member("value"));
  if (request.find("add") != nullptr) return text.add(member("section"), member("type"), member("add"));
  if (request.find("copy") != nullptr) return text.copy(member("copy"), member("to"));
  if (request.find("rename") != nullptr) return text.rename(member("rename"), member("to"));
  if (request.find("remove") != nullptr) return text.remove(member("remove"));
  return {text.text(), {}, {}};
}

std::string element_of(const Json& request) {
  for (const std::string_view key : {"set", "copy", "rename", "remove"}) {
    if (const Json* found = request.find(key)) return found->text().substr(0, found->text().find_first_of(".["));
  }
  return {};
}

}  // namespace

Json kinds_json() {
  Scene scratch;
  Json kinds = Json::array();
  for (const SingleTable& table : single_tables()) {
    kinds.push_back({{"section", table.section},
                     {"type", ""},
                     {"doc", table.doc},
                     {"is_single", true},
                     {"fields", fields_json(table.fields, table.def(scratch))}});
  }
  for (const std::string_view section : element_sections()) {
    for (const ElementTable& table : element_tables()) {
      if (table.section != section) continue;
      Json fields = fields_json(table.fields, table.append(scratch, "Name"));
      for (const ListTable& list : table.lists)
        fields.push_back({{"key", list.key}, {"type", "rows"}, {"doc", list.doc}});
      kinds.push_back({{"section", section},
                       {"type", table.type},
                       {"kind", table.kind},
                       {"doc", table.doc},
                       {"is_default", table.is_default},
                       {"fields", std::move(fields)}});
    }
  }
  return kinds;
}

Json diagnostics_json(const LoadError& error) {
  Json list = Json::array();
  for (const Diagnostic& diagnostic : error.diagnostics()) {
    list.push_back({{"file", diagnostic.file},
                    {"line", diagnostic.line},
                    {"column", diagnostic.column},
                    {"path", diagnostic.path},
                    {"what", diagnostic.what},
                    {"expected", diagnostic.expected},
                    {"suggestion", diagnostic.suggestion}});
  }
  return list;
}

Json problems_json(const LoadError& error) {
  return {{"ok", false},
          {"code", static_cast<int>(ExitCode::bad_input)},
          {"problems", diagnostics_json(error)},
          {"omitted", error.omitted()}};
}

Json problems_json(const Failure& failure) {
  const Json problem = {{"file", ""},     {"line", 0},       {"column", 0}, {"path", ""}, {"what", failure.what()},
                        {"expected", ""}, {"suggestion", ""}};
  return {
      {"ok", false}, {"code", static_cast<int>(failure.code())}, {"problems", Json::array({problem})}, {"omitted", 0}};
}

Json outline_json(const std::string& path, const std::string& text, const Overrides& overrides) {
  Json json = {{"elements", Json::array()},
               {"points", Json::array()},
               {"problems", Json::array()},
               {"omitted", 0},
               {"warnings", Json::array()}};
  try {
    const Scene scene = load_edited(path, text, overrides);
    for (const std::string& warning : scene.warnings) json["warnings"].push_back(warning);
  } catch (const LoadError& error) {
    json["problems"] = diagnostics_json(error);
    json["omitted"] = error.omitted();
  }
  if (const std::optional<SceneText> own = read_text(path, text)) {
    const WrittenOut whole(path, text);
    json["elements"] = Outline(*own, whole).json();
    json["points"] = points_json(whole.points, whole.report);
  }
  return json;
}

EditedText edit_text(const std::string& path, const std::string& text, const Json& request) {
  const std::string element = element_of(request);
  const std::optional<SceneText> own = read_text(path, text);
  if (!own) return {text, "the text cannot be read as YAML: put that right first; nothing was changed", {}};
  TextEdit edit = edit_of(*own, request);
  if (request.find("rename") != nullptr && edit.refusal.empty()) {
    if (std::vector<std::string> places = places_in_included_files(path, text, element); !places.empty()) {
      return {text,
              fmt::format("included files name '{}' as well, and this page does not change them; nothing was changed; "
                          "rename it there and here with an editor",
                          element),
              std::move(places)};
    }
  }
  if (!edit.refusal.empty() && !element.empty() && own->find(element).entry == nullptr &&
      own->root().find(element) == nullptr) {
    const std::string place = WrittenOut(path, text).place_of_element(element);
    if (!place.empty())
      edit.refusal = fmt::format("'{}' is not of this file: it comes from {}; nothing was changed; change it there",
                                 element, place);
  }
  return {std::move(edit.text), std::move(edit.refusal), std::move(edit.notes)};
}

}  // namespace slew::scene
