// SPDX-License-Identifier: Apache-2.0
#include "scene/expand.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>
#include <vector>

#include "core/suggestion.h"
#include "scene/assets.h"
#include "scene/element_table.h"
#include "scene/field_reader.h"
#include "scene/instances.h"
#include "scene/named_points.h"
#include "scene/scope.h"
#include "scene/sections.h"
#include "scene/setting.h"
#include "scene/source.h"
#include "scene/tree_merge.h"

namespace slew::scene {
namespace {

// given: the content of the file; null: it is read.
std::optional<Node> read_tree(const std::string& path, const std::string* given, int source, Report& report) {
  const std::optional<SourceText> text =
      given != nullptr ? check_source(*given, source, report) : read_source(path, source, report);
  return text ? parse_yaml(*text, report) : std::nullopt;
}

std::vector<std::string_view> element_names(const Node& root) {
  std::vector<std::string_view> names;
  for (const std::string_view section : element_sections()) {
    const Node::Entry* entry = root.find(section);
    if (entry == nullptr) continue;
    for (const Node::Entry& element : entry->value.entries) names.push_back(element.key);
  }
  return names;
}

// ---- includes

// Reads the files of a scene: each file is laid over those that it includes. A file with a prefix stays apart, as
// instances.h expects it.
class IncludeReader {
 public:
  IncludeReader(LoadContext load_context, Includes includes, Report& report)
      : load_context_(std::move(load_context)), includes_(includes), report_(report) {}

  // The scene with what it includes; empty after a problem. file: its name in its folder.
  std::optional<Node> read(const std::string& path, const std::string& file, const std::string* text) {
    open_.push_back(file);
    return read(path, text);
  }

 private:
  std::optional<Node> read(const std::string& path, const std::string* text) {
    const int source = report_.add_source(path);
    std::optional<Node> tree = read_tree(path, text, source, report_);
    if (!tree) return std::nullopt;
    const auto include = take(*tree, kIncludeKey);
    const auto without = take(*tree, kWithoutKey);
    if (without && !include) {
      report_.add(without->mark, "without", {"nothing is included", "a file under `include` with the elements", ""});
      return std::nullopt;
    }
    if (include && !add_included(include->value, without ? &without->value : nullptr, *tree)) return std::nullopt;
    report_.put_on_top(source);
    return tree;
  }

  // without: names of elements that are left out; null: none.
  bool add_included(const Node& include, const Node* without, Node& tree) {
    Node base, apart;
    base.kind = apart.kind = Node::Kind::map;
    bool is_complete = true;
    const auto add = [&](const Node& item) { is_complete = add_file(item, base, apart) && is_complete; };
    if (include.kind == Node::Kind::sequence) {
      for (const Node& item : include.items) add(item);
    } else {
      add(include);
    }
    if (!is_complete || (without != nullptr && !leave_out(*without, base))) return false;
    if (base.entries.empty() && apart.entries.empty()) return true;
    merge(base, std::move(tree));
    tree = std::move(base);
    add_apart(tree, std::move(apart));
    return true;
  }

  bool leave_out(const Node& without, Node& base) {
    const std::size_t problems = report_.size();
    const auto leave_out_one = [&](const Node& name) {
      if (name.kind != Node::Kind::scalar) {
        report_.add(name.mark, "without", {"is " + describe(name), "the name of an element, or a list of names", ""});
        return;
      }
      for (const std::string_view section : element_sections()) {
        Node::Entry* present = base.find(section);
        if (present != nullptr && take(present->value, name.text)) return;
      }
      report_.add(name.mark, "without",
                  {"the included files have no element '" + name.text + "'",
                   "an element of a file that is included without a prefix", closest(name.text, element_names(base))});
    };
    if (without.kind == Node::Kind::sequence) {
      for (const Node& name : without.items) leave_out_one(name);
    } else {
      leave_out_one(without);
    }
    return report_.size() == problems;
  }

  // files with a prefix, of this file and of those under it
  static void add_apart(Node& tree, Node apart) {
    if (apart.entries.empty()) return;
    Node::Entry* present = tree.find(kIncludedFiles);
    if (present == nullptr) {
      tree.entries.push_back({std::string(kIncludedFiles), tree.mark, std::move(apart)});
    } else {
      std::move(apart.entries.begin(), apart.entries.end(), std::back_inserter(present->value.entries));
    }
  }

