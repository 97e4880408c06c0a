// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "core/json.h"
#include "flex/field_tables.h"
#include "multibody/model/defs.h"
#include "scene/defs.h"
#include "scene/element_table.h"
#include "scene/field_reader.h"
#include "scene/mesh_inertia.h"
#include "scene/schema.h"
#include "scene/sections.h"
#include "scene/shape_fields.h"
#include "scene/shape_inertia.h"
#include "scene/solid_inertia.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

// a number, then a unit
constexpr const char* kQuantityPattern =
    R"(^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*(1/)?[A-Za-z%°µ].*$)";
// a quantity, or an expression of a scene
constexpr const char* kValuePattern =
    R"(^(\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*(1/)?[A-Za-z%°µ].*|\$\{.*\})$)";
constexpr const char* kExpressionPattern = R"(^\$\{.*\}$)";
constexpr const char* kPointPattern = R"(^([A-Za-z_][A-Za-z0-9_]*\.[A-Za-z_][A-Za-z0-9_]*|\$\{.*\})$)";
constexpr const char* kNamePattern = "^[A-Za-z_][A-Za-z0-9_]*$";

Json bounded(Json schema, const Range& range) {
  if (std::isfinite(range.min)) schema[range.min_is_open ? "exclusiveMinimum" : "minimum"] = range.min;
  if (std::isfinite(range.max)) schema[range.max_is_open ? "exclusiveMaximum" : "maximum"] = range.max;
  return schema;
}

// Kind of file: expressions are part of scenes alone.
enum class Values { of_scene, plain };

// Texts that stand in many places are definitions of the schema.
struct TextPattern {
  std::string_view name;
  const char* pattern;
};
constexpr TextPattern kQuantityText{"quantity", kQuantityPattern}, kValueText{"value", kValuePattern},
    kExpressionText{"expression", kExpressionPattern}, kPointText{"point", kPointPattern};

Json reference_to(std::string_view name) {
  return {{"$ref", "#/$defs/" + std::string(name)}};
}

Json text_like(const TextPattern& text) {
  return reference_to(text.name);
}

Json text_definitions(std::initializer_list<TextPattern> texts) {
  Json definitions = Json::object();
  for (const TextPattern& text : texts) definitions[text.name] = {{"type", "string"}, {"pattern", text.pattern}};
  return definitions;
}

Json quantity(const Range& range, Values values) {
  const TextPattern& pattern = values == Values::of_scene ? kValueText : kQuantityText;
  return {{"anyOf", Json::array({bounded({{"type", "number"}}, range), text_like(pattern)})}};
}

// an integer, a truth value or a choice
Json or_expression(Json schema, Values values) {
  if (values == Values::plain) return schema;
  return {{"anyOf", Json::array({std::move(schema), text_like(kExpressionText)})}};
}

Json list_of(Json items, int length) {
  Json list = {{"type", "array"}, {"items", std::move(items)}};
  if (length > 0) {
    list["maxItems"] = length;
    list["minItems"] = length;
  }
  return list;
}

Json point(const Field& field, Values values) {
  Json pair = {{"type", "array"}, {"minItems", 2}, {"maxItems", 2}};
  pair["prefixItems"] = Json::array({quantity(Range{}, values), quantity(field.range, values)});
  return pair;
}

// a list of three, or the name of a point
Json or_point(Json schema, const Field& field, Values values) {
  const bool may_be_point = field.key.starts_with("point") || field.key == "position";
  if (values == Values::plain || field.dimension != Dimension::length || !may_be_point) {
    return or_expression(std::move(schema), values);
  }
  return {{"anyOf", Json::array({std::move(schema), text_like(kPointText)})}};
}

