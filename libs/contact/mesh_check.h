// What is wrong with a mesh or a height field, in words; nothing when it is sound.
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

// Triangles of vertices that are there and finite.
[[nodiscard]] std::optional<MeshFault> find_number_fault(const MeshDef& mesh);

// An oriented surface, open or closed: finite vertices, triangles with an area, all turning the same way.
[[nodiscard]] std::optional<MeshFault> find_surface_fault(const MeshDef& mesh);

// A surface that encloses a volume: every edge has one triangle on either side, and outside is outside.
[[nodiscard]] std::optional<MeshFault> find_closed_fault(const MeshDef& mesh);

// What encloses a volume for mass properties, which ask for less than contact does: solids may touch at vertices, edges
// and faces, triangles may have no area, as long as each edge has as many triangles one way as the other. Parts that do
// not hang together may be holes: turned inside out within another part.
[[nodiscard]] std::optional<MeshFault> find_solid_fault(const MeshDef& mesh);

// A closed surface without dents, which is then inside of all its triangles.
[[nodiscard]] std::optional<MeshFault> find_convex_fault(const MeshDef& mesh);

[[nodiscard]] std::optional<MeshFault> find_field_fault(const HeightFieldDef& field);

}  // namespace slew::contact
