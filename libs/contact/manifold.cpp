// SPDX-License-Identifier: Apache-2.0
#include "contact/manifold.h"

#include <algorithm>
#include <limits>

namespace slew::contact {
namespace {

using math::Vec3;

// a polygon gains at most one vertex per side that clips it
using Polygon = StaticVector<Vec3, 2 * kMaxFaceVertices>;

// the half space (x - on).inward >= 0
struct Side {
  Vec3 on, inward;
  [[nodiscard]] double distance(Vec3 x) const noexcept { return dot(x - on, inward); }
};

// Sutherland and Hodgman: the part of a polygon, or of an edge, inside one side
Polygon clipped(const Polygon& in, const Side& side) noexcept {
  Polygon out;
  const std::size_t n = in.size();
  const bool is_open = n == 2;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 here = in[i], next = in[(i + 1) % n];
    const double d = side.distance(here), d_next = side.distance(next);
    if (d >= 0 && out.size() < Polygon::capacity()) out.push_back(here);
    if (is_open && i == 1) break;
    if (n > 1 && (d >= 0) != (d_next >= 0) && out.size() < Polygon::capacity()) {
      out.push_back(here + (next - here) * (d / (d - d_next)));
    }
  }
  return out;
}

// Areas represented by the corners of a plane polygon or of an edge.
using Areas = std::array<double, Polygon::capacity()>;

Areas areas_of(const Polygon& polygon) noexcept {
  Areas areas;
  areas.fill(kSpot);
  const std::size_t n = polygon.size();
  if (n == 2) areas[0] = areas[1] = std::max(kSpot, 0.5 * kStrip * norm(polygon[1] - polygon[0]));
  if (n < 3) return areas;
  // triangles to the first corner; their areas as vectors, all along the polygon's normal
  Vec3 sum, moment;
  for (std::size_t i = 2; i < n; ++i) {
    const Vec3 to_last = polygon[i - 1] - polygon[0], to_this = polygon[i] - polygon[0];
    const Vec3 twice = cross(to_last, to_this);
    sum += twice;
    moment += (to_last + to_this) * (norm(twice) / 3);
  }
  const double whole = norm(sum);
  if (!(whole > 0)) return areas;
  const Vec3 centroid = polygon[0] + moment * (1 / whole);
  areas.fill(0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const double quarter = norm(cross(polygon[i] - centroid, polygon[next] - centroid)) / 4;
    areas[i] += quarter;
    areas[next] += quarter;
  }
  // give every corner an area: it may be the only one inside
  constexpr double kLeastShare = 1e-9;
  for (std::size_t i = 0; i < n; ++i) areas[i] = std::max(areas[i], kLeastShare * whole);
  return areas;
}

bool is_polygon(const Face& face) noexcept {
  return face.vertices.size() >= 3;
}

}  // namespace

void clip_faces(const Face& a, const Face& b, Vec3 n_W, Manifold& out) noexcept {
  // the reference: the polygon that faces the other shape more squarely; A faces -n, B faces n
  const double of_a = is_polygon(a) ? -dot(a.normal, n_W) : 0.0;
  const double of_b = is_polygon(b) ? dot(b.normal, n_W) : 0.0;
  // take B's of nearly equal polygons, so that rounding does not swap them
  constexpr double kPreference = 1e-6;
  const bool b_is_reference = of_b >= of_a - kPreference && of_b > 0;
  const double squareness = b_is_reference ? of_b : of_a;
  // a face at an angle to the normal is not the touching one (edge on edge, curved shapes); 0.8 degrees allow for the
  // accuracy of an iterated normal
  constexpr double kSquare = 0.9999;
  if (!(squareness > kSquare)) return;
  const Face& reference = b_is_reference ? b : a;
  const Face& incident = b_is_reference ? a : b;

  Polygon polygon;
  for (const Vec3& vertex : incident.vertices) polygon.push_back(vertex);
  const std::size_t sides = reference.vertices.size();
  for (std::size_t i = 0; i < sides && !polygon.empty(); ++i) {
    const Vec3 edge = reference.vertices[(i + 1) % sides] - reference.vertices[i];
    polygon = clipped(polygon, {reference.vertices[i], cross(reference.normal, edge)});
  }
  // depth along n: from the incident point to the reference plane
  const Vec3 towards = b_is_reference ? n_W : -n_W;
  const Areas areas = areas_of(polygon);
  for (std::size_t i = 0; i < polygon.size() && out.size() < Manifold::capacity(); ++i) {
    const double depth = dot(reference.vertices[0] - polygon[i], reference.normal) / squareness;
    if (depth > 0) out.push_back({polygon[i] + towards * (depth / 2), n_W, depth, areas[i]});
  }
}

void reduce(Manifold& points) noexcept {
  if (points.size() <= kMaxPointsPerPair) return;
  std::array<bool, Manifold::capacity()> is_kept{};
  std::array<double, Manifold::capacity()> distance{};  // squared distance to the nearest kept point
  distance.fill(std::numeric_limits<double>::infinity());
  std::size_t chosen = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].depth > points[chosen].depth) chosen = i;
  }
  for (std::size_t kept = 0; kept < kMaxPointsPerPair; ++kept) {
    is_kept[chosen] = true;
    std::size_t farthest = chosen;
    double largest = -1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (is_kept[i]) continue;
      const Vec3 away = points[i].p_W - points[chosen].p_W;
      distance[i] = std::min(distance[i], dot(away, away));
      if (distance[i] > largest) {
        largest = distance[i];
        farthest = i;
      }
    }
    chosen = farthest;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_kept[i]) continue;
    std::size_t nearest = chosen;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 away = points[k].p_W - points[i].p_W;
      if (!is_kept[k] || !(dot(away, away) < least)) continue;
      least = dot(away, away);
      nearest = k;
    }
    points[nearest].area += points[i].area;
  }
  std::size_t end = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (is_kept[i]) points[end++] = points[i];
  }
  points.resize(end);
}

}  // namespace slew::contact