Json type_of(const Field& field, Values values) {
  switch (field.type) {
    case FieldType::number:
      return quantity(field.range, values);
    case FieldType::integer:
      return or_expression(bounded({{"type", "integer"}}, field.range), values);
    case FieldType::boolean:
      return or_expression({{"type", "boolean"}}, values);
    case FieldType::text:
      // a text of one number needs no quotes
      return {{"type", Json::array({"string", "number"})}};
    case FieldType::triple:
      return or_point(list_of(quantity(field.range, values), 3), field, values);
    case FieldType::triples:
      return or_expression(list_of(or_point(list_of(quantity(field.range, values), 3), field, values), 0), values);
    case FieldType::table: {
      Json table = list_of(point(field, values), 0);
      table["minItems"] = 1;
      const Json name = {{"type", "string"}, {"pattern", "\\.csv$"}};
      const Json text = {{"type", "string"}};
      const Json file = {{"type", "object"},
                         {"properties", {{"file", name}, {"columns", list_of(text, 2)}, {"sha256", text}}},
                         {"required", Json::array({"file"})},
                         {"additionalProperties", false}};
      Json forms = Json::array({std::move(table), name, file});
      if (values == Values::of_scene) forms.push_back(text_like(kExpressionText));
      return {{"anyOf", std::move(forms)}};
    }
    case FieldType::numbers:
      return or_expression(list_of(quantity(field.range, values), 0), values);
    case FieldType::texts:
      return or_expression(list_of({{"type", "string"}}, 0), values);
    case FieldType::choice:
      return or_expression({{"enum", field.choices}}, values);
  }
  return {};
}

Json property(const Field& field, Values values) {
  Json schema = type_of(field, values);
  std::string description(field.doc);
  const bool has_unit = field.type == FieldType::number || field.type == FieldType::triple ||
                        field.type == FieldType::triples || field.type == FieldType::numbers;
  if (has_unit && field.dimension != Dimension::none) description += "; " + expected_quantity(field.dimension);
  if (!field.reference.empty()) description += "; name of a " + std::string(field.reference);
  for (const ReadBy& condition : field.read_by) description += "; read with " + std::string(condition.what);
  schema["description"] = description;
  if (field.change == Change::live) schema["x-live"] = true;
  return schema;
}

Json object_of(std::span<const Field> fields, std::string_view doc, std::string_view type, Values values,
               bool is_default = false) {
  Json schema = {{"type", "object"}, {"description", std::string(doc)}, {"additionalProperties", false}};
  Json required = Json::array();
  Json& properties = schema["properties"] = Json::object();
  if (!type.empty()) {
    properties["type"] = {{"const", std::string(type)}};
    if (!is_default) required.push_back("type");
  }
  for (const Field& field : fields) {
    properties[std::string(field.key)] = property(field, values);
    // a named point gives its body
    const bool may_follow_point =
        values == Values::of_scene && field.reference == "body" && field.key.starts_with("bod");
    if (field.presence == Presence::required && !may_follow_point) required.push_back(std::string(field.key));
  }
  if (!required.items().empty()) schema["required"] = std::move(required);
  return schema;
}

Json named(Json element) {
  return {{"type", "object"}, {"additionalProperties", std::move(element)}};
}

Json density_or_mass() {
  const Json density = {{"required", Json::array({"density"})}}, mass = {{"required", Json::array({"mass"})}};
  return Json::array({density, mass});
}

// A body with its inertia from a mesh: the remaining fields of a body, and those of the mesh.
Json mesh_body(const ElementTable& table) {
  std::vector<Field> fields = fields_beside_solid(table.fields);
  fields.insert(fields.end(), mesh_inertia_fields().begin(), mesh_inertia_fields().end());
  Json schema =
      object_of(fields, "rigid body, inertia from a closed mesh", table.type, Values::of_scene, table.is_default);
  schema["properties"]["inertia"] = {{"const", std::string(kFromMesh)}};
  schema["required"].push_back("inertia");
  schema["oneOf"] = density_or_mass();
  return schema;
}

// A body with its inertia from a shape: the remaining fields of a body, and those of the shape.
Json shape_body(const ElementTable& table, const ShapeWord& word) {
  std::vector<Field> fields = fields_beside_solid(table.fields);
  fields.insert(fields.end(), word.body_fields.begin(), word.body_fields.end());
  Json schema = object_of(fields, "rigid body, inertia of a " + std::string(word.name), table.type, Values::of_scene,
                          table.is_default);
  schema["properties"][kInertiaKey] = {{"const", std::string(kFromShape)}};
  schema["properties"][kShapeKey] = {{"const", std::string(word.name)}};
  for (const std::string_view key : {kInertiaKey, kShapeKey}) schema["required"].push_back(std::string(key));
  schema["oneOf"] = density_or_mass();
  return schema;
}

