// SPDX-License-Identifier: Apache-2.0
// The texts of a file that name an element of it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/yaml_tree.h"

namespace slew::scene {

struct TextReference {
  std::string path;            // "Pillar_LiftBoom.body1"
  const Node* text = nullptr;  // "Boom", "Boom.tip", "Boom.position.y"; null: the key of `entry`
  const Node::Entry* entry = nullptr;
  [[nodiscard]] const Mark& mark() const noexcept { return text != nullptr ? text->mark : entry->mark; }
};

// All but those of the element itself, in the order of the file's sections: fields with references, named points,
// variables and conditions, start coordinates, payload, and the script. Of templates, and of parameters of the file and
// of instances, each text that begins with the name. Patterns are not among them.
[[nodiscard]] std::vector<TextReference> references_to(const Node& root, std::string_view name);

}  // namespace slew::scene
