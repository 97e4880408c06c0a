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

// An oriented surface, open or closed: finite vertices, triangles with an area, all turning the same way.
[[nodiscard]] std::optional<MeshFault> find_surface_fault(const MeshDef& mesh);

// A surface that encloses a volume: every edge has one triangle on either side, and outside is outside.
[[nodiscard]] std::optional<MeshFault> find_closed_fault(const MeshDef& mesh);

// A closed surface without dents, which is then inside of all its triangles.
[[nodiscard]] std::optional<MeshFault> find_convex_fault(const MeshDef& mesh);

[[nodiscard]] std::optional<MeshFault> find_field_fault(const HeightFieldDef& field);

}  // namespace slew::contact
