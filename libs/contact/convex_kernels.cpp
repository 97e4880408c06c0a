// SPDX-License-Identifier: Apache-2.0
// Convex shapes without a closed form: spheres against cylinders and convex meshes by the nearest point of their
// surface, all others by their overlap (overlap.h) and the faces that meet there.
#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/kernels.h"
#include "contact/overlap.h"

namespace slew::contact {
namespace {

using math::Vec3;

// A point of B's surface, shape's axes, and the position of a ball's centre relative to it.
struct Foot {
  Vec3 on, outward;
  double distance = 0;  // m, distance of the centre along `outward`; negative inside
};

void add_ball(const Solid& ball, const Solid& b, const Foot& foot, Manifold& out) noexcept {
  const double depth = ball.geometry->radius - foot.distance;
  if (!(depth > 0)) return;
  // half way between the surface and the ball's lowest point
  out.push_back({b.to_world(foot.on - foot.outward * (depth / 2)), b.R_WS * foot.outward, depth});
}

Foot foot_of(Vec3 centre, Vec3 nearest) noexcept {
  const Vec3 apart = centre - nearest;
  const double distance = norm(apart);
  return {nearest, apart * (1 / distance), distance};
}

// point of a flat face's border nearest to p
Vec3 nearest_of_border(const Geometry& g, const Geometry::FlatFace& face, Vec3 p) noexcept {
  Vec3 best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < face.count; ++i) {
    const Vec3 from = g.vertices[g.face_vertices[face.first + i]];
    const Vec3 edge = g.vertices[g.face_vertices[face.first + (i + 1) % face.count]] - from;
    const Vec3 on = from + edge * std::clamp(dot(p - from, edge) / dot(edge, edge), 0.0, 1.0);
    const double distance2 = dot(p - on, p - on);
    if (distance2 >= least) continue;
    least = distance2;
    best = on;
  }
  return best;
}

bool is_above(const Geometry& g, const Geometry::FlatFace& face, Vec3 p) noexcept {
  for (std::size_t i = 0; i < face.count; ++i) {
    const Vec3 from = g.vertices[g.face_vertices[face.first + i]];
    const Vec3 to = g.vertices[g.face_vertices[face.first + (i + 1) % face.count]];
    if (dot(p - from, cross(face.normal, to - from)) < 0) return false;
  }
  return true;
}

// the normal of the shape's face that points along d_W; d_W itself if there is none
Vec3 face_normal(const Solid& solid, Vec3 d_W) noexcept {
  const Face face = supporting_face(solid, d_W);
  return face.vertices.size() >= 3 ? face.normal : d_W;
}

// A face carries more points than an edge, so it is taken if the overlap along its normal is hardly larger.
void prefer_faces(const Solid& a, const Solid& b, Overlap& overlap) noexcept {
  constexpr double kFacePreference = 0.95;
  double least = overlap.depth / kFacePreference;
  const Vec3 of_b = face_normal(b, overlap.n_W), of_a = -face_normal(a, -overlap.n_W);
  for (const Vec3& n_W : {of_b, of_a}) {
    const double depth = overlap_along(a, b, n_W);
    if (depth >= least) continue;
    least = depth * (1 - 1e-9);  // take B's of two equal overlaps
    overlap.n_W = n_W;
    overlap.depth = depth;
  }
}

// two lines side by side: the ends of the part that they share
void clip_lines(const Face& a, const Face& b, Vec3 n_W, Manifold& out) noexcept {
  constexpr double kParallelSine2 = 1e-6;
  if (a.vertices.size() != 2 || b.vertices.size() != 2) return;
  const Vec3 along_a = a.vertices[1] - a.vertices[0], along_b = b.vertices[1] - b.vertices[0];
  const double length_a = norm(along_a), length_b = norm(along_b);
  const Vec3 u = along_a * (1 / length_a), w = along_b * (1 / length_b);
  const Vec3 sine = cross(u, w);
  if (dot(sine, sine) > kParallelSine2) return;
  const double first = dot(b.vertices[0] - a.vertices[0], u), last = dot(b.vertices[1] - a.vertices[0], u);
  const double low = std::max(0.0, std::min(first, last)), high = std::min(length_a, std::max(first, last));
  if (low >= high) return;
  for (const double s : {low, high}) {
    const Vec3 on_a = a.vertices[0] + u * s;
    const Vec3 on_b = b.vertices[0] + w * std::clamp(dot(on_a - b.vertices[0], w), 0.0, length_b);
    const double depth = dot(on_b - on_a, n_W);
    if (depth > 0) out.push_back({(on_a + on_b) * 0.5, n_W, depth});
  }
}

}  // namespace

