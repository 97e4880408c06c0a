// SPDX-License-Identifier: Apache-2.0
// Mass, centre of mass and inertia of a body from simple solids: `inertia: from_shape` and `inertia: from_parts`.
//
//   Pin:  {inertia: from_shape, shape: cylinder, radius: 40 mm, length: 0.3 m, axis: y, density: 7850 kg/m3}
//   Boom: {inertia: from_parts, density: 7850 kg/m3, parts: [
//           {shape: hollow_box, length: 4 m, width: 0.3 m, height: 0.4 m, wall: 8 mm},
//           {shape: cylinder, radius: 45 mm, length: 0.3 m, axis: y, position: [2 m, 0, 0], hole: true}]}
//
// The words are those of `shapes:` and, for plates and tubes, those of the sections of flexible bodies; the numbers
// come from contact/shape_properties.h. A shape's origin is at p_BS (position) in the body, its axes are turned by R_BS
// (orientation), and for shapes of revolution those turned so that their axis is the named one.
// Refused: density and mass together, neither; walls that leave no hollow; a hole where the parts have no material; a
// sum without mass; sizes and densities that no machine has. Parts that overlap count twice,
// with a warning.
#pragma once

#include <span>
#include <string_view>

#include "core/field.h"
#include "multibody/model/defs.h"
#include "scene/field_reader.h"
#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

inline constexpr std::string_view kFromShape = "from_shape", kFromParts = "from_parts";

// True if an element of the section `bodies` has inertia: from_shape or from_parts.
[[nodiscard]] bool takes_from_shapes(const Node& body);

// Reads such an element into the body, and the results into scene.solid_inertias. Problems go to the report.
void read_shape_body(const Node::Entry& element, std::span<const Field> body_fields, multibody::BodyDef& body,
                     Scene& scene, const ReadContext& context);

}  // namespace slew::scene
