// SPDX-License-Identifier: Apache-2.0
#include "scene/setting.h"

#include <utility>

#include "scene/source.h"

namespace slew::scene {
namespace {

void move_all_marks(Node& node, const Mark& mark) {
  node.mark = mark;
  for (Node& item : node.items) move_all_marks(item, mark);
  for (Node::Entry& entry : node.entries) {
    entry.mark = mark;
    move_all_marks(entry.value, mark);
  }
}

}  // namespace

std::optional<Setting> parse_setting(const std::string& text, const std::string& expected, Report& report) {
  const Mark mark{report.add_source("--set " + text, Report::Lines::none), 0, 0};
  const std::size_t equals = text.find('=');
  const std::string path = text.substr(0, equals);
  if (equals == std::string::npos || path.empty() || path.front() == '.' || path.back() == '.') {
    report.add(mark, "", {"is not a setting", expected, ""});
    return std::nullopt;
  }
  if (text.find_first_not_of(" \t", equals + 1) == std::string::npos) {
    report.add(mark, "", {"has no value", expected, ""});
    return std::nullopt;
  }
  const std::optional<SourceText> source = check_source("value: " + text.substr(equals + 1), mark.source, report);
  std::optional<Node> map = source ? parse_yaml(*source, report) : std::nullopt;
  if (!map) return std::nullopt;
  Node& value = map->entries.front().value;
  move_all_marks(value, mark);
  return Setting{path, std::move(value), mark};
}

void set_key(Node& map, const std::string& key, Node value, const Mark& mark) {
  if (Node::Entry* found = map.find(key)) {
    found->mark = mark;
    found->value = std::move(value);
  } else {
    map.entries.push_back({key, mark, std::move(value)});
  }
}

}  // namespace slew::scene
