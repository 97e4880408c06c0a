// SPDX-License-Identifier: Apache-2.0
#include "analysis/tradeoff/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/failure.h"
#include "core/input_file.h"
#include "scene/canonical.h"
#include "scene/element_table.h"
#include "scene/sections.h"
#include "scene/setting.h"
#include "scene/yaml_tree.h"

namespace slew::analysis {
namespace {

using scene::Node;

constexpr std::string_view kFirstLine = "# Overlay written by slewring";

std::string flow_text(const Node& node) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  switch (node.kind) {
    case Node::Kind::empty:
      return "";
    case Node::Kind::scalar:
      return node.is_quoted ? scene::yaml_scalar(node.text) : node.text;
    case Node::Kind::sequence:
      for (const Node& item : node.items) add(flow_text(item));
      return '[' + text + ']';
    case Node::Kind::map:
      for (const Node::Entry& entry : node.entries) add(entry.key + ": " + flow_text(entry.value));
      return '{' + text + '}';
  }
  return text;
}

// the first two levels on lines of their own
std::string block_text(const Node& root) {
  std::string text;
  for (const Node::Entry& section : root.entries) {
    if (section.value.kind != Node::Kind::map) {
      text += fmt::format("{}: {}\n", section.key, flow_text(section.value));
      continue;
    }
    text += section.key + ":\n";
    for (const Node::Entry& entry : section.value.entries) {
      text += fmt::format("  {}: {}\n", entry.key, flow_text(entry.value));
    }
  }
  return text;
}

Node& map_at(Node& parent, const std::string& key) {
  if (Node::Entry* found = parent.find(key)) return found->value;
  Node map;
  map.kind = Node::Kind::map;
  parent.entries.push_back({key, parent.mark, std::move(map)});
  return parent.find(key)->value;
}

// name of the section that has an element; empty: its name is a section's
std::string section_of(scene::Scene& scene, const std::string& owner) {
  for (const scene::ElementRef& element : scene::elements(scene)) {
    if (element.name == owner) return std::string(element.section);
  }
  return "";
}

Node read_tree(const std::string& file) {
  scene::Report report;
  const auto source = scene::read_source(file, report.add_source(file), report);
  std::optional<Node> root = source ? scene::parse_yaml(*source, report) : std::nullopt;
  if (!root) report.fail(scene::kMaxReportedProblems);
  return std::move(*root);
}

bool is_own(const std::string& path) {
  std::string text;
  return !read_input(path, scene::kMaxFileBytes, text) && text.starts_with(kFirstLine);
}

}  // namespace

std::string overlay_text(const std::string& file, scene::Scene& scene, const scene::Overrides& settings,
                         const std::string& remark) {
  Node root = read_tree(file);
  if (root.find("include") == nullptr) {
    Node name;
    name.kind = Node::Kind::scalar;
    name.is_quoted = true;
    name.text = std::filesystem::path(file).filename().string();
    root = {};
    root.kind = Node::Kind::map;
    root.entries.push_back({"include", root.mark, std::move(name)});
  }
  scene::Report report;
  for (const std::string& text : settings) {
    std::optional<scene::Setting> setting = scene::parse_setting(text, "Element.key=value", report);
    if (!setting) report.fail(scene::kMaxReportedProblems);
    const std::size_t dot = setting->path.find('.');
    if (dot == std::string::npos) {
      Node& parameters = map_at(root, std::string(scene::kParametersKey));
      scene::set_key(parameters, setting->path, std::move(setting->value), setting->mark);
      continue;
    }
    const std::string owner = setting->path.substr(0, dot), section = section_of(scene, owner);
    Node& map = section.empty() ? map_at(root, owner) : map_at(map_at(root, section), owner);
    scene::set_key(map, setting->path.substr(dot + 1), std::move(setting->value), setting->mark);
  }
  return fmt::format("{} {}\n", kFirstLine, remark) + block_text(root);
}

std::string overlay_target(const std::string& file, const std::string& path, std::string_view suffix) {
  const std::filesystem::path source(file);
  const std::string target =
      path.empty() ? (source.parent_path() / fmt::format("{}_{}.yaml", source.stem().string(), suffix)).string() : path;
  if (std::filesystem::exists(target) && !is_own(target)) {
    throw Failure(ExitCode::bad_input, target +
                                           " is there already and no overlay of slewring; it was left as it is and "
                                           "nothing was run; name another file with --overlay");
  }
  std::error_code error;
  const auto folder_of = [&error](const std::filesystem::path& of) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(of, error).parent_path(), error);
  };
  if (folder_of(target) != folder_of(source)) {
    throw Failure(ExitCode::bad_input, target +
                                           " would not lie beside its scene, whose files it needs; nothing was "
                                           "run; name a file in " +
                                           folder_of(source).string() + "/");
  }
  return target;
}

void write_overlay(const std::string& file, const scene::Overrides& settings, const std::string& remark,
                   const std::string& target) {
  scene::Scene scene = scene::load_file(file, settings);
  std::ofstream out(target, std::ios::binary);
  out << overlay_text(file, scene, settings, remark);
  if (!out.flush()) {
    throw Failure(ExitCode::storage, "cannot write " + target + "; the table is complete; free some space");
  }
  out.close();
  try {
    static_cast<void>(scene::load_file(target));
  } catch (const scene::LoadError& problem) {
    throw Failure(ExitCode::failed, target + " was written but does not load: " + problem.what());
  }
}

}  // namespace slew::analysis
