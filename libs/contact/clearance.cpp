// SPDX-License-Identifier: Apache-2.0
// Lower bound of the distance of two shapes, and whether they can have met since.
//
// Convex shapes are apart by at least the gap between them along any direction; the directions tried are the line of
// their middles and the axes of boxes, meshes and planes. Surfaces of triangles count as the box around them. A point
// of a shape that lies up to r from its frame's origin moves by
//   |p - p_0| + |R - R_0| r                                                                          (1)
// at most, with the Frobenius norm.
#include <algorithm>
#include <cmath>

#include "contact/contact_model.h"

namespace slew::contact {

using math::Mat3;
using math::Vec3;

namespace {

bool is_surface(const Geometry& g) noexcept {
  return g.type == ShapeType::triangle_mesh || g.type == ShapeType::height_field;
}

bool has_axes(const Geometry& g) noexcept {
  return g.type == ShapeType::box || g.type == ShapeType::convex_mesh || is_surface(g);
}

// how far a shape, or the box around a surface, reaches along n [m]
double extent_along(const Solid& s, Vec3 n) noexcept {
  if (!is_surface(*s.geometry)) return reach(s, n);
  const Vec3 d = transpose_multiply(s.R_WS, n), h = s.geometry->half_size;
  return dot(s.to_world(s.geometry->centre), n) + h[0] * std::fabs(d[0]) + h[1] * std::fabs(d[1]) +
         h[2] * std::fabs(d[2]);
}

// gap along n, which points from b to a; negative: the shapes overlap there
double gap_along(const Solid& a, const Solid& b, Vec3 n) noexcept {
  const double top_of_b = b.geometry->type == ShapeType::plane ? dot(b.p_WS, n) : extent_along(b, n);
  return -extent_along(a, -n) - top_of_b;
}

// the largest gap along the tried directions
double gap_between(const Solid& a, const Solid& b) noexcept {
  if (b.geometry->type == ShapeType::plane) return gap_along(a, b, b.R_WS.c[2]);
  if (a.geometry->type == ShapeType::plane) return gap_along(b, a, a.R_WS.c[2]);
  const Vec3 apart = a.to_world(a.geometry->centre) - b.to_world(b.geometry->centre);
  const double distance = norm(apart);
  const double of_balls = distance - a.geometry->bounding_radius - b.geometry->bounding_radius;
  if (!(distance > 0)) return of_balls;
  double largest = std::max(of_balls, gap_along(a, b, apart * (1 / distance)));
  for (const Solid* solid : {&a, &b}) {
    if (!has_axes(*solid->geometry)) continue;
    for (const Vec3& axis : solid->R_WS.c) {
      largest = std::max(largest, gap_along(a, b, dot(axis, apart) < 0 ? -axis : axis));
    }
  }
  return largest;
}

double difference(const Mat3& a, const Mat3& b) noexcept {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 column = a.c[k] - b.c[k];
    sum += dot(column, column);
  }
  return std::sqrt(sum);
}

// (1)
double largest_motion(const Pose& from, const Pose& to, double extent) noexcept {
  const double turn = difference(from.R_WF, to.R_WF);
  return norm(to.p_WF - from.p_WF) + (turn > 0 ? turn * extent : 0.0);
}

}  // namespace

bool ContactModel::is_clear(std::size_t pair, const Pose& frame_a, const Pose& frame_b,
                            const ContactSet& set) const noexcept {
  constexpr double kRounding = 0.999;  // share of the distance: sums of (1) and poses are rounded
  const ContactSet::Clearance& known = set.clearances_[pair];
  if (!(known.distance > 0)) return false;
  const double moved = largest_motion(known.frame_a, frame_a, shapes_[pairs_[pair].shape_a].extent) +
                       largest_motion(known.frame_b, frame_b, shapes_[pairs_[pair].shape_b].extent);
  return moved < kRounding * known.distance;
}

void ContactModel::note_clearance(std::size_t pair, const Pose& frame_a, const Pose& frame_b,
                                  ContactSet& set) const noexcept {
  const Shape &shape_a = shapes_[pairs_[pair].shape_a], &shape_b = shapes_[pairs_[pair].shape_b];
  const double gap = gap_between(place(shape_a, frame_a), place(shape_b, frame_b));
  set.clearances_[pair] = {frame_a, frame_b, gap};
}

}  // namespace slew::contact
