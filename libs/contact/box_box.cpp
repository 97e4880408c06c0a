// SPDX-License-Identifier: Apache-2.0
// Two boxes: separating axes, then face against face or edge against edge.
#include <algorithm>
#include <cmath>

#include "contact/kernels.h"

namespace slew::contact {
namespace {

using math::Mat3;
using math::Vec3;

// an edge axis must be better than the best face by this share, since faces carry more points
constexpr double kFaceOverEdge = 0.95;
// sine of the angle between two edges, below which they have no axis of their own
constexpr double kParallel = 1e-6;

struct Axis {
  double depth = 0;  // m, overlap along the normal
  Vec3 n_W;          // unit, from B to A
  int edge_a = -1, edge_b = -1;
  bool is_separating = false;
};

struct Boxes {
  const Solid& a;
  const Solid& b;
  Vec3 apart;  // from B's centre to A's

  [[nodiscard]] double reach(const Solid& s, Vec3 n) const noexcept {
    const Vec3 h = s.geometry->half_size;
    return h[0] * std::fabs(dot(s.R_WS.c[0], n)) + h[1] * std::fabs(dot(s.R_WS.c[1], n)) +
           h[2] * std::fabs(dot(s.R_WS.c[2], n));
  }
  [[nodiscard]] Axis along(Vec3 n) const noexcept {
    const double distance = dot(apart, n);
    const double depth = reach(a, n) + reach(b, n) - std::fabs(distance);
    return {depth, distance < 0 ? -n : n, -1, -1, !(depth > 0)};
  }
};

// the axis of least overlap, or a separating one
Axis best_axis(const Boxes& boxes) noexcept {
  Axis best = boxes.along(boxes.b.R_WS.c[0]);
  for (const Solid* solid : {&boxes.b, &boxes.a}) {
    for (const Vec3& normal : solid->R_WS.c) {
      const Axis axis = boxes.along(normal);
      if (axis.is_separating) return axis;
      if (axis.depth < best.depth) best = axis;
    }
  }
  double least = best.depth * kFaceOverEdge;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 product = cross(boxes.a.R_WS.c[i], boxes.b.R_WS.c[j]);
      const double length = norm(product);
      if (length < kParallel) continue;
      Axis axis = boxes.along(product * (1 / length));
      if (axis.is_separating) return axis;
      if (axis.depth < least) {
        least = axis.depth;
        best = axis;
        best.edge_a = i;
        best.edge_b = j;
      }
    }
  }
  return best;
}

// middle of the box's edge along its axis k that lies farthest in the direction d
Vec3 edge_middle(const Solid& s, int k, Vec3 d) noexcept {
  Vec3 p = s.p_WS;
  for (int i = 0; i < 3; ++i) {
    if (i == k) continue;
    p += s.R_WS.c[i] * (dot(s.R_WS.c[i], d) < 0 ? -s.geometry->half_size[i] : s.geometry->half_size[i]);
  }
  return p;
}

// nearest points of the two lines, half way
void add_edges(const Solid& a, const Solid& b, const Axis& axis, Manifold& out) noexcept {
  const Vec3 u = a.R_WS.c[axis.edge_a], w = b.R_WS.c[axis.edge_b];
  const Vec3 on_a = edge_middle(a, axis.edge_a, -axis.n_W), on_b = edge_middle(b, axis.edge_b, axis.n_W);
  const Vec3 r = on_b - on_a;
  const double uw = dot(u, w), sine2 = 1 - uw * uw;
  const double s = (dot(r, u) - uw * dot(r, w)) / sine2;
  const double t = (uw * dot(r, u) - dot(r, w)) / sine2;
  out.push_back({(on_a + u * s + on_b + w * t) * 0.5, axis.n_W, axis.depth});
}

}  // namespace

void box_box(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const Axis axis = best_axis({a, b, a.p_WS - b.p_WS});
  if (axis.is_separating) return;
  if (axis.edge_a >= 0) {
    add_edges(a, b, axis, out);
    return;
  }
  const std::size_t before = out.size();
  const Face of_a = supporting_face(a, -axis.n_W);
  clip_faces(of_a, supporting_face(b, axis.n_W), axis.n_W, out);
  if (out.size() > before) return;
  // a face was preferred over an edge with hardly less overlap, and no point of it is inside: A's lowest corner
  Vec3 lowest = of_a.vertices[0];
  for (const Vec3& p : of_a.vertices) {
    if (dot(p, axis.n_W) < dot(lowest, axis.n_W)) lowest = p;
  }
  out.push_back({lowest + axis.n_W * (axis.depth / 2), axis.n_W, axis.depth});
}

}  // namespace slew::contact
