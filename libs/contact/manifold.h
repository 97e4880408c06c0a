// SPDX-License-Identifier: Apache-2.0
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

// area represented by a point without a face: a square of 1 mm; by an edge: a strip of 1 mm
inline constexpr double kSpot = 1e-6;   // m^2
inline constexpr double kStrip = 1e-3;  // m

struct ManifoldPoint {
  math::Vec3 p_W;       // m
  math::Vec3 n_W;       // unit, from B to A
  double depth = 0;     // m, > 0
  double area = kSpot;  // m^2 > 0, part of the touching faces that the point represents
};

// The points found for one pair, before they are cut down to kMaxPointsPerPair.
using Manifold = StaticVector<ManifoldPoint, 64>;

// Flat convex face or part of one: a polygon (3 and more vertices in order), an edge (2) or a vertex (1).
struct Face {
  StaticVector<math::Vec3, kMaxFaceVertices> vertices;  // m, world axes
  math::Vec3 normal;                                    // outward unit normal of a polygon, world axes
};

// Appends the points of A's and B's faces that overlap along n_W. The flatter face against n_W clips the other one.
// No point is appended if no face is at right angles to n_W, or if the common face is empty: the caller then has its
// single point. A corner of the common face represents half of the triangles that its two edges form with the face's
// centroid, so that a corner doubled by rounding keeps its total area.
void clip_faces(const Face& a, const Face& b, math::Vec3 n_W, Manifold& out) noexcept;

// Reduces the points to kMaxPointsPerPair: the deepest, then always the one farthest from the kept points. Order kept.
// The area of a dropped point goes to the nearest kept point.
void reduce(Manifold& points) noexcept;

}  // namespace slew::contact
