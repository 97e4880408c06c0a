// SPDX-License-Identifier: Apache-2.0
// A YAML document as a tree of our own, with the place of every key and value.
//
// Stricter than libyaml, whose events it is built from: one document, a map at its root, no anchors, aliases
// or tags, keys are words, duplicate keys are found, quotes must be closed, at most kMaxDepth levels. Behind `${` up to
// the next `}` the signs of YAML are text, so that an expression (expression.h) may stand in brackets without quotes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/diagnostic.h"
#include "scene/source.h"

namespace slew::scene {

inline constexpr int kMaxDepth = 16;

struct Node {
  enum class Kind { empty, scalar, sequence, map };
  struct Entry;
  struct Duplicate {
    std::string key;
    Mark mark;  // mark of the later key, whose value is dropped
    Mark first;
  };

  // Source of a scalar: the file, an expression, or an expression whose result is a ratio, never a quantity in SI.
  enum class Origin : std::uint8_t { file, expression, ratio };

  Kind kind = Kind::empty;
  bool is_quoted = false;  // scalar in quotes or a block: text, never a number
  Origin origin = Origin::file;
  std::uint8_t level = 0;             // nested instances around the place where the text stands; 0: none (instances.h)
  std::string text;                   // scalar
  std::vector<Node> items;            // sequence
  std::vector<Entry> entries;         // map, in file order
  std::vector<Duplicate> duplicates;  // map: repeated keys; the reader of the map reports them
  Mark mark;
  Mark end;  // behind its last character; of a block scalar: behind the lines that may belong to it

  [[nodiscard]] const Entry* find(std::string_view key) const;
  [[nodiscard]] Entry* find(std::string_view key);
};

struct Node::Entry {
  std::string key;
  Mark mark;  // mark of the key
  Node value;
};

// Description of a node, for messages: "a list", "a map", "nothing", "'text'".
[[nodiscard]] std::string describe(const Node& node);

// The document's root, a map; problems go to the report. Empty if no tree could be built.
[[nodiscard]] std::optional<Node> parse_yaml(const SourceText& source, Report& report);

}  // namespace slew::scene
