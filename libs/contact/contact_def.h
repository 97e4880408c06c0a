// SPDX-License-Identifier: Apache-2.0
// Contact definition: shapes in frames, and the pairs of shapes that are tested. Only declared pairs are tested.
//
// A frame is a body or Ground; this library uses its pose only. A shape has a pose in its frame. Its own axes: sphere
// and box about the origin; cylinder and capsule about the origin along z; a plane is the half space z <= 0; a height
// field spans x and y from the origin, heights along z, solid below; meshes by their vertices.
// Planes, height fields and triangle meshes in pairs belong to frames that do not move.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "contact/friction_law.h"
#include "contact/normal_law.h"
#include "core/field.h"

namespace slew::contact {

struct FrameDef {
  std::string name{};
  bool is_static = false;
};

enum class ShapeType : int { sphere, box, cylinder, capsule, plane, height_field, convex_mesh, triangle_mesh };

// Triangles turn counter-clockwise seen from outside.
struct MeshDef {
  std::vector<Triple> vertices;                         // m, shape's axes
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices of vertices
};

struct HeightFieldDef {
  std::size_t columns = 0;      // along x, >= 2
  std::size_t rows = 0;         // along y, >= 2
  double spacing_x = 1;         // m, > 0
  double spacing_y = 1;         // m, > 0
  std::vector<double> heights;  // m, row by row: heights[row * columns + column]
};

// One struct for every shape; each type uses the members that its comment names.
struct ShapeDef {
  std::string name{};
  std::string frame{};
  ShapeType type = ShapeType::sphere;
  Triple position{};              // m, in the frame
  Triple orientation{};           // rad, successive rotations z, x', z''
  double radius = 0;              // m, > 0: sphere, cylinder, capsule
  double length = 0;              // m, > 0: cylinder; capsule between the centres of its ends
  Triple size{};                  // m, > 0: edges of a box
  MeshDef mesh{};                 // convex mesh (closed), triangle mesh
  HeightFieldDef height_field{};  // height field
};

// A pair as in table 11.
struct PairDef {
  std::string name{};
  std::string shape_a{}, shape_b{};
  NormalLawDef normal{};
  std::optional<FrictionLawDef> friction{};  // none: frictionless
};

struct ContactDef {
  std::vector<FrameDef> frames;
  std::vector<ShapeDef> shapes;
  std::vector<PairDef> pairs;
};

// Appends all problems: names, sizes, laws, meshes (empty, not finite, index out of range; a convex mesh that is not
// closed, not convex or inside out; a triangle mesh that turns differently in parts), shapes that must not move in
// frames that do, pairs without a moving shape or without a kernel. A sound Def gives no problems. Paths are
// "Element.key".
void validate(const ContactDef& def, Problems& problems);

}  // namespace slew::contact
