// Contact points of two faces: the face of one shape clipped by the face of the other.
//
// n_W is the contact normal, from B to A; depth is counted along it, positive where the shapes overlap; a point lies
// half way between both surfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/static_vector.h"
#include "math/vector3.h"

namespace slew::contact {

inline constexpr std::size_t kMaxPointsPerPair = 8;
inline constexpr std::size_t kMaxFaceVertices = 16;

struct ManifoldPoint {
  math::Vec3 p_W;    // m
  math::Vec3 n_W;    // unit, from B to A
  double depth = 0;  // m, > 0
};

// The points found for one pair, before they are cut down to kMaxPointsPerPair.
using Manifold = StaticVector<ManifoldPoint, 64>;

// Flat convex face or part of one: a polygon (3 and more vertices in order), an edge (2) or a vertex (1).
struct Face {
  StaticVector<math::Vec3, kMaxFaceVertices> vertices;  // m, world axes
  math::Vec3 normal;                                    // outward unit normal of a polygon, world axes
};

// Appends the points of A's and B's faces that overlap along n_W. The flatter face against n_W clips the other one.
// Nothing is appended when no face is at right angles to n_W, or when nothing is left: the caller then has its single
// point.
void clip_faces(const Face& a, const Face& b, math::Vec3 n_W, Manifold& out) noexcept;

// Cuts the points down to kMaxPointsPerPair: the deepest, then always the one farthest from those kept. Order kept.
void reduce(Manifold& points) noexcept;

}  // namespace slew::contact
