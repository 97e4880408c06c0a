// SPDX-License-Identifier: Apache-2.0
// Checks of meshes and height fields: the fault in words, or none.
#pragma once

#include <optional>
#include <string>

#include "contact/contact_def.h"
#include "math/vector3.h"

namespace slew::contact {

// Corners of the box around a mesh that has vertices [m].
struct Extent {
  math::Vec3 low, high;
};
[[nodiscard]] Extent extent_of(const MeshDef& mesh);

struct MeshFault {
  std::string what;
  std::string expected;
};

// Triangles of existing, finite vertices.
[[nodiscard]] std::optional<MeshFault> find_number_fault(const MeshDef& mesh);

// An oriented surface, open or closed: finite vertices, triangles with an area, all turning the same way.
[[nodiscard]] std::optional<MeshFault> find_surface_fault(const MeshDef& mesh);

// A surface that bodies touch from its outer side: in addition, no closed part is inside out, unless it lies within
// another.
[[nodiscard]] std::optional<MeshFault> find_touched_fault(const MeshDef& mesh);

// A surface that encloses a volume: every edge has one triangle on either side, and normals point outwards.
[[nodiscard]] std::optional<MeshFault> find_closed_fault(const MeshDef& mesh);

// A surface that encloses a volume for mass properties, with weaker conditions than for contact: solids may touch at
// vertices, edges and faces, and triangles may have no area. Each edge must have equal numbers of triangles in both
// directions. A separate part may be a hole: turned inside out within another part. At most a thousandth of the volume
// may lie in two solids at once (mesh_overlap.h).
[[nodiscard]] std::optional<MeshFault> find_solid_fault(const MeshDef& mesh);

// A convex closed surface: it lies behind the planes of all its triangles.
[[nodiscard]] std::optional<MeshFault> find_convex_fault(const MeshDef& mesh);

[[nodiscard]] std::optional<MeshFault> find_field_fault(const HeightFieldDef& field);

}  // namespace slew::contact
