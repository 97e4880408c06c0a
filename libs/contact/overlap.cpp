// SPDX-License-Identifier: Apache-2.0
#include "contact/overlap.h"

#include <array>
#include <cstdint>
#include <utility>

#include "core/static_vector.h"

namespace slew::contact {
namespace {

using math::Vec3;

constexpr double kSettled = 1e-10;  // share of the shapes' size: a ten thousandth of the depth of a load on stiff
                                    // springs
constexpr double kInPlane = 1e-12;  // share of the shapes' size: rounding of a point's distance from a plane
constexpr int kMostRounds = 64;
constexpr std::size_t kMostPoints = 80;

// A point of D and its source points, in world axes from A's origin.
struct Corner {
  Vec3 x, on_a, on_b;
};

struct Difference {
  const Solid& a;
  const Solid& b;
  Vec3 p_AB = b.p_WS - a.p_WS;

  [[nodiscard]] Corner within() const noexcept {
    const Vec3 on_a = a.R_WS * a.geometry->inside, on_b = p_AB + b.R_WS * b.geometry->inside;
    return {on_b - on_a, on_a, on_b};
  }
  // the point of D farthest along d
  [[nodiscard]] Corner farthest(Vec3 d) const noexcept {
    const Vec3 on_a = a.R_WS * farthest_point(*a.geometry, transpose_multiply(a.R_WS, -d));
    const Vec3 on_b = p_AB + b.R_WS * farthest_point(*b.geometry, transpose_multiply(b.R_WS, d));
    return {on_b - on_a, on_a, on_b};
  }
};

// a direction at a right angle to v, along no axis of the usual shapes
Vec3 across(Vec3 v) noexcept {
  const Vec3 n = cross(v, Vec3(0.36, 0.48, 0.8));
  return dot(n, n) > 1e-6 * dot(v, v) ? n : cross(v, Vec3(0.8, -0.36, 0.48));
}

// Step 1: the triangle of D through which the ray from `within` to the origin leaves.
class Portal {
 public:
  Portal(const Difference& difference, double size) noexcept : difference_(difference), size_(size) {}

  // false: the shapes do not overlap
  [[nodiscard]] bool find() noexcept { return begin() && turn_to_origin() && move_outwards(); }
  [[nodiscard]] const std::array<Corner, 4>& corners() const noexcept { return v_; }

 private:
  [[nodiscard]] bool begin() noexcept {
    v_[0] = difference_.within();
    // middles that coincide: any ray serves
    if (norm(v_[0].x) < kSettled * size_) v_[0].x = Vec3(kSettled * size_, 0, 0);
    if (!take(1, -v_[0].x)) return false;
    Vec3 n = cross(v_[1].x, v_[0].x);
    if (norm(n) < kInPlane * size_ * size_) n = across(v_[0].x);
    if (!take(2, n)) return false;
    n_ = cross(v_[1].x - v_[0].x, v_[2].x - v_[0].x);
    if (dot(n_, v_[0].x) > 0) {
      std::swap(v_[1], v_[2]);
      n_ = -n_;
    }
    return true;
  }

  [[nodiscard]] bool turn_to_origin() noexcept {
    for (int round = 0; round < kMostRounds; ++round) {
      if (!take(3, n_)) return false;
      int outside = 0;  // corner on whose other side the origin is
      if (dot(cross(v_[1].x, v_[3].x), v_[0].x) < 0) {
        outside = 2;
      } else if (dot(cross(v_[3].x, v_[2].x), v_[0].x) < 0) {
        outside = 1;
      }
      if (outside == 0) return true;
      v_[static_cast<std::size_t>(outside)] = v_[3];
      n_ = cross(v_[1].x - v_[0].x, v_[2].x - v_[0].x);
    }
    return false;
  }

  [[nodiscard]] bool move_outwards() noexcept {
    for (int round = 0; round < kMostRounds; ++round) {
      Vec3 n = cross(v_[2].x - v_[1].x, v_[3].x - v_[1].x);
      const double area = norm(n);
      if (!(area > 0)) return false;
      n = n * (1 / area);
      if (dot(n, v_[1].x) >= 0) return true;
      const Corner next = difference_.farthest(n);
      if (!(dot(next.x, n) > 0) || dot(next.x - v_[3].x, n) <= kInPlane * size_) return false;
      const Vec3 side = cross(next.x, v_[0].x);
      const std::size_t replaced =
          dot(v_[1].x, side) > 0 ? (dot(v_[2].x, side) > 0 ? 1 : 3) : (dot(v_[3].x, side) > 0 ? 2 : 1);
      v_[replaced] = next;
    }
    return false;
  }

  // false: the plane at a right angle to d parts the shapes
  [[nodiscard]] bool take(std::size_t i, Vec3 d) noexcept {
    const double length = norm(d);
    if (!(length > 0)) return false;
    v_[i] = difference_.farthest(d * (1 / length));
    return dot(v_[i].x, d) > 0;
  }

  const Difference& difference_;
  double size_;
  std::array<Corner, 4> v_;
  Vec3 n_;
};

// Step 2.
class Polytope {
 public:
  explicit Polytope(double size) noexcept : in_plane_(kInPlane * size) {}

