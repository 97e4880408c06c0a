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

// A name that a value refers to, resolved when all elements are known.
struct Reference {
  std::string_view kind;  // Field::reference
  std::string name;
  std::string path;
  Mark mark;
};

struct Surroundings;

struct ReadContext {
  UnitSystem& units;
  Report& report;
  PlaceMap& places;
  std::vector<Reference>& references;
  const Surroundings* surroundings = nullptr;     // null: no file may be named
  std::vector<TableFile>* table_files = nullptr;  // gets the tables that stay in their files
  std::vector<std::string>* warnings = nullptr;   // null: keys that nothing reads are not looked for
};

// Reads every entry of `map` into the Def at `def`. Keys in `other_keys` are the caller's and are left alone. A key
// that nothing reads with the choices beside it (Field::read_by) is an error; where a choice of a later layer (an
// overlay, an override) left it unread, or where sweeps carry it along, a warning. path: what stands before the keys in
// messages, "Bag"; place: where a missing key is reported.
void read_fields(const Node& map, std::span<const Field> fields, void* def, const std::string& path, const Mark& place,
                 std::span<const std::string_view> other_keys, const ReadContext& context);

// Reads one value; its problems go to the report.
void read_value(const Node& node, const Field& field, void* def, const std::string& path, const ReadContext& context);

// Reports the keys that a map holds twice. path: "" at the root, else what stands before the key.
void report_duplicates(const Node& map, const std::string& path, Report& report);

// Whether a point with this argument may come behind those of the table, and how arguments of the field go on.
[[nodiscard]] bool may_follow(const Table& table, double argument, const Field& field);
[[nodiscard]] std::string order_text(const Field& field);

// What a field takes, for messages: "a mass such as '500 kg', or a bare number in kg".
[[nodiscard]] std::string expected_value(const Field& field);

// "hold, linear, two or tlm".
[[nodiscard]] std::string choice_list(std::span<const std::string_view> choices);

// "more than 0 kg", "0 to 1", for messages and documentation; empty for any finite number.
[[nodiscard]] std::string range_text(const Range& range, Dimension dimension);

}  // namespace slew::scene
