// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

#include "scene/element_table.h"
#include "scene/sections.h"

namespace slew::scene {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::size_t kIndent = 2;  // of what is added

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

bool is_same_tree(const Node& a, const Node& b);

bool is_same_entry(const Node::Entry& a, const Node::Entry& b) {
  return a.key == b.key && is_same_tree(a.value, b.value);
}

bool is_same_tree(const Node& a, const Node& b) {
  return a.kind == b.kind && a.is_quoted == b.is_quoted && a.text == b.text &&
         a.duplicates.size() == b.duplicates.size() && std::ranges::equal(a.items, b.items, is_same_tree) &&
         std::ranges::equal(a.entries, b.entries, is_same_entry);
}

// The text behind a value, with its comment at the column where it was: `grown` more characters stand before it.
std::string moved_comment(std::string_view rest, std::ptrdiff_t grown) {
  const std::size_t blanks = rest.find_first_not_of(' ');
  constexpr std::size_t kAligned = 2;
  if (blanks == std::string_view::npos || rest[blanks] != '#' || blanks < kAligned) return std::string(rest);
  const std::ptrdiff_t wanted = static_cast<std::ptrdiff_t>(blanks) - grown;
  return std::string(static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, wanted)), ' ') +
         std::string(rest.substr(blanks));
}

std::ptrdiff_t characters_of(std::string_view text) {
  return std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

}  // namespace

std::optional<SceneText> SceneText::read(std::string text, int source, Report& report) {
  const std::size_t problems = report.size();
  std::optional<SourceText> checked = check_source(std::move(text), source, report);
  if (!checked) return std::nullopt;
  std::optional<Node> root = parse_yaml(*checked, report);
  if (!root) return std::nullopt;
  return SceneText(std::move(*checked), std::move(*root), report.size() - problems);
}

// ---- places in the text

SceneText::Span SceneText::span_of(const Node& value) const {
  const std::size_t begin = source_.byte_of(value.mark);
  std::size_t end = std::max(begin, source_.byte_of(value.end));
  while (end > begin && kBlanks.find(source_.text[end - 1]) != std::string_view::npos) --end;
  return {begin, end};
}

SceneText::Span SceneText::span_of_key(const Node::Entry& entry) const {
  const std::size_t begin = source_.byte_of(entry.mark);
  const bool is_quoted = source_.text[begin] == '"' || source_.text[begin] == '\'';
  return {begin, std::min(source_.text.size(), begin + entry.key.size() + (is_quoted ? 2 : 0))};
}

std::size_t SceneText::behind_colon(const Node::Entry& entry) const {
  const std::size_t colon = source_.text.find(':', span_of_key(entry).end);
  return colon == std::string::npos ? source_.text.size() : colon + 1;
}

std::size_t SceneText::end_of(const Node::Entry& entry) const {
  if (entry.value.kind == Node::Kind::empty) return std::max(behind_colon(entry), source_.byte_of(entry.value.end));
  return span_of(entry.value).end;
}

std::size_t SceneText::line_begin(std::size_t at) const {
  const std::size_t before = at == 0 ? std::string::npos : source_.text.rfind('\n', at - 1);
  return before == std::string::npos ? 0 : before + 1;
}

std::size_t SceneText::line_end(std::size_t at) const {
  std::size_t end = std::min(source_.text.find('\n', at), source_.text.size());
  if (end > at && source_.text[end - 1] == '\r') --end;
  return end;
}

bool SceneText::is_in_brackets(const Node& node) const {
  const std::size_t at = source_.byte_of(node.mark);
  return at < source_.text.size() && (source_.text[at] == '{' || source_.text[at] == '[');
}

std::string SceneText::line_break() const {
  return source_.text.find("\r\n") == std::string::npos ? "\n" : "\r\n";
}

std::string_view SceneText::written(const Node& value) const {
  if (value.kind == Node::Kind::empty) return {};
  const Span span = span_of(value);
  return std::string_view(source_.text).substr(span.begin, span.end - span.begin);
}

SceneText::Element SceneText::find(std::string_view name) const {
  for (const std::string_view section : element_sections()) {
    const Node::Entry* found = root_.find(section);
    const Node::Entry* element = found != nullptr ? found->value.find(name) : nullptr;
    if (element != nullptr) return {found, element};
  }
  return {};
}