// A body with its inertia from a list of shapes.
Json parts_body(const ElementTable& table) {
  std::vector<Field> fields = fields_beside_solid(table.fields);
  fields.insert(fields.end(), parts_fields().begin(), parts_fields().end());
  Json schema =
      object_of(fields, "rigid body, inertia from a list of shapes", table.type, Values::of_scene, table.is_default);
  Json shapes = Json::array();
  for (const ShapeWord& word : shape_words()) {
    Json part = object_of(word.part_fields, word.doc, "", Values::of_scene);
    part["properties"][kShapeKey] = {{"const", std::string(word.name)}};
    part["required"].push_back(std::string(kShapeKey));
    shapes.push_back(std::move(part));
  }
  schema["properties"][kInertiaKey] = {{"const", std::string(kFromParts)}};
  schema["properties"][kPartsKey] = list_of({{"oneOf", std::move(shapes)}}, 0);
  schema["properties"][kPartsKey]["description"] = "shapes whose masses, centres and inertia tensors add";
  schema["required"] = Json::array({std::string(kInertiaKey), std::string(kPartsKey)});
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
  return object_of(fields, table.doc, table.type, Values::of_scene);
}

// keys that the loader resolves: templates, named points, frames
void add_language_keys(Json& type, const ElementTable& table) {
  Json& properties = type["properties"];
  if (table.section == "bodies") {
    const Json position = list_of(quantity(Range{}, Values::of_scene), 3);
    Json frame = {{"type", "object"}, {"additionalProperties", false}, {"required", Json::array({"position"})}};
    frame["properties"] = {{"position", position}, {"orientation", position}};
    properties[kPointsKey] = named({{"anyOf", Json::array({position, std::move(frame)})}});
    properties[kPointsKey]["description"] = "named points, usable as Body.name; the orientation is a joint frame's";
  }
  for (const char* number : {"", "1", "2"}) {
    const auto has = [&](const std::string& key) {
      return std::any_of(table.fields.begin(), table.fields.end(),
                         [&](const Field& field) { return field.key == key; });
    };
    const std::string suffix = number, key = std::string(kFrameKey) + suffix;
    if (has(key) || !has("body" + suffix) || !has("point" + suffix) || !has("orientation" + suffix)) continue;
    properties[key] = text_like(kPointText);
    properties[key]["description"] = "named point that gives body, point and orientation";
  }
}

// An element under a template, which may give any of its keys.
Json element_of_template(std::string_view section) {
  Json schema = {{"type", "object"}, {"required", Json::array({std::string(kUseKey)})}};
  Json& properties = schema["properties"] = Json::object();
  const Json text = {{"type", "string"}};
  properties[kUseKey] = {{"anyOf", Json::array({text, list_of(text, 0)})},
                         {"description", "template, or list of templates, that this element is laid over"}};
  for (const ElementTable& table : element_tables()) {
    if (table.section != section) continue;
    for (const Field& field : table.fields) {
      // keys of several types may take different values
      if (!properties.find(field.key)) properties[field.key] = {{"description", std::string(field.doc)}};
    }
  }
  return schema;
}

// All forms of the elements of a section; the last one is laid over a template.
Json forms_of(std::string_view section) {
  Json types = Json::array();
  for (const ElementTable& table : element_tables()) {
    if (table.section != section) continue;
    const bool is_flexible = section == "bodies" && !table.is_default;
    Json type = is_flexible ? flexible_body(table)
                            : object_of(table.fields, table.doc, table.type, Values::of_scene, table.is_default);
    for (const ListTable& list : table.lists) {
      type["properties"][std::string(list.key)] = list_of(object_of(list.fields, list.doc, "", Values::of_scene), 0);
    }
    add_language_keys(type, table);
    types.push_back(std::move(type));
    if (section != "bodies" || !table.is_default) continue;
    types.push_back(mesh_body(table));
    for (const ShapeWord& word : shape_words()) types.push_back(shape_body(table, word));
    types.push_back(parts_body(table));
  }
  types.push_back(element_of_template(section));
  return types;
}

// "bodies.rigid.from_shape.box": the section, and what makes this form of its elements one of its own.
std::string name_of_form(std::string_view section, const Json& form) {
  std::string name(section);
  const Json& properties = form.at("properties");
  if (properties.find(kUseKey) != nullptr) return name + "." + std::string(kUseKey);
  for (const std::string_view key : {std::string_view("type"), kInertiaKey, kShapeKey}) {
    const Json* const property = properties.find(key);
    const Json* const word = property == nullptr ? nullptr : property->find("const");
    if (word != nullptr) name += "." + word->text();
  }
  return name;
}

