// SPDX-License-Identifier: Apache-2.0
#include "scene/field_entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "core/dimension.h"
#include "scene/canonical.h"
#include "scene/names.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

// Six digits, "1e6" for 1e+06.
std::string short_number(double value) {
  std::string text = fmt::format("{:.6g}", value);
  for (const std::string_view zeros : {"e+0", "e-0", "e+"}) {
    const std::size_t found = text.find(zeros);
    if (found != std::string::npos) text.replace(found, zeros.size(), zeros == "e-0" ? "e-" : "e");
  }
  return text;
}

std::string bound_text(const Field& field, double value) {
  return field.type == FieldType::integer ? fmt::format("{}", value) : short_number(value);
}

// ">0", "0..1", ">=0, <1"
std::string range_word(const Field& field) {
  const Range& range = field.range;
  const bool has_min = std::isfinite(range.min), has_max = std::isfinite(range.max);
  const std::string min = bound_text(field, range.min), max = bound_text(field, range.max);
  if (has_min && has_max && !range.min_is_open && !range.max_is_open) return min + ".." + max;
  std::string text;
  if (has_min) text = (range.min_is_open ? ">" : ">=") + min;
  if (has_max) text += fmt::format("{}{}{}", has_min ? ", " : "", range.max_is_open ? "<" : "<=", max);
  return text;
}

bool is_numeric(FieldType type) {
  switch (type) {
    case FieldType::number:
    case FieldType::integer:
    case FieldType::triple:
    case FieldType::triples:
    case FieldType::table:
    case FieldType::numbers:
      return true;
    case FieldType::boolean:
    case FieldType::text:
    case FieldType::texts:
    case FieldType::choice:
      return false;
  }
  return false;
}

// "hold, linear, **two** or tlm": the default is bold.
std::string choices_of(const Field& field, void* defaults) {
  const std::string chosen = field.presence == Presence::required ? "" : value_text(field, defaults);
  std::string text;
  for (std::size_t i = 0; i < field.choices.size(); ++i) {
    if (i > 0) text += i + 1 < field.choices.size() ? ", " : " or ";
    text += field.choices[i] == chosen ? "**" + chosen + "**" : std::string(field.choices[i]);
  }
  return text;
}

std::string kind_text(const Field& field, void* defaults) {
  const DimensionInfo& about = info(field.dimension);
  switch (field.type) {
    case FieldType::number:
      return about.si_unit != "1" || !range_word(field).empty() ? "" : std::string(about.name);
    case FieldType::integer:
      return "integer";
    case FieldType::boolean:
      return "true or false";
    case FieldType::text:
      return field.reference.empty() ? "text" : with_article(field.reference);
    case FieldType::triple:
      return "three";
    case FieldType::triples:
      return "list of three";
    case FieldType::table:
      return "points";
    case FieldType::numbers:
      return "list";
    case FieldType::texts:
      return "list of texts";
    case FieldType::choice:
      return choices_of(field, defaults);
  }
  return {};
}

std::string unit_text(const Field& field) {
  const DimensionInfo& about = info(field.dimension);
  const bool has_unit = is_numeric(field.type) && field.type != FieldType::integer && field.type != FieldType::table;
  if (!has_unit || about.si_unit == "1") return {};
  return std::string(about.si_unit) + (field.dimension == Dimension::temperature_difference ? " (difference)" : "");
}

std::string shown_default(const Field& field, void* defaults) {
  if (field.presence == Presence::required) return "required";
  const bool is_number = field.type == FieldType::number;
  if (field.type == FieldType::choice) return {};  // choices_of()
  std::string value = value_text(field, defaults);
  if (value.empty()) return is_number || field.type == FieldType::triple ? "none" : "";
  if (value == "[]") return {};
  return is_number ? short_number(std::stod(value)) : value;
}

bool has_value(const FieldEntry& entry) {
  return !entry.value.empty() && entry.value != "required" && entry.value != "none";
}

void append_part(std::string& text, const std::string& part, std::string_view separator = ", ") {
  if (!text.empty() && !part.empty()) text += separator;
  text += part;
}

