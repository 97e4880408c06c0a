// SPDX-License-Identifier: Apache-2.0
#include "scene/canonical.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "scene/assets.h"
#include "scene/scope.h"
#include "scene/sections.h"
#include "scene/table_file.h"

namespace slew::scene {
namespace {

// words that some YAML version does not read as text
constexpr std::string_view kLoadedWords[] = {"true", "false", "yes", "no", "on", "off", "y", "n", "null", "nan", "inf"};

bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
}

bool is_plain_word(const std::string& text) {
  if (text.empty() || !((text[0] >= 'a' && text[0] <= 'z') || (text[0] >= 'A' && text[0] <= 'Z') || text[0] == '_')) {
    return false;
  }
  std::string word = text;
  for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return std::all_of(text.begin(), text.end(), is_word_character) &&
         std::find(std::begin(kLoadedWords), std::end(kLoadedWords), word) == std::end(kLoadedWords);
}

// Shortest text that reads back to the same bits.
std::string number_text(double value) {
  return fmt::format("{}", value);
}

template <typename Value>
const Value& member(const Field& field, void* def) {
  return *static_cast<const Value*>(field.member(def));
}

template <typename Range, typename Format>
std::string list_text(const Range& values, const Format& format) {
  std::string text = "[";
  for (const auto& value : values) {
    if (text.size() > 1) text += ", ";
    text += format(value);
  }
  return text + "]";
}

std::string point_text(const std::array<double, 2>& point) {
  return fmt::format("[{}, {}]", point[0], point[1]);
}

// The file of a table that is kept outside the text; null: it is in the text.
const TableFile* file_of(const Scene& scene, const std::string& path) {
  for (const TableFile& table : scene.table_files) {
    if (table.path == path) return &table;
  }
  return nullptr;
}

enum class UnreadKeys : std::uint8_t { written, left_out };

bool is_written(const Field& field, const void* def, UnreadKeys unread) {
  return unread == UnreadKeys::written || std::all_of(field.read_by.begin(), field.read_by.end(),
                                                      [&](const ReadBy& condition) { return condition.holds(def); });
}

void write_fields(std::string& text, const Scene& scene, const ElementRef& element, std::string_view indent,
                  UnreadKeys unread) {
  for (const Field& field : element.fields) {
    if (!is_written(field, element.def, unread)) continue;
    const TableFile* file =
        field.type == FieldType::table ? file_of(scene, fmt::format("{}.{}", element.name, field.key)) : nullptr;
    const std::string value = file != nullptr ? reference_text(*file) : value_text(field, element.def);
    if (!value.empty()) text += fmt::format("{}{}: {}\n", indent, field.key, value);
  }
}

void write_lists(std::string& text, const ElementRef& element, UnreadKeys unread) {
  for (const ListTable& list : element.lists) {
    const std::vector<void*> rows = list.rows(element.def);
    if (!rows.empty()) text += fmt::format("    {}:\n", list.key);
    for (void* const row : rows) {
      std::string line;
      for (const Field& field : list.fields) {
        if (!is_written(field, row, unread)) continue;
        const std::string value = value_text(field, row);
        if (!value.empty()) line += fmt::format("{}{}: {}", line.empty() ? "" : ", ", field.key, value);
      }
      text += fmt::format("      - {{{}}}\n", line);
    }
  }
}

struct Longest {
  std::string element;
  std::size_t bytes = 0;
};

void write_elements(std::string& text, const Scene& scene, const std::vector<ElementRef>& all, std::string_view section,
                    UnreadKeys unread, Longest& longest) {
  bool is_first = true;
  for (const ElementRef& element : all) {
    if (element.section != section) continue;
    if (is_first) text += fmt::format("{}:\n", section);
    is_first = false;
    std::string fields;
    if (!element.type.empty()) fields += fmt::format("    type: {}\n", element.type);
    write_fields(fields, scene, element, "    ", unread);
    write_lists(fields, element, unread);
    text += fmt::format("  {}:{}{}", element.name, fields.empty() ? " {}\n" : "\n", fields);
    if (fields.size() > longest.bytes) longest = {std::string(element.name), fields.size()};
  }
}

void write_tracks(std::string& text, const Scene& scene) {
  const ScriptDef& script = scene.script;
  if (script.file) {
    const TableFile& file = *script.file;
    text += fmt::format("  file: {}\n  sha256: \"{}\"\n", yaml_text(file.file), hex_text(file.sha256));
    if (!file.columns.empty()) text += fmt::format("  columns: {}\n", list_text(file.columns, yaml_text));
    return;
  }
  if (!script.tracks.empty()) text += "  inputs:\n";
  for (const ScriptTrack& track : script.tracks) {
    const TableFile* file = file_of(scene, "script.inputs." + track.input);
    text += fmt::format("    {}: {}\n", track.input,
                        file != nullptr ? reference_text(*file) : list_text(track.points, point_text));
  }
}

void write_script(std::string& text, const Scene& scene) {
  const ScriptDef& script = scene.script;
  if (script.is_empty()) return;
  text += fmt::format("script:\n  interpolation: {}\n",
                      script.interpolation == ScriptInterpolation::linear ? "linear" : "step");
  write_tracks(text, scene);
  if (!script.changes.empty()) text += "  parameters:\n";
  for (const ScriptChange& change : script.changes) {
    const std::string value = change.choice.empty() ? number_text(change.value) : change.choice;
    text += fmt::format("    - {{at: {}, set: {}, value: {}, over: {}}}\n", change.at, change.set, value, change.over);
  }
}

}  // namespace