  bool add_file(const Node& item, Node& base, Node& apart) {
    const bool has_prefix = item.kind == Node::Kind::map && includes_ == Includes::with_prefix;
    const Node* name = &item;
    if (has_prefix) {
      if (!check_keys(item)) return false;
      name = &item.find("file")->value;
    }
    if (name->kind != Node::Kind::scalar || name->text.empty()) {
      const char* expected = includes_ == Includes::with_prefix
                                 ? "the name of a file, {file: name, prefix: Left_}, or a list of these"
                                 : "the name of a file, or a list of names";
      report_.add(name->mark, "include", {"is " + describe(*name), expected, ""});
      return false;
    }
    std::optional<Node> tree = read_included(*name);
    if (!tree) return false;
    if (!has_prefix) {
      const auto inner = take(*tree, kIncludedFiles);
      merge(base, std::move(*tree));
      if (inner) add_apart(base, std::move(inner->value));
      return true;
    }
    Node::Entry entry{name->text, item.mark, item};
    entry.value.entries.push_back({std::string(kIncludedTree), item.mark, std::move(*tree)});
    apart.entries.push_back(std::move(entry));
    return true;
  }

  bool check_keys(const Node& item) {
    constexpr std::string_view kKeys[] = {"file", "prefix", "parameters"};
    const std::size_t problems = report_.size();
    report_duplicates(item, "include", report_);
    for (const Node::Entry& entry : item.entries) {
      if (std::find(std::begin(kKeys), std::end(kKeys), entry.key) != std::end(kKeys)) continue;
      report_.add(entry.mark, "include." + entry.key, {"unknown key", "file, prefix or parameters", ""});
    }
    for (const std::string_view key : {kKeys[0], kKeys[1]}) {
      const Node::Entry* entry = item.find(key);
      if (entry != nullptr && entry->value.kind == Node::Kind::scalar) continue;
      report_.add(
          item.mark, "include",
          {fmt::format("the key '{}' is missing or no text", key), "such as {file: side.yaml, prefix: Left_}", ""});
    }
    return report_.size() == problems;
  }

  std::optional<Node> read_included(const Node& name) {
    if (auto refusal = load_context_.refusal_of(name.text)) {
      report_.add(name.mark, "include", std::move(*refusal));
      return std::nullopt;
    }
    const std::string file = std::filesystem::path(name.text).lexically_normal().string();
    if (std::find(open_.begin(), open_.end(), file) != open_.end()) {
      report_.add(name.mark, "include", {describe(name) + " includes itself", "includes without a circle", ""});
      return std::nullopt;
    }
    if (open_.size() >= kMaxIncludeDepth || files_ >= kMaxIncludedFiles) {
      report_.add(name.mark, "include",
                  {"too many files include each other",
                   fmt::format("at most {} levels and {} files", kMaxIncludeDepth, kMaxIncludedFiles), ""});
      return std::nullopt;
    }
    ++files_;
    open_.push_back(file);
    std::optional<Node> tree = read(load_context_.path_of(name.text), nullptr);
    open_.pop_back();
    if (!tree) report_.add(name.mark, "include", {describe(name) + " cannot be included", "", ""});
    return tree;
  }

