// SPDX-License-Identifier: Apache-2.0
// A capsule against a box: the nearest points of its axis, then of the part of it that runs along a face.
#include <algorithm>
#include <cmath>

#include "contact/kernels.h"

namespace slew::contact {
namespace {

using math::Vec3;

// the capsule's axis in the box's axes: centre + s direction
struct CapsuleAxis {
  Vec3 centre, direction, half_size;

  [[nodiscard]] Vec3 at(double s) const noexcept { return centre + direction * s; }
  [[nodiscard]] Vec3 outside(double s) const noexcept {
    const Vec3 p = at(s);
    Vec3 away;
    for (int k = 0; k < 3; ++k) away.lanes[k] = p[k] - std::clamp(p[k], -half_size[k], half_size[k]);
    return away;
  }
  // half the slope over s of the squared distance to the box; it never falls, since the box is convex
  [[nodiscard]] double slope(double s) const noexcept { return dot(outside(s), direction); }
};

// where the distance stops falling between -half and half: halving of a slope that never falls
double nearest_along(const CapsuleAxis& axis, double half) noexcept {
  if (axis.slope(-half) >= 0) return -half;
  if (axis.slope(half) <= 0) return half;
  constexpr int kRounds = 60;  // more than a double has bits
  double low = -half, high = half;
  for (int i = 0; i < kRounds; ++i) {
    const double middle = (low + high) / 2;
    (axis.slope(middle) < 0 ? low : high) = middle;
  }
  return high;
}

// the interval of s in which the axis is over the face that looks along k; kNoFace: inside the box
struct Interval {
  double low, high;
};
constexpr int kNoFace = -1;

Interval over_face(const CapsuleAxis& axis, int k, double half) noexcept {
  Interval part{-half, half};
  for (int j = 0; j < 3; ++j) {
    const double d = axis.direction[j];
    if (j == k || d == 0) continue;
    const double first = (-axis.half_size[j] - axis.centre[j]) / d, second = (axis.half_size[j] - axis.centre[j]) / d;
    part.low = std::max(part.low, std::min(first, second));
    part.high = std::min(part.high, std::max(first, second));
  }
  return part;
}

}  // namespace

void capsule_box(const Solid& a, const Solid& b, Manifold& out) noexcept {
  const double half = a.geometry->half_length, radius = a.geometry->radius;
  const CapsuleAxis axis{b.to_shape(a.p_WS), transpose_multiply(b.R_WS, a.R_WS.c[2]), b.geometry->half_size};
  const auto add_ball = [&](double s) { ball_box(a.p_WS + a.R_WS.c[2] * s, radius, b, out); };
  const double nearest = nearest_along(axis, half);
  const Vec3 away = axis.outside(nearest);
  if (norm(away) >= radius) return;
  // grazing counts as inside: the direction of a distance of rounding size has no meaning
  constexpr double kGrazing = 1e-9;
  if (norm(away) < kGrazing * radius) {
    // the axis itself is inside: from the middle of that part out through the nearest face
    const Interval inside = over_face(axis, kNoFace, half);
    add_ball((inside.low + inside.high) / 2);
    return;
  }
  // over a face: the two ends of the part above it
  constexpr double kSquare = 0.9999;  // the axis may lean by 0.8 degrees
  for (int k = 0; k < 3; ++k) {
    if (!(std::fabs(away[k]) > 0) || std::fabs(away[k]) < kSquare * norm(away)) continue;
    Interval part = over_face(axis, k, half);
    // leaning over the face's edge, the nearest point is beside it
    part.low = std::min(part.low, nearest);
    part.high = std::max(part.high, nearest);
    const double shortest = radius * 1e-3;  // shorter ones are one point
    if (part.high - part.low < shortest) continue;
    add_ball(part.low);
    add_ball(part.high);
    return;
  }
  add_ball(nearest);
}

}  // namespace slew::contact
