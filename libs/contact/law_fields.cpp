// SPDX-License-Identifier: Apache-2.0
// Keys, dimensions and ranges of the two laws, and the check of a Def against them.
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "contact/friction_law.h"
#include "contact/normal_law.h"

namespace slew::contact {
namespace {

using enum Dimension;

constexpr Range kRestitution{.min = kSmallestRestitution, .max = 1, .min_is_open = false, .max_is_open = false};
constexpr Range kDepthExponent{.min = 1, .max = 3, .min_is_open = false, .max_is_open = false};
constexpr Range kStribeckExponent{.min = 1, .max = 4, .min_is_open = false, .max_is_open = false};

constexpr ReadBy kReadByCurvedLaw[] = {{"contact_exponent", "contact_exponent above 1", [](const void* def) noexcept {
                                          return static_cast<const NormalLawDef*>(def)->exponent != 1;
                                        }}};

constexpr Field kNormalLawFields[] = {
    field<&NormalLawDef::stiffness>("spring_constant", {.dimension = slew::Dimension::stiffness,
                                                        .range = kPositive,
                                                        .presence = Presence::required,
                                                        .doc = "stiffness of the pair at the reference depth"}),
    field<&NormalLawDef::restitution>("restitution_coefficient",
                                      {.range = kRestitution, .doc = "rebound speed over impact speed"}),
    field<&NormalLawDef::exponent>("contact_exponent",
                                   {.range = kDepthExponent, .doc = "force over depth: 1 linear, 1.5 Hertz"}),
    field<&NormalLawDef::reference_depth>("reference_depth", {.dimension = length,
                                                              .range = kPositive,
                                                              .read_by = kReadByCurvedLaw,
                                                              .doc = "depth at which the stiffness holds"}),
    field<&NormalLawDef::smallest_impact_speed>(
        "smallest_impact_speed",
        {.dimension = velocity, .range = kPositive, .doc = "slower impacts rebound with more than the coefficient"}),
};

constexpr Field kFrictionLawFields[] = {
    field<&FrictionLawDef::pressing_force>(
        "constant_pressing_force",
        {.dimension = force, .range = kNotNegative, .doc = "added to the normal force while in contact"}),
    field<&FrictionLawDef::stiffness>(
        "surface_stiffness",
        {.dimension = slew::Dimension::stiffness, .range = kPositive, .doc = "stiffness of the bristles"}),
    field<&FrictionLawDef::damping>(
        "surface_damping",
        {.dimension = slew::Dimension::damping, .range = kNotNegative, .doc = "damping of the bristles"}),
    field<&FrictionLawDef::stribeck_speed>(
        "stribeck_velocity",
        {.dimension = velocity, .range = kPositive, .doc = "speed over which static falls to dynamic friction"}),
    field<&FrictionLawDef::viscosity>(
        "viscosity_coefficient",
        {.dimension = slew::Dimension::damping, .range = kNotNegative, .doc = "force per sliding speed"}),
    field<&FrictionLawDef::static_coefficient>(
        "static_friction_coefficient", {.range = kPositive, .doc = "at rest; at least the dynamic coefficient"}),
    field<&FrictionLawDef::dynamic_coefficient>("dynamic_friction_coefficient",
                                                {.range = kPositive, .doc = "while sliding fast"}),
    field<&FrictionLawDef::exponent>(
        "stribeck_exponent", {.range = kStribeckExponent, .doc = "shape of the fall from static to dynamic friction"}),
};

std::string interval(const Range& range, std::string_view unit) {
  const std::string tail = unit.empty() ? "" : fmt::format(" {}", unit);
  if (std::isinf(range.max)) return fmt::format("a number {} {}{}", range.min_is_open ? ">" : ">=", range.min, tail);
  return fmt::format("{} .. {}{}", range.min, range.max, tail);
}

void check_fields(std::string_view owner, std::span<const Field> fields, void* def, Problems& problems) {
  for (const Field& row : fields) {
    const double value = *static_cast<const double*>(row.member(def));
    if (std::isfinite(value) && row.range.contains(value)) continue;
    const std::string_view unit = info(row.dimension).si_unit;
    problems.push_back({fmt::format("{}.{}", owner, row.key),
                        fmt::format("{}{}{} is out of range", value, unit.empty() ? "" : " ", unit),
                        interval(row.range, unit),
                        {}});
  }
}

}  // namespace

std::span<const Field> normal_law_fields() noexcept {
  return kNormalLawFields;
}

std::span<const Field> friction_law_fields() noexcept {
  return kFrictionLawFields;
}

void check(std::string_view owner, const NormalLawDef& def, Problems& problems) {
  NormalLawDef copy = def;  // rows give the address of a member to write to
  check_fields(owner, kNormalLawFields, &copy, problems);
}

void check(std::string_view owner, const FrictionLawDef& def, Problems& problems) {
  FrictionLawDef copy = def;
  check_fields(owner, kFrictionLawFields, &copy, problems);
  if (def.static_coefficient < def.dynamic_coefficient) {
    problems.push_back(
        {fmt::format("{}.static_friction_coefficient", owner),
         fmt::format("{} is below the dynamic coefficient {}", def.static_coefficient, def.dynamic_coefficient),
         "static friction of at least the dynamic one",
         {}});
  }
}

}  // namespace slew::contact
