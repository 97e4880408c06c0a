// SPDX-License-Identifier: Apache-2.0
// Field tables of the mechanics Defs: what a scene may set, by section and element type.
#pragma once

#include <span>
#include <string>
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

  bool is_default = false;  // whether it is meant where the key `type` is missing

  // Why a live field would change nothing of this Def; empty: it changes something. Null: every live field does.
  std::string (*obstacle_of_change)(const void* def, const Field& field) = nullptr;
};

struct Section {
  std::string_view name;  // "bodies", "joints", "forces", "dummies", "shapes", "contacts", "frictions"
  std::span<const ElementType> types;
};

// Null when a section has no such type.
[[nodiscard]] const ElementType* find_type(std::string_view section, std::string_view name) noexcept;

// The sections of elements by name.
[[nodiscard]] std::span<const Section> sections() noexcept;

// Rows of the section `mechanics`; they bind to MechanicsDef itself.
[[nodiscard]] std::span<const Field> mechanics_fields() noexcept;

// Names in a scene.
[[nodiscard]] std::string_view key_of(Formulation formulation) noexcept;
[[nodiscard]] std::string_view key_of(Integrator integrator) noexcept;

}  // namespace slew::multibody
