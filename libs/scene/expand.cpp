// SPDX-License-Identifier: Apache-2.0
#include "scene/expand.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "core/suggestion.h"
#include "scene/assets.h"
#include "scene/sections.h"
#include "scene/setting.h"
#include "scene/source.h"

namespace slew::scene {
namespace {

std::optional<Node> read_tree(const std::string& path, int source, Report& report) {
  const std::optional<SourceText> text = read_source(path, source, report);
  return text ? parse_yaml(*text, report) : std::nullopt;
}

// Maps merge key by key, anything else is replaced; new keys go to the end.
void merge(Node& base, Node overlay) {
  if (base.kind != Node::Kind::map || overlay.kind != Node::Kind::map) {
    base = std::move(overlay);
    return;
  }
  base.mark = overlay.mark;
  std::move(overlay.duplicates.begin(), overlay.duplicates.end(), std::back_inserter(base.duplicates));
  for (Node::Entry& entry : overlay.entries) {
    if (Node::Entry* found = base.find(entry.key)) {
      found->mark = entry.mark;
      merge(found->value, std::move(entry.value));
    } else {
      base.entries.push_back(std::move(entry));
    }
  }
}

// File names in `include: file` or `include: [file, file]`.
std::vector<const Node*> included_files(const Node& include, Report& report) {
  std::vector<const Node*> files;
  const auto add = [&](const Node& node) {
    if (node.kind == Node::Kind::scalar && !node.text.empty()) {
      files.push_back(&node);
    } else {
      report.add(node.mark, "include", {"is " + describe(node), "the name of a file, or a list of names", ""});
    }
  };
  if (include.kind == Node::Kind::sequence) {
    for (const Node& item : include.items) add(item);
  } else {
    add(include);
  }
  return files;
}

std::optional<Node> read_included(const Node& name, const LoadContext& load_context, Report& report) {
  if (auto refusal = load_context.refusal_of(name.text)) {
    report.add(name.mark, "include", std::move(*refusal));
    return std::nullopt;
  }
  const std::string path = load_context.path_of(name.text);
  std::optional<Node> tree = read_tree(path, report.add_source(path), report);
  if (!tree) {
    report.add(name.mark, "include", {describe(name) + " cannot be included", "", ""});
    return std::nullopt;
  }
  if (const Node::Entry* nested = tree->find("include")) {
    report.add(nested->mark, "include", {"an included file includes another", "one level of includes", ""});
    return std::nullopt;
  }
  return tree;
}

void erase(Node& map, std::string_view key) {
  std::erase_if(map.entries, [&](const Node::Entry& entry) { return entry.key == key; });
}

// ---- overrides

bool is_single_section(std::string_view name) {
  return name == "script" || std::any_of(single_tables().begin(), single_tables().end(),
                                         [&](const SingleTable& table) { return table.section == name; });
}

// The map named by a path's first part: a single section (created if missing) or an element.
Node* owner_of(Node& root, const std::string& name, const Mark& mark) {
  if (is_single_section(name)) {
    if (root.find(name) == nullptr) {
      Node section;
      section.kind = Node::Kind::map;
      section.mark = mark;
      root.entries.push_back({name, mark, std::move(section)});
    }
    return &root.find(name)->value;
  }
  for (const std::string_view section : element_sections()) {
    Node::Entry* entry = root.find(section);
    Node::Entry* element = entry != nullptr ? entry->value.find(name) : nullptr;
    if (element != nullptr) return &element->value;
  }
  return nullptr;
}

std::string closest_owner(const Node& root, const std::string& name) {
  std::vector<std::string_view> names = {"script"};
  for (const SingleTable& table : single_tables()) names.push_back(table.section);
  for (const std::string_view section : element_sections()) {
    const Node::Entry* entry = root.find(section);
    if (entry == nullptr) continue;
    for (const Node::Entry& element : entry->value.entries) names.push_back(element.key);
  }
  return closest(name, names);
}

constexpr const char* kSetting = "Element.key=value, such as 'Bag.mass=1500kg'";

void apply_override(Node& root, const std::string& text, Report& report) {
  std::optional<Setting> setting = parse_setting(text, kSetting, report);
  if (!setting) return;
  const std::size_t dot = setting->path.find('.');
  if (dot == std::string::npos) {
    report.add(setting->mark, "", {"is not a setting", kSetting, ""});
    return;
  }
  const std::string owner_name = setting->path.substr(0, dot);
  Node* owner = owner_of(root, owner_name, setting->mark);
  if (owner == nullptr) {
    report.add(setting->mark, "", {"no element or section '" + owner_name + "'", "", closest_owner(root, owner_name)});
    return;
  }
  if (owner->kind != Node::Kind::map) return;  // reported when the section is read
  set_key(*owner, setting->path.substr(dot + 1), std::move(setting->value), setting->mark);
}

}  // namespace

std::string LoadContext::path_of(const std::string& file) const {
  return (std::filesystem::path(folder) / file).string();
}

std::string LoadContext::asset_path_of(const std::string& file) const {
  return (std::filesystem::path(asset_folder) / file).string();
}

std::optional<ValueProblem> LoadContext::refusal_of(const std::string& file) const {
  if (!is_confined || is_inside_folder(file)) return std::nullopt;
  return ValueProblem{"'" + file + "' lies outside of the scene's folder and was not read",
                      "a file in that folder or below", ""};
}

std::optional<Node> read_with_includes(const std::string& path, Report& report) {
  std::optional<Node> scene = read_tree(path, report.add_source(path), report);
  if (!scene) return std::nullopt;
  const Node::Entry* include = scene->find("include");
  if (include == nullptr) return scene;
  const LoadContext load_context{true, std::filesystem::path(path).parent_path().string()};
  Node base;
  base.kind = Node::Kind::map;
  bool is_complete = true;
  for (const Node* name : included_files(include->value, report)) {
    std::optional<Node> tree = read_included(*name, load_context, report);
    is_complete = is_complete && tree;
    if (tree) merge(base, std::move(*tree));
  }
  if (!is_complete) return std::nullopt;
  erase(*scene, "include");
  merge(base, std::move(*scene));
  return base;
}

void apply_overrides(Node& root, const Overrides& overrides, Report& report) {
  for (const std::string& text : overrides) apply_override(root, text, report);
}

}  // namespace slew::scene
