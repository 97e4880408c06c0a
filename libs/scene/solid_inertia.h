// SPDX-License-Identifier: Apache-2.0
// Common part of bodies whose inertia follows from a solid: `inertia: from_mesh`, `from_shape`, `from_parts`.
//
// The solid gives mass, center_of_mass, inertia and products, about the centre of mass. Sizes and masses that no
// machine has are refused, unlikely ones give a warning: a slip in a unit shows there.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contact/mass_properties.h"
#include "core/field.h"
#include "multibody/model/defs.h"
#include "scene/field_reader.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

inline constexpr std::string_view kInertiaKey = "inertia";
inline constexpr std::string_view kDensityKey = "density";
inline constexpr std::string_view kMassKey = "mass";
// keys of a body that the solid replaces
inline constexpr std::string_view kDerivedKeys[] = {"center_of_mass", "products", "inertia_about"};

// True if the element of the section `bodies` has inertia: word.
[[nodiscard]] bool has_inertia_word(const Node& body, std::string_view word);

// Fields of a body that the user still sets when its inertia comes from a solid.
[[nodiscard]] std::vector<Field> fields_beside_solid(std::span<const Field> body_fields);

// Reads a body's element by two tables: the keys of `own` into own_def, the others into the body. more_keys belong to
// the caller.
void read_beside_solid(const Node::Entry& element, std::span<const Field> body_fields, multibody::BodyDef& body,
                       std::span<const Field> own, void* own_def, std::span<const std::string_view> more_keys,
                       const ReadContext& context);

// Refuses the keys that follow from the solid. solid: "the mesh"; word: from_mesh.
void refuse_derived_keys(const Node::Entry& element, std::string_view solid, std::string_view word,
                         const ReadContext& context);

// Refuses both of density and mass in a map, and neither. path: of the map; place: where neither is reported.
void check_density_or_mass(const Node& map, const std::string& path, const Mark& place, std::string_view of_what,
                           const ReadContext& context);

enum class Plausibility : std::uint8_t { likely, unlikely, impossible };

// size: largest extent [m]; volume [m3]; density [kg/m3].
[[nodiscard]] Plausibility plausibility_of(double size, double volume, double density) noexcept;

// Writes centre, inertia and products of the solid, in body axes, into the body.
void put_inertia(math::Vec3 centre_B, const math::Mat3& I_B, multibody::BodyDef& body) noexcept;

}  // namespace slew::scene
