// SPDX-License-Identifier: Apache-2.0
// Elements of a scene's text: added, copied, renamed, removed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/dimension.h"
#include "multibody/model/defs.h"
#include "scene/defs.h"
#include "scene/element_table.h"
#include "scene/names.h"
#include "scene/scene_text.h"
#include "scene/sections.h"
#include "scene/text_references.h"
#include "scene/units.h"

namespace slew::scene {
namespace {

// A number in the range: 0 or 1 where they lie in it, else between its ends.
double number_in(const Range& range, double wanted) {
  for (const double one : {wanted, 1.0, 0.0}) {
    if (range.contains(one)) return one;
  }
  if (std::isfinite(range.min) && std::isfinite(range.max)) return 0.5 * (range.min + range.max);
  return std::isfinite(range.min) ? range.min + 1 : range.max - 1;
}

std::string quantity_text(double value, Dimension dimension) {
  const std::string_view unit = info(dimension).si_unit;
  return is_plain_number(dimension) || unit == "1" ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

// A value to begin with. named: an element that a reference may name.
std::string first_value(const Field& field, const std::string& named) {
  const auto number = [&field](double wanted) {
    return quantity_text(number_in(field.range, wanted), field.dimension);
  };
  switch (field.type) {
    case FieldType::number:
      return number(1);
    case FieldType::integer:
      return fmt::format("{}", std::ceil(number_in(field.range, 1)));
    case FieldType::boolean:
      return "false";
    case FieldType::text:
      return field.reference.empty() ? "text" : named;
    case FieldType::triple:
      return fmt::format("[{0}, {0}, {0}]", number(0));
    case FieldType::triples:
      return fmt::format("[[{0}, {0}, {0}]]", number(0));
    case FieldType::table: {
      const std::string value = quantity_text(number_in(field.range, 0), field.value_dimension);
      return fmt::format("[[{0}, {2}], [{1}, {2}]]", quantity_text(0, field.dimension),
                         quantity_text(1, field.dimension), value);
    }
    case FieldType::numbers:
      return fmt::format("[{}]", number(1));
    case FieldType::texts:
      return field.reference.empty() ? "[]" : "[" + named + "]";
    case FieldType::choice:
      return std::string(field.choices.front());
  }
  return {};
}

std::string note_of(const TextReference& reference) {
  return fmt::format("{} (line {})", reference.path, reference.mark().line);
}

}  // namespace

std::string SceneText::name_problem(std::string_view name) const {
  const auto& keys = top_level_keys();
  if (!is_word(name)) return fmt::format("'{}' is no name: use letters, digits and _, beginning with a letter", name);
  if (name.size() > kMaxNameLength) return fmt::format("a name has at most {} characters", kMaxNameLength);
  if (name == multibody::kGroundName || std::find(keys.begin(), keys.end(), name) != keys.end())
    return fmt::format("the name '{}' is reserved: use another one", name);
  if (const Element taken = find(name); taken.entry != nullptr)
    return fmt::format("the name '{}' is taken (line {}): use another one", name, taken.entry->mark.line);
  return {};
}

std::string SceneText::some_of(std::string_view kinds, std::size_t number) const {
  for (const ElementTable& table : element_tables()) {
    const Node::Entry* section = root_.find(table.section);
    if (section != nullptr && is_one_of(table.kind, kinds) && !section->value.entries.empty())
      return section->value.entries[std::min(number, section->value.entries.size() - 1)].key;
  }
  return is_one_of("body", kinds) ? std::string(multibody::kGroundName) : "";
}

TextEdit SceneText::prove_read(std::string result) const {
  Report report;
  std::optional<SceneText> read_again = read(std::move(result), report.add_source(""), report);
  if (read_again) return {read_again->text(), {}, {}};
  try {
    report.fail(1);
  } catch (const LoadError& error) {
    return refuse("the text is written in a way for which there is no such edit: change the text itself: " +
                  error.first_reason());
  }
}

std::string SceneText::with_element(std::string_view section, std::string_view name,
                                    const std::vector<std::pair<std::string, std::string>>& fields) const {
  std::string text = source_.text, in_brackets;
  for (const auto& [key, value] : fields)
    in_brackets += fmt::format("{}{}: {}", in_brackets.empty() ? "" : ", ", key, value);
  const Node::Entry* present = root_.find(section);
  const bool has_map = present != nullptr && present->value.kind == Node::Kind::map && !present->value.entries.empty();
  if (has_map && is_in_brackets(present->value)) {
    return text.insert(end_of(present->value.entries.back()), fmt::format(", {}: {{{}}}", name, in_brackets));
  }
  const std::size_t indent = has_map ? static_cast<std::size_t>(present->value.entries.front().mark.column) - 1 : 2;
  std::string lines = fmt::format("{}{:{}}{}:", line_break(), "", indent, name);
  for (const auto& [key, value] : fields)
    lines += fmt::format("{}{:{}}{}: {}", line_break(), "", indent + 2, key, value);
  if (fields.empty()) lines += " {}";
  if (present == nullptr) {
    if (!text.ends_with('\n')) text += line_break();
    return text + line_break() + std::string(section) + ":" + lines + line_break();
  }
  if (has_map) return text.insert(line_end(end_of(present->value.entries.back())), lines);
  // nothing, or empty brackets
  const std::size_t colon = behind_colon(*present);
  const std::size_t end = std::max(colon, end_of(*present));
  text.erase(colon, end - colon);
  std::size_t at = std::min(text.find('\n', colon), text.size());
  if (at > colon && text[at - 1] == '\r') --at;
  return text.insert(at, lines);
}

TextEdit SceneText::add(std::string_view section, std::string_view type, std::string_view name) const {
  const auto& tables = element_tables();
  const auto table = std::find_if(tables.begin(), tables.end(), [&](const ElementTable& one) {
    return one.section == section && (one.type == type || (type.empty() && one.is_default));
  });
  if (table == tables.end()) return refuse(fmt::format("there is no kind of element '{}' '{}'", section, type));
  if (std::string problem = name_problem(name); !problem.empty()) return refuse(std::move(problem));
  std::vector<std::pair<std::string, std::string>> fields;
  if (!table->type.empty() && !table->is_default) fields.emplace_back("type", table->type);
  std::map<std::string_view, std::size_t> references;  // number of those of the same kinds so far
  for (const Field& field : table->fields) {
    if (field.presence != Presence::required) continue;
    std::string named = field.reference.empty() ? "" : some_of(field.reference, references[field.reference]++);
    if (named.empty()) named = "none";  // the loader reports it
    fields.emplace_back(field.key, first_value(field, named));
  }
  return prove_read(with_element(section, name, fields));
}

TextEdit SceneText::copy(std::string_view name, std::string_view other) const {
  const Element element = find(name);
  if (element.entry == nullptr) return refuse(fmt::format("this file has no element '{}'", name));
  if (std::string problem = name_problem(other); !problem.empty()) return refuse(std::move(problem));
  const Span key = span_of_key(*element.entry);
  const std::size_t end = end_of(*element.entry);
  std::string text = source_.text;
  if (is_in_brackets(element.section->value)) {
    return prove_read(text.insert(end, ", " + std::string(other) + text.substr(key.end, end - key.end)));
  }
  const std::size_t last = line_end(end);
  const std::string indent = text.substr(line_begin(key.begin), key.begin - line_begin(key.begin));
  return prove_read(
      text.insert(last, line_break() + indent + std::string(other) + text.substr(key.end, last - key.end)));
}

TextEdit SceneText::rename(std::string_view name, std::string_view other) const {
  const Element element = find(name);
  if (element.entry == nullptr) return refuse(fmt::format("this file has no element '{}'", name));
  if (name == other) return {source_.text, {}, {}};
  if (std::string problem = name_problem(other); !problem.empty()) return refuse(std::move(problem));
  TextEdit edit;
  std::vector<std::size_t> places = {span_of_key(*element.entry).begin};
  std::vector<TextReference> references = references_to(root_, name);
  for (const TextReference& reference : references) {
    places.push_back(source_.byte_of(reference.mark()));
    edit.notes.push_back(note_of(reference));
  }
  std::sort(places.begin(), places.end(), std::greater<>());
  std::string text = source_.text;
  for (std::size_t at : places) {
    if (text[at] == '"' || text[at] == '\'') ++at;
    if (text.compare(at, name.size(), name) != 0)
      return refuse(
          fmt::format("the name in line {} is written in a way for which there is no such edit: change the text",
                      source_.mark_at(at).line));
    text.replace(at, name.size(), other);
  }
  TextEdit proved = prove_read(std::move(text));
  if (proved.refusal.empty()) proved.notes = std::move(edit.notes);
  return proved;
}

TextEdit SceneText::remove(std::string_view name) const {
  const Element element = find(name);
  if (element.entry == nullptr) return refuse(fmt::format("this file has no element '{}'", name));
  const std::vector<TextReference> references = references_to(root_, name);
  if (!references.empty()) {
    TextEdit edit = refuse(fmt::format("'{}' is named by other parts of the scene", name));
    for (const TextReference& reference : references) edit.notes.push_back(note_of(reference));
    return edit;
  }
  std::string result = without(element.section, element.section->value, *element.entry);
  if (result.empty()) return refuse(fmt::format("'{}' cannot be taken out alone: change the text", name));
  return prove_read(std::move(result));
}

}  // namespace slew::scene