std::optional<SceneText::Place> SceneText::find_place(std::string_view path) const {
  const std::size_t first_end = path.find_first_of(".[");
  const std::string_view first = path.substr(0, first_end);
  path.remove_prefix(std::min(path.size(), first.size()));
  Place place;
  place.map = &root_;
  const auto enter = [&place](const Node::Entry* entry, std::string_view key) {
    place.entry = entry;
    place.value = entry == nullptr ? nullptr : &entry->value;
    place.key = key;
    place.steps.push_back({std::string(key)});
  };
  if (const Element element = find(first); element.entry != nullptr) {
    enter(element.section, element.section->key);
    place.owner = element.section;
    place.map = place.value;
    enter(element.entry, first);
  } else {
    enter(root_.find(first), first);
  }
  while (!path.empty()) {
    if (place.value == nullptr) return std::nullopt;
    if (path.front() == '[') {
      std::size_t row = 0;
      const char* const end = path.data() + path.size();
      const auto [behind, error] = std::from_chars(path.data() + 1, end, row);
      if (error != std::errc() || behind == end || *behind != ']' || row >= place.value->items.size())
        return std::nullopt;
      path.remove_prefix(static_cast<std::size_t>(behind + 1 - path.data()));
      place.value = &place.value->items[row];
      place.entry = nullptr;
      place.steps.push_back({"", row});
      continue;
    }
    path.remove_prefix(1);
    const std::string_view key = path.substr(0, path.find_first_of(".["));
    path.remove_prefix(key.size());
    const bool may_have_keys = place.value->kind == Node::Kind::map || place.value->kind == Node::Kind::empty;
    if (key.empty() || !may_have_keys) return std::nullopt;
    place.owner = place.entry;
    place.map = place.value;
    enter(place.map->find(key), key);
  }
  return place;
}

// ---- edits of one value

TextEdit SceneText::refuse(std::string reason) const {
  return {source_.text, std::move(reason) + "; nothing was changed", {}};
}

std::string SceneText::with_key(const Place& place, std::string_view value) const {
  std::string text = source_.text;
  const std::string pair = fmt::format("{}: {}", place.key, value);
  const Node& map = *place.map;
  if (map.kind == Node::Kind::map && is_in_brackets(map)) {
    const std::size_t at = map.entries.empty() ? span_of(map).begin + 1 : end_of(map.entries.back());
    return text.insert(at, (map.entries.empty() ? "" : ", ") + pair);
  }
  std::size_t at = 0, indent = 0;
  if (map.kind == Node::Kind::map && !map.entries.empty()) {
    at = line_end(end_of(map.entries.back()));
    indent = static_cast<std::size_t>(map.entries.front().mark.column) - 1;
  } else {
    at = line_end(end_of(*place.owner));
    indent = static_cast<std::size_t>(place.owner->mark.column) - 1 + kIndent;
  }
  return text.insert(at, line_break() + std::string(indent, ' ') + pair);
}

std::string SceneText::without(const Node::Entry* owner, const Node& map, const Node::Entry& entry) const {
  std::string text = source_.text;
  const std::size_t number = static_cast<std::size_t>(&entry - map.entries.data());
  const std::size_t begin = span_of_key(entry).begin, end = end_of(entry);
  if (is_in_brackets(map)) {
    if (number > 0) {
      const std::size_t before = end_of(map.entries[number - 1]);
      return text.erase(before, end - before);
    }
    const std::size_t next = map.entries.size() > 1 ? span_of_key(map.entries[1]).begin : end;
    return text.erase(begin, next - begin);
  }
  const std::size_t line = line_begin(begin);
  const bool is_behind_dash = text.find_first_not_of(' ', line) != begin;
  const bool is_last = map.entries.size() == 1;
  if (is_behind_dash || (is_last && owner == nullptr)) return {};
  const std::size_t next = std::min(text.find('\n', end), text.size() - 1) + 1;
  text.erase(line, next - line);
  // a map without keys is written in brackets
  if (is_last) text.insert(behind_colon(*owner), " {}");
  return text;
}

