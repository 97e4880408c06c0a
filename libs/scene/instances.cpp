// SPDX-License-Identifier: Apache-2.0
#include "scene/instances.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "core/suggestion.h"
#include "scene/element_table.h"
#include "scene/field_reader.h"
#include "scene/names.h"
#include "scene/renaming.h"
#include "scene/tree_merge.h"

namespace slew::scene {
namespace {

// Named nodes of one kind, of a file or group, and those around it.
struct Library {
  Node entries;  // map
  std::set<std::string, std::less<>> used;
};

// A file, a group or an instance of it.
struct Level {
  Scope& scope;
  Level* around = nullptr;
  int depth = 0;
  Library templates{}, groups{};
  std::set<std::pair<std::string, std::string>> brought_in{};  // section and name of elements from instances
};

void stamp(Node& node, int level) {
  node.level = static_cast<std::uint8_t>(level);
  for (Node& item : node.items) stamp(item, level);
  for (Node::Entry& entry : node.entries) stamp(entry.value, level);
}

bool may_be_in_group(std::string_view key) {
  const auto& keys = language_keys();
  return is_element_section(key) || key == kIncludedFiles || std::find(keys.begin(), keys.end(), key) != keys.end();
}

class Expander {
 public:
  Expander(ScopeContext& context, std::vector<std::string>* warnings)
      : context_(context), report_(context.report), warnings_(warnings) {}

  // The tree of a file or group, without a prefix.
  void expand(Node& tree, Level& level) {
    if (auto parameters = take(tree, kParametersKey)) level.scope.declare(parameters->value, "parameters");
    expand_declared(tree, level);
  }

 private:
  void expand_declared(Node& tree, Level& level) {
    take_library(tree, kTemplatesKey, level.templates);
    take_library(tree, kGroupsKey, level.groups);
    const auto instances = take(tree, kInstancesKey);
    const auto included = take(tree, kIncludedFiles);
    for (Node::Entry& section : tree.entries) {
      if (!is_element_section(section.key)) {
        level.scope.substitute(section.value, section.key);
        continue;
      }
      for (Node::Entry& element : section.value.entries) {
        lay_over_templates(element.value, element.key, level, 0);
        level.scope.substitute(element.value, element.key);
      }
    }
    if (instances) add_instances(tree, *instances, level);
    if (included) add_files(tree, included->value, level);
    level.scope.settle_rest();
    warn_of_unused(level);
  }

  void take_library(Node& tree, std::string_view key, Library& library) {
    auto entry = take(tree, key);
    if (!entry) return;
    if (!is_map(entry->value, std::string(key))) return;
    report_duplicates(entry->value, std::string(key), report_);
    library.entries = std::move(entry->value);
    for (const Node::Entry& named : library.entries.entries) {
      const std::string path = fmt::format("{}.{}", key, named.key);
      if (is_map(named.value, path) && key == kGroupsKey) report_duplicates(named.value, path, report_);
    }
  }

  bool is_map(const Node& node, const std::string& path) {
    if (node.kind == Node::Kind::map) return true;
    report_.add(node.mark, path, {"is " + describe(node), "a map", ""});
    return false;
  }

  // The node of this name with the level that has it; marks it as used.
  const Node* find(std::string_view name, Library Level::*library, Level& level, std::string& suggestion) {
    std::vector<std::string_view> names;
    for (Level* at = &level; at != nullptr; at = at->around) {
      Library& own = at->*library;
      if (const Node::Entry* found = own.entries.find(name)) {
        own.used.emplace(name);
        return &found->value;
      }
      for (const Node::Entry& entry : own.entries.entries) names.push_back(entry.key);
    }
    suggestion = closest(name, names);
    return nullptr;
  }

  // Counts values that are copied; false, with one problem, beyond the bound.
  bool may_copy(const Node& node, const Mark& mark, const std::string& path) {
    if (is_too_large_) return false;
    const std::size_t count = count_of(node);
    if (count <= values_left_) {
      values_left_ -= count;
      return true;
    }
    is_too_large_ = true;
    report_.add(
        mark, path,
        {fmt::format("templates and instances bring in more than {} values", kMaxCopiedValues), "fewer instances", ""});
    return false;
  }

  // ---- templates

  // names of templates under `use:`
  std::vector<const Node*> used_templates(const Node& use, const std::string& path) {
    std::vector<const Node*> names;
    const auto add = [&](const Node& node) {
      if (node.kind == Node::Kind::scalar && !node.text.empty()) {
        names.push_back(&node);
      } else {
        report_.add(node.mark, path, {"is " + describe(node), "the name of a template, or a list of names", ""});
      }
    };
    if (use.kind == Node::Kind::sequence) {
      for (const Node& item : use.items) add(item);
    } else {
      add(use);
    }
    return names;
  }