  const LoadContext load_context_;
  const Includes includes_;
  Report& report_;
  std::vector<std::string> open_;  // files around the present one
  std::size_t files_ = 0;
};

// ---- overrides

bool is_single_section(std::string_view name) {
  return name == "script" || std::any_of(single_tables().begin(), single_tables().end(),
                                         [&](const SingleTable& table) { return table.section == name; });
}

Node& section_of(Node& root, const std::string& name, const Mark& mark) {
  if (Node::Entry* present = root.find(name)) return present->value;
  Node section;
  section.kind = Node::Kind::map;
  section.mark = mark;
  root.entries.push_back({name, mark, std::move(section)});
  return root.entries.back().value;
}

// The map named by a path's first part: a single section (created if missing) or an element.
Node* owner_of(Node& root, const std::string& name, const Mark& mark) {
  if (is_single_section(name)) return &section_of(root, name, mark);
  for (const std::string_view section : element_sections()) {
    Node::Entry* entry = root.find(section);
    Node::Entry* element = entry != nullptr ? entry->value.find(name) : nullptr;
    if (element != nullptr) return &element->value;
  }
  return name == kStartKey ? &section_of(root, name, mark) : nullptr;
}

std::string closest_owner(const Node& root, const std::string& name) {
  std::vector<std::string_view> names = element_names(root);
  names.emplace_back("script");
  for (const SingleTable& table : single_tables()) names.push_back(table.section);
  return closest(name, names);
}

constexpr const char* kSetting = "Element.key=value, such as 'Bag.mass=1500kg'";
constexpr const char* kSettingOrParameter =
    "Element.key=value, such as 'Bag.mass=1500kg', or Parameter=value, such as 'L=3m'";

bool is_of_parameter(const Setting& setting) {
  return setting.path.find('.') == std::string::npos;
}

// Values of the scene's own parameters.
void set_parameter(Node& root, Setting setting, Report& report) {
  Node::Entry* parameters = root.find(kParametersKey);
  if (parameters == nullptr || parameters->value.kind != Node::Kind::map) {
    report.add(setting.mark, "", {"is not a setting", kSetting, ""});
    return;
  }
  if (parameters->value.find(setting.path) == nullptr) {
    std::vector<std::string_view> names;
    for (const Node::Entry& entry : parameters->value.entries) names.push_back(entry.key);
    report.add(setting.mark, "",
               {"there is no parameter '" + setting.path + "'", kSettingOrParameter, closest(setting.path, names)});
    return;
  }
  set_key(parameters->value, setting.path, std::move(setting.value), setting.mark);
}

void set_value(Node& root, Setting setting, Scope& scope, Report& report) {
  const std::size_t dot = setting.path.find('.');
  const std::string owner_name = setting.path.substr(0, dot);
  Node* owner = owner_of(root, owner_name, setting.mark);
  if (owner == nullptr) {
    report.add(setting.mark, "", {"no element or section '" + owner_name + "'", "", closest_owner(root, owner_name)});
    return;
  }
  if (owner->kind != Node::Kind::map) return;  // reported when the section is read
  scope.substitute(setting.value, setting.path);
  set_key(*owner, setting.path.substr(dot + 1), std::move(setting.value), setting.mark);
}

}  // namespace

namespace {

// Where a name in a folder leads by symbolic links, if that is outside of the folder; empty: it stays inside, or a part
// of the path is not there or cannot be searched, so that nothing can be opened either.
std::string link_out_of(const std::string& folder, const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path base = fs::canonical(folder.empty() ? fs::path(".") : fs::path(folder), error);
  if (error) return {};
  const fs::path target = fs::canonical(base / file, error);
  if (error || is_inside_folder(target.lexically_relative(base).generic_string())) return {};
  return target.string();
}

}  // namespace

std::string LoadContext::path_of(const std::string& file) const {
  return (std::filesystem::path(folder) / file).string();
}

std::string LoadContext::asset_path_of(const std::string& file) const {
  return (std::filesystem::path(asset_folder) / file).string();
}

std::optional<ValueProblem> LoadContext::refusal_of(const std::string& file) const {
  if (!is_confined) return std::nullopt;
  const std::string expected = "a file in that folder or below";
  if (!is_inside_folder(file)) {
    return ValueProblem{"'" + file + "' lies outside of the scene's folder and was not read", expected, ""};
  }
  for (const auto& [is_read, from] : {std::pair(has_folder, &folder), std::pair(has_assets, &asset_folder)}) {
    const std::string target = is_read ? link_out_of(*from, file) : "";
    if (target.empty()) continue;
    return ValueProblem{"'" + file + "' is a link to '" + target + "', outside of the scene's folder, and was not read",
                        expected + ": copy it there", ""};
  }
  return std::nullopt;
}

std::optional<Node> read_with_includes(const std::string& path, Report& report, Includes includes,
                                       const std::string* text) {
  const std::filesystem::path file(path);
  IncludeReader reader(LoadContext{true, file.parent_path().string()}, includes, report);
  return reader.read(path, file.filename().string(), text);
}

bool expand(Node& root, const Overrides& overrides, Report& report, std::vector<std::string>* warnings,
            std::vector<ParameterText>& values, std::vector<NamedPoint>* points) {
  std::vector<Setting> settings;
  for (const std::string& text : overrides) {
    std::optional<Setting> setting = parse_setting(text, kSetting, report);
    if (!setting) continue;
    if (is_of_parameter(*setting)) {
      set_parameter(root, std::move(*setting), report);
    } else {
      settings.push_back(std::move(*setting));
    }
  }
  ScopeContext context{report};
  Scope scope(context, nullptr);
  std::size_t problems = report.size();
  expand_instances(root, scope, context, warnings);
  bool is_sound = report.size() == problems;
  values = scope.own_values();
  for (Setting& setting : settings) set_value(root, std::move(setting), scope, report);
  problems = report.size();
  std::vector<NamedPoint> placed = place_named_points(root, report);
  if (points != nullptr) *points = std::move(placed);
  is_sound = is_sound && report.size() == problems;
  return is_sound;
}

}  // namespace slew::scene
