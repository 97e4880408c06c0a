// Field tables of the mechanics Defs: what a scene may set, by section and element type.
#pragma once

#include <span>
#include <string_view>

#include "core/field.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

// A type of element that a section of the scene may hold.
struct ElementType {
  std::string_view name;  // value of the key `type`; empty where the section has one type only
  std::string_view kind;  // kind in references (Field::reference): "body", "joint", "force", "dummy"
  std::string_view doc;   // one line
  std::span<const Field> fields;

  // Appends a Def of this type with its defaults and the given name; returns its address for Field::member, which
  // holds until the next append to the same MechanicsDef.
  void* (*append)(MechanicsDef& mechanics, std::string_view element);

  bool is_default = false;  // true: type of an element without the key `type`
};

struct Section {
  std::string_view name;  // "bodies", "joints", "forces", "dummies", "shapes", "contacts", "frictions"
  std::span<const ElementType> types;
};

// The sections of elements by name.
[[nodiscard]] std::span<const Section> sections() noexcept;

// Rows of the section `mechanics`; they bind to MechanicsDef itself.
[[nodiscard]] std::span<const Field> mechanics_fields() noexcept;

// Names in a scene.
[[nodiscard]] std::string_view key_of(Formulation formulation) noexcept;
[[nodiscard]] std::string_view key_of(Integrator integrator) noexcept;

}  // namespace slew::multibody