  // Replaces the key `use` by the keys of the templates, the element's own keys over them.
  void lay_over_templates(Node& element, const std::string& path, Level& level, int depth) {
    auto use = take(element, kUseKey);
    if (!use) return;
    const std::string use_path = path + ".use";
    level.scope.substitute(use->value, use_path);
    Node base;
    base.kind = Node::Kind::map;
    for (const Node* name : used_templates(use->value, use_path)) {
      std::string suggestion;
      const Node* found = find(name->text, &Level::templates, level, suggestion);
      if (found == nullptr) {
        report_.add(name->mark, use_path, {"there is no template " + describe(*name), "", suggestion});
        continue;
      }
      if (depth >= kMaxInstanceDepth) {
        report_.add(name->mark, use_path,
                    {"templates use each other too deeply, or in a circle",
                     fmt::format("at most {} levels", kMaxInstanceDepth), ""});
        return;
      }
      if (found->kind != Node::Kind::map || !may_copy(*found, name->mark, use_path)) continue;
      Node copy = *found;
      lay_over_templates(copy, use_path, level, depth + 1);
      merge(base, std::move(copy));
    }
    merge(base, std::move(element));
    element = std::move(base);
  }

  // ---- instances

  void add_instances(Node& tree, const Node::Entry& instances, Level& level) {
    if (!is_map(instances.value, instances.key)) return;
    report_duplicates(instances.value, instances.key, report_);
    for (const Node::Entry& entry : instances.value.entries) {
      const std::string path = fmt::format("{}.{}", instances.key, entry.key);
      if (!is_map(entry.value, path)) continue;
      if (!has_only(entry.value, {"group", "prefix", "parameters"}, path)) continue;
      const Node::Entry* group = entry.value.find("group");
      if (group == nullptr || group->value.kind != Node::Kind::scalar) {
        report_.add(entry.mark, path, {"the key 'group' is missing", "the name of a group", ""});
        continue;
      }
      std::string suggestion;
      const std::string& name = group->value.text;
      const Node* found = find(name, &Level::groups, level, suggestion);
      if (found == nullptr) {
        report_.add(group->value.mark, path + ".group", {"there is no group '" + name + "'", "", suggestion});
        continue;
      }
      const Node::Entry* prefix = entry.value.find("prefix");
      if (prefix != nullptr && prefix->value.kind != Node::Kind::scalar) {
        report_.add(prefix->value.mark, path + ".prefix",
                    {"is " + describe(prefix->value), "a prefix such as Left_", ""});
        continue;
      }
      add_instance(tree, *found, {name, prefix == nullptr ? entry.key + "_" : prefix->value.text, path, entry}, level);
    }
  }

  // files with a prefix, as read_with_includes() leaves them
  void add_files(Node& tree, const Node& files, Level& level) {
    for (const Node::Entry& entry : files.entries) {
      const Node::Entry* own = entry.value.find(kIncludedTree);
      const Node::Entry* prefix = entry.value.find("prefix");
      if (own == nullptr || prefix == nullptr) continue;
      report_duplicates(own->value, "", report_);
      add_instance(tree, own->value, {"file " + entry.key, prefix->value.text, "include." + entry.key, entry}, level);
    }
  }

  bool has_only(const Node& map, const std::vector<std::string_view>& keys, const std::string& path) {
    report_duplicates(map, path, report_);
    bool is_sound = map.duplicates.empty();
    for (const Node::Entry& entry : map.entries) {
      if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
      report_.add(entry.mark, path + "." + entry.key, {"unknown key", choice_list(keys), closest(entry.key, keys)});
      is_sound = false;
    }
    return is_sound;
  }

  struct Instance {
    std::string group;
    std::string prefix;
    std::string path;
    const Node::Entry& entry;
  };

  void add_instance(Node& tree, const Node& group, const Instance& instance, Level& level) {
    const Mark& mark = instance.entry.mark;
    if (!is_allowed(group, instance, level)) return;
    if (!may_copy(group, mark, instance.path)) return;
    Node copy = group;
    for (const std::string_view about : {"scene", "description"}) take(copy, about);
    for (const Node::Entry& section : copy.entries) {
      if (may_be_in_group(section.key)) continue;
      report_.add(section.mark, instance.path,
                  {fmt::format("a group has no section '{}'", section.key),
                   "sections of elements, parameters, templates, groups, instances, start or payload", ""});
      return;
    }
    Scope scope(context_, &level.scope);
    Level own{.scope = scope, .around = &level, .depth = level.depth + 1};
    stamp(copy, own.depth);
    if (auto parameters = take(copy, kParametersKey)) scope.declare(parameters->value, instance.path + ".parameters");
    give_parameters(instance, level, scope);
    open_.push_back(instance.group);
    expand_declared(copy, own);
    open_.pop_back();
    put_prefix(copy, instance.prefix, own.depth);
    join(tree, std::move(copy), instance, level);
  }

