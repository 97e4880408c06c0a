// SPDX-License-Identifier: Apache-2.0
#include "contact/kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace slew::contact {
namespace {

using math::Vec3;

// overlap of a point of A, a ball of `radius` about `centre`, with a ball about `other`
void add_balls(Vec3 centre, double radius, Vec3 other, double other_radius, Vec3 fallback, Manifold& out) noexcept {
  const Vec3 apart = centre - other;
  const double distance = norm(apart);
  const double depth = radius + other_radius - distance;
  if (!(depth > 0)) return;
  const Vec3 n = distance > 0 ? apart * (1 / distance) : fallback;
  out.push_back({other + n * (other_radius - depth / 2), n, depth});
}

// a point of A's surface below the plane of B
void add_below(Vec3 p_W, const Solid& plane, Manifold& out) noexcept {
  const Vec3 n = plane.R_WS.c[2];
  const double depth = dot(plane.p_WS - p_W, n);
  if (depth > 0 && out.size() < Manifold::capacity()) out.push_back({p_W + n * (depth / 2), n, depth});
}

}  // namespace

void sphere_sphere(const Solid& a, const Solid& b, Manifold& out) noexcept {
  add_balls(a.p_WS, a.geometry->radius, b.p_WS, b.geometry->radius, b.R_WS.c[2], out);
}

void sphere_capsule(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const double half = b.geometry->half_length;
  const double along = std::clamp(dot(a.p_WS - b.p_WS, b.R_WS.c[2]), -half, half);
  const Vec3 nearest = b.p_WS + b.R_WS.c[2] * along;
  add_balls(a.p_WS, a.geometry->radius, nearest, b.geometry->radius, b.R_WS.c[0], out);
}

void capsule_capsule(const Solid& a, const Solid& b, Manifold& out) noexcept {
  // below this angle the lines count as parallel and touch along their overlap
  constexpr double kParallelSine2 = 1e-6;
  const Vec3 u = a.R_WS.c[2], w = b.R_WS.c[2];
  const double half_a = a.geometry->half_length, half_b = b.geometry->half_length;
  const double radius_a = a.geometry->radius, radius_b = b.geometry->radius;
  const Vec3 r = b.p_WS - a.p_WS;
  const double uw = dot(u, w), ru = dot(r, u), rw = dot(r, w);
  const double sine2 = 1 - uw * uw;
  const auto along_b = [&](double s) { return std::clamp(s * uw - rw, -half_b, half_b); };
  const auto add_at = [&](double s, double t, Vec3 fallback) {
    add_balls(a.p_WS + u * s, radius_a, b.p_WS + w * t, radius_b, fallback, out);
  };
  if (sine2 < kParallelSine2) {
    const double low = std::max(-half_a, ru - half_b), high = std::min(half_a, ru + half_b);
    if (low < high) {
      add_at(low, along_b(low), b.R_WS.c[0]);
      add_at(high, along_b(high), b.R_WS.c[0]);
      return;
    }
  }
  // nearest points of the segments: on the lines, then cut to one segment after the other
  double s =
      sine2 < kParallelSine2 ? std::clamp(ru, -half_a, half_a) : std::clamp((ru - uw * rw) / sine2, -half_a, half_a);
  const double t = along_b(s);
  s = std::clamp(ru + t * uw, -half_a, half_a);
  // lines that cross: out along their common normal
  const Vec3 across = cross(u, w);
  add_at(s, t, sine2 < kParallelSine2 ? b.R_WS.c[0] : across * (1 / norm(across)));
}

void ball_box(Vec3 centre_W, double radius, const Solid& b, Manifold& out) noexcept {
  const Vec3 c = b.to_shape(centre_W);
  const Vec3 h = b.geometry->half_size;
  Vec3 nearest;
  for (int k = 0; k < 3; ++k) nearest.lanes[k] = std::clamp(c[k], -h[k], h[k]);
  const Vec3 apart = c - nearest;
  const double distance = norm(apart);
  if (distance > 0) {
    const double depth = radius - distance;
    if (!(depth > 0)) return;
    const Vec3 n = apart * (1 / distance);
    out.push_back({b.to_world(nearest - n * (depth / 2)), b.R_WS * n, depth});
    return;
  }
  // the centre is inside: out through the nearest face
  int axis = 0;
  for (int k = 1; k < 3; ++k) {
    if (h[k] - std::fabs(c[k]) < h[axis] - std::fabs(c[axis])) axis = k;
  }
  const double side = c[axis] < 0 ? -1.0 : 1.0;
  const double depth = h[axis] - std::fabs(c[axis]) + radius;
  const Vec3 n = b.R_WS.c[axis] * side;
  out.push_back({centre_W + n * (depth / 2 - radius), n, depth});
}

