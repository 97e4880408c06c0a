// SPDX-License-Identifier: Apache-2.0
// Rows that the field tables of all cylinders share. Def has a member `CylinderParameters common`; a type's own
// geometry stands between the two groups.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

inline constexpr std::string_view kPortCouplings[] = {"session", "hold", "linear", "two", "tlm"};

template <typename Def, auto Member>
constexpr Field cylinder_field(std::string_view key, const FieldOptions& options) {
  return field<&Def::common, Member>(key, options);
}

// Connections and piston.
template <typename Def>
constexpr auto cylinder_piston_fields() {
  using C = CylinderParameters;
  return std::array{
      cylinder_field<Def, &C::force>(
          "force",
          {.presence = Presence::required, .reference = "force", .doc = "force element that the cylinder drives"}),
      cylinder_field<Def, &C::friction_curve>("friction_curve",
                                              {.reference = "curve", .doc = "friction coefficient over piston speed"}),
      cylinder_field<Def, &C::port_a>(
          "port_a", {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
      cylinder_field<Def, &C::port_b>(
          "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
      cylinder_field<Def, &C::piston_diameter>("piston_diameter", {.dimension = Dimension::length,
                                                                   .range = kPositive,
                                                                   .presence = Presence::required,
                                                                   .doc = "diameter of the piston"}),
      cylinder_field<Def, &C::piston_length>("piston_length", {.dimension = Dimension::length,
                                                               .range = kNotNegative,
                                                               .presence = Presence::required,
                                                               .doc = "length of the piston"}),
      cylinder_field<Def, &C::chamber_length>("chamber_length", {.dimension = Dimension::length,
                                                                 .range = kPositive,
                                                                 .presence = Presence::required,
                                                                 .doc = "inner length of the barrel"}),
  };
}

// Stroke, barrel, friction, leak and end dampers.
template <typename Def>
constexpr auto cylinder_stroke_fields() {
  using C = CylinderParameters;
  return std::array{
      cylinder_field<Def, &C::minimum_stroke>("minimum_stroke", {.dimension = Dimension::length,
                                                                 .range = kNotNegative,
                                                                 .presence = Presence::required,
                                                                 .doc = "stroke at the lower end damper"}),
      cylinder_field<Def, &C::maximum_stroke>("maximum_stroke", {.dimension = Dimension::length,
                                                                 .range = kPositive,
                                                                 .presence = Presence::required,
                                                                 .doc = "stroke at the upper end damper"}),
      cylinder_field<Def, &C::bulk_modulus>(
          "bulk_modulus", {.dimension = Dimension::pressure, .range = kPositive, .doc = "bulk modulus of the barrel"}),
      cylinder_field<Def, &C::cylinder_coefficient>(
          "cylinder_coefficient", {.range = kFraction, .doc = "efficiency eta; 1 - eta scales the friction curve"}),
      cylinder_field<Def, &C::seal_friction>(
          "seal_friction",
          {.dimension = Dimension::force, .range = kNotNegative, .doc = "friction at equal pressures"}),
      cylinder_field<Def, &C::viscous_friction>(
          "viscous_friction",
          {.dimension = Dimension::damping, .range = kNotNegative, .doc = "friction proportional to the speed"}),
      cylinder_field<Def, &C::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "leak across the piston at leak_pressure"}),
      cylinder_field<Def, &C::leak_pressure>(
          "leak_pressure",
          {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of leak_flow"}),
      cylinder_field<Def, &C::end_stiffness>(
          "end_stiffness",
          {.dimension = Dimension::stiffness, .range = kPositive, .doc = "spring constant of the end dampers"}),
      cylinder_field<Def, &C::end_damping>(
          "end_damping",
          {.dimension = Dimension::damping, .range = kNotNegative, .doc = "damping constant of the end dampers"}),
      cylinder_field<Def, &C::dead_volume>(
          "dead_volume",
          {.dimension = Dimension::volume, .range = kNotNegative, .doc = "oil in each chamber beyond the stroke"}),
      cylinder_field<Def, &C::coupling>(
          "coupling", {.change = Change::live,
                       .choices = kPortCouplings,
                       .doc = "coupling level of this cylinder's port; session: the level of session.coupling"}),
  };
}

// A cylinder's whole table.
template <typename Def, std::size_t N>
constexpr auto cylinder_fields(const std::array<Field, N>& geometry) {
  constexpr auto piston = cylinder_piston_fields<Def>();
  constexpr auto stroke = cylinder_stroke_fields<Def>();
  std::array<Field, piston.size() + N + stroke.size()> table;
  auto end = std::copy(piston.begin(), piston.end(), table.begin());
  end = std::copy(geometry.begin(), geometry.end(), end);
  std::copy(stroke.begin(), stroke.end(), end);
  return table;
}

}  // namespace slew::hydraulics
