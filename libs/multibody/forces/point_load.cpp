// SPDX-License-Identifier: Apache-2.0
#include "multibody/forces/point_load.h"

#include <array>

#include "multibody/forces/build_elements.h"
#include "multibody/forces/force_fields.h"
#include "multibody/forces/validate_elements.h"

namespace slew::multibody {
namespace {

constexpr std::array<std::string_view, 2> kLoadAxes = {"body", "ground"};
constexpr std::array<std::string_view, 2> kLoadKeys = {"force", "torque"};  // by LoadKind

constexpr Field kPointForceFields[] = {
    required_body<&PointForceDef::body>("body", "body that the force acts on"),
    field<&PointForceDef::point>("point", {.dimension = Dimension::length, .doc = "force's point in the body"}),
    field<&PointForceDef::direction>("direction", {.doc = "direction of a positive force, of any length"}),
    field<&PointForceDef::axes>("axes", {.choices = kLoadAxes, .doc = "axes that the direction is given in and keeps"}),
    field<&PointForceDef::force>("force",
                                 {.dimension = Dimension::force, .change = Change::live, .doc = "constant part"}),
    field<&PointForceDef::force_table>("force_table", {.dimension = Dimension::time,
                                                       .value_dimension = Dimension::force,
                                                       .doc = "force over time, added; end values hold"}),
};

constexpr Field kPointTorqueFields[] = {
    required_body<&PointTorqueDef::body>("body", "body that the torque acts on"),
    field<&PointTorqueDef::direction>("direction", {.doc = "axis of a positive torque, of any length"}),
    field<&PointTorqueDef::axes>("axes",
                                 {.choices = kLoadAxes, .doc = "axes that the direction is given in and keeps"}),
    field<&PointTorqueDef::torque>("torque",
                                   {.dimension = Dimension::torque, .change = Change::live, .doc = "constant part"}),
    field<&PointTorqueDef::torque_table>("torque_table", {.dimension = Dimension::time,
                                                          .value_dimension = Dimension::torque,
                                                          .doc = "torque over time, added; end values hold"}),
};

template <typename Def>
PointLoad build_load(const Def& def, LoadKind kind, double constant, const Table& table,
                     const ElementBuilder& builder) {
  const int body = builder.number_of(def.body);
  PointLoad load{.name = def.name,
                 .kind = kind,
                 .axes = def.axes,
                 .link = builder.body_at(body).link,
                 .body = body,
                 .p_L = {},
                 .direction = math::Vec3(def.direction) * (1 / norm(math::Vec3(def.direction))),
                 .constant = constant,
                 .table = math::monotone_cubic(table, math::Ends::hold)};
  if (def.axes == LoadAxes::body) load.direction = builder.body_at(body).R_LB * load.direction;
  return load;
}

template <typename Def>
void check_load(const Def& def, const Table& table, const char* key, ElementRules& rules) {
  if (rules.check_body(def.name, "body", def.body) && def.body == kGroundName) {
    rules.add(def.name + ".body", "the load acts on Ground, which does not move", "a body");
  }
  rules.check_direction(def.name + ".direction", def.direction);
  rules.check_table(def.name + "." + key, table, TableUse::any);
}

}  // namespace

double magnitude_of(const PointLoad& load, double time) noexcept {
  return load.signal * (load.constant + (load.table.empty() ? 0.0 : math::value_at(load.table, time)));
}

Wrench wrench_of(const PointLoad& load, const LinkMotion& link, double time) noexcept {
  const math::Vec3 d = load.axes == LoadAxes::body ? link.R * load.direction : load.direction;
  const math::Vec3 F = d * magnitude_of(load, time);
  if (load.kind == LoadKind::torque) return {math::Vec3(), F};
  return {F, cross(link.R * load.p_L, F)};
}

std::span<const Field> point_force_fields() noexcept {
  return kPointForceFields;
}

std::span<const Field> point_torque_fields() noexcept {
  return kPointTorqueFields;
}

PointLoad PointLoadRow::build(const PointForceDef& def, ElementBuilder& builder) {
  PointLoad load = build_load(def, LoadKind::force, def.force, def.force_table, builder);
  load.p_L = builder.in_link(load.body, def.point);
  return load;
}

PointLoad PointLoadRow::build(const PointTorqueDef& def, ElementBuilder& builder) {
  return build_load(def, LoadKind::torque, def.torque, def.torque_table, builder);
}

void PointLoadRow::check(const PointForceDef& def, ElementRules& rules) {
  check_load(def, def.force_table, "force_table", rules);
}

void PointLoadRow::check(const PointTorqueDef& def, ElementRules& rules) {
  check_load(def, def.torque_table, "torque_table", rules);
}

void PointLoadRow::list_variables(const PointLoad& load, VariableNames& names) {
  const bool is_force = load.kind == LoadKind::force;
  names.add(load.name + (is_force ? ".force" : ".torque"), is_force ? Dimension::force : Dimension::torque);
}

void PointLoadRow::read_variables(const PointLoad& load, std::span<const LinkMotion> /*motion*/, double time,
                                  VariableSink& sink) noexcept {
  sink.put(magnitude_of(load, time));
}

std::span<const std::string_view> PointLoadRow::value_keys(const PointLoad& load) noexcept {
  return {&kLoadKeys[static_cast<std::size_t>(load.kind)], 1};
}

}  // namespace slew::multibody
