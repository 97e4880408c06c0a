// SPDX-License-Identifier: Apache-2.0
#include "scene/names.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/suggestion.h"
#include "multibody/model/defs.h"
#include "scene/defs.h"
#include "scene/sections.h"

namespace slew::scene {
namespace {

bool is_reserved(std::string_view name) {
  const auto& keys = top_level_keys();
  return name == multibody::kGroundName || std::find(keys.begin(), keys.end(), name) != keys.end();
}

std::string_view kind_of_section(std::string_view section) {
  for (const ElementTable& table : element_tables()) {
    if (table.section == section) return table.kind;
  }
  return {};
}

bool is_flexible(const Node& body) {
  const Node::Entry* type = body.find("type");
  return type != nullptr && type->value.kind == Node::Kind::scalar &&
         (type->value.text == "flexible" || type->value.text == "segmented");
}

constexpr std::string_view kNode = ".Node";

}  // namespace

std::string with_article(std::string_view kind) {
  return (kind == "input" || kind == "output" ? "an " : "a ") + std::string(kind);
}

bool is_one_of(std::string_view kind, std::string_view kinds) {
  constexpr std::string_view kOr = " or ";
  for (std::size_t end = kinds.find(kOr); end != std::string_view::npos; end = kinds.find(kOr)) {
    if (kinds.substr(0, end) == kind) return true;
    kinds.remove_prefix(end + kOr.size());
  }
  return kinds == kind;
}

bool is_word(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

void NameTable::declare_all(const Node& root, Report& report) {
  for (const std::string_view section : element_sections()) {
    const Node::Entry* entry = root.find(section);
    if (entry == nullptr) continue;
    for (const Node::Entry& element : entry->value.entries) {
      const std::string& name = element.key;
      if (!is_word(name)) {
        report.add(element.mark, name, {"is not a name", "letters, digits and _, beginning with a letter", ""});
      } else if (name.size() > kMaxNameLength) {
        report.add(
            element.mark, name,
            {fmt::format("the name has {} characters", name.size()), fmt::format("at most {}", kMaxNameLength), ""});
      } else if (is_reserved(name)) {
        report.add(element.mark, name, {"the name is reserved", "another name", ""});
      }
      if (section == "bodies" && is_flexible(element.value)) flexible_.insert(name);
      const auto [first, is_new] = names_.emplace(name, Declared{kind_of_section(section), element.mark});
      if (!is_new) {
        report.add(element.mark, name,
                   {fmt::format("the name is taken by {} (line {})", with_article(first->second.kind),
                                first->second.mark.line),
                    "a name of its own", ""});
      }
    }
  }
}

void NameTable::resolve(const std::vector<Reference>& references, Report& report) const {
  for (const Reference& reference : references) {
    const std::string_view found = kind_of(reference.name);
    if (is_one_of(found, reference.kind)) continue;
    const std::string kind(reference.kind);
    if (found.empty()) {
      report.add(reference.mark, reference.path,
                 {"no " + kind + " '" + reference.name + "'", "", closest_of(reference.name, kind)});
    } else {
      report.add(reference.mark, reference.path,
                 {"'" + reference.name + "' is " + with_article(found), "the name of " + with_article(kind),
                  closest_of(reference.name, kind)});
    }
  }
}

std::string_view NameTable::kind_of(std::string_view name) const {
  if (name == multibody::kGroundName) return "body";
  if (const std::size_t dot = name.find(kNode); dot != std::string_view::npos) {
    // the node itself is checked when its files are read
    return flexible_.contains(name.substr(0, dot)) ? "body" : "";
  }
  const auto found = names_.find(name);
  return found == names_.end() ? std::string_view() : found->second.kind;
}

std::vector<std::string_view> NameTable::names_of(std::string_view kind) const {
  std::vector<std::string_view> names;
  for (const auto& [name, declared] : names_) {
    if (kind.empty() || is_one_of(declared.kind, kind)) names.push_back(name);
  }
  if (kind == "body") names.push_back(multibody::kGroundName);
  return names;
}

std::string NameTable::closest_of(std::string_view name, std::string_view kind) const {
  return closest(name, names_of(kind));
}

bool fits_pattern(std::string_view text, std::string_view pattern) {
  // on a mismatch the last star takes one more character
  std::size_t t = 0, p = 0, star = std::string_view::npos, star_text = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      star_text = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p, ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++star_text;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

}  // namespace slew::scene
