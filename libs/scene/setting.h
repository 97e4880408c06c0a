// SPDX-License-Identifier: Apache-2.0
// One change of a file's values from a command line: "PATH=VALUE".
#pragma once

#include <optional>
#include <string>

#include "scene/diagnostic.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

struct Setting {
  std::string path;
  Node value;  // read as the value of a key, so that brackets and quotes have the same meaning as in a file
  Mark mark;   // mark of "--set PATH=VALUE", the same everywhere in it
};

// Problems go to the report. expected: for messages, "Element.key=value, such as 'Bag.mass=1500kg'".
[[nodiscard]] std::optional<Setting> parse_setting(const std::string& text, const std::string& expected,
                                                   Report& report);

// Replaces the key's value, or adds the key.
void set_key(Node& map, const std::string& key, Node value, const Mark& mark);

}  // namespace slew::scene
