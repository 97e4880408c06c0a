// SPDX-License-Identifier: Apache-2.0
// Surfaces of bodies as triangles, from meshes for the eye or from contact shapes.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "math/vector3.h"
#include "scene/scene.h"

namespace slew::analysis {

using Face = std::array<math::Vec3, 3>;  // m, in the body's frame; seen from outside anticlockwise

// Faces of a contact shape; none of a plane.
[[nodiscard]] std::vector<Face> faces_of(const multibody::ShapeDef& shape);

// Faces of a mesh for the eye. Appends a sentence and returns none if its file cannot be read. folder: of the scene.
[[nodiscard]] std::vector<Face> faces_of(const scene::GraphicDef& graphic, const std::string& folder,
                                         std::vector<std::string>& left_out);

}  // namespace slew::analysis
