// SPDX-License-Identifier: Apache-2.0
#include "scene/tree_merge.h"

#include <iterator>
#include <utility>

namespace slew::scene {

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

std::optional<Node::Entry> take(Node& map, std::string_view key) {
  for (auto entry = map.entries.begin(); entry != map.entries.end(); ++entry) {
    if (entry->key != key) continue;
    Node::Entry taken = std::move(*entry);
    map.entries.erase(entry);
    return taken;
  }
  return std::nullopt;
}

std::size_t count_of(const Node& node) {
  std::size_t count = 1;
  for (const Node& item : node.items) count += count_of(item);
  for (const Node::Entry& entry : node.entries) count += count_of(entry.value);
  return count;
}

}  // namespace slew::scene
