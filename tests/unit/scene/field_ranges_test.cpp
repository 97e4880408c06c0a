// SPDX-License-Identifier: Apache-2.0
// Every field of every table refuses a value outside its range, with its path and the range in the message. The cases
// are made from the field tables, so that a new field is tested as soon as it is there.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "scene/field_reader.h"
#include "scene/mesh_inertia.h"
#include "scene/scene.h"
#include "scene/sections.h"
#include "scene/shape_fields.h"
#include "scene/units.h"

namespace slew::scene {
namespace field_ranges_test {

// A table, and how a scene begins that holds one field of it.
struct Case {
  std::string label;  // label of the table
  std::string owner;  // what stands before the key in messages
  std::string before;
  std::span<const Field> fields;
  std::string after{};  // behind the field, before the last brace
};

std::string in_list(const Field& field, const std::string& value) {
  switch (field.type) {
    case FieldType::triple:
      return fmt::format("[{0}, {0}, {0}]", value);
    case FieldType::triples:
      return fmt::format("[[{0}, {0}, {0}]]", value);
    case FieldType::table:
      return fmt::format("[[0, {}]]", value);
    case FieldType::numbers:
      return fmt::format("[{}]", value);
    default:
      return value;
  }
}

struct BadValue {
  std::string text, what, expected;
};

// Numbers just outside the range, or one that is no number where every finite number is taken.
std::vector<BadValue> bad_numbers(const Field& field) {
  std::vector<BadValue> bad;
  const Dimension dimension = field.type == FieldType::integer ? Dimension::none
                              : field.type == FieldType::table ? field.value_dimension
                                                               : field.dimension;
  const std::string range = range_text(field.range, dimension);
  const auto add = [&](double value) {
    const std::string number = fmt::format("{}", value);
    bad.push_back({in_list(field, number), fmt::format("'{}' is out of range", number), range});
  };
  if (std::isfinite(field.range.min)) {
    const double step = field.type == FieldType::integer ? 1 : std::max(1e-12, std::abs(field.range.min) * 1e-3);
    add(field.range.min_is_open ? field.range.min : field.range.min - step);
  }
  if (std::isfinite(field.range.max)) {
    const double step = field.type == FieldType::integer ? 1 : std::max(1e-12, std::abs(field.range.max) * 1e-3);
    add(field.range.max_is_open ? field.range.max : field.range.max + step);
  }
  bad.push_back({in_list(field, ".nan"), "'.nan' is not finite", "a finite number"});
  return bad;
}

std::vector<BadValue> bad_values(const Field& field) {
  switch (field.type) {
    case FieldType::number:
    case FieldType::integer:
    case FieldType::triple:
    case FieldType::triples:
    case FieldType::table:
    case FieldType::numbers:
      return bad_numbers(field);
    case FieldType::boolean:
      return {{"maybe", "is 'maybe'", "true or false"}};
    case FieldType::choice:
      return {{"no_such_choice", "is 'no_such_choice'", expected_value(field)}};
    case FieldType::text:
      if (field.reference.empty()) return {{"[a]", "is a list", "a text"}};
      return {{"No_such_element", fmt::format("no {} 'No_such_element'", field.reference), ""}};
    case FieldType::texts:
      return {{"{a: b}", "is a map", expected_value(field)}};
  }
  return {};
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const SingleTable& table : single_tables()) {
    const std::string section(table.section);
    all.push_back({section, section, fmt::format("{}: {{", section), table.fields});
  }
  for (const ElementTable& table : element_tables()) {
    const std::string type = table.type.empty() ? "" : fmt::format("type: {}, ", table.type);
    const std::string label =
        table.type.empty() ? std::string(table.section) : fmt::format("{}_{}", table.section, table.type);
    all.push_back({label, "Thing", fmt::format("{}:\n  Thing: {{{}", table.section, type), table.fields});
    for (const ListTable& list : table.lists) {
      all.push_back({fmt::format("{}_{}", label, list.key), fmt::format("Thing.{}[0]", list.key),
                     fmt::format("{}:\n  Thing: {{{}{}: [{{", table.section, type, list.key), list.fields, "}]"});
    }
  }
  all.push_back({"bodies_from_mesh", "Thing", "bodies:\n  Thing: {inertia: from_mesh, ", mesh_inertia_fields()});
  for (const ShapeWord& word : shape_words()) {
    all.push_back({fmt::format("bodies_from_shape_{}", word.name), "Thing",
                   fmt::format("bodies:\n  Thing: {{inertia: from_shape, shape: {}, ", word.name), word.body_fields});
    all.push_back({fmt::format("bodies_from_parts_{}", word.name), "Thing.parts[0]",
                   fmt::format("bodies:\n  Thing: {{inertia: from_parts, parts: [{{shape: {}, ", word.name),
                   word.part_fields, "}]"});
  }
  all.push_back({"bodies_from_parts", "Thing", "bodies:\n  Thing: {inertia: from_parts, ", parts_fields()});
  return all;
}

void expect_refusal(const Case& one, const Field& field, const BadValue& bad) {
  const std::string text = fmt::format("{}{}: {}{}}}\n", one.before, field.key, bad.text, one.after);
  const std::string path = fmt::format("{}.{}", one.owner, field.key);
  try {
    (void)load_text(text, "test");
    ADD_FAILURE() << "accepted:\n" << text;
  } catch (const LoadError& error) {
    const auto& diagnostics = error.diagnostics();
    const bool is_reported = std::any_of(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& diagnostic) {
      return diagnostic.path == path && diagnostic.what == bad.what && diagnostic.expected == bad.expected &&
             diagnostic.line > 0;
    });
    EXPECT_TRUE(is_reported) << text << path << ": " << bad.what << "; expected " << bad.expected << "\nis not in\n"
                             << error.what();
  }
}

TEST(FieldRanges, OfEveryFieldAreCheckedWithPathAndMessage) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.label);
    for (const Field& field : one.fields) {
      for (const BadValue& bad : bad_values(field)) expect_refusal(one, field, bad);
    }
  }
}

}  // namespace field_ranges_test
}  // namespace slew::scene
