// SPDX-License-Identifier: Apache-2.0
// Edits of a scene file's text by position: comments, layout and all that an edit does not name stay as they are.
//
// A path is that of a problem: "Bag.mass", "session.step", "Platform.axes[1].gain"; its first part is an element of
// this file or a section. A value is YAML as it stands behind a key. Every edit is proved by reading its result: a text
// that changes anything else in the file (an open quote, a comma in brackets, a comment) is refused.
//
// It has the file's own text alone. Elements of included files, and those that instances make, are not in it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/source.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

struct TextEdit {
  std::string text{};                // the whole text; after a refusal as it was
  std::string refusal{};             // empty: done
  std::vector<std::string> notes{};  // references that followed, or for which a removal is refused: "J.body1 (line 41)"
};

class SceneText {
 public:
  // source: index of the text in the report. Nothing: it is no YAML of a scene, and the report has the problem.
  [[nodiscard]] static std::optional<SceneText> read(std::string text, int source, Report& report);

  [[nodiscard]] const std::string& text() const noexcept { return source_.text; }
  [[nodiscard]] const Node& root() const noexcept { return root_; }
  // The value as it stands in the file, with comments between its lines.
  [[nodiscard]] std::string_view written(const Node& value) const;
  // The element of this file, and its section; null: there is none.
  struct Element {
    const Node::Entry* section = nullptr;
    const Node::Entry* entry = nullptr;
  };
  [[nodiscard]] Element find(std::string_view name) const;

  // Replaces a value, or adds the key to its element or section. An empty value removes the key.
  [[nodiscard]] TextEdit set(std::string_view path, std::string_view value) const;
  // An element with all required fields, each with a value that lies in its range, or an element that it may
  // name. type: empty where the section has one type, or for the type without a name.
  [[nodiscard]] TextEdit add(std::string_view section, std::string_view type, std::string_view name) const;
  // The text of an element once more, behind it, under another name.
  [[nodiscard]] TextEdit copy(std::string_view name, std::string_view other) const;
  // With all texts of this file that name the element; the notes list them.
  [[nodiscard]] TextEdit rename(std::string_view name, std::string_view other) const;
  // Refused while texts of this file name it; the notes list them. Comment lines around it stay.
  [[nodiscard]] TextEdit remove(std::string_view name) const;

 private:
  struct Span {
    std::size_t begin = 0, end = 0;  // bytes
  };
  // A place in the tree: the entries and rows down to it.
  struct Step {
    std::string key;
    std::optional<std::size_t> row{};
  };
  struct Place {
    std::vector<Step> steps{};           // from the root
    const Node::Entry* owner = nullptr;  // whose value has the key; null: the root or a row
    const Node* map = nullptr;           // that has, or would have, the key
    const Node::Entry* entry = nullptr;  // null: the key is missing, or the place is a row
    const Node* value = nullptr;         // null: the key is missing
    std::string key{};                   // the last one
  };

  SceneText(SourceText source, Node root, std::size_t problems)
      : source_(std::move(source)), root_(std::move(root)), problems_(problems) {}

  // scene_text.cpp
  [[nodiscard]] Span span_of(const Node& value) const;
  [[nodiscard]] Span span_of_key(const Node::Entry& entry) const;
  [[nodiscard]] std::size_t end_of(const Node::Entry& entry) const;  // of its value, or of the key
  [[nodiscard]] std::size_t behind_colon(const Node::Entry& entry) const;
  [[nodiscard]] std::size_t line_begin(std::size_t at) const;
  [[nodiscard]] std::size_t line_end(std::size_t at) const;  // its break, without a carriage return
  [[nodiscard]] bool is_in_brackets(const Node& node) const;
  [[nodiscard]] std::string line_break() const;
  [[nodiscard]] std::optional<Place> find_place(std::string_view path) const;
  [[nodiscard]] std::string with_key(const Place& place, std::string_view value) const;
  // Empty: the key cannot be taken out.
  [[nodiscard]] std::string without(const Node::Entry* owner, const Node& map, const Node::Entry& entry) const;
  [[nodiscard]] TextEdit refuse(std::string reason) const;
  [[nodiscard]] TextEdit prove(const Place& place, std::string result, std::string_view value) const;

  // scene_text_elements.cpp
  [[nodiscard]] std::string name_problem(std::string_view name) const;
  // An element of these kinds, for the reference with this number among those of the kinds.
  [[nodiscard]] std::string some_of(std::string_view kinds, std::size_t number) const;
  [[nodiscard]] std::string with_element(std::string_view section, std::string_view name,
                                         const std::vector<std::pair<std::string, std::string>>& fields) const;
  [[nodiscard]] TextEdit prove_read(std::string result) const;

  SourceText source_;
  Node root_;
  std::size_t problems_;  // of its YAML, such as an anchor
};

}  // namespace slew::scene
