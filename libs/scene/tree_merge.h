// SPDX-License-Identifier: Apache-2.0
// Laying one map of a scene over another.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "scene/yaml_tree.h"

namespace slew::scene {

// Maps merge key by key, anything else is replaced; new keys go to the end.
void merge(Node& base, Node overlay);

// Removes the key and returns its entry; empty: there is none.
std::optional<Node::Entry> take(Node& map, std::string_view key);

// Number of values in a node, itself included.
[[nodiscard]] std::size_t count_of(const Node& node);

}  // namespace slew::scene