std::string value_text(const Field& field, void* def) {
  switch (field.type) {
    case FieldType::number: {
      const double value = member<double>(field, def);
      return std::isfinite(value) && field.range.contains(value) ? number_text(value) : "";
    }
    case FieldType::integer:
      return std::to_string(member<std::int64_t>(field, def));
    case FieldType::boolean:
      return member<bool>(field, def) ? "true" : "false";
    case FieldType::text: {
      const auto& text = member<std::string>(field, def);
      return text.empty() ? "" : yaml_text(text);
    }
    case FieldType::triple: {
      // an omitted value is infinite
      const auto& triple = member<Triple>(field, def);
      return std::isfinite(triple[0]) ? list_text(triple, number_text) : "";
    }
    case FieldType::triples:
      return list_text(member<std::vector<Triple>>(field, def),
                       [](const Triple& triple) { return list_text(triple, number_text); });
    case FieldType::table: {
      const auto& table = member<Table>(field, def);
      return table.empty() ? "" : list_text(table, point_text);
    }
    case FieldType::numbers:
      return list_text(member<std::vector<double>>(field, def), number_text);
    case FieldType::texts:
      return list_text(member<std::vector<std::string>>(field, def), yaml_text);
    case FieldType::choice:
      return std::string(field.choices[static_cast<std::size_t>(field.get_choice(def))]);
  }
  return {};
}

std::string yaml_text(const std::string& text) {
  return yaml_scalar(is_expression(text) || is_escaped(text) ? "$" + text : text);
}

std::string yaml_scalar(const std::string& text) {
  if (is_plain_word(text)) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (c == '\n') {
      quoted += "\\n";
    } else if (c == '\t') {
      quoted += "\\t";
    } else if (c == '\r') {
      quoted += "\\r";
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

namespace {

std::string text_of(Scene& scene, UnreadKeys unread, Problems& problems) {
  std::string text = "scene: " + yaml_text(scene.name) + "\n";
  if (!scene.description.empty()) text += "description: " + yaml_text(scene.description) + "\n";
  if (!scene.assets.empty()) {
    text += "assets: " + list_text(scene.assets, [](const Asset& asset) { return yaml_text(asset.name); }) + "\n";
  }
  if (!scene.other_payloads.empty()) {
    std::vector<std::string> payloads = scene.other_payloads;
    payloads.insert(payloads.begin(), scene.mechanics.payload);
    text += "payload: " + list_text(payloads, yaml_text) + "\n";
  }
  const std::vector<ElementRef> all = elements(scene);
  for (const ElementRef& single : single_sections(scene)) {
    text += fmt::format("{}:\n", single.section);
    write_fields(text, scene, single, "  ", unread);
  }
  Longest longest;
  for (const std::string_view section : element_sections()) write_elements(text, scene, all, section, unread, longest);
  write_script(text, scene);
  if (text.size() > kMaxExpandedBytes) {
    problems.push_back(
        {longest.element,
         fmt::format("the scene with its script has {} bytes when published to the nodes, {} of them in '{}'",
                     text.size(), longest.bytes, longest.element),
         fmt::format("at most {}: meshes of fewer triangles; long tables in .csv files are not counted",
                     kMaxExpandedBytes),
         ""});
  }
  return text;
}

std::string text_of(Scene& scene, UnreadKeys unread) {
  Problems problems;
  std::string text = text_of(scene, unread, problems);
  if (problems.empty()) return text;
  const Problem& problem = problems.front();
  throw LoadError({{.file = scene.name,
                    .path = problem.path,
                    .what = problem.what,
                    .expected = problem.expected,
                    .suggestion = problem.suggestion}},
                  0);
}

}  // namespace

std::string canonical_text(Scene& scene, Problems& problems) {
  return text_of(scene, UnreadKeys::written, problems);
}

std::string canonical_text(Scene& scene) {
  return text_of(scene, UnreadKeys::written);
}

std::string file_text(Scene& scene) {
  return text_of(scene, UnreadKeys::left_out);
}

}  // namespace slew::scene
