// SPDX-License-Identifier: Apache-2.0
// Overlap of two convex shapes of any kind: the shortest separating displacement, by an expanding polytope.
//
// All differences of their points, D = {b - a}, make a convex shape that holds the origin when they overlap. Along a
// unit vector n the two overlap by
//   h(n) = max of x . n over D = reach(b, n) + reach(a, -n)                                            (1)
// and the depth is the least h, its n the normal from B to A.
//   1. A tetrahedron of D that holds the origin, or a plane that parts the shapes: from a point within D, the ray to
//   the
//      origin leaves D through a triangle, which is moved outwards until it is on one side of the origin (Snethen
//      2008).
//   2. The tetrahedron grows by the point of D that is farthest along the normal of the face nearest to the origin,
//   until
//      that face is on the border of D within kSettled of the shapes' size (van den Bergen 2001).
// Every tried direction separates the shapes, so the result after kMostPoints separates them too, but is not the
// shortest: has_settled is then false. Polyhedra end after a few points; curved shapes gain a factor of four with about
// three points.
//
// Deviations: points are those of step 1, which need not be on the border; faces whose plane holds the new point are
// replaced together with the visible ones, so that every face has an area.
// Real-time safe: no allocation, at most kMostRounds + kMostPoints searches for a farthest point.
#pragma once

#include "contact/solid.h"

namespace slew::contact {

struct Overlap {
  bool is_found = false;    // the shapes overlap
  bool has_settled = true;  // the depth is the least one
  math::Vec3 n_W;           // unit, from B to A
  double depth = 0;         // m, > 0
  math::Vec3 p_W;           // m, half way between the deepest points
};

// Pre-condition: convex shapes, no planes and no surfaces of triangles.
[[nodiscard]] Overlap find_overlap(const Solid& a, const Solid& b) noexcept;

// (1) [m]: displacement of A along n_W (unit) that separates it from B; not positive if they are apart along it.
[[nodiscard]] double overlap_along(const Solid& a, const Solid& b, math::Vec3 n_W) noexcept;

}  // namespace slew::contact
