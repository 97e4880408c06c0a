// SPDX-License-Identifier: Apache-2.0
// The sections of a scene and the types of elements in them, from the libraries that own the Defs.
//
// All code that iterates over a scene (reading, canonical text, parameters, schema, documentation) uses these tables
// and depends on no single Def.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "scene/scene.h"

namespace slew::scene {

// A key of an element whose value is a list of maps, all with the same fields, the first of which names the row.
struct ListTable {
  std::string_view key;  // "axes"
  std::string_view doc;
  std::span<const Field> fields;
  void* (*append)(void* def) = nullptr;             // appends a row with its defaults to the element's list
  std::vector<void*> (*rows)(void* def) = nullptr;  // the element's rows
};

// One type of element in a section of named elements.
struct ElementTable {
  std::string_view section;  // "joints"
  std::string_view type;     // value of `type:`; empty where the section has one type only
  std::string_view kind;     // its kind in references: "body", "force", "component", ...
  std::string_view doc;
  std::span<const Field> fields;
  std::function<void*(Scene&, const std::string&)> append;  // appends a Def with its defaults; the address is for
                                                            // Field::member
  bool is_default = false;                                  // type of an element without `type:`
  std::span<const ListTable> lists = {};
};

// A section that is one map of fields.
struct SingleTable {
  std::string_view section;  // "mechanics"
  std::string_view doc;
  std::span<const Field> fields;
  std::function<void*(Scene&)> def;
};

// An element of a scene, or one of its single sections (name = section's name).
struct ElementRef {
  std::string_view name;
  std::string_view section;
  std::string_view type;  // empty if the section has one type
  std::string_view kind;
  std::span<const Field> fields;
  void* def = nullptr;
  std::span<const ListTable> lists = {};
};

[[nodiscard]] const std::vector<ElementTable>& element_tables();
[[nodiscard]] const std::vector<SingleTable>& single_tables();

// Names of the sections of elements, in canonical order.
[[nodiscard]] const std::vector<std::string_view>& element_sections();
// All top-level keys, in canonical order.
[[nodiscard]] const std::vector<std::string_view>& top_level_keys();

// All elements in canonical order: by section, within it in the order in which the Scene keeps them.
[[nodiscard]] std::vector<ElementRef> elements(Scene& scene);
[[nodiscard]] std::vector<ElementRef> single_sections(Scene& scene);

}  // namespace slew::scene
