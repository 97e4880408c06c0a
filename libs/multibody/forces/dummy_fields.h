// SPDX-License-Identifier: Apache-2.0
// Field tables of dummy_defs.h. Internal to the library: field_tables.cpp puts them into the sections.
#pragma once

#include "multibody/forces/dummy_defs.h"
#include "multibody/forces/force_fields.h"

namespace slew::multibody {

inline constexpr Range kFrameIndex{.min = 1, .max = 2, .min_is_open = false, .max_is_open = false};

template <typename Def>
constexpr Field dummy_position(std::string_view doc) {
  return field<&Def::position>("position", {.dimension = Dimension::length, .doc = doc});
}
template <typename Def>
constexpr Field dummy_orientation() {
  return field<&Def::orientation>("orientation", {.dimension = Dimension::angle, .doc = "Euler rotations z, x', z''"});
}
template <typename Def>
constexpr Field dummy_center() {
  return field<&Def::center_of_mass>("center_of_mass",
                                     {.dimension = Dimension::length, .doc = "centre of mass, dummy's frame"});
}
template <typename Def>
constexpr Field dummy_inertia() {
  return field<&Def::inertia>("inertia", {.dimension = Dimension::inertia,
                                          .range = kNotNegative,
                                          .doc = "moments about the centre of mass, dummy's axes"});
}

inline constexpr Field kPartDummyFields[] = {
    field<&PartDummyDef::relative_to>("relative_to", {.reference = "body", .doc = "body that the pose refers to"}),
    required_body<&PartDummyDef::carried_by>("carried_by", "body that the mass is fixed to"),
    dummy_position<PartDummyDef>("origin of the dummy in relative_to's frame, at the start"),
    dummy_orientation<PartDummyDef>(),
    dummy_mass<&PartDummyDef::mass>("mass; 0 for graphics only"),
    dummy_center<PartDummyDef>(),
    dummy_inertia<PartDummyDef>(),
};

inline constexpr Field kConstraintDummyFields[] = {
    field<&ConstraintDummyDef::relative_to>(
        "relative_to", {.presence = Presence::required, .reference = "joint", .doc = "joint whose part has the mass"}),
    field<&ConstraintDummyDef::index>("index", {.range = kFrameIndex,
                                                .presence = Presence::required,
                                                .doc = "1: fixed to the joint's frame on body 1; 2: on body 2"}),
    dummy_position<ConstraintDummyDef>("origin of the dummy in the joint's frame"),
    dummy_orientation<ConstraintDummyDef>(),
    dummy_mass<&ConstraintDummyDef::mass>("mass; 0 for graphics only"),
    dummy_center<ConstraintDummyDef>(),
    dummy_inertia<ConstraintDummyDef>(),
};

}  // namespace slew::multibody
