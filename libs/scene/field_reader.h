// SPDX-License-Identifier: Apache-2.0
// Fills a Def from a map of the scene by the Def's field table, checking type, unit, range and choice of every value.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "scene/defs.h"
#include "scene/diagnostic.h"
#include "scene/place_map.h"
#include "scene/units.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// A reference by name, resolved after all elements are read.
struct Reference {
  std::string_view kind;  // Field::reference
  std::string name;
  std::string path;
  Mark mark;
};

struct LoadContext;

struct ReadContext {
  UnitSystem& units;
  Report& report;
  PlaceMap& places;
  std::vector<Reference>& references;
  const LoadContext* load_context = nullptr;      // null: files are not allowed
  std::vector<TableFile>* table_files = nullptr;  // receives the tables that stay in their files
  std::vector<std::string>* warnings = nullptr;   // null: unused keys are not searched for
};

// Reads every entry of `map` into the Def at `def`. Keys in `other_keys` belong to the caller and are skipped. A key
// unused with the present choices (Field::read_by) is an error. It is a warning if a choice of a later layer (an
// overlay, an override) made it unused, or if sweeps carry it along. path: prefix of the keys in messages, "Bag";
// place: position at which a missing key is reported.
void read_fields(const Node& map, std::span<const Field> fields, void* def, const std::string& path, const Mark& place,
                 std::span<const std::string_view> other_keys, const ReadContext& context);

// Reads one value; its problems go to the report.
void read_value(const Node& node, const Field& field, void* def, const std::string& path, const ReadContext& context);

// Reports duplicate keys of a map. path: "" at the root, else the prefix of the key.
void report_duplicates(const Node& map, const std::string& path, Report& report);

// True if a point with this argument may follow those of the table; and the rule for the field's arguments.
[[nodiscard]] bool may_follow(const Table& table, double argument, const Field& field);
[[nodiscard]] std::string order_text(const Field& field);

// Accepted values of a field, for messages: "a mass such as '500 kg', or a bare number in kg".
[[nodiscard]] std::string expected_value(const Field& field);

// "hold, linear, two or tlm".
[[nodiscard]] std::string choice_list(std::span<const std::string_view> choices);

// "more than 0 kg", "0 to 1", for messages and documentation; empty for any finite number.
[[nodiscard]] std::string range_text(const Range& range, Dimension dimension);

}  // namespace slew::scene