  // false: it has no volume
  [[nodiscard]] bool begin(const std::array<Corner, 4>& tetrahedron) noexcept {
    for (const Corner& corner : tetrahedron) corners_.push_back(corner);
    const Vec3 x = corners_[0].x;
    const double volume = dot(cross(corners_[1].x - x, corners_[2].x - x), corners_[3].x - x);
    // counter-clockwise seen from outside
    const bool is_right_handed = volume > 0;
    for (const auto& face : {std::array<std::uint8_t, 3>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
      if (!add(face[0], is_right_handed ? face[1] : face[2], is_right_handed ? face[2] : face[1])) return false;
    }
    return true;
  }

  struct Face {
    std::array<std::uint8_t, 3> corner{};
    Vec3 n;               // outward, unit
    double distance = 0;  // distance of its plane from the origin
  };

  [[nodiscard]] const Face& nearest() const noexcept {
    std::size_t best = 0;
    for (std::size_t i = 1; i < faces_.size(); ++i) {
      if (faces_[i].distance < faces_[best].distance) best = i;
    }
    return faces_[best];
  }

  // false: no room, or rounding made a face without area
  [[nodiscard]] bool grow(const Corner& corner) noexcept {
    if (corners_.size() == Corners::capacity()) return false;
    const auto index = static_cast<std::uint8_t>(corners_.size());
    corners_.push_back(corner);
    edges_.clear();
    std::size_t kept = 0;
    for (const Face& face : faces_) {
      if (dot(corner.x - corners_[face.corner[0]].x, face.n) > -in_plane_) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (!note_edge(face.corner[k], face.corner[(k + 1) % 3])) return false;
        }
      } else {
        faces_[kept++] = face;
      }
    }
    faces_.resize(kept);
    for (const Edge& edge : edges_) {
      if (faces_.size() == Faces::capacity() || !add(edge.from, edge.to, index)) return false;
    }
    return !faces_.empty();
  }

  // half way between the points of both shapes behind the face's point nearest to the origin, from A's origin
  [[nodiscard]] Vec3 middle_of(const Face& face) const noexcept {
    const Corner &a = corners_[face.corner[0]], &b = corners_[face.corner[1]], &c = corners_[face.corner[2]];
    const Vec3 foot = face.n * face.distance;
    const Vec3 normal = cross(b.x - a.x, c.x - a.x);
    const double area2 = dot(normal, normal);
    const double v = dot(cross(foot - a.x, c.x - a.x), normal) / area2;
    const double w = dot(cross(b.x - a.x, foot - a.x), normal) / area2;
    const auto weighted = [&](Vec3 at_a, Vec3 at_b, Vec3 at_c) { return at_a * (1 - v - w) + at_b * v + at_c * w; };
    return (weighted(a.on_a, b.on_a, c.on_a) + weighted(a.on_b, b.on_b, c.on_b)) * 0.5;
  }

 private:
  struct Edge {
    std::uint8_t from = 0, to = 0;
  };
  using Corners = StaticVector<Corner, kMostPoints + 4>;
  using Faces = StaticVector<Face, 2 * (kMostPoints + 4)>;

  [[nodiscard]] bool add(std::uint8_t a, std::uint8_t b, std::uint8_t c) noexcept {
    Vec3 n = cross(corners_[b].x - corners_[a].x, corners_[c].x - corners_[a].x);
    const double area = norm(n);
    if (!(area > in_plane_ * in_plane_)) return false;
    n = n * (1 / area);
    faces_.push_back({{a, b, c}, n, dot(n, corners_[a].x)});
    return true;
  }

  // edges that two of the faces taken away share are inside
  [[nodiscard]] bool note_edge(std::uint8_t from, std::uint8_t to) noexcept {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (edges_[i].from != to || edges_[i].to != from) continue;
      edges_[i] = edges_.back();
      edges_.resize(edges_.size() - 1);
      return true;
    }
    if (edges_.size() == edges_.capacity()) return false;
    edges_.push_back({from, to});
    return true;
  }

  double in_plane_;
  Corners corners_;
  Faces faces_;
  StaticVector<Edge, 2 * (kMostPoints + 4)> edges_;
};

}  // namespace

double overlap_along(const Solid& a, const Solid& b, Vec3 n_W) noexcept {
  const Difference difference{a, b};
  return dot(difference.farthest(n_W).x, n_W);
}

Overlap find_overlap(const Solid& a, const Solid& b) noexcept {
  const double size = a.geometry->bounding_radius + b.geometry->bounding_radius;
  const Difference difference{a, b};
  Portal portal(difference, size);
  if (!portal.find()) return {};
  Polytope polytope(size);
  Overlap best{.is_found = false, .has_settled = false, .n_W = {}, .depth = 2 * size, .p_W = {}};
  bool grows = polytope.begin(portal.corners());
  while (grows) {
    const auto face = polytope.nearest();
    const Corner corner = difference.farthest(face.n);
    const double overlap = dot(corner.x, face.n);
    if (overlap < best.depth) {
      best = {true, false, face.n, overlap, a.p_WS + polytope.middle_of(face)};
    }
    if (overlap - face.distance <= kSettled * size) {
      best.has_settled = true;
      break;
    }
    grows = polytope.grow(corner);
  }
  best.is_found = best.is_found && best.depth > 0;
  return best;
}

}  // namespace slew::contact
