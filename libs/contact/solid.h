// SPDX-License-Identifier: Apache-2.0
// A shape placed in the world, and the geometric queries of the kernels.
#pragma once

#include <vector>

#include "contact/contact_def.h"
#include "contact/manifold.h"
#include "contact/triangle_tree.h"
#include "math/vector3.h"

namespace slew::contact {

// Immutable geometry of one shape, in its own axes.
struct Geometry {
  ShapeType type = ShapeType::sphere;
  double radius = 0;                 // m: sphere, cylinder, capsule
  double half_length = 0;            // m: cylinder, capsule (to the centre of an end)
  math::Vec3 half_size;              // m: box; meshes and height fields: half size of the box around them about
                                     // `centre`
  double bounding_radius = 0;        // m about `centre`; infinite for a plane
  math::Vec3 centre;                 // m
  math::Vec3 inside;                 // m: a point within a convex shape
  std::vector<math::Vec3> vertices;  // m: convex mesh, triangle mesh, height field
  std::vector<Triangle> triangles;

  // faces of a convex mesh, coplanar triangles as one: loops of vertices one after the other
  struct FlatFace {
    math::Vec3 normal;
    std::size_t first = 0, count = 0;  // in face_vertices
  };
  std::vector<FlatFace> faces;
  std::vector<std::uint32_t> face_vertices;

  // triangle mesh, height field
  std::vector<math::Vec3> triangle_normals;
  std::vector<std::uint8_t> open_edges;  // by triangle, bit k: the ground ends or falls away sharply over the edge from
                                         // corner k to the next
  TriangleTree tree;
};

// Pre-condition: validate() found nothing.
[[nodiscard]] Geometry make_geometry(const ShapeDef& def);

// Radius of a ball inside the shape about its middle [m]; infinite for a plane, 0 for surfaces of triangles.
[[nodiscard]] double inner_radius(const Geometry& geometry) noexcept;

// A shape in the world.
struct Solid {
  const Geometry* geometry = nullptr;
  math::Vec3 p_WS;  // m
  math::Mat3 R_WS;

  [[nodiscard]] math::Vec3 to_world(math::Vec3 p_S) const noexcept { return p_WS + R_WS * p_S; }
  [[nodiscard]] math::Vec3 to_shape(math::Vec3 p_W) const noexcept { return transpose_multiply(R_WS, p_W - p_WS); }
};

// The largest p_W . d_W of all points of a convex shape [m]; d_W is a unit vector.
[[nodiscard]] double reach(const Solid& solid, math::Vec3 d_W) noexcept;

// The point of a convex shape farthest along d_S [m], shape's axes; the first of several at equal distance. d_S may
// have any length.
[[nodiscard]] math::Vec3 farthest_point(const Geometry& geometry, math::Vec3 d_S) noexcept;

// The face, edge or vertex of a convex shape that faces d_W (unit) most squarely. None for triangle meshes and planes.
[[nodiscard]] Face supporting_face(const Solid& solid, math::Vec3 d_W) noexcept;

}  // namespace slew::contact