bool is_word_part(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

std::string with_words_replaced(std::string text, const std::string& word, std::string_view by) {
  for (std::size_t i = 0; (i = text.find(word, i)) != std::string::npos; ++i) {
    const std::size_t next = i + word.size();
    const bool is_begin = word.front() == '_' || i == 0 || !is_word_part(text[i - 1]);
    if (is_begin && (next == text.size() || !is_word_part(text[next]))) text.replace(i, word.size(), by);
  }
  return text;
}

// `*` in place of the end of a key, its last digit or what is behind its last `_`, where its text repeats it: "body 1"
// for `point1`, "curve_pa" and "edge P-A" for `overlap_pa`, "along y" for `shear_factor_y`.
std::string without_key_end(std::string text, std::string_view key) {
  const std::size_t begin = key.rfind('_');
  if (begin == std::string_view::npos) {
    const bool has_digit = std::isdigit(static_cast<unsigned char>(key.back())) != 0;
    return has_digit ? with_words_replaced(std::move(text), std::string(1, key.back()), "*") : text;
  }
  const std::string end(key.substr(begin)), small = end.substr(1);
  std::string capital;
  for (const char c : small) {
    capital +=
        fmt::format("{}{}", capital.empty() ? "" : "-", static_cast<char>(std::toupper(static_cast<unsigned char>(c))));
  }
  if (small.empty()) return text;
  text = with_words_replaced(with_words_replaced(std::move(text), end, "_*"), capital, "*");
  return small == "y" || small == "z" ? with_words_replaced(std::move(text), small, "*") : text;
}

// "`port_1` at the inlet; `port_2`, not required, ..."
std::string ports_item(std::span<const FieldEntry> entries) {
  std::string text;
  constexpr std::string_view kNoun = "volume ";
  for (const FieldEntry& entry : entries) {
    if (!entry.is_port) continue;
    std::string meaning = entry.meaning.starts_with(kNoun) ? entry.meaning.substr(kNoun.size()) : entry.meaning;
    // `port_a` needs no "at port A"
    if (without_key_end(meaning, entry.key) == "at port *") meaning.clear();
    append_part(text,
                fmt::format("`{}`{}{}{}", entry.key, entry.value == "required" ? "" : " (optional)",
                            meaning.empty() ? "" : " ", meaning),
                "; ");
  }
  return "- volumes: " + text + '\n';
}

constexpr std::size_t kLineWidth = 120;  // of prose in documents, in characters; tests/architecture/words_test.py

// One line of prose, or one item, in lines of kLineWidth, broken at spaces outside of code spans.
std::string wrapped(std::string_view line) {
  const std::string_view indent = line.starts_with("- ") ? "  " : "";
  std::string text;
  std::size_t width = 0, begin = 0;
  bool is_code = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '`') is_code = !is_code;
    if (i < line.size() && (line[i] != ' ' || is_code)) continue;
    const std::string_view word = line.substr(begin, i - begin);
    const bool fits = width + 1 + word.size() <= kLineWidth;
    if (begin > 0) text += fits ? " " : fmt::format("\n{}", indent);
    text += word;
    width = (begin == 0 ? 0 : fits ? width + 1 : indent.size()) + word.size();
    begin = i + 1;
  }
  return text;
}

}  // namespace

FieldEntry entry_of(const Field& field, void* defaults) {
  FieldEntry entry{.key = field.key,
                   .kind = kind_text(field, defaults),
                   .unit = unit_text(field),
                   .range = is_numeric(field.type) ? range_word(field) : "",
                   .value = shown_default(field, defaults),
                   .is_live = field.change == Change::live,
                   .is_port = field.reference == "volume",
                   .meaning = std::string(field.doc)};
  for (std::size_t i = 0; i < field.read_by.size(); ++i) {
    entry.meaning += fmt::format("{}{}", i == 0 ? "; with " : ", ", field.read_by[i].what);
  }
  return entry;
}

std::vector<FieldEntry> entries_of(std::span<const Field> fields, void* defaults) {
  std::vector<FieldEntry> entries;
  for (const Field& field : fields) entries.push_back(entry_of(field, defaults));
  return entries;
}

std::string default_text(const FieldEntry& entry) {
  std::string text = entry.value;
  if (has_value(entry)) append_part(text, entry.unit, " ");
  append_part(text, entry.is_live ? "live" : "");
  return text;
}

std::string facts_text(const FieldEntry& entry) {
  // a number, truth value or list of three shows its kind
  const bool shows_kind = entry.kind == "true or false" || entry.kind == "three" || entry.kind == "number";
  const std::string kind = has_value(entry) && shows_kind ? "" : entry.kind;
  std::string text;
  const bool is_first = has_value(entry) && (kind.empty() || kind == "integer" || kind == "control signal");
  if (is_first) text = entry.value + (entry.unit.empty() ? "" : " " + entry.unit);
  append_part(text, kind);
  if (!is_first) append_part(text, entry.unit);
  append_part(text, entry.range, kind == "integer" ? " " : ", ");
  if (!is_first) append_part(text, entry.value);
  append_part(text, entry.is_live ? "live" : "");
  return text;
}

std::string items_of(std::span<const FieldEntry> entries) {
  struct Item {
    std::string keys, facts, common;  // common: facts without the ends of the keys
  };
  std::vector<Item> items;
  const bool has_ports = std::count_if(entries.begin(), entries.end(), [](const auto& one) { return one.is_port; }) > 1;
  for (const FieldEntry& entry : entries) {
    if (has_ports && entry.is_port) continue;
    std::string name(entry.key);
    std::replace(name.begin(), name.end(), '_', ' ');
    // a key that states its meaning needs no more
    const std::string meaning = entry.meaning == name ? "" : ": " + entry.meaning;
    const std::string facts = fmt::format("({}){}", facts_text(entry), meaning);
    const std::string common = without_key_end(facts, entry.key), key = fmt::format("`{}`", entry.key);
    const auto same = std::find_if(items.begin(), items.end(), [&](const Item& one) { return one.common == common; });
    if (same == items.end()) {
      items.push_back({key, facts, common});
    } else {
      same->keys += ", " + key;
      if (same->facts != facts) same->facts = common;
    }
  }
  std::string text = has_ports ? ports_item(entries) : "";
  for (const Item& item : items) text += fmt::format("- {} {}\n", item.keys, item.facts);
  return text;
}

std::string joined_keys(std::span<const std::string> keys) {
  std::string text;
  for (const std::string& key : keys) append_part(text, fmt::format("`{}`", key));
  return text;
}

std::string with_wrapped_prose(std::string_view text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    result += line.starts_with('#') ? std::string(line) : wrapped(line);
    if (end < text.size()) result += '\n';
    begin = end + 1;
  }
  return result;
}

}  // namespace slew::scene
