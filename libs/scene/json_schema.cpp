// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "flex/field_tables.h"
#include "scene/defs.h"
#include "scene/field_reader.h"
#include "scene/mesh_inertia.h"
#include "scene/schema.h"
#include "scene/sections.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

// a number, then a unit
constexpr const char* kQuantityPattern =
    R"(^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*(1/)?[A-Za-z%°µ].*$)";
constexpr const char* kNamePattern = "^[A-Za-z_][A-Za-z0-9_]*$";

Json bounded(Json schema, const Range& range) {
  if (std::isfinite(range.min)) schema[range.min_is_open ? "exclusiveMinimum" : "minimum"] = range.min;
  if (std::isfinite(range.max)) schema[range.max_is_open ? "exclusiveMaximum" : "maximum"] = range.max;
  return schema;
}

Json quantity(const Range& range) {
  const Json text = {{"type", "string"}, {"pattern", kQuantityPattern}};
  return {{"anyOf", Json::array({bounded({{"type", "number"}}, range), text})}};
}

Json list_of(Json items, int length) {
  Json list = {{"type", "array"}, {"items", std::move(items)}};
  if (length > 0) {
    list["maxItems"] = length;
    list["minItems"] = length;
  }
  return list;
}

Json point(const Field& field) {
  Json pair = {{"type", "array"}, {"minItems", 2}, {"maxItems", 2}};
  pair["prefixItems"] = Json::array({quantity(Range{}), quantity(field.range)});
  return pair;
}

Json type_of(const Field& field) {
  switch (field.type) {
    case FieldType::number:
      return quantity(field.range);
    case FieldType::integer:
      return bounded({{"type", "integer"}}, field.range);
    case FieldType::boolean:
      return {{"type", "boolean"}};
    case FieldType::text:
      return {{"type", "string"}};
    case FieldType::triple:
      return list_of(quantity(field.range), 3);
    case FieldType::triples:
      return list_of(list_of(quantity(field.range), 3), 0);
    case FieldType::table: {
      Json table = list_of(point(field), 0);
      table["minItems"] = 1;
      const Json name = {{"type", "string"}, {"pattern", "\\.csv$"}};
      const Json text = {{"type", "string"}};
      const Json file = {{"type", "object"},
                         {"properties", {{"file", name}, {"columns", list_of(text, 2)}, {"sha256", text}}},
                         {"required", Json::array({"file"})},
                         {"additionalProperties", false}};
      return {{"anyOf", Json::array({std::move(table), name, file})}};
    }
    case FieldType::numbers:
      return list_of(quantity(field.range), 0);
    case FieldType::texts:
      return list_of({{"type", "string"}}, 0);
    case FieldType::choice:
      return {{"enum", field.choices}};
  }
  return {};
}

Json property(const Field& field) {
  Json schema = type_of(field);
  std::string description(field.doc);
  const bool has_unit = field.type == FieldType::number || field.type == FieldType::triple ||
                        field.type == FieldType::triples || field.type == FieldType::numbers;
  if (has_unit && field.dimension != Dimension::none) description += "; " + expected_quantity(field.dimension);
  if (!field.reference.empty()) description += "; name of a " + std::string(field.reference);
  schema["description"] = description;
  if (field.change == Change::live) schema["x-live"] = true;
  return schema;
}

Json object_of(std::span<const Field> fields, std::string_view doc, std::string_view type, bool is_default = false) {
  Json schema = {{"type", "object"}, {"description", std::string(doc)}, {"additionalProperties", false}};
  Json required = Json::array();
  Json& properties = schema["properties"] = Json::object();
  if (!type.empty()) {
    properties["type"] = {{"const", std::string(type)}};
    if (!is_default) required.push_back("type");
  }
  for (const Field& field : fields) {
    properties[std::string(field.key)] = property(field);
    if (field.presence == Presence::required) required.push_back(std::string(field.key));
  }
  if (!required.items().empty()) schema["required"] = std::move(required);
  return schema;
}

// A body with its inertia from a mesh: the remaining fields of a body, and those of the mesh.
Json mesh_body(const ElementTable& table) {
  std::vector<Field> fields = fields_beside_mesh(table.fields);
  fields.insert(fields.end(), mesh_inertia_fields().begin(), mesh_inertia_fields().end());
  Json schema = object_of(fields, "rigid body, inertia from a closed mesh", table.type, table.is_default);
  schema["properties"]["inertia"] = {{"const", std::string(kFromMesh)}};
  schema["required"].push_back("inertia");
  const Json density = {{"required", Json::array({"density"})}}, mass = {{"required", Json::array({"mass"})}};
  schema["oneOf"] = Json::array({density, mass});
  return schema;
}

// A flexible body may keep the keys of a rigid one, without effect.
Json flexible_body(const ElementTable& table) {
  std::vector<Field> fields(table.fields.begin(), table.fields.end());
  for (const ElementTable& rigid : element_tables()) {
    if (rigid.section != table.section || !rigid.is_default) continue;
    for (Field field : rigid.fields) {
      const auto has_key = [&](const Field& own) { return own.key == field.key; };
      if (std::any_of(table.fields.begin(), table.fields.end(), has_key)) continue;
      field.presence = Presence::optional;
      field.change = Change::restart;
      fields.push_back(field);
    }
  }
  return object_of(fields, table.doc, table.type);
}

