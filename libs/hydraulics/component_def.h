// SPDX-License-Identifier: Apache-2.0
// Definition of one hydraulic component, and the table of all component types.
//
// The set is open: a new type is a final Def with its field table, a ComponentType row, and a HydraulicComponent. The
// row is entered by hand in component_types.cpp; nothing registers itself.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/field.h"
#include "core/problem.h"
#include "hydraulics/actuator_def.h"

namespace slew::hydraulics {

struct HydraulicsDef;
struct PumpLines;
class HydraulicComponent;
class CircuitBuilder;

// Shaft that a component turns, for the pumps that name it as their engine.
struct ShaftDef {
  double speed = 0;    // rad/s, at the start
  double inertia = 0;  // kg m2
};

// Base of every component's Def. Members that a scene may set have a row in the type's field table.
struct ComponentDef {
  std::string name;  // element name, unique in the scene

  ComponentDef() = default;
  ComponentDef(const ComponentDef&) = default;
  ComponentDef(ComponentDef&&) = default;
  ComponentDef& operator=(const ComponentDef&) = default;
  ComponentDef& operator=(ComponentDef&&) = default;
  virtual ~ComponentDef() = default;

  // Key of the type in component_types().
  [[nodiscard]] virtual std::string_view type_name() const noexcept = 0;
  // Address of the final Def, for Field::member.
  [[nodiscard]] virtual void* address() noexcept = 0;
  // Facts of a component that drives a force element through a power port; none of the others.
  [[nodiscard]] virtual std::optional<ActuatorDef> actuator() const { return std::nullopt; }
  // Shaft of a component that drives pumps; none of the others.
  [[nodiscard]] virtual std::optional<ShaftDef> shaft() const { return std::nullopt; }
  // True if it may raise the pressure of a volume above those of the others that it joins.
  [[nodiscard]] virtual bool raises_pressure() const { return actuator().has_value(); }
  // True if an input may name the component; its type has a control signal then.
  [[nodiscard]] virtual bool takes_signal() const;
  // Adds what connects or relieves volumes whatever the control signals are (pump_lines.h), and pumps.
  virtual void add_lines(PumpLines& /*lines*/) const {}
};

struct ComponentType {
  std::string_view name;          // value of `type:` in the scene
  std::span<const Field> fields;  // fields of the final Def
  std::string_view doc;
  std::unique_ptr<ComponentDef> (*make_def)() = nullptr;
  // Rules between fields and between elements; ranges and references are checked from the table. May be null.
  void (*validate)(const HydraulicsDef& circuit, const ComponentDef& def, Problems& errors,
                   Problems& warnings) = nullptr;
  std::unique_ptr<HydraulicComponent> (*build)(const ComponentDef& def, CircuitBuilder& builder) = nullptr;
  bool has_control_signal = false;  // takes an input (`inputs: ... primitive: NAME`)
  bool has_ls_port = false;         // may be named where a load-sensing pressure is wanted (reference "ls_source")
};

// All component types of this version, in the order of the documentation.
[[nodiscard]] std::span<const ComponentType> component_types();

// Null if the type does not exist.
[[nodiscard]] const ComponentType* find_component_type(std::string_view name);

// A row of the Def's field table; null if its type has no such field.
[[nodiscard]] const Field* find_field(const ComponentDef& def, std::string_view key);

// Volumes that a component names, in the order of its fields; they end with the Def.
[[nodiscard]] std::vector<std::string_view> volumes_of(const ComponentDef& def);

// Member of a Def by the key of its field; Value{} if the type has no such field, or one of another FieldType.
template <typename Value>
[[nodiscard]] Value member_of(const ComponentDef& def, std::string_view key) {
  const Field* field = find_field(def, key);
  if (field == nullptr || field->type != slew::detail::field_type_of<Value>() || field->member == nullptr) return {};
  // the table binds members of a Def that may change; nothing is changed here
  return *static_cast<const Value*>(field->member(const_cast<ComponentDef&>(def).address()));
}

}  // namespace slew::hydraulics
