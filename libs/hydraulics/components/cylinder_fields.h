// SPDX-License-Identifier: Apache-2.0
// Rows that the field tables of all cylinders share. Def has a member `CylinderParameters common`; a type's own
// geometry stands between the two groups.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "hydraulics/components/cylinder_def.h"

namespace slew::hydraulics {

inline constexpr std::string_view kPortCouplings[] = {"session", "hold", "linear", "two", "tlm"};

template <typename Def, auto Member>
constexpr Field cylinder_field(std::string_view key, const FieldOptions& options) {
  return field<&Def::common, Member>(key, options);
}

template <typename Def>
constexpr auto cylinder_connection_fields() {
  using C = CylinderParameters;
  return std::array{
      cylinder_field<Def, &C::force>(
          "force", {.presence = Presence::required, .reference = "force", .doc = "force that the cylinder drives"}),
      cylinder_field<Def, &C::friction_curve>("friction_curve",
                                              {.reference = "curve", .doc = "friction coefficient over piston speed"}),
      cylinder_field<Def, &C::port_a>(
          "port_a", {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
      cylinder_field<Def, &C::port_b>(
          "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
  };
}

template <typename Def>
constexpr auto cylinder_piston_fields() {
  using C = CylinderParameters;
  return std::array{
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

template <typename Def>
inline constexpr ReadBy kReadByBreakaway[] = {
    {"breakaway_friction", "a breakaway_friction above 0",
     [](const void* def) noexcept { return static_cast<const Def*>(def)->common.breakaway_friction != 0; }}};

// An efficiency of 1 is right without a curve.
template <typename Def>
inline constexpr ReadBy kReadByCurve[] = {{"friction_curve", "a friction_curve",
                                           [](const void* def) noexcept {
                                             const CylinderParameters& common = static_cast<const Def*>(def)->common;
                                             return !common.friction_curve.empty() || common.cylinder_coefficient == 1;
                                           },
                                           ReadBy::Otherwise::warning}};

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
      cylinder_field<Def, &C::cylinder_coefficient>("cylinder_coefficient",
                                                    {.range = kFraction,
                                                     .read_by = kReadByCurve<Def>,
                                                     .doc = "efficiency eta; 1 - eta scales the friction curve"}),
      cylinder_field<Def, &C::seal_friction>(
          "seal_friction",
          {.dimension = Dimension::force, .range = kNotNegative, .doc = "friction at equal pressures"}),
      cylinder_field<Def, &C::viscous_friction>(
          "viscous_friction",
          {.dimension = Dimension::damping, .range = kNotNegative, .doc = "friction proportional to the speed"}),
      cylinder_field<Def, &C::breakaway_friction>("breakaway_friction",
                                                  {.dimension = Dimension::force,
                                                   .range = kNotNegative,
                                                   .doc = "friction of the seals near rest beyond seal_friction"}),
      cylinder_field<Def, &C::stribeck_speed>("stribeck_speed",
                                              {.dimension = Dimension::velocity,
                                               .range = kPositive,
                                               .read_by = kReadByBreakaway<Def>,
                                               .doc = "speed at which 1/e of breakaway_friction is left"}),
      cylinder_field<Def, &C::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                       .range = kNotNegative,
                                                       .change = Change::live,
                                                       .doc = "leak across the piston at leak_pressure"}),
      cylinder_field<Def, &C::leak_pressure>(
          "leak_pressure",
          {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of the leak flows"}),
      cylinder_field<Def, &C::end_stiffness>(
          "end_stiffness",
          {.dimension = Dimension::stiffness, .range = kNotNegative, .doc = "spring constant of the end dampers"}),
      cylinder_field<Def, &C::end_damping>(
          "end_damping",
          {.dimension = Dimension::damping, .range = kNotNegative, .doc = "damping constant of the end dampers"}),
      cylinder_field<Def, &C::dead_volume>(
          "dead_volume",
          {.dimension = Dimension::volume, .range = kNotNegative, .doc = "oil in each chamber beyond the stroke"}),
      cylinder_field<Def, &C::dead_volume_a>("dead_volume_a",
                                             {.dimension = Dimension::volume,
                                              .range = kNotNegative,
                                              .doc = "oil in chamber A beside dead_volume: port and lines"}),
      cylinder_field<Def, &C::coupling>("coupling",
                                        {.change = Change::live,
                                         .choices = kPortCouplings,
                                         .doc = "coupling level of this port; session: that of session.coupling"}),
  };
}

inline constexpr std::string_view kCushionReturns[] = {"check_valve", "throttle"};

// Keys of one chamber's cushion.
struct CushionKeys {
  std::string_view length, entry_length, plunger_diameter, orifice_diameter, areas, discharge_coefficient, flow_back;
};
inline constexpr CushionKeys kCushionKeysA{"cushion_a_length",
                                           "cushion_a_entry_length",
                                           "cushion_a_plunger_diameter",
                                           "cushion_a_orifice_diameter",
                                           "cushion_a_areas",
                                           "cushion_a_discharge_coefficient",
                                           "cushion_a_return"};
inline constexpr CushionKeys kCushionKeysB{"cushion_b_length",
                                           "cushion_b_entry_length",
                                           "cushion_b_plunger_diameter",
                                           "cushion_b_orifice_diameter",
                                           "cushion_b_areas",
                                           "cushion_b_discharge_coefficient",
                                           "cushion_b_return"};

// Conditions under which the fields of a cushion are read: it has a length.
template <typename Def, auto Cushion>
inline constexpr ReadBy kReadByCushion[] = {
    {Cushion == &CylinderParameters::cushion_a ? kCushionKeysA.length : kCushionKeysB.length, "a length above 0",
     [](const void* def) noexcept { return (static_cast<const Def*>(def)->common.*Cushion).length != 0; }}};

template <typename Def, auto Cushion>
constexpr auto cushion_fields() {
  using P = CushionParameters;
  constexpr CushionKeys keys = Cushion == &CylinderParameters::cushion_a ? kCushionKeysA : kCushionKeysB;
  constexpr std::span<const ReadBy> read_by = kReadByCushion<Def, Cushion>;
  return std::array{
      field<&Def::common, Cushion, &P::length>(
          keys.length, {.dimension = Dimension::length,
                        .range = kNotNegative,
                        .doc = Cushion == &CylinderParameters::cushion_a
                                   ? "way before the minimum stroke on which chamber A brakes; 0: no cushion"
                                   : "way before the maximum stroke on which chamber B brakes; 0: no cushion"}),
      field<&Def::common, Cushion, &P::entry_length>(
          keys.entry_length, {.dimension = Dimension::length,
                              .range = kPositive,
                              .read_by = read_by,
                              .doc = "first part of the cushion, on which the plunger shuts the port"}),
      field<&Def::common, Cushion, &P::plunger_diameter>(
          keys.plunger_diameter,
          {.dimension = Dimension::length,
           .range = kNotNegative,
           .read_by = read_by,
           .doc = "diameter of the plunger that shuts the port; 0: the whole chamber is enclosed"}),
      field<&Def::common, Cushion, &P::orifice_diameter>(
          keys.orifice_diameter, {.dimension = Dimension::length,
                                  .range = kNotNegative,
                                  .read_by = read_by,
                                  .doc = "diameter of a throttle of constant area; 0: by its areas"}),
      field<&Def::common, Cushion, &P::areas>(keys.areas, {.dimension = Dimension::length,
                                                           .value_dimension = Dimension::area,
                                                           .range = kPositive,
                                                           .read_by = read_by,
                                                           .doc = "area of the throttle over the remaining stroke"}),
      field<&Def::common, Cushion, &P::discharge_coefficient>(
          keys.discharge_coefficient,
          {.range = kFractionAboveZero, .read_by = read_by, .doc = "discharge coefficient of the throttle"}),
      field<&Def::common, Cushion, &P::flow_back>(
          keys.flow_back, {.choices = kCushionReturns,
                           .read_by = read_by,
                           .doc = "way back of the oil: a check valve without a pressure drop, or the throttle alone"}),
  };
}

// Of chambers that hold oil on both sides.
template <typename Def>
constexpr auto cylinder_second_chamber_fields() {
  return std::array{cylinder_field<Def, &CylinderParameters::dead_volume_b>(
      "dead_volume_b", {.dimension = Dimension::volume,
                        .range = kNotNegative,
                        .doc = "oil in chamber B beside dead_volume: port and lines"})};
}

// Chambers that may have a cushion.
enum class CushionEnds { a, both };

template <std::size_t... N>
constexpr auto joined(const std::array<Field, N>&... parts) {
  std::array<Field, (N + ...)> table;
  auto end = table.begin();
  ((end = std::copy(parts.begin(), parts.end(), end)), ...);
  return table;
}

// A cylinder's whole table.
template <typename Def, CushionEnds Ends = CushionEnds::both, std::size_t N>
constexpr auto cylinder_fields(const std::array<Field, N>& geometry) {
  const auto until_a = joined(cylinder_connection_fields<Def>(), cylinder_piston_fields<Def>(), geometry,
                              cylinder_stroke_fields<Def>(), cushion_fields<Def, &CylinderParameters::cushion_a>());
  if constexpr (Ends == CushionEnds::a) {
    return until_a;
  } else {
    return joined(until_a, cushion_fields<Def, &CylinderParameters::cushion_b>(),
                  cylinder_second_chamber_fields<Def>());
  }
}

}  // namespace slew::hydraulics
