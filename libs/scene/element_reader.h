// SPDX-License-Identifier: Apache-2.0
// Reads the sections of a scene that are maps of fields or of elements, each element by the table of its type.
#pragma once

#include <string_view>
#include <vector>

#include "scene/element_table.h"
#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/place_map.h"
#include "scene/scene.h"
#include "scene/source.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

class ElementReader {
 public:
  // All outlive this. root: the expanded tree; scene: receives the elements.
  ElementReader(const Node& root, const LoadContext& load_context, Scene& scene, const ReadContext& context)
      : root_(root),
        load_context_(load_context),
        scene_(scene),
        context_(context),
        report_(context.report),
        places_(context.places) {}

  // One that is not in the scene is none. Problems go to the report.
  void read_section(std::string_view name);

 private:
  bool is_map(const Node::Entry& section);
  void read_element(std::string_view section, const Node::Entry& element);
  void read_list(const Node::Entry& element, const ListTable& list, void* def);
  void read_flexible_body(const Node::Entry& element, const ElementTable& table, void* def);
  void refuse_keys_of_other_type(const Node::Entry& element, const ElementTable& table,
                                 std::vector<std::string_view>& passed_over);
  [[nodiscard]] const ElementTable* table_of(std::string_view section, const Node::Entry& element);

  const Node& root_;
  const LoadContext& load_context_;
  Scene& scene_;
  const ReadContext& context_;
  Report& report_;
  PlaceMap& places_;
};

}  // namespace slew::scene