// Parts of a form that a whole element must have.
constexpr const char* kDemands[] = {"required", "oneOf"};

// Ground is there by itself and has named points alone.
Json ground(const Json& forms) {
  Json schema = {{"type", "object"}, {"description", "the world"}, {"additionalProperties", false}};
  schema["properties"] = {{kPointsKey, forms.items().front().at("properties").at(kPointsKey)}};
  return schema;
}

// The elements of a file: whole ones, or with an include also parts of those of the included files.
enum class Elements { whole, of_include };

Json elements_of(std::string_view section, Elements elements, const Json& forms) {
  Json types = Json::array();
  for (const Json& form : forms.items()) {
    Json type = reference_to(name_of_form(section, form));
    // what lies over a template takes any key, and only `use` makes it one
    const bool is_whole = elements == Elements::whole || form.at("properties").find(kUseKey) != nullptr;
    for (const char* const demand : kDemands) {
      if (is_whole && form.find(demand) != nullptr) type[demand] = form.at(demand);
    }
    types.push_back(std::move(type));
  }
  const char* const choice = elements == Elements::whole ? "oneOf" : "anyOf";
  Json schema = {{"additionalProperties", Json{{choice, std::move(types)}}}};
  if (section == "bodies") schema["properties"] = {{std::string(multibody::kGroundName), ground(forms)}};
  return schema;
}

// The forms of a section's elements by name, without what a whole element must have.
void add_definitions(Json& definitions, std::string_view section, const Json& forms) {
  for (const Json& form : forms.items()) {
    Json definition = form;
    for (const char* const demand : kDemands) definition.erase(demand);
    definitions[name_of_form(section, form)] = std::move(definition);
  }
}

Json script() {
  Json schema = object_of(script_fields(), "the scene's own operator", "", Values::of_scene);
  Json change = object_of(script_change_fields(), "change of a live parameter", "", Values::of_scene);
  // name of a choice
  change["properties"]["value"] = {{"type", Json::array({"number", "string"})}};
  change["required"].push_back("value");
  Json& properties = schema["properties"];
  properties["file"] = {{"type", "string"}, {"description", "CSV or YAML file beside the scene, instead of inputs"}};
  const Json text = {{"type", "string"}};
  properties["columns"] = list_of(text, 0);
  properties["columns"]["description"] = "used columns of the CSV file; default: those of inputs";
  properties["sha256"] = {{"type", "string"}, {"description", "content that the CSV file must have"}};
  properties["inputs"] = {{"type", "object"},
                          {"additionalProperties", property(script_track_fields().front(), Values::of_scene)}};
  properties["parameters"] = list_of(std::move(change), 0);
  return schema;
}

Json flexible_section() {
  Json shapes = Json::array();
  for (const flex::SectionType& type : flex::section_types()) {
    Json schema = object_of(type.fields, type.doc, "", Values::plain);
    schema["properties"]["shape"] = {{"const", std::string(type.name)}};
    schema["required"].push_back("shape");
    if (type.shape == flex::SectionShape::given)
      schema["properties"]["stress_points"] =
          list_of(object_of(flex::stress_point_fields(), "points of stress output", "", Values::plain), 0);
    shapes.push_back(std::move(schema));
  }
  return {{"oneOf", std::move(shapes)}};
}

}  // namespace

std::string flexible_json_schema() {
  Json schema = object_of(flex::body_fields(), "a flexible body", "", Values::plain);
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["title"] = "Slewring flexible body";
  const Json text = {{"type", "string"}};
  Json& properties = schema["properties"];
  properties["include"] = {{"anyOf", Json::array({text, list_of(text, 0)})},
                           {"description", "files that this one is merged over"}};
  // with an include a material may be that of the included file with other values
  Json material = object_of(flex::material_fields(), "material", "", Values::plain);
  schema["if"] = {{"required", Json::array({"include"})}};
  schema["else"] = {{"properties", {{"materials", named(material)}}}};
  material.erase("required");
  properties["materials"] = named(std::move(material));
  properties["sections"] = named(flexible_section());
  properties["line"] = object_of(flex::line_fields(), "nodes 1, 2, ... at equal distances", "", Values::plain);
  properties["nodes"] = {{"type", "object"},
                         {"propertyNames", {{"pattern", "^[0-9]+$"}}},
                         {"additionalProperties", property(flex::node_field(), Values::plain)}};
  properties["elements"] = list_of(object_of(flex::element_fields(), "elements in a row", "", Values::plain), 0);
  properties["matrices"] =
      object_of(flex::matrix_file_fields(), "files of another finite element code", "", Values::plain);
  properties["reduction"] = object_of(flex::reduction_fields(), "reduction of the body", "", Values::plain);
  // with an include the names may stand there
  schema.erase("required");
  schema["$defs"] = text_definitions({kQuantityText});
  return schema.dump(2, Json::Order::as_put) + "\n";
}

