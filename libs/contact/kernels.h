// SPDX-License-Identifier: Apache-2.0
// Contacts of two shapes without open-ended iteration. Every kernel appends the points of A against B with the normal
// from B to A, and nothing when the shapes do not overlap. Real-time safe; cost bounded by the vertices of the shapes.
//
// Where the centre of a sphere is at the very centre line of the other, the normal is along an axis of that shape.
#pragma once

#include "contact/manifold.h"
#include "contact/solid.h"

namespace slew::contact {

using Kernel = void (*)(const Solid& a, const Solid& b, Manifold& out) noexcept;

// The kernel of a pair of types in this order, or null: then the reversed order has one, except for pairs without a
// moving shape.
[[nodiscard]] Kernel find_kernel(ShapeType a, ShapeType b) noexcept;

void sphere_sphere(const Solid& a, const Solid& b, Manifold& out) noexcept;
void sphere_capsule(const Solid& a, const Solid& b, Manifold& out) noexcept;
// one point; two at the ends of the overlap when the lines are parallel
void capsule_capsule(const Solid& a, const Solid& b, Manifold& out) noexcept;
// one point; two along a face; deep inside, from the middle of the part within the box
void capsule_box(const Solid& a, const Solid& b, Manifold& out) noexcept;
// a ball about centre_W [m] with the radius [m], part of any shape
void ball_box(math::Vec3 centre_W, double radius, const Solid& b, Manifold& out) noexcept;
void sphere_box(const Solid& a, const Solid& b, Manifold& out) noexcept;
void sphere_plane(const Solid& a, const Solid& b, Manifold& out) noexcept;
// two points when both ends are below
void capsule_plane(const Solid& a, const Solid& b, Manifold& out) noexcept;
// every corner below, eight at most
void box_plane(const Solid& a, const Solid& b, Manifold& out) noexcept;
// the lowest rim point of each end; for the lower end also the opposite point and the two between
void cylinder_plane(const Solid& a, const Solid& b, Manifold& out) noexcept;
void convex_mesh_plane(const Solid& a, const Solid& b, Manifold& out) noexcept;
// 15 separating axes; face against face gives up to eight points, edge against edge one (Gottschalk, Lin and Manocha
// 1996 for the axes)
void box_box(const Solid& a, const Solid& b, Manifold& out) noexcept;
// nearest point of the surface; a centre inside leaves through the nearest face, cap or side
void sphere_cylinder(const Solid& a, const Solid& b, Manifold& out) noexcept;
void sphere_convex_mesh(const Solid& a, const Solid& b, Manifold& out) noexcept;
// any two of box, cylinder, capsule, convex mesh: least overlap (overlap.h), facing faces clipped
void convex_convex(const Solid& a, const Solid& b, Manifold& out) noexcept;

// B is a triangle mesh or a height field. Sphere: the points of the ground at a local minimum of distance.
void sphere_on_triangles(const Solid& a, const Solid& b, Manifold& out) noexcept;
// Other convex shapes: the face that faces a triangle, clipped by it. An edge of the shape that lies on an edge of the
// mesh touches through the faces beside it only.
void convex_on_triangles(const Solid& a, const Solid& b, Manifold& out) noexcept;

}  // namespace slew::contact