Json elements_of(std::string_view section) {
  Json types = Json::array();
  for (const ElementTable& table : element_tables()) {
    if (table.section != section) continue;
    const bool is_flexible = section == "bodies" && !table.is_default;
    Json type = is_flexible ? flexible_body(table) : object_of(table.fields, table.doc, table.type, table.is_default);
    for (const ListTable& list : table.lists) {
      type["properties"][std::string(list.key)] = list_of(object_of(list.fields, list.doc, ""), 0);
    }
    types.push_back(std::move(type));
    if (section == "bodies" && table.is_default) types.push_back(mesh_body(table));
  }
  Json element = types.items().size() == 1 ? types.items().front() : Json{{"oneOf", types}};
  return {{"type", "object"},
          {"propertyNames", {{"pattern", kNamePattern}, {"maxLength", kMaxNameLength}}},
          {"additionalProperties", std::move(element)}};
}

Json script() {
  Json schema = object_of(script_fields(), "the scene's own operator", "");
  Json change = object_of(script_change_fields(), "change of a live parameter", "");
  // name of a choice
  change["properties"]["value"] = {{"type", Json::array({"number", "string"})}};
  change["required"].push_back("value");
  Json& properties = schema["properties"];
  properties["file"] = {{"type", "string"}, {"description", "CSV or YAML file beside the scene, instead of inputs"}};
  const Json text = {{"type", "string"}};
  properties["columns"] = list_of(text, 0);
  properties["columns"]["description"] = "used columns of the CSV file; default: those of inputs";
  properties["sha256"] = {{"type", "string"}, {"description", "content that the CSV file must have"}};
  properties["inputs"] = {{"type", "object"}, {"additionalProperties", property(script_track_fields().front())}};
  properties["parameters"] = list_of(std::move(change), 0);
  return schema;
}

Json named(Json element) {
  return {{"type", "object"}, {"additionalProperties", std::move(element)}};
}

Json flexible_section() {
  Json shapes = Json::array();
  for (const flex::SectionType& type : flex::section_types()) {
    Json schema = object_of(type.fields, type.doc, "");
    schema["properties"]["shape"] = {{"const", std::string(type.name)}};
    schema["required"].push_back("shape");
    if (type.shape == flex::SectionShape::given)
      schema["properties"]["stress_points"] =
          list_of(object_of(flex::stress_point_fields(), "points of stress output", ""), 0);
    shapes.push_back(std::move(schema));
  }
  return {{"oneOf", std::move(shapes)}};
}

}  // namespace

std::string flexible_json_schema() {
  Json schema = object_of(flex::body_fields(), "a flexible body", "");
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "Slewring flexible body";
  const Json text = {{"type", "string"}};
  Json& properties = schema["properties"];
  properties["include"] = {{"anyOf", Json::array({text, list_of(text, 0)})},
                           {"description", "files that this one is merged over"}};
  properties["materials"] = named(object_of(flex::material_fields(), "material", ""));
  properties["sections"] = named(flexible_section());
  properties["line"] = object_of(flex::line_fields(), "nodes 1, 2, ... at equal distances", "");
  properties["nodes"] = {{"type", "object"},
                         {"propertyNames", {{"pattern", "^[0-9]+$"}}},
                         {"additionalProperties", property(flex::node_field())}};
  properties["elements"] = list_of(object_of(flex::element_fields(), "elements in a row", ""), 0);
  properties["matrices"] = object_of(flex::matrix_file_fields(), "files of another finite element code", "");
  properties["reduction"] = object_of(flex::reduction_fields(), "reduction of the body", "");
  // with an include the names may stand there
  schema.erase("required");
  return schema.dump(2, Json::Order::as_put) + "\n";
}

std::string json_schema() {
  const Json text = {{"type", "string"}};
  const Json texts = list_of(text, 0);
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Slewring scene"},
                 {"type", "object"},
                 {"additionalProperties", false}};
  Json& properties = schema["properties"] = Json::object();
  for (const std::string_view key : top_level_keys()) properties[std::string(key)] = Json::object();
  properties["scene"] = {{"type", "string"}, {"description", "name of the scene"}};
  properties["description"] = {{"type", "string"}, {"description", "description of the scene"}};
  properties["include"] = {{"anyOf", Json::array({text, texts})},
                           {"description", "files that this one is merged over"}};
  properties["assets"] = list_of(text, 0);
  properties["assets"]["description"] = "files that every machine of a session must have alike";
  properties["script"] = script();
  for (const SingleTable& table : single_tables()) {
    properties[std::string(table.section)] = object_of(table.fields, table.doc, "");
  }
  for (const std::string_view section : element_sections()) properties[std::string(section)] = elements_of(section);
  return schema.dump(2, Json::Order::as_put) + "\n";
}

}  // namespace slew::scene