namespace {

// the top-level keys that the loader resolves
void add_language_sections(Json& properties) {
  const Json text = {{"type", "string"}}, any = {{"type", "object"}};
  const Json value = {{"type", Json::array({"number", "string", "boolean", "array"})}};
  const Json declared = {{"type", Json::array({"number", "string", "boolean", "null", "array"})}};
  const auto object = [](const char* first, const Json& type, std::vector<std::string> required) {
    Json schema = {{"type", "object"}, {"additionalProperties", false}, {"required", Json(required)}};
    schema["properties"] = {{first, type}, {"prefix", Json{{"type", "string"}}}};
    return schema;
  };
  Json file = object("file", text, {"file", "prefix"}), instance = object("group", text, {"group"});
  for (Json* schema : {&file, &instance}) (*schema)["properties"]["parameters"] = named(value);
  const Json entry = {{"anyOf", Json::array({text, std::move(file)})}};
  properties["include"] = {{"anyOf", Json::array({text, list_of(entry, 0)})},
                           {"description", "files that this one is merged over; with a prefix: groups of elements"}};
  properties["without"] = {{"anyOf", Json::array({text, list_of(text, 0)})},
                           {"description", "elements of the included files that are left out"}};
  const auto put = [&properties](std::string_view key, Json schema, const char* description) {
    properties[key] = std::move(schema);
    properties[key]["description"] = description;
  };
  put(kParametersKey, named(declared), "values for ${name}, or as parts of expressions");
  put(kTemplatesKey, named(any), "keys of elements by the name for `use`");
  put(kGroupsKey, named(any), "groups of elements: sections, with parameters of their own");
  put(kInstancesKey, named(std::move(instance)), "groups with a prefix before the names of their elements");
  const Json coordinate = quantity(Range{}, Values::of_scene);
  put(kStartKey, named({{"anyOf", Json::array({coordinate, list_of(coordinate, 2)})}}),
      "start coordinates of joints; loops are closed");
  put(kPayloadKey, {{"anyOf", Json::array({text, list_of(text, 0)})}}, "bodies that the machine lifts");
}

}  // namespace

std::string json_schema() {
  const Json text = {{"type", "string"}};
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Slewring scene"},
                 {"type", "object"},
                 {"additionalProperties", false}};
  Json& properties = schema["properties"] = Json::object();
  for (const std::string_view key : top_level_keys()) properties[std::string(key)] = Json::object();
  properties["scene"] = {{"type", "string"}, {"description", "name of the scene"}};
  properties["description"] = {{"type", "string"}, {"description", "description of the scene"}};
  add_language_sections(properties);
  properties["assets"] = list_of(text, 0);
  properties["assets"]["description"] = "files that every machine of a session must have alike";
  properties["script"] = script();
  for (const SingleTable& table : single_tables()) {
    properties[std::string(table.section)] = object_of(table.fields, table.doc, "", Values::of_scene);
  }
  Json whole = Json::object(), of_include = Json::object();
  Json definitions = text_definitions({kValueText, kExpressionText, kPointText});
  for (const std::string_view key : element_sections()) {
    const std::string section(key);
    properties[section] = {{"type", "object"},
                           {"propertyNames", {{"pattern", kNamePattern}, {"maxLength", kMaxNameLength}}}};
    const Json forms = forms_of(section);
    whole[section] = elements_of(section, Elements::whole, forms);
    of_include[section] = elements_of(section, Elements::of_include, forms);
    add_definitions(definitions, section, forms);
  }
  schema["if"] = {{"required", Json::array({"include"})}};
  schema["then"] = {{"properties", std::move(of_include)}};
  schema["else"] = {{"properties", std::move(whole)}};
  schema["$defs"] = std::move(definitions);
  return schema.dump(2, Json::Order::as_put) + "\n";
}

}  // namespace slew::scene
