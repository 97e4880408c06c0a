// SPDX-License-Identifier: Apache-2.0
#include "hydraulics/live_rules.h"

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/field.h"

namespace slew::hydraulics {
namespace {

constexpr std::string_view kStallingFriction = ".friction_torque";

template <typename Value>
void copy_member(const Field& row, void* from, void* to) {
  *static_cast<Value*>(row.member(to)) = *static_cast<const Value*>(row.member(from));
}

void copy_field(const Field& row, void* from, void* to) {
  switch (row.type) {
    case FieldType::number:
      return copy_member<double>(row, from, to);
    case FieldType::integer:
      return copy_member<std::int64_t>(row, from, to);
    case FieldType::boolean:
      return copy_member<bool>(row, from, to);
    case FieldType::text:
      return copy_member<std::string>(row, from, to);
    case FieldType::triple:
      return copy_member<Triple>(row, from, to);
    case FieldType::triples:
      return copy_member<std::vector<Triple>>(row, from, to);
    case FieldType::table:
      return copy_member<Table>(row, from, to);
    case FieldType::numbers:
      return copy_member<std::vector<double>>(row, from, to);
    case FieldType::texts:
      return copy_member<std::vector<std::string>>(row, from, to);
    case FieldType::choice:
      return row.set_choice(to, row.get_choice(from));
  }
}

// The tables bind to members of a Def that may change; `from` is only read.
void copy_fields(std::span<const Field> fields, const void* from, void* to) {
  for (const Field& row : fields) copy_field(row, const_cast<void*>(from), to);
}

bool is_path_of(std::string_view path, std::string_view element) {
  return path.size() > element.size() && path[element.size()] == '.' && path.starts_with(element);
}

}  // namespace

HydraulicsDef copy_of(const HydraulicsDef& circuit) {
  HydraulicsDef copy;
  copy_fields(kHydraulicsFields, &circuit, &copy);
  copy.volumes = circuit.volumes;
  copy.curves = circuit.curves;
  for (const auto& component : circuit.components) {
    const ComponentType& type = *find_component_type(component->type_name());
    copy.components.push_back(type.make_def());
    copy.components.back()->name = component->name;
    copy_fields(type.fields, component->address(), copy.components.back()->address());
  }
  return copy;
}

double* LiveRules::find(std::string_view path) {
  for (const auto& component : circuit_.components) {
    if (!is_path_of(path, component->name)) continue;
    const Field* const row = find_field(*component, path.substr(component->name.size() + 1));
    if (row != nullptr && row->type == FieldType::number)
      return static_cast<double*>(row->member(component->address()));
  }
  return nullptr;
}

std::optional<Problem> LiveRules::broken_rule_of(std::string_view path) const {
  for (const auto& component : circuit_.components) {
    if (!is_path_of(path, component->name)) continue;
    const auto validate = find_component_type(component->type_name())->validate;
    if (validate == nullptr) return std::nullopt;
    Problems found, warnings;
    validate(circuit_, *component, found, warnings);
    for (Problem& problem : found) {
      if (!problem.path.ends_with(kStallingFriction)) return std::move(problem);
    }
    return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace slew::hydraulics