void sphere_cylinder(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const Geometry& g = *b.geometry;
  const Vec3 c = b.to_shape(a.p_WS);
  const double across = std::hypot(c.x(), c.y());
  const Vec3 radial = across > 0 ? Vec3(c.x() / across, c.y() / across, 0) : Vec3(1, 0, 0);
  const double side = c.z() < 0 ? -1.0 : 1.0;
  const double beyond_side = across - g.radius, beyond_end = std::fabs(c.z()) - g.half_length;
  if (beyond_side > 0 && beyond_end > 0) {
    add_ball(a, b, foot_of(c, radial * g.radius + Vec3(0, 0, side * g.half_length)), out);
  } else if (beyond_side > beyond_end) {
    add_ball(a, b, {radial * g.radius + Vec3(0, 0, c.z()), radial, beyond_side}, out);
  } else {
    add_ball(a, b, {{c.x(), c.y(), side * g.half_length}, {0, 0, side}, beyond_end}, out);
  }
}

void sphere_convex_mesh(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const Geometry& g = *b.geometry;
  const Vec3 c = b.to_shape(a.p_WS);
  const auto height_over = [&](const Geometry::FlatFace& face) {
    return dot(c - g.vertices[g.face_vertices[face.first]], face.normal);
  };
  const Geometry::FlatFace* highest = &g.faces[0];
  for (const Geometry::FlatFace& face : g.faces) {
    if (height_over(face) > height_over(*highest)) highest = &face;
  }
  const double height = height_over(*highest);
  if (height >= a.geometry->radius) return;
  if (height <= 0 || is_above(g, *highest, c)) {
    add_ball(a, b, {c - highest->normal * height, highest->normal, height}, out);
    return;
  }
  // over an edge or a corner of faces that point towards the centre
  Vec3 nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const Geometry::FlatFace& face : g.faces) {
    const double over = height_over(face);
    if (over < 0) continue;
    const Vec3 on = is_above(g, face, c) ? c - face.normal * over : nearest_of_border(g, face, c);
    if (norm(c - on) >= least) continue;
    least = norm(c - on);
    nearest = on;
  }
  add_ball(a, b, foot_of(c, nearest), out);
}

void convex_convex(const Solid& a, const Solid& b, Manifold& out) noexcept {
  Overlap overlap = find_overlap(a, b);
  if (!overlap.is_found) return;
  prefer_faces(a, b, overlap);
  const Face of_a = supporting_face(a, -overlap.n_W), of_b = supporting_face(b, overlap.n_W);
  clip_faces(of_a, of_b, overlap.n_W, out);
  clip_lines(of_a, of_b, overlap.n_W, out);
  // the faces may miss the deepest point (edge on edge, a rounded end, a rim between its representative corners)
  constexpr double kRounding = 1e-6;
  const bool is_met = std::any_of(out.begin(), out.end(), [&](const ManifoldPoint& point) {
    return point.depth > (1 - kRounding) * overlap.depth;
  });
  if (!is_met) out.push_back({overlap.p_W, overlap.n_W, overlap.depth});
}

}  // namespace slew::contact
