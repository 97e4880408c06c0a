// SPDX-License-Identifier: Apache-2.0
// The names of a scene's elements: one name, one element, in any section.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/diagnostic.h"
#include "scene/field_reader.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

class NameTable {
 public:
  // Registers every element of every section, valid or not, so that a fault in one element leaves no dangling
  // references. Reports names that are not words, too long, taken, or reserved.
  void declare_all(const Node& root, Report& report);

  // Reports the references whose name is not an element of the required kind.
  void resolve(const std::vector<Reference>& references, Report& report) const;

  // Kind of an element ("body", "force", ...); empty if it does not exist.
  [[nodiscard]] std::string_view kind_of(std::string_view name) const;
  [[nodiscard]] std::vector<std::string_view> names_of(std::string_view kind) const;  // "" for all
  [[nodiscard]] std::string closest_of(std::string_view name, std::string_view kind) const;

 private:
  struct Declared {
    std::string_view kind;
    Mark mark;
  };
  std::map<std::string, Declared, std::less<>> names_;
  std::set<std::string, std::less<>> flexible_;  // bodies whose nodes are bodies as well: "Boom.Node20"
};

// "a body", "an input"
[[nodiscard]] std::string with_article(std::string_view kind);

// kinds: one, or several as in "component or force".
[[nodiscard]] bool is_one_of(std::string_view kind, std::string_view kinds);

// True for letters, digits and _ that begin with a letter or _.
[[nodiscard]] bool is_word(std::string_view name);

// True if a pattern with * (any characters) and ? (one character) matches the whole text.
[[nodiscard]] bool fits_pattern(std::string_view text, std::string_view pattern);

}  // namespace slew::scene
