// SPDX-License-Identifier: Apache-2.0
// A convex shape against the triangles of a ground that does not move.
//
// A triangle is one side of a solid. It counts if the shape's middle is on its outer side and the overlap along its
// normal is smaller than over any of its edges where the ground ends or falls away: so the wall beside the face that
// carries a body does not push it sideways. Where two triangles give the same point, one stays.
#include <algorithm>
#include <array>
#include <cmath>

#include "contact/kernels.h"

namespace slew::contact {
namespace {

using math::Vec3;

// a triangle in the world
struct Corner3 {
  std::array<Vec3, 3> at;
  Vec3 normal;
};

Corner3 placed(const Solid& mesh, std::uint32_t triangle) noexcept {
  const Geometry& g = *mesh.geometry;
  Corner3 t;
  for (std::size_t k = 0; k < 3; ++k) t.at[k] = mesh.to_world(g.vertices[g.triangles[triangle][k]]);
  t.normal = mesh.R_WS * g.triangle_normals[triangle];
  return t;
}

// room for the points of one more triangle: an octagon clipped by three sides has eleven corners
void make_room(Manifold& out) noexcept {
  constexpr std::size_t kLargest = 2 * kMaxFaceVertices;
  if (out.size() + kLargest > Manifold::capacity()) reduce(out);
}

// removes points that two triangles share, equal to rounding
void drop_doubles(double size, Manifold& out) noexcept {
  constexpr double kSame = 1e-9;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::size_t k = 0;
    while (k < kept && !(norm(out[i].p_W - out[k].p_W) < kSame * size && dot(out[i].n_W, out[k].n_W) > 1 - kSame)) ++k;
    if (k < kept) {
      out[k].area += out[i].area;
    } else {
      out[kept++] = out[i];
    }
  }
  out.resize(kept);
}

template <typename Visit>
void visit_near(const Solid& a, const Solid& mesh, Visit visit) noexcept {
  Vec3 low, high;
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = mesh.R_WS.c[k];
    const double origin = dot(mesh.p_WS, axis);
    high.lanes[k] = reach(a, axis) - origin;
    low.lanes[k] = -reach(a, -axis) - origin;
  }
  mesh.geometry->tree.visit_box(low, high, visit);
}

// point of the triangle nearest to c, and whether it is inside and not on an edge (Ericson 2005, 5.1.5)
struct Nearest {
  Vec3 point;
  bool is_inside;
};

Nearest nearest_on(const Corner3& t, Vec3 c) noexcept {
  Nearest best{t.at[0], true};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 inward = cross(t.normal, t.at[(k + 1) % 3] - t.at[k]);
    if (dot(c - t.at[k], inward) < 0) best.is_inside = false;
  }
  if (best.is_inside) {
    best.point = c - t.normal * dot(c - t.at[0], t.normal);
    return best;
  }
  double least = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = t.at[(k + 1) % 3] - t.at[k];
    const double along = std::clamp(dot(c - t.at[k], edge) / dot(edge, edge), 0.0, 1.0);
    const Vec3 on = t.at[k] + edge * along;
    const double distance2 = dot(c - on, c - on);
    if (least < 0 || distance2 < least) {
      least = distance2;
      best.point = on;
    }
  }
  return best;
}

// True when no triangle that meets in the point q has a point nearer to c than q, at `distance`: else the sphere rests
// on that triangle, and q is only where this one ends.
bool is_nearest_around(const Solid& mesh, Vec3 q, Vec3 c, double distance) noexcept {
  constexpr double kSame = 1e-9;
  if (!(distance > 0)) return false;  // on the very edge: no direction
  const double same = kSame * (mesh.geometry->bounding_radius + distance);
  const Vec3 q_S = mesh.to_shape(q), around(same, same, same);
  bool is_nearest = true;
  mesh.geometry->tree.visit_box(q_S - around, q_S + around, [&](std::uint32_t triangle) {
    const Corner3 t = placed(mesh, triangle);
    if (norm(nearest_on(t, q).point - q) > same) return;
    if (norm(nearest_on(t, c).point - c) < distance - same) is_nearest = false;
  });
  return is_nearest;
}

}  // namespace

void sphere_on_triangles(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const double radius = a.geometry->radius;
  const Vec3 c = a.p_WS;
  visit_near(a, b, [&](std::uint32_t triangle) {
    const Corner3 t = placed(b, triangle);
    if (dot(c - t.at[0], t.normal) < 0) return;
    const Nearest nearest = nearest_on(t, c);
    const double distance = norm(c - nearest.point);
    if (distance >= radius || (!nearest.is_inside && !is_nearest_around(b, nearest.point, c, distance))) return;
    const Vec3 n = nearest.is_inside ? t.normal : (c - nearest.point) * (1 / distance);
    make_room(out);
    out.push_back({nearest.point - n * ((radius - distance) / 2), n, radius - distance});
  });
  drop_doubles(radius, out);
}

void convex_on_triangles(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const Vec3 middle = a.to_world(a.geometry->centre);
  visit_near(a, b, [&](std::uint32_t triangle) {
    const Corner3 t = placed(b, triangle);
    if (dot(middle - t.at[0], t.normal) < 0) return;
    const double depth = dot(t.at[0], t.normal) + reach(a, -t.normal);
    if (!(depth > 0)) return;
    Face face;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = t.at[(k + 1) % 3] - t.at[k];
      const Vec3 inward = cross(t.normal, edge) * (1 / norm(edge));
      const bool is_open_edge = (b.geometry->open_edges[triangle] >> k & 1U) != 0;
      if (is_open_edge && reach(a, inward) - dot(t.at[k], inward) < depth) return;
      face.vertices.push_back(t.at[k]);
    }
    face.normal = t.normal;
    make_room(out);
    clip_faces(supporting_face(a, -t.normal), face, t.normal, out);
  });
  drop_doubles(a.geometry->bounding_radius, out);
}

}  // namespace slew::contact
