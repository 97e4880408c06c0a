// SPDX-License-Identifier: Apache-2.0
// Distance of two convex shapes, with a proof (docs/models/sensors.md).
//
// The differences of their points, D = {a - b}, make a convex set, and the distance is that of D from the origin.
// A simplex of up to four points of D grows by the point of D that is farthest towards the origin, and shrinks to the
// corners of the side on which its point v nearest to the origin lies (Gilbert, Johnson, Keerthi 1988). With w that
// farthest point,
//   v . w / |v| <= distance <= |v|                                                                      (1)
// Every v is a point of D, also where rounding spoils a flat simplex, so both bounds hold always; a search that stands
// still begins again from v itself.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>

#include <fcl/common/types.h>

namespace slew::sensors::fcl_border {

using Vector3 = fcl::Vector3d;

constexpr double kEnough = 1e-13;       // share of the shapes' size: (1) is closed
constexpr double kProved = 1e-7;        // the same: the widest gap of (1) that counts as a distance, seen: 7e-9
constexpr double kTouching = 1e-14;     // the same: rounding of a difference of points
constexpr int kMostDifferences = 1000;  // of D, in a search; polyhedra need some ten, a cylinder up to a hundred

// A point of D and where it comes from.
struct Difference {
  Vector3 x, on_a, on_b;
};

struct ConvexDistance {
  bool is_proved = false;  // the bounds (1) meet
  double distance = 0;     // m; 0: they touch or overlap
  Vector3 on_a, on_b;      // nearest points
};

namespace simplex {

struct Corners {
  std::array<Difference, 4> at;
  std::size_t count = 0;
};

// A point of the simplex: its corners with their weights.
struct Nearest {
  Vector3 x;
  double square = std::numeric_limits<double>::infinity();
  std::array<std::size_t, 4> corner{};
  std::array<double, 4> weight{};
  std::size_t count = 0;
};

inline void take(const Corners& s, std::initializer_list<std::size_t> corner, std::initializer_list<double> weight,
                 Nearest& nearest) {
  Vector3 x = Vector3::Zero();
  for (std::size_t k = 0; k < corner.size(); ++k) x += weight.begin()[k] * s.at[corner.begin()[k]].x;
  if (!(x.squaredNorm() < nearest.square)) return;
  nearest = {x, x.squaredNorm(), {}, {}, corner.size()};
  std::copy(corner.begin(), corner.end(), nearest.corner.begin());
  std::copy(weight.begin(), weight.end(), nearest.weight.begin());
}

inline void try_edge(const Corners& s, std::size_t i, std::size_t j, Nearest& nearest) {
  const Vector3 &a = s.at[i].x, edge = s.at[j].x - a;
  const double length2 = edge.squaredNorm(), along = -a.dot(edge);
  if (along > 0 && along < length2) take(s, {i, j}, {1 - along / length2, along / length2}, nearest);
}

inline void try_triangle(const Corners& s, std::size_t i, std::size_t j, std::size_t k, Nearest& nearest) {
  const Vector3 &a = s.at[i].x, ab = s.at[j].x - a, ac = s.at[k].x - a;
  const Vector3 n = ab.cross(ac);
  const double area2 = n.squaredNorm();
  if (!(area2 > 0)) return;
  const double v = a.cross(ac).dot(n) / -area2, w = ab.cross(a).dot(n) / -area2, u = 1 - v - w;
  if (u > 0 && v > 0 && w > 0) take(s, {i, j, k}, {u, v, w}, nearest);
}

// The origin is within the tetrahedron, not only by rounding.
inline bool holds_origin(const Corners& s) {
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3& a = s.at[(i + 1) % 4].x;
    const Vector3 n = (s.at[(i + 2) % 4].x - a).cross(s.at[(i + 3) % 4].x - a);
    const double height = n.dot(s.at[i].x - a), of_origin = -n.dot(a);
    if (!(height > 0 ? of_origin >= 0 && of_origin <= height : of_origin <= 0 && of_origin >= height)) return false;
  }
  return true;
}

// The sides without the last corner, which is new, are no nearer than before.
inline Nearest nearest_of(const Corners& s) {
  Nearest nearest;
  const std::size_t last = s.count - 1;
  take(s, {last}, {1}, nearest);
  for (std::size_t i = 0; i < last; ++i) {
    try_edge(s, last, i, nearest);
    for (std::size_t k = 0; k < i; ++k) try_triangle(s, last, i, k, nearest);
  }
  return nearest;
}

// Keeps the corners of the nearest point, and returns this as a point of D.
inline Difference shrink(Corners& s, Nearest nearest) {
  Difference point{nearest.x, Vector3::Zero(), Vector3::Zero()};
  for (std::size_t k = 0; k < nearest.count; ++k) {
    point.on_a += nearest.weight[k] * s.at[nearest.corner[k]].on_a;
    point.on_b += nearest.weight[k] * s.at[nearest.corner[k]].on_b;
  }
  const auto kept = nearest.corner.begin();
  std::sort(kept, kept + static_cast<std::ptrdiff_t>(nearest.count));
  for (s.count = 0; s.count < nearest.count; ++s.count) {
    if (nearest.corner[s.count] != s.count) s.at[s.count] = s.at[nearest.corner[s.count]];
  }
  return point;
}

}  // namespace simplex

// farthest(d): the point of D that is farthest along d, which need not be a unit vector.
template <typename Farthest>
ConvexDistance find_convex_distance(const Farthest& farthest) {
  simplex::Corners s;
  s.at[s.count++] = farthest(Vector3(-1, 0, 0));
  Difference v = s.at[0];
  double size = std::max(v.on_a.norm(), v.on_b.norm());
  double gap = 0;  // of (1), times |v|
  for (int i = 0; i < kMostDifferences; ++i) {
    const double square = v.x.squaredNorm(), length = std::sqrt(square);
    if (length <= kTouching * size) return {true, 0, v.on_a, v.on_b};
    const Difference w = farthest(-v.x);
    size = std::max({size, w.on_a.norm(), w.on_b.norm()});
    gap = square - v.x.dot(w.x);
    if (gap <= kEnough * size * length) break;
    s.at[s.count++] = w;
    if (s.count == 4 && simplex::holds_origin(s)) return {true, 0, v.on_a, v.on_b};
    simplex::Nearest next = simplex::nearest_of(s);
    if (!(next.square < square)) {
      s.at[0] = v;
      s.at[1] = w;
      s.count = 2;
      next = simplex::nearest_of(s);
      if (!(next.square < square)) break;
    }
    v = simplex::shrink(s, next);
  }
  const double length = v.x.norm();
  // near contact the direction of v is known less well, and the distance is small itself
  const bool is_proved = gap <= kProved * size * length || gap <= kTouching * size * size;
  return {is_proved, length, v.on_a, v.on_b};
}

}  // namespace slew::sensors::fcl_border