void sphere_box(const Solid& a, const Solid& b, Manifold& out) noexcept {
  ball_box(a.p_WS, a.geometry->radius, b, out);
}

void sphere_plane(const Solid& a, const Solid& b, Manifold& out) noexcept {
  add_below(a.p_WS - b.R_WS.c[2] * a.geometry->radius, b, out);
}

void capsule_plane(const Solid& a, const Solid& b, Manifold& out) noexcept {
  for (const double end : {-a.geometry->half_length, a.geometry->half_length}) {
    add_below(a.to_world({0, 0, end}) - b.R_WS.c[2] * a.geometry->radius, b, out);
  }
}

void box_plane(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const Vec3 h = a.geometry->half_size;
  for (int i = 0; i < 8; ++i) {
    add_below(a.to_world({(i & 1) != 0 ? h.x() : -h.x(), (i & 2) != 0 ? h.y() : -h.y(), (i & 4) != 0 ? h.z() : -h.z()}),
              b, out);
  }
}

void cylinder_plane(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const Geometry& g = *a.geometry;
  const Vec3 up = transpose_multiply(a.R_WS, b.R_WS.c[2]);
  const double across = std::hypot(up.x(), up.y());
  // upright within rounding: any direction is the lowest
  constexpr double kUpright = 1e-12;
  const double x = across > kUpright ? -up.x() / across * g.radius : g.radius;
  const double y = across > kUpright ? -up.y() / across * g.radius : 0;
  const double low = up.z() > 0 ? -g.half_length : g.half_length;
  add_below(a.to_world({x, y, low}), b, out);
  add_below(a.to_world({-y, x, low}), b, out);
  add_below(a.to_world({-x, -y, low}), b, out);
  add_below(a.to_world({y, -x, low}), b, out);
  add_below(a.to_world({x, y, -low}), b, out);
}

void convex_mesh_plane(const Solid& a, const Solid& b, Manifold& out) noexcept {
  // more vertices than the manifold holds: reduce meanwhile; the deepest and the widest points stay
  for (const Vec3& vertex : a.geometry->vertices) {
    if (out.size() == Manifold::capacity()) reduce(out);
    add_below(a.to_world(vertex), b, out);
  }
}

Kernel find_kernel(ShapeType a, ShapeType b) noexcept {
  using enum ShapeType;
  struct Row {
    ShapeType a, b;
    Kernel kernel;
  };
  static constexpr std::array kRows = {Row{sphere, sphere, sphere_sphere},
                                       Row{sphere, capsule, sphere_capsule},
                                       Row{sphere, box, sphere_box},
                                       Row{sphere, plane, sphere_plane},
                                       Row{capsule, plane, capsule_plane},
                                       Row{box, plane, box_plane},
                                       Row{cylinder, plane, cylinder_plane},
                                       Row{convex_mesh, plane, convex_mesh_plane},
                                       Row{box, box, box_box},
                                       Row{capsule, capsule, capsule_capsule},
                                       Row{capsule, box, capsule_box},
                                       Row{sphere, cylinder, sphere_cylinder},
                                       Row{sphere, convex_mesh, sphere_convex_mesh},
                                       Row{cylinder, box, convex_convex},
                                       Row{cylinder, cylinder, convex_convex},
                                       Row{cylinder, capsule, convex_convex},
                                       Row{convex_mesh, box, convex_convex},
                                       Row{convex_mesh, cylinder, convex_convex},
                                       Row{convex_mesh, capsule, convex_convex},
                                       Row{convex_mesh, convex_mesh, convex_convex}};
  if (b == triangle_mesh || b == height_field) {
    const bool is_ground = a == plane || a == triangle_mesh || a == height_field;
    return is_ground ? nullptr : a == sphere ? sphere_on_triangles : convex_on_triangles;
  }
  for (const Row& row : kRows) {
    if (row.a == a && row.b == b) return row.kernel;
  }
  return nullptr;
}

}  // namespace slew::contact