  bool is_allowed(const Node& group, const Instance& instance, const Level& level) {
    const Mark& mark = instance.entry.mark;
    if (group.kind != Node::Kind::map) return false;  // reported with the group
    if (!instance.prefix.empty() && !is_word(instance.prefix)) {
      report_.add(mark, instance.path, {"'" + instance.prefix + "' cannot begin a name", "letters, digits and _", ""});
      return false;
    }
    if (std::find(open_.begin(), open_.end(), instance.group) != open_.end()) {
      report_.add(mark, instance.path, {"'" + instance.group + "' holds an instance of itself", "another group", ""});
      return false;
    }
    if (level.depth >= kMaxInstanceDepth) {
      report_.add(mark, instance.path,
                  {"instances are nested too deeply", fmt::format("at most {} levels", kMaxInstanceDepth), ""});
      return false;
    }
    if (instances_ == kMaxInstances) {
      report_.add(mark, instance.path,
                  {fmt::format("there are more than {} instances", kMaxInstances), "fewer instances", ""});
    }
    return instances_++ < kMaxInstances;
  }

  // values of the instance, evaluated around it
  void give_parameters(const Instance& instance, Level& level, Scope& scope) {
    const Node::Entry* given = instance.entry.value.find("parameters");
    if (given == nullptr || !is_map(given->value, instance.path + ".parameters")) return;
    report_duplicates(given->value, instance.path + ".parameters", report_);
    for (const Node::Entry& entry : given->value.entries) {
      const std::string path = fmt::format("{}.parameters.{}", instance.path, entry.key);
      Node value = entry.value;
      if (!is_value_of_parameter(value)) {
        report_.add(value.mark, path, {"is " + describe(value), kValueOfParameter, ""});
        continue;
      }
      const std::size_t problems = report_.size();
      level.scope.substitute(value, path);
      if (report_.size() > problems) continue;
      if (scope.give(entry.key, std::move(value))) continue;
      report_.add(entry.mark, path,
                  {fmt::format("'{}' has no parameter '{}'", instance.group, entry.key), "",
                   closest(entry.key, scope.own_names())});
    }
  }

  // Puts the elements of an instance into the tree, under elements of the same name there.
  void join(Node& tree, Node own, const Instance& instance, Level& level) {
    for (Node::Entry& section : own.entries) {
      Node::Entry* present = tree.find(section.key);
      if (present == nullptr) {
        tree.entries.push_back({section.key, section.mark, {}});
        present = &tree.entries.back();
        present->value.kind = section.value.kind;
        present->value.mark = section.value.mark;
      }
      if (present->value.kind != section.value.kind) continue;  // reported when the section is read
      Node& target = present->value;
      std::move(section.value.duplicates.begin(), section.value.duplicates.end(),
                std::back_inserter(target.duplicates));
      std::move(section.value.items.begin(), section.value.items.end(), std::back_inserter(target.items));
      for (Node::Entry& element : section.value.entries) {
        const bool is_new = level.brought_in.emplace(section.key, element.key).second;
        join_element(target, std::move(element), is_new, instance);
      }
    }
  }

  void join_element(Node& target, Node::Entry element, bool is_new, const Instance& instance) {
    if (!is_new) {
      report_.add(instance.entry.mark, instance.path,
                  {fmt::format("another instance has an element '{}'", element.key), "another prefix", ""});
      return;
    }
    Node::Entry* present = target.find(element.key);
    if (present == nullptr) {
      target.entries.push_back(std::move(element));
      return;
    }
    merge(element.value, std::move(present->value));
    present->value = std::move(element.value);
  }

  // ---- warnings

  void warn_of_unused(const Level& level) {
    if (warnings_ == nullptr || level.depth > 0) return;
    for (const Scope::Unused& parameter : level.scope.unused()) {
      warn(parameter.mark, "parameters." + parameter.name, "nothing uses this parameter");
    }
    const auto see = [&](std::string_view key, const Library& library, const char* what) {
      for (const Node::Entry& entry : library.entries.entries) {
        if (!library.used.contains(entry.key)) warn(entry.mark, fmt::format("{}.{}", key, entry.key), what);
      }
    };
    see(kTemplatesKey, level.templates, "nothing uses this template");
    see(kGroupsKey, level.groups, "the group has no instance");
  }

  // a file of parts has more than one scene uses
  void warn(const Mark& mark, std::string path, std::string what) {
    if (mark.source == 0) warnings_->push_back(report_.at(mark, std::move(path), {std::move(what), "", ""}).text());
  }

  ScopeContext& context_;
  Report& report_;
  std::vector<std::string>* warnings_;
  std::size_t values_left_ = kMaxCopiedValues;
  std::size_t instances_ = 0;
  bool is_too_large_ = false;
  std::vector<std::string> open_;  // groups around the present instance
};

}  // namespace

void expand_instances(Node& root, Scope& scope, ScopeContext& context, std::vector<std::string>* warnings) {
  Level level{.scope = scope};
  Expander(context, warnings).expand(root, level);
}

}  // namespace slew::scene