TextEdit SceneText::set(std::string_view path, std::string_view value) const {
  value = without_blanks(value);
  std::optional<Place> place = find_place(path);
  const auto& sections = single_tables();
  const std::string_view section = path.substr(0, path.find('.'));
  const bool is_single = std::ranges::any_of(sections, [&](const SingleTable& one) { return one.section == section; });
  if (!place && is_single && root_.find(section) == nullptr && path.size() > section.size() + 1 && !value.empty()) {
    const std::string key(path.substr(section.size() + 1));
    std::string result = source_.text;
    if (!result.ends_with('\n')) result += line_break();
    result += fmt::format("{0}{1}:{0}  {2}: {3}{0}", line_break(), section, key, value);
    place.emplace();
    place->steps = {{std::string(section)}, {key}};
    return prove(*place, std::move(result), value);
  }
  if (!place || (place->value == nullptr && place->map == &root_))
    return refuse(fmt::format("this file has no place '{}'", path));
  if (place->value == nullptr) {
    if (value.empty()) return {source_.text, {}, {}};
    return prove(*place, with_key(*place, value), value);
  }
  if (value.empty()) {
    if (place->entry == nullptr) return refuse("a row of a list is changed in the list's text");
    std::string result = without(place->owner, *place->map, *place->entry);
    if (result.empty()) return refuse(fmt::format("'{}' cannot be taken out alone: change the text", path));
    return prove(*place, std::move(result), value);
  }
  Span span = span_of(*place->value);
  std::string text(value);
  if (place->value->kind == Node::Kind::empty) {
    span = {behind_colon(*place->entry), end_of(*place->entry)};
    text.insert(0, " ");
  }
  const std::string_view before = std::string_view(source_.text).substr(span.begin, span.end - span.begin);
  const bool is_one_line = before.find('\n') == std::string_view::npos && value.find('\n') == std::string_view::npos;
  const std::ptrdiff_t grown = is_one_line ? characters_of(text) - characters_of(before) : 0;
  return prove(
      *place,
      source_.text.substr(0, span.begin) + text + moved_comment(std::string_view(source_.text).substr(span.end), grown),
      value);
}

namespace {

// The trees differ at the place alone. at: number of the present step.
template <typename Steps>
bool is_same_elsewhere(const Node& before, const Node& after, const Steps& steps, std::size_t at) {
  if (at == steps.size()) return true;
  if (steps[at].row) {
    const std::size_t row = *steps[at].row;
    if (before.kind != after.kind || before.items.size() != after.items.size()) return false;
    for (std::size_t i = 0; i < before.items.size(); ++i) {
      const bool is_sound = i == row ? is_same_elsewhere(before.items[i], after.items[i], steps, at + 1)
                                     : is_same_tree(before.items[i], after.items[i]);
      if (!is_sound) return false;
    }
    return true;
  }
  const std::string& key = steps[at].key;
  const auto is_map = [](const Node& node) { return node.kind == Node::Kind::map || node.kind == Node::Kind::empty; };
  if (!is_map(before) || !is_map(after) || before.duplicates.size() != after.duplicates.size()) return false;
  const auto others = [&key](const Node& node) {
    std::vector<const Node::Entry*> entries;
    for (const Node::Entry& entry : node.entries)
      if (entry.key != key) entries.push_back(&entry);
    return entries;
  };
  const auto is_same_one = [](const Node::Entry* a, const Node::Entry* b) { return is_same_entry(*a, *b); };
  if (!std::ranges::equal(others(before), others(after), is_same_one)) return false;
  const Node::Entry *old = before.find(key), *now = after.find(key);
  if (old != nullptr && now != nullptr) return is_same_elsewhere(old->value, now->value, steps, at + 1);
  return at + 1 == steps.size() || old == nullptr;
}

}  // namespace

TextEdit SceneText::prove(const Place& place, std::string result, std::string_view value) const {
  Report report;
  const std::optional<SceneText> read_again = read(std::move(result), report.add_source(""), report);
  if (!read_again || read_again->problems_ > problems_) {
    try {
      report.fail(1);
    } catch (const LoadError& error) {
      return refuse(fmt::format("'{}' is no value: {}", value, error.first_reason()));
    }
  }
  const Node* node = &read_again->root();
  bool is_sound = is_same_elsewhere(root_, *node, place.steps, 0);
  for (const Step& step : place.steps) {
    if (node == nullptr) break;
    const Node::Entry* entry = step.row ? nullptr : node->find(step.key);
    node = step.row ? (*step.row < node->items.size() ? &node->items[*step.row] : nullptr)
                    : (entry == nullptr ? nullptr : &entry->value);
  }
  is_sound = is_sound && (value.empty() ? node == nullptr : node != nullptr && read_again->written(*node) == value);
  if (is_sound) return {read_again->text(), {}, {}};
  return refuse(
      fmt::format("'{}' would change more of the file than this value: a text with a comma, a colon or a '#' "
                  "needs quotes",
                  value));
}

}  // namespace slew::scene
